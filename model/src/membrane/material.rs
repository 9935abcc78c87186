//! What a film is made of: energy and stress under a stretch L equal in both directions, at constant volume.
//!
//! Gent: W = -mu J/2 ln(1 - (2 L^2 + L^-4 - 3)/J). Ogden: W = sum of `mu_i`/`alpha_i` (2 L^`alpha_i` + L^(-2 `alpha_i`) - 3).
//! All is written in the logarithm l of the stretch: then W' = 2 sigma, with the true stress sigma = L/2 dW/dL, and no digits are
//! lost next to the stretch from which an energy counts.

/// Part of the way to the limit of a Gent film that it never exceeds.
const LOCKED: f64 = 1.0 - 1e-12;

/// A hyperelastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Material {
    /// Gent 1996: chains of limited length.
    Gent {
        /// mu, Pa.
        modulus: f64,
        /// J: largest value of 2 L^2 + L^-4 - 3.
        limit: f64,
    },
    /// Ogden 1972, with these terms.
    Ogden([Term; 3]),
}

/// One term of Ogden's sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Term {
    /// `mu_i`, Pa.
    pub modulus: f64,
    /// `alpha_i`.
    pub exponent: f64,
}

impl Term {
    /// Half of `mu_i` `alpha_i`: what it adds to the shear modulus, Pa.
    pub(crate) fn stiffness(&self) -> f64 {
        0.5 * self.modulus * self.exponent
    }

    /// Whether it counts. Without its product of modulus and exponent it is zero at any stretch.
    fn counts(&self) -> bool {
        /// Pa: nothing that a film is made of.
        const NEGLIGIBLE: f64 = 1e-30;
        self.stiffness().abs() > NEGLIGIBLE
    }
}

/// L^alpha - L^(-2 alpha) at the stretch of this logarithm.
fn imbalance(alpha: f64, log: f64) -> f64 {
    let power = alpha * log;
    if power > 0.0 { -power.exp() * (-3.0 * power).exp_m1() } else { (-2.0 * power).exp() * (3.0 * power).exp_m1() }
}

/// Its derivative with the logarithm.
fn imbalance_slope(alpha: f64, log: f64) -> f64 {
    alpha * ((alpha * log).exp() + 2.0 * (-2.0 * alpha * log).exp())
}

/// 2 L^alpha + L^(-2 alpha) at the logarithm `from` + `by`, less that at `from`.
fn growth(alpha: f64, from: f64, by: f64) -> f64 {
    let (ratio, excess) = ((alpha * by).exp(), (alpha * by).exp_m1());
    let shrunk = (-2.0 * alpha * from).exp() * excess * (3.0 + 2.0 * excess) / (ratio * ratio);
    excess * (2.0 * imbalance(alpha, from) + shrunk)
}

impl Material {
    /// Energy density, J/m^3, where the logarithm of the stretch is `from` + `by`, less that at `from`. A Gent film next to its
    /// limit has that of the stretch just below.
    pub(crate) fn energy(&self, from: f64, by: f64) -> f64 {
        match self {
            Self::Gent { modulus, limit } => {
                let part = growth(2.0, from, by) / (limit - growth(2.0, 0.0, from));
                -0.5 * modulus * limit * (-part.min(LOCKED)).ln_1p()
            }
            Self::Ogden(terms) => {
                let terms = terms.iter().filter(|term| term.counts());
                terms.map(|term| term.modulus / term.exponent * growth(term.exponent, from, by)).sum()
            }
        }
    }

    /// True stress in both directions, Pa, where the logarithm of the stretch is `log`.
    pub(crate) fn stress(&self, log: f64) -> f64 {
        match self {
            Self::Gent { modulus, limit } => modulus * imbalance(2.0, log) / Self::room(*limit, log),
            Self::Ogden(terms) => {
                let terms = terms.iter().filter(|term| term.counts());
                terms.map(|term| term.modulus * imbalance(term.exponent, log)).sum()
            }
        }
    }

    /// Its derivative with the logarithm, Pa.
    pub(crate) fn stress_slope(&self, log: f64) -> f64 {
        match self {
            Self::Gent { modulus, limit } => {
                let (pull, room) = (imbalance(2.0, log), Self::room(*limit, log));
                modulus / room * (imbalance_slope(2.0, log) + 4.0 * pull * pull / (limit * room))
            }
            Self::Ogden(terms) => {
                let terms = terms.iter().filter(|term| term.counts());
                terms.map(|term| term.modulus * imbalance_slope(term.exponent, log)).sum()
            }
        }
    }

    /// What is left of a Gent film's way to its limit, as part of it.
    fn room(limit: f64, log: f64) -> f64 {
        1.0 - (growth(2.0, 0.0, log) / limit).min(LOCKED)
    }

    /// Part of the way to its limit that a film has gone at the stretch of this logarithm; none where there is no limit.
    pub(crate) fn locked(&self, log: f64) -> Option<f64> {
        match self {
            Self::Gent { limit, .. } => Some(growth(2.0, 0.0, log) / limit),
            Self::Ogden(_) => None,
        }
    }

