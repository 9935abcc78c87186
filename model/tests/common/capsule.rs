//! The 1:1 orbits of a capsule in closed form: one impact at each end in a period of the excitation, without sticking.
//!
//! With y = `z_M` - `z_m`, from s/2 at the left end (bottom) to -s/2 at the right end (top), flights have
//! y'' = a cos(w t) + p upwards and a cos(w t) + q downwards, and an impact turns y' into -r y'. Given the time of the flight
//! upwards, both flights are two linear equations for the sine and cosine of the phase; sin^2 + cos^2 = 1 then gives that time.
//! `docs/theory/literature.md` derives this.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper fails a test, too")]

use std::f64::consts::TAU;

use videg_model::{ExcitationKind, Parameters};

/// What the motion of a free or shaken capsule depends on.
#[derive(Debug, Clone, Copy)]
pub struct Capsule {
    /// a: amplitude of the cylinder's acceleration, m/s^2.
    pub acceleration: f64,
    /// w: angular frequency of the excitation, rad/s.
    pub frequency: f64,
    /// p and q: accelerations of y by gravity and friction while the ball slides up, and down, m/s^2.
    pub pulls: [f64; 2],
    /// r: coefficient of restitution, below 1.
    pub restitution: f64,
    /// s: way of the ball, m.
    pub travel: f64,
}

/// A 1:1 orbit.
#[derive(Debug, Clone, Copy)]
pub struct Orbit {
    /// Phase of the excitation at the impact on the left end, rad, from 0 to 2 pi.
    pub phase: f64,
    /// Duration of the flight from the left to the right end, s.
    pub flight: f64,
    /// Relative speeds of the impacts on the left and the right end, m/s.
    pub speeds: [f64; 2],
    /// Trace of the derivative of the map over a period, d(time, speed) after the impact on the left.
    pub trace: f64,
    /// Determinant of the same: r^4.
    pub determinant: f64,
    /// How far the ball stays off the membranes where it turns within a flight, m: infinite if it does not turn, 0 where it grazes,
    /// below 0 if the orbit does not exist because it meets a membrane once more.
    pub clearance: f64,
    /// Least relative speed within the flights, m/s: below 0 if the ball turns.
    pub slowest: f64,
}

impl Orbit {
    /// Both Floquet multipliers if they are real, the larger in magnitude first; else their real and imaginary part.
    pub fn multipliers(&self) -> Result<[f64; 2], [f64; 2]> {
        let half = self.trace / 2.0;
        let square = half * half - self.determinant;
        if square < 0.0 {
            return Err([half, (-square).sqrt()]);
        }
        let first = half + square.sqrt().copysign(half);
        Ok([first, self.determinant / first])
    }

    /// Whether small disturbances decay.
    pub fn is_stable(&self) -> bool {
        self.trace.abs() < 1.0 + self.determinant
    }

    /// 1 + trace + determinant: 0 where the period doubles, below 0 beyond.
    pub fn period_doubling(&self) -> f64 {
        1.0 + self.trace + self.determinant
    }

    /// 1 - trace + determinant: 0 at a fold.
    pub fn fold(&self) -> f64 {
        1.0 - self.trace + self.determinant
    }
}

/// The start of a flight: phase of the excitation, and y' after the impact.
#[derive(Clone, Copy)]
struct Flight {
    phase: f64,
    rate: f64,
    pull: f64,
    duration: f64,
}

impl Capsule {
    /// The capsule with these parameters: no suspension, no noise, impulsive law.
    pub fn new(p: &Parameters) -> Self {
        let is_driven = p.excitation_kind == ExcitationKind::Motion;
        let acceleration = if is_driven { p.acceleration } else { p.amplitude / p.cylinder_mass };
        let ratio = if p.reaction && !is_driven { p.ball_mass / p.cylinder_mass } else { 0.0 };
        let weight = p.gravity * p.inclination.sin();
        let friction = p.friction * p.gravity * p.inclination.cos() * (1.0 + ratio);
        Self {
            acceleration,
            frequency: TAU * p.frequency,
            pulls: [weight + friction, weight - friction],
            restitution: p.restitution,
            travel: p.travel(),
        }
    }

    fn period(&self) -> f64 {
        TAU / self.frequency
    }

    /// All 1:1 orbits that exist, by the duration of the flight upwards.
    ///
    /// They do not stick: with friction an orbit whose ball turns within a flight is not among them.
    pub fn orbits(&self) -> Vec<Orbit> {
        let rubs = self.pulls[0] > self.pulls[1];
        let mut orbits = self.solutions();
        orbits.retain(|orbit| {
            let turns = orbit.slowest < 0.0;
            orbit.speeds.iter().all(|speed| *speed > 0.0) && orbit.clearance >= 0.0 && !(rubs && turns)
        });
        orbits
    }

