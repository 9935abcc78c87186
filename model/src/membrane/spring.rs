//! A membrane as a spring: its force over the deflection, the work that this takes, and the deflection that an impact leads to.

use super::Membrane;
use super::elasticity::{DEEPEST, Elasticity};
use super::material::Material;
use super::table::ForceTable;
use crate::error::ModelError;
use crate::numerics::roots::root_near;
use crate::paper::force;

/// Deflection, m, below which no force is told from none.
const SMALLEST: f64 = 1e-60;

impl Membrane {
    /// Force, N, at the deflection `x`, m; odd in x, so that it is smooth where an integrator passes zero.
    #[inline]
    pub fn force(&self, x: f64) -> f64 {
        match &self.elasticity {
            Elasticity::Power { stiffness, exponent, .. } => force::force(*stiffness, *exponent, x),
            _ => self.general_force(x.abs()).copysign(x),
        }
    }

    #[cold]
    fn general_force(&self, x: f64) -> f64 {
        match &self.elasticity {
            Elasticity::Power { stiffness, exponent, .. } => force::force(*stiffness, *exponent, x),
            Elasticity::Table(table) => table.force(x),
            Elasticity::Film(film, limit) => {
                let x = x.min(*limit);
                film.force(self.area_excess(x), self.area_slope(x))
            }
        }
    }

    /// Work, J, of the force from 0 to `x`, m: Eq. (9) in general form.
    pub fn work(&self, x: f64) -> f64 {
        match &self.elasticity {
            Elasticity::Power { stiffness, exponent, .. } => {
                force::work(force::force(*stiffness, *exponent, x), *exponent, x)
            }
            Elasticity::Table(table) => table.work(x.abs()),
            Elasticity::Film(film, limit) => film.energy(self.area_excess(x.abs().min(*limit))),
        }
    }

    /// Work, J, of the force from `way` before the deflection `x`, m, to there, without cancellation.
    pub(crate) fn last_work(&self, x: f64, way: f64) -> f64 {
        /// Shorter ways, in units of the deflection, lose digits as differences of areas.
        const SHORT: f64 = 1e-3;
        match &self.elasticity {
            Elasticity::Table(table) => table.last_work(x, way),
            Elasticity::Film(film, _) => {
                let from = x - way;
                let (excess, there) = (self.area_excess(from), self.area_excess(x));
                let more = if way < SHORT * x {
                    // Simpson's rule: the area is smooth over so short a way.
                    let slopes = [from, x - 0.5 * way, x].map(|x| self.area_slope(x));
                    way / 6.0 * (slopes[0] + 4.0 * slopes[1] + slopes[2])
                } else {
                    there - excess
                };
                film.energy_above(excess, more)
            }
            Elasticity::Power { .. } => self.work(x) - self.work(x - way),
        }
    }

    /// Largest deflection delta, m, after an impact at relative `speed`, m/s: where the work of the force is the kinetic energy,
    /// Eq. (10).
    #[inline]
    pub fn deflection(&self, speed: f64) -> f64 {
        match &self.elasticity {
            Elasticity::Power { deflection, .. } => force::deflection(*deflection, speed),
            _ => self.general_deflection(speed),
        }
    }

    #[cold]
    fn general_deflection(&self, speed: f64) -> f64 {
        let energy = 0.5 * self.mass * speed * speed;
        let deepest = self.deepest();
        let [low, high] = match &self.elasticity {
            Elasticity::Table(table) => table.bracket(energy),
            _ => [0.0, deepest],
        };
        let (low, high) = (low.max(SMALLEST), high.min(deepest));
        if high <= low || energy <= self.work(low) {
            return if low > SMALLEST { low.min(deepest) } else { 0.0 };
        }
        if self.work(high) <= energy {
            return high;
        }
        // In logarithms, work is nearly a straight line over deflection, however small both are.
        let [low, high] = [low, high].map(f64::ln);
        let balance = |log: f64| {
            let x = log.exp();
            let work = self.work(x);
            ((energy / work).ln(), -x * self.force(x) / work)
        };
        // Next to the limit of a film steps are short, however far the root is: they end by digits, not by a length.
        let start = self.radius.min(0.5 * deepest).ln().clamp(low, high);
        root_near(start, low, high, balance).exp()
    }

    /// That the membrane takes up the energy of an impact at relative `speed`, m/s, at `time`, s: a film may be locked before.
    ///
    /// # Errors
    /// It does not.
    #[inline]
    pub(crate) fn check_impact(&self, time: f64, speed: f64) -> Result<(), ModelError> {
        let Elasticity::Film(_, limit) = self.elasticity else { return Ok(()) };
        let (energy, most) = (0.5 * self.mass * speed * speed, self.work(limit));
        if energy <= most { Ok(()) } else { Err(ModelError::FilmLocked { time, speed, energy, most }) }
    }

    /// n, if the force goes as x^n about the deflection `x`, m: in general x f / E - 1.
    pub(crate) fn exponent(&self, x: f64) -> f64 {
        if let Elasticity::Power { exponent, .. } = &self.elasticity {
            return *exponent;
        }
        let x = x.max(SMALLEST);
        x * self.force(x) / self.work(x) - 1.0
    }

    /// By how much the rounding of the force at the deflection `x`, m, is larger than that of its terms: next to the limit of a film
    /// the force follows from the little that is left of the way.
    pub(crate) fn magnified_rounding(&self, x: f64) -> f64 {
        match &self.elasticity {
            Elasticity::Film(film, limit) => {
                1.0 / (1.0 - film.locked(self.area_excess(x.min(*limit)))).max(f64::EPSILON)
            }
            Elasticity::Power { .. } | Elasticity::Table(_) => 1.0,
        }
    }

    /// The deflection, m, that the film allows no motion to reach.
    pub(crate) fn deepest(&self) -> f64 {
        match &self.elasticity {
            Elasticity::Film(_, limit) => *limit,
            Elasticity::Power { .. } | Elasticity::Table(_) => DEEPEST * self.radius,
        }
    }

    /// The material of the film, if it is the law of the membrane.
    pub(crate) fn material(&self) -> Option<&Material> {
        match &self.elasticity {
            Elasticity::Film(film, _) => Some(&film.material),
            Elasticity::Power { .. } | Elasticity::Table(_) => None,
        }
    }

    /// The points of a measured membrane.
    pub fn table(&self) -> Option<&ForceTable> {
        self.elasticity.table()
    }

    /// Whether the force is that of Eq. (2), for which pulses and changes have closed forms.
    pub(crate) fn is_power(&self) -> bool {
        matches!(self.elasticity, Elasticity::Power { .. })
    }
}