    /// Shear modulus at small strains, Pa.
    pub(crate) fn shear_modulus(&self) -> f64 {
        match self {
            Self::Gent { modulus, .. } => *modulus,
            Self::Ogden(terms) => terms.iter().map(Term::stiffness).sum(),
        }
    }

    /// A material of the same form with this shear `modulus`, Pa.
    pub(crate) fn scaled(&self, modulus: f64) -> Self {
        match self {
            Self::Gent { limit, .. } => Self::Gent { modulus, limit: *limit },
            Self::Ogden(terms) => {
                let factor = modulus / self.shear_modulus();
                Self::Ogden(terms.map(|term| Term { modulus: factor * term.modulus, ..term }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// The energy as it is printed.
    fn printed(material: &Material, stretch: f64) -> f64 {
        match material {
            Material::Gent { modulus, limit } => {
                let invariant = 2.0 * stretch.powi(2) + stretch.powi(-4);
                -0.5 * modulus * limit * (1.0 - (invariant - 3.0) / limit).ln()
            }
            Material::Ogden(terms) => terms
                .iter()
                .map(|&Term { modulus, exponent }| {
                    modulus / exponent * (2.0 * stretch.powf(exponent) + stretch.powf(-2.0 * exponent) - 3.0)
                })
                .sum(),
        }
    }

    pub(crate) fn any_material() -> impl Strategy<Value = Material> {
        let term = |sign: f64| {
            (1e2..1e6_f64, 0.3..6.0_f64)
                .prop_map(move |(modulus, exponent)| Term { modulus: sign * modulus, exponent: sign * exponent })
        };
        let gent = (1e3..1e6_f64, 2e3..1e5_f64).prop_map(|(modulus, limit)| Material::Gent { modulus, limit });
        let ogden = (term(1.0), term(-1.0), term(1.0)).prop_map(|(a, b, c)| Material::Ogden([a, b, c]));
        prop_oneof![gent, ogden]
    }

    proptest! {
        #[test]
        fn energy_and_stress_are_those_of_the_equations_as_printed(
            material in any_material(), stretch in 1.0..4.0_f64, factor in 1.01..3.0_f64,
        ) {
            let (from, by) = (stretch.ln(), factor.ln());
            let energy = printed(&material, stretch * factor) - printed(&material, stretch);
            // As printed, the logarithm of nearly 1 and powers that cancel lose digits.
            let size = match &material {
                Material::Gent { modulus, limit } => modulus * limit,
                Material::Ogden(terms) => terms.iter().map(|term| term.modulus / term.exponent).sum(),
            };
            let scale = printed(&material, stretch * factor).abs() + 1e-2 * size;
            prop_assert!((material.energy(from, by) - energy).abs() <= 1e-13 * scale, "{energy}");
            let h = 1e-3;
            let slope = |h: f64| material.energy(from, h) - material.energy(from, -h);
            let stress = (8.0 * slope(h) - slope(2.0 * h)) / (12.0 * h) / 2.0;
            prop_assert!((material.stress(from) - stress).abs() <= 1e-8 * material.stress_slope(from));
            let slope = |h: f64| material.stress(from + h) - material.stress(from - h);
            let rate = (8.0 * slope(h) - slope(2.0 * h)) / (12.0 * h);
            prop_assert!((material.stress_slope(from) - rate).abs() <= 1e-8 * rate, "{rate}");
        }

        #[test]
        fn small_strains_have_the_shear_modulus_and_keep_their_digits(material in any_material(), log in 1e-12..1e-6_f64) {
            // W = 6 mu l^2 and sigma = 6 mu l to first order.
            let modulus = material.shear_modulus();
            prop_assert!((material.energy(0.0, log) / (6.0 * modulus * log * log) - 1.0).abs() < 30.0 * log + 1e-13);
            prop_assert!((material.stress(log) / (6.0 * modulus * log) - 1.0).abs() < 30.0 * log + 1e-13);
            let double = material.scaled(2.0 * modulus);
            prop_assert!((double.stress(log) / material.stress(log) - 2.0).abs() < 1e-13);
        }
    }

    #[test]
    fn both_have_the_same_neo_hookean_limit() {
        let none = Term { modulus: 0.0, exponent: 2.0 };
        let ogden = Material::Ogden([Term { modulus: 45e3, exponent: 2.0 }, none, none]);
        let gent = Material::Gent { modulus: 45e3, limit: 1e12 };
        for k in 1..60 {
            let stretch = 1.0 + 0.1 * f64::from(k);
            let neo_hookean = 45e3 * (stretch.powi(2) - stretch.powi(-4));
            assert_relative_eq!(ogden.stress(stretch.ln()), neo_hookean, max_relative = 1e-13);
            assert_relative_eq!(gent.stress(stretch.ln()), neo_hookean, max_relative = 1e-9);
            assert_relative_eq!(gent.energy(0.0, stretch.ln()), ogden.energy(0.0, stretch.ln()), max_relative = 1e-9);
        }
    }

    #[test]
    fn a_gent_film_stays_finite_at_its_limit() {
        let gent = Material::Gent { modulus: 45e3, limit: 270.0 };
        for log in [3.0, 10.0] {
            assert!(gent.energy(0.7, log).is_finite() && gent.stress(log).is_finite());
            assert!(gent.locked(log).unwrap() > 1.0);
        }
    }
}
