//! Steps, derivatives of inputs and outputs, and the status functions of co-simulation.

use super::values::variable;
use super::{Call, Instance};
use crate::call_state::CallState;
use crate::error::{CallError, Severity, SlaveError};
use crate::slave::Slave;
use crate::variable::{AsReal, Kind, Transfer, Variable};
use fmu_abi::{
    fmi2Discard, fmi2DoStepStatus, fmi2Error, fmi2Fatal, fmi2LastSuccessfulTime, fmi2OK, fmi2Status, fmi2StatusKind,
    fmi2Terminated, fmi2Warning,
};

/// How the last step went, for the status functions.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct LastStep {
    pub(super) status: fmi2Status,
    /// Time up to which it was carried out, s; `None` before the first.
    pub(super) successful_time: Option<f64>,
    /// The slave asked to end the simulation.
    pub(super) terminated: bool,
}

impl LastStep {
    pub(super) const NONE: Self = Self { status: fmi2OK, successful_time: None, terminated: false };
}

/// Relative difference of two communication points that comes from rounding.
const TIME_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Relative difference of two communication points that a master with a clock in single precision may have: one unit in
/// the last place for each.
const SINGLE_PRECISION: f64 = 2.0 * f32::EPSILON as f64;

/// Part of a step by which communication points may differ, whatever the clock of the master.
const PART_OF_STEP: f64 = 0.1;

/// How far two communication points may differ and still be the same, s: by 2.4e-7 of the time or of 1 s, if that is more,
/// but at most by a tenth of the step. Masters count time as `n * h`, as a sum, in integer nanoseconds or in single
/// precision; a difference that could be a step of its own is never accepted, unless it is rounding in double precision.
pub(super) fn time_tolerance(a: f64, b: f64, step: f64) -> f64 {
    let magnitude = a.abs().max(b.abs());
    (TIME_ROUNDING * magnitude).max((SINGLE_PRECISION * magnitude.max(1.0)).min(PART_OF_STEP * step))
}

impl<S: Slave> Instance<S> {
    /// `fmi2DoStep`
    pub(crate) fn do_step(&mut self, t: f64, h: f64) -> Call {
        self.check_step(t, h)?;
        let core = &mut *self.core;
        match core.model.do_step(t, h, &self.logger) {
            Ok(()) => {
                let status = if self.logger.has_warned() { fmi2Warning } else { fmi2OK };
                core.time = t + h;
                core.last_step = LastStep { status, successful_time: Some(t + h), terminated: false };
                Ok(())
            }
            Err(error) => Err(self.step_failed(t, error)),
        }
    }

    /// A step that is as it should be, as nearly all are, is seen at a glance.
    #[inline]
    pub(super) fn check_step(&self, t: f64, h: f64) -> Call {
        let (end, stop) = (t + h, self.core.experiment.and_then(|e| e.stop_time));
        let latest = stop.map_or(f64::MAX, |stop| stop.min(f64::MAX));
        if t < end && end <= latest && (t - self.core.time).abs() <= TIME_ROUNDING * t.abs() {
            return Ok(());
        }
        self.check_step_closely(t, h)
    }

    #[cold]
    fn check_step_closely(&self, t: f64, h: f64) -> Call {
        let refuse = |argument, value: f64, bound: String| {
            Err(CallError::BadArgument { argument, value: value.to_string(), bound })
        };
        if !t.is_finite() {
            return refuse("currentCommunicationPoint", t, "it must be finite".into());
        }
        if !(h.is_finite() && h > 0.0) {
            let bound = "it must be finite and positive".into();
            return refuse("communicationStepSize", h, bound);
        }
        if t + h <= t || !(t + h).is_finite() {
            let bound = format!("it does not advance time from {t} s");
            return refuse("communicationStepSize", h, bound);
        }
        let tolerance = time_tolerance(t, self.core.time, h);
        if (t - self.core.time).abs() > tolerance {
            return Err(CallError::WrongTime { found: t, expected: self.core.time, tolerance });
        }
        self.check_stop_time(t, h)
    }

