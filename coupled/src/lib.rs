//! Harvester and embedded circuit in one process, without communication steps: the energies of a co-simulation in its limit of small
//! steps, as fast as C(t) can be worked out.
//!
//! The harvester goes from knot to knot of C(t): begins, peaks and ends of pulses. Between two knots the circuit gets C(t) as straight
//! lines, as many as keep their distance from C(t) below a bound; at the knots C(t) is exact, and the circuit is exact on each line.
//! A [`Track`] keeps C(t), so that many circuits can follow it.
#![forbid(unsafe_code)]

mod averages;
mod film;
mod impacts;
mod mechanics;
mod pulses;
mod simulation;
mod track;
mod voltages;

use thiserror::Error;
use videg_circuit::{Circuit, CircuitSample, Ledger, Settings};
use videg_model::{ModelError, Setup};

pub use averages::{Averages, Gains, Powers};
pub use film::{Film, OVER_LIMITS, Watch};
pub use impacts::Impacts;
use mechanics::{Follower, Piece};
pub use simulation::Simulation;
pub use track::Track;
pub use voltages::{Given, best_release_voltage};

/// Bound of the distance of the straight lines from C(t), over C(t), unless another is asked for.
pub const TOLERANCE: f64 = 1e-3;

/// Why a coupled run failed.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum CoupledError {
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Circuit(#[from] videg_circuit::Error),
    #[error(
        "contact.electrostaticFeedback = true: the voltages do not act back in a sweep; allowed: false, or videg cosim"
    )]
    Feedback,
    #[error("tolerance = {tolerance}: allowed: above 0")]
    Tolerance { tolerance: f64 },
    #[error("window = {from},{to} s and until = {until} s: allowed: 0 <= from < to <= until, finite")]
    Times { from: f64, to: f64, until: f64 },
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

impl Times {
    fn check(&self) -> Result<(), CoupledError> {
        let Self { until, window: [from, to], .. } = *self;
        // NaN fails each comparison.
        let are_times = 0.0 <= from && from < to && to <= until && until.is_finite();
        if are_times { Ok(()) } else { Err(CoupledError::Times { from, to, until }) }
    }
}

/// Results of a coupled run.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// Of the mechanics, over the window.
    pub averages: Averages,
    /// Of the circuit, over the window.
    pub powers: Powers,
    /// Mean flows of the circuit over the window: powers, W, and currents, A.
    pub flows: Ledger,
    /// The circuit at the end.
    pub circuit: CircuitSample,
    /// Straight lines that the circuit was given.
    pub lines: u64,
}

/// Runs the harvester of `setup` with a circuit of `settings` from 0 s on, both membranes charged.
///
/// # Errors
/// Parameters that harvester or circuit refuse; electrostatic feedback; times that are none; more events than can be resolved.
pub fn run<'a>(setup: impl Into<Setup<'a>>, settings: &Settings, times: &Times) -> Result<Results, CoupledError> {
    run_watched(setup, settings, times, &mut ())
}

/// The same, while `watch` looks at the films.
///
/// # Errors
/// As [`run`].
pub fn run_watched<'a>(
    setup: impl Into<Setup<'a>>,
    settings: &Settings,
    times: &Times,
    watch: &mut dyn Watch,
) -> Result<Results, CoupledError> {
    times.check()?;
    let mut simulation = Simulation::new(setup, settings, times.tolerance, watch)?;
    let mut sums = |time: f64| simulation.advance(time).map(|()| (simulation.gains(), simulation.circuit().ledger()));
    let [before, after] = times.window;
    let (before, after) = (sums(before)?, sums(after)?);
    simulation.advance(times.until)?;
    let averages = Averages::over(times.window, &before.0, &after.0);
    Ok(simulation.electrics.results(averages, times.window, [before.1, after.1]))
}

/// The circuit of a run, which follows C(t).
struct Electrics<'w> {
    circuit: Circuit,
    watch: &'w mut dyn Watch,
    lines: u64,
}

impl<'w> Electrics<'w> {
    /// A circuit of `settings` with charged membranes, where `start` ends.
    fn new(settings: &Settings, start: Piece<'_>, watch: &'w mut dyn Watch) -> Result<Self, CoupledError> {
        let circuit = Circuit::new(settings.parameters(), start.end())?;
        watch.look(0.0, start.deflection(0), circuit.voltage());
        Ok(Self { circuit, watch, lines: 0 })
    }

    fn results(&self, averages: Averages, [from, to]: [f64; 2], [before, after]: [Ledger; 2]) -> Results {
        let flows = after.flows_since(&before, to - from);
        Results {
            averages,
            powers: Powers::of(&flows),
            flows,
            circuit: CircuitSample::from(&self.circuit),
            lines: self.lines,
        }
    }
}

impl Follower for Electrics<'_> {
    type Error = CoupledError;

    fn looks(&self) -> bool {
        self.watch.looks()
    }

    fn needs_ends_only(&self, last: [f64; 2]) -> bool {
        self.circuit.is_path_independent(last)
    }

    fn take(&mut self, piece: Piece<'_>) -> Result<(), CoupledError> {
        let Self { circuit, watch, lines } = self;
        let last = piece.capacitances.len() - 1;
        if piece.is_monotone && circuit.is_path_independent(piece.end()) {
            circuit.advance(piece.length, piece.end())?;
            watch.look(circuit.time(), piece.deflection(last), circuit.voltage());
            *lines += 1;
            return Ok(());
        }
        let begin = circuit.time();
        circuit.advance_along(piece.length, piece.capacitances, |k, voltages| {
            watch.look(begin + piece.length * (k as f64 / last as f64), piece.deflection(k), voltages);
            *lines += 1;
        })?;
        Ok(())
    }
}
