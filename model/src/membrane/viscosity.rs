//! The viscosity of a film: a Maxwell branch, spring and dashpot in series, beside the elastic film.
//!
//! The stretch of the film splits in the branch, L = `L_e` `L_v`. The spring has the energy `W_v`(`L_e`) of the film's own form; the
//! dashpot gives way as `L_v'` / `L_v` = sigma / (6 mu tau), sigma = `L_e` / 2 d`W_v`/d`L_e`. With l = ln(L / lambda) and the creep
//! u = ln(`L_v` / lambda) the spring has the logarithmic stretch l - u, and u' = sigma(l - u) / (6 mu tau): for small stretches
//! (l - u) / tau.
//!
//! A film that the ball leaves faster than it recovers would push itself together: it goes slack instead, with no tension, and
//! recovers as u falls. The ball touches it again where it is deeper than the slack film.

use super::Membrane;
use super::film::Film;
use super::material::Material;
use crate::numerics::chebyshev::{DEGREE, GRID, Series, Values};
use crate::numerics::roots::bracketed_root;
use crate::parameters::Parameters;

/// The branch of a film, both validated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Viscosity {
    film: Film,
    branch: Material,
    /// 1 / (6 mu tau), 1/(Pa s).
    mobility: f64,
}

/// A film and its branch at one deflection and creep.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Strained {
    /// Force on the ball, N, outwards.
    pub(crate) force: f64,
    /// u', 1/s.
    pub(crate) flow: f64,
    /// -du'/du, 1/s.
    pub(crate) recovery: f64,
    /// Power that is lost, W.
    pub(crate) loss: f64,
    /// Energy of film and branch, J, less that of the flat, relaxed film.
    pub(crate) stored: f64,
}

/// Creep below which it decays exponentially to rounding.
const SMALL: f64 = 1e-12;

impl Viscosity {
    /// The branch of a film with these parameters, if it has one.
    pub(super) fn of(parameters: &Parameters) -> Option<Self> {
        let film = Film::of(parameters).filter(|_| parameters.is_viscous())?;
        let Parameters { viscous_modulus: modulus, relaxation_time, .. } = *parameters;
        let mobility = 1.0 / (6.0 * modulus * relaxation_time);
        Some(Self { film, branch: film.material.scaled(modulus), mobility })
    }

    /// l of a film that nothing presses: 0 if it is flat, more if it is slack.
    fn slack(&self, creep: f64) -> f64 {
        if creep <= 0.0 || self.tension(0.0, creep)[0] >= 0.0 {
            return 0.0;
        }
        bracketed_root(0.0, creep, |strain| self.tension(strain, creep).map(|value| -value).into())
    }

    /// Sum of both stresses, Pa, and its derivative with l.
    fn tension(&self, strain: f64, creep: f64) -> [f64; 2] {
        let (whole, spring) = (self.film.prestretch + strain, strain - creep);
        let Self { film: Film { material, .. }, branch, .. } = self;
        [material.stress(whole) + branch.stress(spring), material.stress_slope(whole) + branch.stress_slope(spring)]
    }

    /// The film at the creep u where the ball makes its area larger by `excess`, with the derivative `slope`, 1/m.
    fn at(&self, [excess, slope]: [f64; 2], creep: f64) -> Strained {
        let Self { film, branch, mobility } = self;
        let pressed = Film::stretching(excess);
        let [tension, _] = self.tension(pressed, creep);
        let touches = tension >= 0.0;
        let strain = if touches { pressed } else { self.slack(creep).max(pressed) };
        let (stress, softness) = (branch.stress(strain - creep), branch.stress_slope(strain - creep));
        let stiffer = film.material.stress_slope(film.prestretch + strain);
        let yielding = if touches || strain == 0.0 { 1.0 } else { stiffer / (stiffer + softness) };
        let flow = mobility * stress;
        Strained {
            force: if touches { film.volume * tension * slope / (1.0 + excess) } else { 0.0 },
            flow,
            recovery: mobility * softness * yielding,
            loss: 2.0 * film.volume * stress * flow,
            stored: film.volume * (film.material.energy(film.prestretch, strain) + branch.energy(0.0, strain - creep)),
        }
    }

