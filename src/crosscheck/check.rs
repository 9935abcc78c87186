//! A check: one quantity by every solver. Whether the solvers agree and whether a claim holds are separate questions.

use serde::{Serialize, Serializer};

use super::solver::Solver;

/// One quantity by every solver; `None` where a solver was not asked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Values([Option<f64>; 4]);

impl Values {
    /// The value by a solver.
    pub fn get(&self, solver: Solver) -> Option<f64> {
        self.0[solver as usize]
    }

    /// The values from a function of the solver.
    pub fn of(value: impl Fn(Solver) -> Option<f64>) -> Self {
        Self(Solver::ALL.map(value))
    }

    /// The values by these solvers alone.
    pub fn by<const N: usize>(values: [(Solver, f64); N]) -> Self {
        Self::of(|solver| values.iter().find(|(other, _)| *other == solver).map(|(_, value)| *value))
    }
}

impl Serialize for Values {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(Solver::ALL.iter().map(|solver| (solver.key(), self.get(*solver))))
    }
}

/// The deviation of two solvers, those with the largest deviation relative to the tolerance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// The solvers.
    pub between: String,
    /// Their deviation, in the unit of the tolerance.
    pub deviation: f64,
    /// The tolerance: a pure number, or V for voltages.
    pub tolerance: f64,
    /// Whether the deviation is within the tolerance.
    pub agree: bool,
}

/// Relative tolerance of the same diodes in two programs: both integrate to some 1e-5.
pub const SAME_DIODES: f64 = 3e-4;
/// Relative tolerance of ideal diodes: those of ngspice drop some mV of the 30 V and more that the load sees.
pub const IDEAL_DIODES: f64 = 1e-3;

/// Solvers that are compared, with the relative tolerance.
const PAIRS: [(Solver, Solver, f64); 3] = [
    (Solver::Exponential, Solver::Batch, SAME_DIODES),
    (Solver::Ideal, Solver::Batch, IDEAL_DIODES),
    (Solver::Live, Solver::Batch, SAME_DIODES),
];

impl Agreement {
    /// Compares `values`, relative to `scale`, or to the larger of each two without one. Ideal diodes may differ from others
    /// by `leaked` more, in the unit of the values.
    pub fn of(values: &Values, scale: Option<f64>, leaked: f64) -> Option<Self> {
        let compared = PAIRS.iter().filter_map(|&(one, other, tolerance)| {
            let (a, b) = (values.get(one)?, values.get(other)?);
            let scale = scale.map_or(a.abs().max(b.abs()), f64::abs);
            let deviation = if a == b { 0.0 } else { (a - b).abs() / scale };
            let tolerance = if one == Solver::Ideal && leaked > 0.0 { tolerance + leaked / scale } else { tolerance };
            Some(Self::between(one, other, deviation, tolerance))
        });
        Self::worst(compared)
    }

    /// Compares the differences of the voltages from those of ngspice in batch, whose highest is `highest`, V.
    pub fn of_voltages(differences: &Values, highest: f64) -> Option<Self> {
        /// Of the root of the mean square of the difference: V, or relative to the highest voltage if that is more.
        const TOLERANCE: f64 = 0.1;
        const RELATIVE_TOLERANCE: f64 = 1e-5;
        let tolerance = TOLERANCE.max(RELATIVE_TOLERANCE * highest);
        let solvers = Solver::ALL.into_iter().filter(|&solver| solver != Solver::Batch);
        Self::worst(
            solvers
                .filter_map(|solver| Some(Self::between(solver, Solver::Batch, differences.get(solver)?, tolerance))),
        )
    }

    /// The deviation of two solvers and its tolerance.
    pub fn between(one: Solver, other: Solver, deviation: f64, tolerance: f64) -> Self {
        Self::new(format!("{} and {}", one.name(), other.name()), deviation, tolerance)
    }

    /// A deviation and its tolerance. A deviation that is not a number does not agree.
    pub fn new(between: String, deviation: f64, tolerance: f64) -> Self {
        Self { between, deviation, tolerance, agree: deviation <= tolerance }
    }

    /// The one with the largest deviation relative to its tolerance.
    pub fn worst(all: impl Iterator<Item = Self>) -> Option<Self> {
        // In the total order, NaN lies above everything else.
        all.max_by(|a, b| (a.deviation / a.tolerance).abs().total_cmp(&(b.deviation / b.tolerance).abs()))
    }
}

/// A statement of the paper or a closed form, and whether a circuit simulator confirms it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// The claim.
    pub says: String,
    /// Deviation of ngspice from it, relative.
    pub deviation: f64,
    /// Its tolerance.
    pub tolerance: f64,
    /// Whether it holds.
    pub holds: bool,
}

impl Claim {
    /// Relative tolerance: the paper gives its powers in two or three digits.
    pub const TOLERANCE: f64 = 0.02;

    /// A deviation and its tolerance.
    pub fn new(says: impl Into<String>, deviation: f64, tolerance: f64) -> Self {
        Self { says: says.into(), deviation, tolerance, holds: deviation.abs() <= tolerance }
    }
}

/// One quantity by every solver and by a closed form.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantityCheck {
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

impl QuantityCheck {
    /// A quantity with its values alone.
    pub fn new(name: impl Into<String>, unit: &'static str, values: Values) -> Self {
        Self { name: name.into(), unit, analytic: None, values, agreement: None, claim: None }
    }

    /// Whether the solvers disagree. A claim that does not hold is no failure.
    pub fn failed(&self) -> bool {
        self.agreement.as_ref().is_some_and(|agreement| !agreement.agree)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agreement(values: [f64; 4], scale: Option<f64>, leaked: f64) -> Agreement {
        Agreement::of(&Values(values.map(Some)), scale, leaked).unwrap()
    }

    #[test]
    fn the_pair_that_uses_up_most_of_its_tolerance_is_named() {
        // 2.9e-4 of 3e-4 is worse than 9e-4 of 1e-3.
        let found = agreement([1.0, 1.000_61, 1.000_9, 1.000_9], Some(1.0), 0.0);
        assert!(found.agree && found.between.starts_with("embedded, exponential"), "{found:?}");
        let found = agreement([1.0, 1.0, 1.0, 1.002], None, 0.0);
        assert!(!found.agree && found.between.contains("live"), "{found:?}");
    }

    #[test]
    fn the_leakage_of_diodes_is_allowed_to_ideal_ones_alone() {
        let agree = |ideal, exponential| agreement([ideal, exponential, 1.0, 1.0], Some(1.0), 0.01).agree;
        assert!(agree(1.01, 1.0) && !agree(1.012, 1.0) && !agree(1.0, 1.001));
    }

    #[test]
    fn nan_agrees_with_nothing_and_equal_zeros_agree() {
        assert!(!agreement([1.0, 1.0, f64::NAN, 1.0], Some(1.0), 0.0).agree);
        assert!(!Claim::new("", f64::NAN, 1.0).holds);
        assert!(agreement([0.0; 4], None, 0.0).agree);
        assert_eq!(Agreement::of(&Values::by([(Solver::Batch, 1.0)]), None, 0.0), None, "one solver");
    }
}