    fn check_stop_time(&self, t: f64, h: f64) -> Call {
        let Some(stop) = self.core.experiment.and_then(|e| e.stop_time) else {
            return Ok(());
        };
        let tolerance = time_tolerance(t + h, t, h);
        if t + h - stop <= tolerance {
            return Ok(());
        }
        Err(CallError::BehindStopTime { from: t, to: t + h, stop, tolerance })
    }

    #[cold]
    fn step_failed(&mut self, t: f64, error: SlaveError) -> CallError {
        let reached = error.last_successful_time().unwrap_or(t);
        let status = match error.severity() {
            Severity::Discard => {
                self.core.state = CallState::StepFailed;
                fmi2Discard
            }
            Severity::Error => fmi2Error,
            Severity::Fatal => fmi2Fatal,
        };
        let terminated = error.wants_to_terminate();
        self.core.last_step = LastStep { status, successful_time: Some(reached), terminated };
        CallError::Slave(error)
    }

    /// `fmi2SetRealInputDerivatives`, all or nothing as a Set. Only inputs have such derivatives, and where the call is
    /// legal, those of all of them may be set: in state `instantiated`, too, where the inputs themselves may not.
    pub(crate) fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Call {
        let rows = || references.iter().zip(orders).zip(values);
        let mut checked = Vec::with_capacity(references.len());
        for ((&reference, &order), &value) in rows() {
            let variable = variable::<S>(reference)?;
            let Kind::Real(spec) = variable.kind() else {
                return Err(self.wrong_type(reference, <AsReal as Transfer<S>>::NAME));
            };
            let Some((highest, set)) = spec.input_derivatives else {
                return Err(no_derivatives(variable));
            };
            checked.push((set, check_order(variable, order, highest)?, value));
            if !value.is_finite() {
                return Err(CallError::BadValue {
                    name: variable.name(),
                    value: format!("derivative {value}"),
                    bound: "it must be finite".to_owned(),
                });
            }
        }
        for (set, order, value) in checked {
            set(&mut self.core.model, order, value);
        }
        self.core.dirty = true;
        Ok(())
    }

    /// `fmi2GetRealOutputDerivatives`
    pub(crate) fn get_output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        mut write: impl FnMut(usize, f64),
    ) -> Call {
        for (i, (&reference, &order)) in references.iter().zip(orders).enumerate() {
            let variable = variable::<S>(reference)?;
            let Kind::Real(spec) = variable.kind() else {
                return Err(self.wrong_type(reference, <AsReal as Transfer<S>>::NAME));
            };
            let Some((highest, get)) = spec.output_derivatives else {
                return Err(no_derivatives(variable));
            };
            let order = check_order(variable, order, highest)?;
            self.check_intermediate(variable, reference)?;
            write(i, get(&self.core.model, order));
        }
        Ok(())
    }

    /// `fmi2GetStatus`
    pub(crate) fn step_status(&self, kind: fmi2StatusKind) -> Call<fmi2Status> {
        match kind {
            fmi2DoStepStatus => Ok(self.core.last_step.status),
            _ => Err(CallError::NoStatus(kind)),
        }
    }

    /// `fmi2GetRealStatus`
    pub(crate) fn real_status(&self, kind: fmi2StatusKind) -> Call<f64> {
        match kind {
            fmi2LastSuccessfulTime => Ok(self.core.last_step.successful_time.unwrap_or(self.core.time)),
            _ => Err(CallError::NoStatus(kind)),
        }
    }

    /// `fmi2GetBooleanStatus`
    pub(crate) fn boolean_status(&self, kind: fmi2StatusKind) -> Call<bool> {
        match kind {
            fmi2Terminated => Ok(self.core.last_step.terminated),
            _ => Err(CallError::NoStatus(kind)),
        }
    }
}

fn no_derivatives<S: Slave>(variable: &Variable<S>) -> CallError {
    CallError::BadValue {
        name: variable.name(),
        value: "time derivative".to_owned(),
        bound: "this variable has none".to_owned(),
    }
}

fn check_order<S: Slave>(variable: &Variable<S>, order: i32, highest: u32) -> Call<u32> {
    let checked = u32::try_from(order).ok().filter(|n| (1..=highest).contains(n));
    checked.ok_or_else(|| CallError::BadValue {
        name: variable.name(),
        value: format!("derivative of order {order}"),
        bound: format!("allowed: 1 to {highest}"),
    })
}