    /// How u falls from `creep` on, of a film that nothing presses.
    ///
    /// ln(u) falls nearly as a straight line: its rate is integrated on Chebyshev nodes, and constant where u is small.
    pub(crate) fn recovery(&self, creep: f64) -> Recovery {
        /// Error of a step, relative to u.
        const TOLERANCE: f64 = 1e-13;
        const MAX_ROUNDS: usize = 16;
        /// Steps take some tens; a state that nobody could have come to takes no longer.
        const MAX_TRIES: usize = 10_000;
        /// Longer than any run, s.
        const FOREVER: f64 = 1e10;
        let rate = |log: f64| {
            let creep = log.exp().max(SMALL);
            self.mobility * self.branch.stress(self.slack(creep) - creep) / creep
        };
        if creep <= 0.0 {
            return Recovery { steps: Vec::new(), end: 0.0, log: f64::NEG_INFINITY, rate: 0.0 };
        }
        let (mut steps, mut log, mut time) = (Vec::new(), creep.ln(), 0.0);
        let mut length = 0.3 / rate(log).abs().max(f64::MIN_POSITIVE);
        let shortest = 1e-6 * length;
        for _ in 0..MAX_TRIES {
            if time >= FOREVER || log <= SMALL.ln() {
                break;
            }
            let step = length;
            let mut logs: Values = [log; DEGREE + 1];
            let mut rates = logs.map(rate);
            let mut change = f64::INFINITY;
            for _ in 0..MAX_ROUNDS {
                let before = logs;
                for (value, row) in logs.iter_mut().zip(&GRID.integral) {
                    *value = log + 0.5 * step * row.iter().zip(&rates).map(|(weight, rate)| weight * rate).sum::<f64>();
                }
                rates = logs.map(rate);
                change = logs.iter().zip(&before).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                if change <= 0.1 * TOLERANCE {
                    break;
                }
            }
            let series = GRID.fit(&rates);
            let error = change.max(step * series.tail() / DEGREE as f64);
            if error <= TOLERANCE || step <= shortest {
                let logs = series.integral(0.5 * step, log);
                (log, time) = (logs.value(1.0), time + step);
                steps.push((time, step, logs));
            }
            let factor = 0.9 * (TOLERANCE / error.max(f64::MIN_POSITIVE)).powf(1.0 / DEGREE as f64);
            length = (step * factor.clamp(0.2, 4.0)).max(shortest);
        }
        Recovery { steps, end: time, log, rate: rate(log) }
    }
}

/// The creep of a film that nothing presses, over time.
#[derive(Debug)]
pub(crate) struct Recovery {
    /// End and length of each step, s, and ln(u) in it.
    steps: Vec<(f64, f64, Series)>,
    /// End of the last step, s, ln(u) there and its rate from there on, 1/s.
    end: f64,
    log: f64,
    rate: f64,
}

impl Recovery {
    /// u, `elapsed`, s, after the begin.
    pub(crate) fn at(&self, elapsed: f64) -> f64 {
        let log = match self.steps.get(self.steps.partition_point(|(end, ..)| *end < elapsed)) {
            Some((end, length, logs)) => logs.value((1.0 - 2.0 * (end - elapsed) / length).clamp(-1.0, 1.0)),
            None => self.log + (elapsed - self.end) * self.rate,
        };
        log.exp()
    }
}

impl Membrane {
    /// l where a ball presses the film in by `x`, m.
    pub(crate) fn strain(&self, x: f64) -> f64 {
        Film::stretching(self.area_excess(x.min(self.deepest())))
    }

    /// Film and branch at the creep u where the ball is at the deflection `x`, m; the force is odd in x.
    pub(crate) fn strained(&self, viscosity: &Viscosity, x: f64, creep: f64) -> Strained {
        let there = x.abs().min(self.deepest());
        let strained = viscosity.at([self.area_excess(there), self.area_slope(there)], creep);
        Strained { force: strained.force.copysign(x), ..strained }
    }

    /// Deflection of the film, m, and its rate, m/s, where a ball that touches it is at `x`, m, with the rate `v`, m/s.
    pub(crate) fn film_deflection(&self, viscosity: &Viscosity, [x, v]: [f64; 2], creep: f64) -> [f64; 2] {
        let slack = viscosity.slack(creep);
        if slack <= Film::stretching(self.area_excess(x.max(0.0))) {
            return [x.max(0.0), v];
        }
        let excess = (2.0 * slack).exp_m1();
        let mut high = self.radius;
        while self.area_excess(high) < excess {
            high *= 2.0;
        }
        let x = bracketed_root(0.0, high, |x| (excess - self.area_excess(x), -self.area_slope(x)));
        let slope = self.area_slope(x);
        let flow = viscosity.at([excess, slope], creep).flow;
        let [_, both] = viscosity.tension(slack, creep);
        let share = viscosity.branch.stress_slope(slack - creep) / both;
        [x, if slope > 0.0 { 2.0 * (1.0 + excess) / slope * share * flow } else { 0.0 }]
    }
}
