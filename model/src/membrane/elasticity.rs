//! The laws of the force of a membrane.

use super::film::Film;
use super::table::ForceTable;
use crate::paper::{force, membrane};
use crate::parameters::{MembraneLaw, Parameters};
use crate::setup::Setup;

/// Deflection, in units of `R_2`, that no film reaches.
pub(super) const DEEPEST: f64 = 1e6;

/// The law of the force.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Elasticity {
    /// f = K x^n, Eq. (2), with the constants of Eq. (10).
    Power { stiffness: f64, exponent: f64, deflection: [f64; 2] },
    /// Measured.
    Table(ForceTable),
    /// That of a film, up to the deflection, m, at which it is locked.
    Film(Film, f64),
}

impl Elasticity {
    pub(super) fn of(setup: &Setup<'_>) -> Self {
        let p = setup.parameters;
        if let Some(table) = setup.table.filter(|_| p.membrane_law == MembraneLaw::Table) {
            return Self::Table(table.clone());
        }
        if let Some(film) = Film::of(p) {
            return Self::Film(film, limit_of(&film, p));
        }
        let Parameters { stiffness, stiffness_exponent: exponent, .. } = *p;
        let deflection = force::deflection_constants(stiffness, exponent, p.impact_mass());
        Self::Power { stiffness, exponent, deflection }
    }

    pub(super) fn table(&self) -> Option<&ForceTable> {
        match self {
            Self::Table(table) => Some(table),
            Self::Power { .. } | Self::Film(..) => None,
        }
    }
}

/// The deflection, m, at which a `film` is as good as locked.
fn limit_of(film: &Film, p: &Parameters) -> f64 {
    /// Beyond, a film is stiffer by a factor of more than a billion: the rest of the way is nothing beside the rounding of x.
    const LOCKED: f64 = 1.0 - 1e-9;
    let radius = p.membrane_radius();
    let deepest = DEEPEST * radius;
    let locked = |x: f64| {
        let angle = membrane::angle(radius, p.ball_radius, x);
        film.locked(membrane::area_excess(radius, p.ball_radius, &angle))
    };
    if locked(deepest) < LOCKED {
        return deepest;
    }
    let (mut low, mut high) = (0.0, deepest);
    while high - low > f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if locked(middle) < LOCKED { low = middle } else { high = middle }
    }
    low
}
