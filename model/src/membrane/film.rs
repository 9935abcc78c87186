//! The force of a film by virtual work: what its energy changes by, on the cone that the ball makes of it.

use core::f64::consts::PI;

use super::material::{Material, Term};
use crate::parameters::{MembraneLaw, Parameters};

/// A film of a known material in its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Film {
    pub material: Material,
    /// ln(lambda).
    pub prestretch: f64,
    /// pi `R_2`^2 `h_2`, m^3.
    pub volume: f64,
}

impl Film {
    /// The film of validated `parameters`; none if its material is none of those.
    pub fn of(parameters: &Parameters) -> Option<Self> {
        let (radius, thickness) = (parameters.membrane_radius(), parameters.membrane_thickness());
        let material = parameters.material()?;
        Some(Self { material, prestretch: parameters.prestretch.ln(), volume: PI * radius * radius * thickness })
    }

    /// How much the logarithm of its stretch is larger, where its area is larger by `excess`.
    pub fn stretching(excess: f64) -> f64 {
        0.5 * excess.ln_1p()
    }

    /// E = pi `R_2`^2 `h_2` (W(L) - W(lambda)), J, where `A_3` / `A_2` - 1 is `excess`.
    pub fn energy(&self, excess: f64) -> f64 {
        self.volume * self.material.energy(self.prestretch, Self::stretching(excess))
    }

    /// What is added to that, J, where `A_3` / `A_2` - 1 grows by `more` from `excess`.
    pub fn energy_above(&self, excess: f64, more: f64) -> f64 {
        let from = self.prestretch + Self::stretching(excess);
        self.volume * self.material.energy(from, Self::stretching(more / (1.0 + excess)))
    }

    /// dE/dx, N, where `A_3` / `A_2` - 1 is `excess` and its derivative is `slope`, 1/m.
    pub fn force(&self, excess: f64, slope: f64) -> f64 {
        let stress = self.material.stress(self.prestretch + Self::stretching(excess));
        self.volume * stress * slope / (1.0 + excess)
    }

    /// Part of the way to the film's limit that it has gone where `A_3` / `A_2` - 1 is `excess`; 0 without a limit.
    pub fn locked(&self, excess: f64) -> f64 {
        self.material.locked(self.prestretch + Self::stretching(excess)).unwrap_or(0.0)
    }
}

impl Parameters {
    /// The material of the film, if `membrane.law` says it.
    pub(crate) fn material(&self) -> Option<Material> {
        match self.membrane_law {
            MembraneLaw::Power | MembraneLaw::Table => None,
            MembraneLaw::Gent => Some(Material::Gent { modulus: self.shear_modulus, limit: self.stretch_limit }),
            MembraneLaw::Ogden => Some(Material::Ogden(self.ogden_terms())),
        }
    }

    /// The terms of Ogden's law.
    pub(crate) fn ogden_terms(&self) -> [Term; 3] {
        let terms = [
            (self.ogden_modulus_1, self.ogden_exponent_1),
            (self.ogden_modulus_2, self.ogden_exponent_2),
            (self.ogden_modulus_3, self.ogden_exponent_3),
        ];
        terms.map(|(modulus, exponent)| Term { modulus, exponent })
    }
}
