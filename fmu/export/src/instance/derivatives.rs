//! Directional derivatives: which variables may be asked for in which state, and the sum over the knowns.
//!
//! The unknowns and knowns of each mode are those of FMI 2.0.4, section 2.1.9 and `dependencies` in section 2.2.8, but for
//! the independent variable, which need not be a variable.

use super::model_exchange::states_and_derivatives;
use super::values::variable;
use super::{Call, Instance};
use crate::call_state::CallState;
use crate::error::{CallError, SlaveError};
use crate::slave::Slave;
use crate::standard::Standard;
use crate::variable::{Causality, Kind, Variability, Variable};

/// The sum, unless the model knows none.
fn known_sum<S>(sum: f64, of: &Variable<S>) -> Call<f64> {
    if !sum.is_nan() {
        return Ok(sum);
    }
    let message = format!("there is no directional derivative of {} under these parameters", of.name());
    Err(SlaveError::error(message).into())
}

/// For each of `rows` the sum of `partial` of it and each of `columns` times the seed of that column.
fn sums<S>(
    rows: &[&Variable<S>],
    columns: &[&Variable<S>],
    seeds: &[f64],
    partial: impl Fn(&Variable<S>, &Variable<S>) -> f64,
    mut write: impl FnMut(usize, f64),
) -> Call {
    for (i, row) in rows.iter().enumerate() {
        let terms = columns.iter().zip(seeds).filter(|(_, seed)| **seed != 0.0);
        let sum: f64 = terms.map(|(column, seed)| partial(row, column) * seed).sum();
        write(i, known_sum(sum, row)?);
    }
    Ok(())
}

impl<S: Slave> Instance<S> {
    /// The argument of the C functions that holds the seeds.
    pub(crate) const fn seed_argument(&self) -> &'static str {
        match self.session.standard {
            Standard::Fmi2 => "dvKnown",
            Standard::Fmi3 => "seed",
        }
    }

    /// `fmi2GetDirectionalDerivative`: for each unknown the sum of its partial derivatives times the seeds.
    pub(crate) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        write: impl FnMut(usize, f64),
    ) -> Call {
        let [unknowns, knowns] = self.unknowns_and_knowns(unknowns, knowns, seeds)?;
        sums(&unknowns, &knowns, seeds, |unknown, known| self.partial_derivative(unknown, known), write)
    }

    /// `fmi3GetAdjointDerivative`: for each known the sum of the partial derivatives with respect to it times the seeds.
    pub(crate) fn adjoint_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        write: impl FnMut(usize, f64),
    ) -> Call {
        let [unknowns, knowns] = self.unknowns_and_knowns(unknowns, knowns, seeds)?;
        sums(&knowns, &unknowns, seeds, |known, unknown| self.partial_derivative(unknown, known), write)
    }

    /// The rows of both, as values that are set have them, once the seeds are found usable.
    fn unknowns_and_knowns(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
    ) -> Call<[Vec<&'static Variable<S>>; 2]> {
        self.check_seeds(seeds)?;
        self.update()?;
        let knowns = knowns.iter().map(|&reference| self.known(reference)).collect::<Call<Vec<_>>>()?;
        let unknowns = unknowns.iter().map(|&reference| self.unknown(reference)).collect::<Call<Vec<_>>>()?;
        Ok([unknowns, knowns])
    }

    fn check_seeds(&self, seeds: &[f64]) -> Call {
        if !S::INFO.directional_derivatives {
            return Err(CallError::Unsupported("directional derivatives"));
        }
        let Some(seed) = seeds.iter().find(|seed| !seed.is_finite()) else { return Ok(()) };
        let bound = "it must be finite".into();
        Err(CallError::BadArgument { argument: self.seed_argument(), value: seed.to_string(), bound })
    }

    /// Between events discrete variables are constant: their derivatives are zero. In model exchange, after initialisation, an
    /// unknown depends on what its row of the table says and on nothing else.
    ///
    /// Not so in co-simulation: the dependencies are those "at the current Communication Point", of `f_output` and `f_der`
    /// (section 2.2.8), but the equations of Step Mode are `f_doStep` (section 4.1), through which an input of the step acts
    /// on an output that does not depend on the input of the same communication point.
    fn partial_derivative(&self, unknown: &Variable<S>, known: &Variable<S>) -> f64 {
        let ask = !self.core.exchange
            || self.core.state.is_before_initialization()
            || unknown.dependencies().is_none_or(|names| names.contains(&known.name()));
        let constant = |variable: &Variable<S>| variable.variability() == Variability::Discrete;
        let between_events = self.core.state == CallState::ContinuousTimeMode;
        let asked = ask && !(between_events && (constant(unknown) || constant(known)));
        let derivative = if let Kind::Real(spec) = unknown.kind() { spec.partial_derivative } else { None };
        derivative.filter(|_| asked).map_or(0.0, |derivative| derivative(&self.core.model, known))
    }

    /// An input; during initialisation a parameter, afterwards a continuous state, too.
    fn known(&self, reference: u32) -> Call<&'static Variable<S>> {
        let variable = variable::<S>(reference)?;
        let initializing = self.core.state.is_before_initialization();
        let is_state = || states_and_derivatives(S::variables()).any(|(state, _)| state.name() == variable.name());
        let may_be = match variable.causality() {
            Causality::Parameter => initializing,
            Causality::Input => true,
            _ => !initializing && is_state(),
        };
        self.check_real(variable, may_be, "known")
    }

    /// An output or the derivative of a continuous state; during initialisation a calculated parameter, too, but no variable of a
    /// clock, which has not ticked yet.
    fn unknown(&self, reference: u32) -> Call<&'static Variable<S>> {
        let variable = variable::<S>(reference)?;
        let initializing = self.core.state.is_before_initialization();
        let may_be = match variable.causality() {
            Causality::CalculatedParameter => initializing,
            Causality::Output => !initializing || variable.clocks().is_empty(),
            _ => variable.derivative_of().is_some(),
        };
        self.check_real(variable, may_be, "unknown")
    }

    fn check_real(
        &self,
        variable: &'static Variable<S>,
        may_be: bool,
        role: &'static str,
    ) -> Call<&'static Variable<S>> {
        if may_be && matches!(variable.kind(), Kind::Real(_)) {
            return Ok(variable);
        }
        Err(CallError::NoDerivative {
            name: variable.name(),
            type_name: self.type_name(variable),
            causality: variable.causality().as_str(),
            variability: variable.variability().as_str(),
            role,
            state: self.core.state,
        })
    }
}
