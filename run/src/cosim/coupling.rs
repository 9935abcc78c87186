//! Coupling of harvester and circuits, and its error.

use clap::ValueEnum;
use serde::Serialize;

use super::CosimError;

/// Signals that the subsystems exchange for a step. The harvester gets the voltages extrapolated; under the plain method it
/// gets those of the communication point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The harvester steps first, then the circuit with C(t) linear between its ends: second order
    #[default]
    GaussSeidel,
    /// Both step at once, with C(t) extrapolated at dC/dt: second order
    Jacobi,
    /// Both step at once on a regular grid and exchange values only, as in a tool without input derivatives: first order
    Plain,
}

/// How to couple.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coupling {
    /// The method.
    pub method: Method,
    /// Largest error of a signal within a step, relative to its value, to which the communication step adapts; none keeps
    /// to the step given.
    pub tolerance: Option<f64>,
}

impl Coupling {
    /// Bounds of the tolerance: below, signals have no digits left; above, a pulse of C(t) is not noticed.
    const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-12..=0.1;

    /// Checks that method and tolerance go together.
    ///
    /// # Errors
    /// A tolerance out of bounds, or one for the plain method.
    pub fn check(&self) -> Result<(), CosimError> {
        let fail = |tolerance, bound| Err(CosimError::Tolerance { tolerance, bound });
        match self.tolerance {
            Some(tolerance) if !Self::TOLERANCES.contains(&tolerance) => {
                fail(tolerance, format!("must lie from {:e} to {}", Self::TOLERANCES.start(), Self::TOLERANCES.end()))
            }
            Some(tolerance) if self.method == Method::Plain => {
                fail(tolerance, "--master plain keeps to a regular grid; allowed: gauss-seidel, jacobi".to_owned())
            }
            _ => Ok(()),
        }
    }
}

/// Steps and error of the coupling. Field names are the keys of `--json`; units are SI.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct CouplingSummary {
    /// The method.
    pub master: Method,
    /// Tolerance of the communication step; null if it is fixed.
    pub tolerance: Option<f64>,
    /// Communication steps of the run.
    pub steps: u64,
    /// Steps tried and undone.
    pub rejected: u64,
    /// Work of the mechanics on the first circuit, -1/2 U^2 dC, J, as the circuit sums it: with its own U and the C(t) from
    /// the master.
    pub circuit_work: f64,
    /// The same as the harvester sums it: with its own C(t) and the U from the master.
    pub harvester_work: f64,
    /// Energy that the coupling makes or loses: the difference, J.
    pub residual: f64,
    /// The difference over the energy moved in both directions.
    pub relative_residual: f64,
    /// The work by the circuit, without signs, J.
    #[serde(skip)]
    moved: f64,
}

impl CouplingSummary {
    /// That of a run which has not begun.
    pub(super) fn new(coupling: Coupling) -> Self {
        Self { master: coupling.method, tolerance: coupling.tolerance, ..Self::default() }
    }

    /// Adds the work of a step.
    pub(super) fn add(&mut self, by_circuit: f64, by_harvester: f64) {
        self.circuit_work += by_circuit;
        self.harvester_work += by_harvester;
        self.moved += by_circuit.abs();
        self.residual = self.circuit_work - self.harvester_work;
        self.relative_residual = if self.moved > 0.0 { self.residual.abs() / self.moved } else { 0.0 };
    }

    /// The warning about a coupling whose error in energy makes the surplus meaningless.
    pub(super) fn warning(&self) -> Option<String> {
        /// In units of the energy moved.
        const LARGEST_RESIDUAL: f64 = 1e-2;
        let residual = self.relative_residual;
        (residual > LARGEST_RESIDUAL).then(|| {
            format!(
                "the coupling makes or loses {:.1} % of the energy moved, more than {:.0} %: a smaller --step, or \
                 --adaptive, is needed to believe the energies",
                100.0 * residual,
                100.0 * LARGEST_RESIDUAL
            )
        })
    }
}