    /// All solutions of the equations, with those in which a ball would have to pass a membrane.
    pub fn solutions(&self) -> Vec<Orbit> {
        let period = self.period();
        let mut found = self.symmetric();
        // Flights of a nearly level capsule are nearly equal. At equal ones the determinant may be 0: they are no sample.
        let close = (0..200).map(|k| 0.5 * 0.9_f64.powi(k)).flat_map(|by| [0.5 - by, 0.5 + by]);
        let mut samples: Vec<f64> = (0..=1001).map(|k| f64::from(k) / 1001.0).chain(close).collect();
        samples.sort_by(f64::total_cmp);
        let residual = |flight| self.residual(flight);
        for (low, high) in samples.windows(2).map(|pair| (pair[0] * period, pair[1] * period)) {
            if residual(low) * residual(high) < 0.0 {
                let flight = bisect(residual, low, high);
                let (numerators, determinant) = self.phase_equations(flight);
                found.extend(self.orbit(flight, numerators.map(|it| it / determinant)));
            }
        }
        found.sort_by(|a, b| a.flight.total_cmp(&b.flight));
        found
    }

    /// The solution that continues one at a neighbouring capsule: the nearest in flight and phase.
    pub fn nearest(&self, to: &Orbit) -> Option<Orbit> {
        let distance = |it: &Orbit| {
            let turn = (it.phase - to.phase) / TAU;
            ((it.flight - to.flight) / self.period()).hypot(turn - turn.round())
        };
        self.solutions().into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Relative speeds of both impacts, left and right, from their sum and difference.
    fn speeds(&self, flight: f64, x: f64) -> [f64; 2] {
        let (sum, difference) = (self.sum(flight, x), self.difference(flight));
        [0.5 * (sum + difference), 0.5 * (sum - difference)]
    }

    /// What both pulls add to y' over a period, over 1 + r.
    fn difference(&self, flight: f64) -> f64 {
        let [p, q] = self.pulls;
        (p * flight + q * (self.period() - flight)) / (1.0 + self.restitution)
    }

    /// By how much the pulls of both flights differ, m/s.
    fn unequal(&self, flight: f64) -> f64 {
        let [p, q] = self.pulls;
        p * flight - q * (self.period() - flight)
    }

    /// Sum of the speeds, linear in X.
    fn sum(&self, flight: f64, x: f64) -> f64 {
        let sine = (self.frequency * flight / 2.0).sin();
        -(4.0 * x * sine + self.unequal(flight)) / (1.0 - self.restitution)
    }

    /// Coefficients of X and Y, and right sides, of the equations of the flights upwards and downwards.
    fn rows(&self, flight: f64) -> [[f64; 3]; 2] {
        let (r, w) = (self.restitution, self.frequency);
        let (sine, cosine) = (w * flight / 2.0).sin_cos();
        let kappa = (1.0 + r) / (1.0 - r);
        let half_speed = 0.5 * r * self.difference(flight);
        let unequal = 0.5 * r * self.unequal(flight) / (1.0 - r);
        let (up, down) = (flight, self.period() - flight);
        let [p, q] = self.pulls;
        [
            [
                kappa * up * sine,
                2.0 * sine / w - up * cosine,
                -self.travel - 0.5 * p * up * up + up * (half_speed - unequal),
            ],
            [
                kappa * down * sine,
                2.0 * sine / w + down * cosine,
                -self.travel + 0.5 * q * down * down - down * (half_speed + unequal),
            ],
        ]
    }

    /// X and Y, the cosine and sine of the phase midway up times a/w, as numerators over a determinant (Cramer).
    fn phase_equations(&self, flight: f64) -> ([f64; 2], f64) {
        let [[a, b, c], [d, e, f]] = self.rows(flight);
        ([c * e - b * f, a * f - c * d], a * e - b * d)
    }

    /// (X^2 + Y^2 - (a/w)^2) times the square of the determinant, which keeps it without poles.
    fn residual(&self, flight: f64) -> f64 {
        let ([x, y], determinant) = self.phase_equations(flight);
        let amplitude = self.acceleration / self.frequency * determinant;
        x * x + y * y - amplitude * amplitude
    }

    /// Orbits with equal flights, which a level capsule has: both equations are one then, and meet the circle twice.
    fn symmetric(&self) -> Vec<Orbit> {
        if self.pulls[0] + self.pulls[1] != 0.0 {
            return Vec::new();
        }
        let flight = self.period() / 2.0;
        let [[a, b, c], _] = self.rows(flight);
        let (square, radius) = (a * a + b * b, self.acceleration / self.frequency);
        let along = (radius * radius - c * c / square).sqrt();
        let foot = [a * c / square, b * c / square];
        let tangent = [-b / square.sqrt(), a / square.sqrt()];
        let signs = if along.is_nan() { &[][..] } else { &[1.0, -1.0] };
        let point = |sign: &f64| [0, 1].map(|k| foot[k] + sign * along * tangent[k]);
        signs.iter().filter_map(|sign| self.orbit(flight, point(sign))).collect()
    }

    fn orbit(&self, flight: f64, [x, y]: [f64; 2]) -> Option<Orbit> {
        let phase = (y.atan2(x) - self.frequency * flight / 2.0).rem_euclid(TAU);
        let speeds = self.speeds(flight, x);
        let r = self.restitution;
        let [p, q] = self.pulls;
        let up = Flight { phase, rate: -r * speeds[0], pull: p, duration: flight };
        let down = Flight {
            phase: phase + self.frequency * flight,
            rate: r * speeds[1],
            pull: q,
            duration: self.period() - flight,
        };
        let (first, second) = (self.derivative(up, -speeds[1]), self.derivative(down, speeds[0]));
        let product = |i: usize, k: usize| second[i][0] * first[0][k] + second[i][1] * first[1][k];
        let trace = product(0, 0) + product(1, 1);
        // Of each flight: -r (y' at its start) / (y' at its end).
        let determinant = r.powi(4);
        let [[there, slow], [back, slow_back]] = [self.way(up, 1.0), self.way(down, -1.0)];
        let (clearance, slowest) = (there.min(back), slow.min(slow_back));
        trace.is_finite().then_some(Orbit { phase, flight, speeds, trace, determinant, clearance, slowest })
    }

    /// d(time, y') after the impact that ends a flight, by d(time, y') at its start; `before` is y' before that impact.
    fn derivative(&self, flight: Flight, before: f64) -> [[f64; 2]; 2] {
        let at = |phase: f64| self.acceleration * phase.cos() + flight.pull;
        let (start, end) = (at(flight.phase), at(flight.phase + self.frequency * flight.duration));
        let time = [(flight.rate + start * flight.duration) / before, -flight.duration / before];
        let r = self.restitution;
        [time, [-r * (end * time[0] - start), -r * (end * time[1] + 1.0)]]
    }

    /// Smallest distance from a membrane where the ball turns within a flight that begins at `side` s/2, and its least speed across.
    fn way(&self, flight: Flight, side: f64) -> [f64; 2] {
        let (a, w) = (self.acceleration, self.frequency);
        let (sine, cosine) = flight.phase.sin_cos();
        let rate = |t: f64| flight.rate + a / w * ((flight.phase + w * t).sin() - sine) + flight.pull * t;
        let y = |t: f64| {
            let swing = -a / (w * w) * ((flight.phase + w * t).cos() - cosine) - a / w * sine * t;
            side * self.travel / 2.0 + flight.rate * t + swing + 0.5 * flight.pull * t * t
        };
        // y' is monotonous between the zeros of y''.
        let mut bounds = vec![0.0, flight.duration];
        let angle = (-flight.pull / a).acos();
        for zero in [angle, -angle] {
            let first = (zero - flight.phase).rem_euclid(TAU) / w;
            bounds.extend((0..2).map(|k| first + f64::from(k) * TAU / w).filter(|t| *t < flight.duration));
        }
        bounds.sort_by(f64::total_cmp);
        let turns = bounds.windows(2).filter(|ends| rate(ends[0]) * rate(ends[1]) < 0.0);
        let distance = |ends: &[f64]| self.travel / 2.0 - y(bisect(rate, ends[0], ends[1])).abs();
        [
            turns.fold(f64::INFINITY, |least, ends| least.min(distance(ends))),
            bounds.iter().fold(f64::INFINITY, |least, t| least.min(-side * rate(*t))),
        ]
    }
}

/// The parameter between `low` and `high` at which `function`, of the orbit that continues `orbit`, changes its sign.
///
/// # Panics
/// If the orbit is lost on the way.
pub fn root(capsule: impl Fn(f64) -> Capsule, orbit: Orbit, function: fn(&Orbit) -> f64, [low, high]: [f64; 2]) -> f64 {
    const STEPS: u32 = 50;
    let mut here = (low, orbit);
    for k in 1..=STEPS {
        let next = low + (high - low) * f64::from(k) / f64::from(STEPS);
        let there = (next, capsule(next).nearest(&here.1).unwrap());
        if function(&here.1) * function(&there.1) <= 0.0 {
            return bisect(|at| function(&capsule(at).nearest(&here.1).unwrap()), here.0, next);
        }
        here = there;
    }
    panic!("no change of sign between {low} and {high}");
}

/// A zero between two arguments at which the signs differ.
pub fn bisect(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let is_positive = function(high) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low.min(high) || middle >= low.max(high) {
            break;
        }
        if (function(middle) > 0.0) == is_positive { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}
