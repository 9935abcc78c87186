//! Harvester and embedded circuit in one process, without communication steps: the energies of [`crate::cosim`] in its limit of small
//! steps, as fast as C(t) can be worked out.
//!
//! The harvester goes from knot to knot of C(t): begins, peaks and ends of pulses. Between two knots the circuit gets C(t) as straight
//! lines, as many as keep their distance from C(t) below a bound; at the knots C(t) is exact, and the circuit is exact on each line.

use thiserror::Error;
use videg_circuit::{Circuit, Ledger, Settings};
use videg_model::{Harvester, ModelError, Setup, Side};

use crate::cosim::{Averages, CircuitSample, Gains, Powers};

/// Bound of the distance of the straight lines from C(t), over C(t), unless another is asked for.
pub const TOLERANCE: f64 = 1e-3;

const SIDES: [Side; 2] = [Side::Left, Side::Right];

/// Most lines between two knots.
const MOST: f64 = 1e4;

/// Why a coupled run failed.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum CoupledError {
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Circuit(#[from] videg_circuit::Error),
    #[error("contact.electrostaticFeedback = true: the voltages do not act back in a sweep; allowed: false, or videg cosim")]
    Feedback,
}

/// When a run ends, what it averages over, and how closely the circuit follows C(t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// End of the run, s.
    pub until: f64,
    /// Averaging window, s.
    pub window: [f64; 2],
    /// Bound of the distance of the lines from C(t), over C(t).
    pub tolerance: f64,
}

/// Results of a coupled run.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// Of the mechanics, over the window.
    pub averages: Averages,
    /// Of the circuit, over the window.
    pub powers: Powers,
    /// The circuit at the end.
    pub circuit: CircuitSample,
    /// Straight lines that the circuit was given.
    pub lines: u64,
}

/// Runs the harvester of `setup` with a circuit of `settings` from 0 s on, both membranes charged.
///
/// # Errors
/// Parameters that harvester or circuit refuse; electrostatic feedback; more events than can be resolved.
pub fn run<'a>(setup: impl Into<Setup<'a>>, settings: &Settings, times: &Times) -> Result<Results, CoupledError> {
    let setup = setup.into();
    if setup.parameters.electrostatic_feedback {
        return Err(CoupledError::Feedback);
    }
    let harvester = Harvester::new(setup, 0.0)?;
    let circuit = Circuit::new(settings.parameters(), capacitance(&harvester))?;
    Coupled { harvester, circuit, tolerance: times.tolerance, lines: 0 }.run(times)
}

struct Coupled {
    harvester: Harvester,
    circuit: Circuit,
    tolerance: f64,
    lines: u64,
}

impl Coupled {
    fn run(mut self, times: &Times) -> Result<Results, CoupledError> {
        let [from, to] = times.window;
        let before = self.at(from)?;
        let after = self.at(to)?;
        self.at(times.until)?;
        Ok(Results {
            averages: Averages::over(times.window, &before.0, &after.0),
            powers: Powers::over(times.window, &before.1, &after.1),
            circuit: CircuitSample::from(&self.circuit),
            lines: self.lines,
        })
    }

    /// Goes on to `time`, s; the sums there.
    fn at(&mut self, time: f64) -> Result<(Gains, Ledger), CoupledError> {
        while self.harvester.time() < time {
            let now = self.harvester.time();
            let knot = self.harvester.next_knot().filter(|knot| *knot > now).unwrap_or(f64::INFINITY);
            self.piece(knot.min(self.harvester.known_until()).min(time))?;
        }
        let totals = self.harvester.totals();
        let impacts = i32::try_from(totals.impacts).unwrap_or(i32::MAX);
        Ok((Gains { voltage: totals.voltage_gain, energy: totals.energy, impacts }, self.circuit.ledger()))
    }

    /// Goes on to `end`, s, over a stretch on which C(t) is smooth.
    fn piece(&mut self, end: f64) -> Result<(), CoupledError> {
        let start = self.harvester.time();
        let is_flat = SIDES.into_iter().all(|side| {
            let deflection = self.harvester.deflection(side);
            deflection.value == 0.0 && deflection.rate == 0.0
        });
        let count = if is_flat && self.harvester.present_impact().is_none() { 1 } else { self.count(end)? };
        for k in 1..=count {
            let next = if k == count { end } else { start + (end - start) * (f64::from(k) / f64::from(count)) };
            let step = next - self.harvester.time();
            self.harvester.advance(next)?;
            self.circuit.advance(step, capacitance(&self.harvester))?;
            self.lines += 1;
        }
        Ok(())
    }

    /// Lines that stay close to C(t) up to `end`, s: a chord of the length h is off by at most h^2/8 times the curvature, here that of
    /// the cubic through values and rates at both ends.
    fn count(&self, end: f64) -> Result<u32, CoupledError> {
        let length = end - self.harvester.time();
        let mut ahead = self.harvester.clone();
        // What happens at the end changes rates there.
        ahead.advance(end.next_down().max(self.harvester.time()))?;
        let curvature = |side: Side| {
            let [c0, c1] = [&self.harvester, &ahead].map(|harvester| harvester.capacitance(side));
            let [r0, r1] = [&self.harvester, &ahead].map(|harvester| length * harvester.capacitance_rate(side));
            let ends = [6.0 * (c1 - c0) - 4.0 * r0 - 2.0 * r1, 6.0 * (c0 - c1) + 2.0 * r0 + 4.0 * r1];
            ends[0].abs().max(ends[1].abs()) / c0.min(c1)
        };
        let largest = SIDES.into_iter().map(curvature).fold(0.0, f64::max);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 1 to MOST
        Ok((largest / (8.0 * self.tolerance)).sqrt().ceil().clamp(1.0, MOST) as u32)
    }
}

fn capacitance(harvester: &Harvester) -> [f64; 2] {
    SIDES.map(|side| harvester.capacitance(side))
}
