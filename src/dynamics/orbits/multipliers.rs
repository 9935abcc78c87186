//! Floquet multipliers: how a small distance from an orbit changes in one round.

use nalgebra::linalg::Schur;
use nalgebra::{Complex, DMatrix};

/// By how much a modulus may be above 1 for rounding.
const ROUNDING: f64 = 1e-7;
/// Turns of the iteration for eigenvalues.
const TURNS: usize = 10_000;

/// The multipliers of an orbit: the eigenvalues of the derivative of its return map, by falling modulus.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Multipliers(pub Vec<Complex<f64>>);

impl Multipliers {
    /// Those of this derivative. None if a number in it is not finite.
    pub fn of(derivative: &DMatrix<f64>) -> Option<Self> {
        if derivative.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        let schur = Schur::try_new(derivative.clone(), f64::EPSILON, TURNS)?;
        let mut values: Vec<_> = schur.complex_eigenvalues().iter().copied().collect();
        // Of a pair the one above comes first, so that equal orbits give equal lists.
        values.sort_by(|a, b| modulus(b).total_cmp(&modulus(a)).then(b.im.total_cmp(&a.im)));
        Some(Self(values))
    }

    /// The largest modulus.
    pub fn largest(&self) -> f64 {
        self.0.first().map_or(f64::NAN, modulus)
    }

    /// How many are outside the unit circle.
    pub fn unstable(&self) -> usize {
        self.0.iter().filter(|value| modulus(value) > 1.0 + ROUNDING).count()
    }

    /// The largest modulus of a conjugate pair less 1; -1 without one.
    pub(super) fn pair_excess(&self) -> f64 {
        self.0.iter().find(|value| value.im.abs() > ROUNDING).map_or(-1.0, |value| modulus(value) - 1.0)
    }
}

fn modulus(value: &Complex<f64>) -> f64 {
    value.re.hypot(value.im)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn they_are_eigenvalues_by_falling_modulus() {
        let matrix = DMatrix::from_row_slice(2, 2, &[-0.5, 0.0, 3.0, -2.0]);
        let found = Multipliers::of(&matrix).unwrap();
        assert_relative_eq!(found.0[0].re, -2.0, max_relative = 1e-14);
        assert_relative_eq!(found.0[1].re, -0.5, max_relative = 1e-14);
        assert_eq!((found.unstable(), found.pair_excess()), (1, -1.0));
        let (sin, cos) = 0.7_f64.sin_cos();
        let turn = DMatrix::from_row_slice(2, 2, &[1.1 * cos, -1.1 * sin, 1.1 * sin, 1.1 * cos]);
        let found = Multipliers::of(&turn).unwrap();
        assert_relative_eq!(found.0[0].arg(), 0.7, max_relative = 1e-12);
        assert_relative_eq!(found.pair_excess(), 0.1, max_relative = 1e-12);
        assert_eq!(Multipliers::of(&DMatrix::from_element(2, 2, f64::NAN)), None);
    }
}
