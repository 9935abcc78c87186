//! A check: one quantity by every solver. Whether the solvers agree is one thing, whether a claim holds another.

use serde::Serialize;

use super::Solver;

/// One quantity by every solver; `None` where a solver was not asked.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Values {
    /// The embedded solver with ideal diodes.
    pub embedded_ideal: Option<f64>,
    /// The embedded solver with ngspice's diodes.
    pub embedded_exponential: Option<f64>,
    /// ngspice as a program.
    pub ngspice_batch: Option<f64>,
    /// ngspice as a library.
    pub ngspice_live: Option<f64>,
}

impl Values {
    /// The value by a solver.
    pub fn get(&self, solver: Solver) -> Option<f64> {
        match solver {
            Solver::Ideal => self.embedded_ideal,
            Solver::Exponential => self.embedded_exponential,
            Solver::Batch => self.ngspice_batch,
            Solver::Live => self.ngspice_live,
        }
    }

    /// The values from a function of the solver.
    pub fn of(value: impl Fn(Solver) -> Option<f64>) -> Self {
        Self {
            embedded_ideal: value(Solver::Ideal),
            embedded_exponential: value(Solver::Exponential),
            ngspice_batch: value(Solver::Batch),
            ngspice_live: value(Solver::Live),
        }
    }
}

/// How far two solvers are apart, those that are the farthest in units of what they may be.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// The solvers.
    pub between: String,
    /// How far they are apart, in the unit of the tolerance.
    pub deviation: f64,
    /// How far they may be: a pure number, or V for voltages.
    pub tolerance: f64,
    /// Whether that is less.
    pub agree: bool,
}

/// Solvers that are compared, with the relative tolerance. The same diodes in two programs: both integrate to some 1e-5.
/// Ideal diodes: those of ngspice drop some mV of the 30 V and more that the load sees.
const PAIRS: [(Solver, Solver, f64); 3] = [
    (Solver::Exponential, Solver::Batch, 3e-4),
    (Solver::Ideal, Solver::Batch, 1e-3),
    (Solver::Live, Solver::Batch, 3e-4),
];

/// Tolerance of the root of the mean square of the difference of voltages: V, or relative to the highest voltage if that is
/// more.
const VOLTAGE: f64 = 0.1;
const RELATIVE_VOLTAGE: f64 = 1e-5;

impl Agreement {
    /// Compares `values`, relative to `scale`, or to the larger of each two without one. By up to `leaked`, in their unit, ideal
    /// diodes may differ from others.
    pub fn of(values: &Values, scale: Option<f64>, leaked: f64) -> Option<Self> {
        let compared = PAIRS.iter().filter_map(|&(one, other, tolerance)| {
            let (a, b) = (values.get(one)?, values.get(other)?);
            let scale = scale.map_or(a.abs().max(b.abs()), f64::abs);
            let deviation = if a == b { 0.0 } else { (a - b).abs() / scale };
            let tolerance = if one == Solver::Ideal && leaked > 0.0 { tolerance + leaked / scale } else { tolerance };
            Some(Self::new(format!("{} and {}", one.name(), other.name()), deviation, tolerance))
        });
        Self::worst(compared)
    }

    /// Compares the differences of the voltages from those of ngspice in batch, the highest of which is `highest`, V.
    pub fn of_voltages(differences: &Values, highest: f64) -> Option<Self> {
        let tolerance = VOLTAGE.max(RELATIVE_VOLTAGE * highest);
        let solvers = Solver::ALL.into_iter().filter(|&solver| solver != Solver::Batch);
        let compared = solvers.filter_map(|solver| {
            let between = format!("{} and {}", solver.name(), Solver::Batch.name());
            Some(Self::new(between, differences.get(solver)?, tolerance))
        });
        Self::worst(compared)
    }

    /// A deviation held against its tolerance. One that is not a number is none that agrees.
    pub fn new(between: String, deviation: f64, tolerance: f64) -> Self {
        Self { between, deviation, tolerance, agree: deviation <= tolerance }
    }

    /// The one that uses up most of its tolerance.
    pub fn worst(all: impl Iterator<Item = Self>) -> Option<Self> {
        // In the total order, what is not a number lies above everything else.
        all.max_by(|a, b| (a.deviation / a.tolerance).abs().total_cmp(&(b.deviation / b.tolerance).abs()))
    }
}

/// What the paper or a closed form says, and whether a circuit simulator bears it out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// The claim.
    pub says: String,
    /// How far ngspice is from it, relative.
    pub deviation: f64,
    /// How far it may be.
    pub tolerance: f64,
    /// Whether it holds.
    pub holds: bool,
}

impl Claim {
    /// A deviation held against its tolerance.
    pub fn new(says: impl Into<String>, deviation: f64, tolerance: f64) -> Self {
        Self { says: says.into(), deviation, tolerance, holds: deviation.abs() <= tolerance }
    }
}

/// One quantity by every solver and by a closed form.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// The quantity.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// The closed form, if there is one.
    pub analytic: Option<f64>,
    /// By solver.
    pub values: Values,
    /// Whether the solvers agree, if more than one was asked.
    pub agreement: Option<Agreement>,
    /// Whether the claim holds, if there is one.
    pub claim: Option<Claim>,
}

impl Check {
    /// Whether the solvers disagree. A claim that does not hold is no failure.
    pub fn failed(&self) -> bool {
        self.agreement.as_ref().is_some_and(|agreement| !agreement.agree)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(ideal: f64, exponential: f64, batch: f64, live: f64) -> Values {
        Values {
            embedded_ideal: Some(ideal),
            embedded_exponential: Some(exponential),
            ngspice_batch: Some(batch),
            ngspice_live: Some(live),
        }
    }

    #[test]
    fn the_pair_that_uses_up_most_of_its_tolerance_is_named() {
        // 2.9e-4 of 3e-4 is worse than 9e-4 of 1e-3.
        let found = Agreement::of(&values(1.0, 1.000_61, 1.000_9, 1.000_9), Some(1.0), 0.0).unwrap();
        assert!(found.agree && found.between.starts_with("embedded, exponential"), "{found:?}");
        let found = Agreement::of(&values(1.0, 1.0, 1.0, 1.002), None, 0.0).unwrap();
        assert!(!found.agree && found.between.contains("live"), "{found:?}");
    }

    #[test]
    fn what_diodes_leak_is_allowed_to_ideal_ones_alone() {
        let of =
            |ideal, exponential| Agreement::of(&values(ideal, exponential, 1.0, 1.0), Some(1.0), 0.01).unwrap().agree;
        assert!(of(1.01, 1.0) && !of(1.012, 1.0) && !of(1.0, 1.001));
    }

    #[test]
    fn what_is_not_a_number_agrees_with_nothing() {
        let found = Agreement::of(&values(1.0, 1.0, f64::NAN, 1.0), Some(1.0), 0.0).unwrap();
        assert!(!found.agree, "{found:?}");
        assert!(!Claim::new("", f64::NAN, 1.0).holds);
    }

    #[test]
    fn equal_zeros_agree_and_a_single_solver_has_nothing_to_agree_with() {
        assert!(Agreement::of(&values(0.0, 0.0, 0.0, 0.0), None, 0.0).unwrap().agree);
        assert_eq!(Agreement::of(&Values { ngspice_batch: Some(1.0), ..Values::default() }, None, 0.0), None);
    }
}
