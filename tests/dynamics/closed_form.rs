//! The 1:1 orbit of an inclined capsule in closed form: one impact on the left and one on the right membrane in each period.
//!
//! Between impacts the relative displacement x = `z_M` - `z_m` of a ball in a free cylinder has the acceleration a cos(w t) + G with a = A / M and
//! G = g sin(beta): x = X(t) + c1 + c2 t + G t^2 / 2, X = -(a / w^2) cos(w t). The ball meets the left membrane at x = +s/2 with x' = v, and
//! leaves it with -r v; the right one at x = -s/2 with x' = -u, and leaves it with +r u. Let it fly from left to right for the time T1, and for
//! T2 = T - T1 back. With p = cos(w t1) and q = sin(w t1) at the impact on the left all conditions of the orbit are linear in p, q, u and v; that p^2 + q^2
//! = 1 is one equation for T1.
//!
//! The map from one impact to the next takes (time, speed after it) to (time, speed after it); its derivative follows from the same
//! flight, and the product of two of them has the multipliers of the orbit as eigenvalues.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use approx::assert_relative_eq;
use nalgebra::{Matrix4, Vector4};
use proptest::prelude::*;
use videg::dynamics::orbits::{self, Bifurcation, Orbit, Search};
use videg_model::{Parameters, Side};

use super::{at, over};

/// The capsule of the literature: M = 124.5 g, m = 0.1 M, A = 5 N, 2.5 Hz, r = 0.5.
fn capsule(travel: f64, inclination: f64) -> Parameters {
    let p = Parameters {
        cylinder_mass: 0.1245,
        ball_mass: 0.012_45,
        amplitude: 5.0,
        frequency: 2.5,
        restitution: 0.5,
        inclination,
        ..Parameters::default()
    };
    with_travel(p, travel)
}

fn with_travel(p: Parameters, travel: f64) -> Parameters {
    Parameters { cylinder_length: travel - 2.0 * p.frame_width + 2.0 * p.ball_radius, ..p }
}

/// What the orbit depends on.
#[derive(Debug, Clone, Copy)]
struct Capsule {
    /// A / M.
    a: f64,
    /// Angular frequency.
    w: f64,
    /// g sin(beta).
    g: f64,
    /// Travel.
    s: f64,
    r: f64,
}

/// A 1:1 orbit: time of the impact on the left, from it to that on the right, and both speeds before.
#[derive(Debug, Clone, Copy)]
struct OneToOne {
    left: f64,
    across: f64,
    left_speed: f64,
    right_speed: f64,
}

impl Capsule {
    fn of(p: &Parameters) -> Self {
        let g = p.gravity * p.inclination.sin();
        Self { a: p.amplitude / p.cylinder_mass, w: TAU * p.frequency, g, s: p.travel(), r: p.restitution }
    }

    fn period(&self) -> f64 {
        TAU / self.w
    }

    /// p, q, v and u of a flight to the right of this time.
    fn linear(&self, across: f64) -> Vector4<f64> {
        let Self { a, w, g, s, r } = *self;
        let (sin, cos) = (w * across).sin_cos();
        let back = self.period() - across;
        // cos(w t2) = p cos - q sin, sin(w t2) = q cos + p sin.
        let (k, l) = (a / (w * w), a / w);
        let rows = [
            // -u = -r v + l (sin w t2 - sin w t1) + G T1
            ([l * sin, l * (cos - 1.0), -r, 1.0], -g * across),
            // v = r u + l (sin w t1 - sin w t2) + G T2
            ([l * sin, l * (cos - 1.0), 1.0, -r], g * back),
            // -s = -r v T1 - k (cos w t2 - cos w t1) - l sin(w t1) T1 + G T1^2 / 2
            ([-k * (cos - 1.0), k * sin - l * across, -r * across, 0.0], -s - 0.5 * g * across * across),
            // s = r u T2 - k (cos w t1 - cos w t2) - l sin(w t2) T2 + G T2^2 / 2
            ([-k * (1.0 - cos) - l * sin * back, -k * sin - l * cos * back, 0.0, r * back], s - 0.5 * g * back * back),
        ];
        let matrix = Matrix4::from_fn(|row, column| rows[row].0[column]);
        matrix.lu().solve(&Vector4::from_fn(|row, _| rows[row].1)).unwrap()
    }

    fn defect(&self, across: f64) -> f64 {
        let found = self.linear(across);
        found[0] * found[0] + found[1] * found[1] - 1.0
    }

    /// The orbit whose flight to the right takes about this time: nearly level ones are close together.
    fn near(&self, guess: f64) -> OneToOne {
        let steps = (0..14).map(|k| 1e-12 * 4.0_f64.powi(k) * self.period());
        let mut brackets = steps.map(|step| [guess - step, guess + step]);
        let [low, high] = brackets.find(|[low, high]| self.defect(*low) * self.defect(*high) < 0.0).unwrap();
        self.orbit(root(low, high, |across| self.defect(across)))
    }

    fn orbit(&self, across: f64) -> OneToOne {
        let found = self.linear(across);
        let left = (found[1].atan2(found[0]) / self.w).rem_euclid(self.period());
        OneToOne { left, across, left_speed: found[2], right_speed: found[3] }
    }

    /// All orbits with positive speeds, by the time of flight to the right.
    fn all(&self) -> Vec<OneToOne> {
        let times: Vec<f64> = (1..4000).map(|k| self.period() * f64::from(k) / 4000.0).collect();
        let roots = times.windows(2).filter(|pair| self.defect(pair[0]) * self.defect(pair[1]) < 0.0);
        let orbits = roots.map(|pair| self.orbit(root(pair[0], pair[1], |across| self.defect(across))));
        orbits.filter(|orbit| orbit.left_speed > 0.0 && orbit.right_speed > 0.0).collect()
    }

    /// Derivative of (time, speed after) of the next impact: a flight from `start` to `end`, left with the rate `rate` of x, that arrives
    /// with the rate `arrival`; `sign` is that of the speed in x after the next impact.
    fn derivative(&self, [start, end]: [f64; 2], [rate, arrival]: [f64; 2]) -> [[f64; 2]; 2] {
        let push = |time: f64| self.a * (self.w * time).cos() + self.g;
        let time = end - start;
        let (by_start, by_rate) = ((rate + push(start) * time) / arrival, -time / arrival);
        // The rate on arrival changes with the rate at the start, and with both times.
        let arrival_by = [push(end) * by_start - push(start), 1.0 + push(end) * by_rate];
        [[by_start, by_rate], arrival_by.map(|by| -self.r * by)]
    }

    /// Trace and determinant of the derivative of the map from the left impact to the next one.
    fn trace_and_determinant(&self, orbit: &OneToOne) -> [f64; 2] {
        let (left, right) = (orbit.left, orbit.left + orbit.across);
        let there = self.derivative([left, right], [-self.r * orbit.left_speed, -orbit.right_speed]);
        let back = self.derivative([right, left + self.period()], [self.r * orbit.right_speed, orbit.left_speed]);
        let round = [0, 1].map(|i| [0, 1].map(|j| back[i][0] * there[0][j] + back[i][1] * there[1][j]));
        let [[a, b], [c, d]] = round;
        [a + d, a * d - b * c]
    }

    /// The orbit with the strongest impact on the left: at the literature's parameters the stable one.
    fn main_orbit(&self) -> OneToOne {
        self.all().into_iter().max_by(|a, b| a.left_speed.total_cmp(&b.left_speed)).unwrap()
    }

    /// What is zero at a period doubling.
    fn doubling(&self) -> f64 {
        let [trace, determinant] = self.trace_and_determinant(&self.main_orbit());
        1.0 + trace + determinant
    }
}

fn root(mut low: f64, mut high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let rising = of(low) < 0.0;
    assert!(of(low) * of(high) < 0.0, "no root from {low} to {high}");
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if (of(middle) < 0.0) == rising { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Compares phase, speeds and multipliers of an orbit that was found with the closed form, to a relative `tolerance`.
fn compare(found: &Orbit, p: &Parameters, tolerance: f64) {
    let capsule = Capsule::of(p);
    let of = |side| found.impacts.iter().find(|impact| impact.side == side).unwrap();
    let (left, right) = (of(Side::Left), of(Side::Right));
    let across = (right.time - left.time).rem_euclid(1.0) * capsule.period();
    let exact = capsule.near(across);
    assert_relative_eq!(across, exact.across, max_relative = tolerance);
    let late = (left.time - exact.left / capsule.period() + 0.5).rem_euclid(1.0) - 0.5;
    assert!(late.abs() < tolerance, "phase {} against {}", left.time, exact.left / capsule.period());
    assert_relative_eq!(left.speed, exact.left_speed, max_relative = tolerance);
    assert_relative_eq!(right.speed, exact.right_speed, max_relative = tolerance);
    let [trace, determinant] = capsule.trace_and_determinant(&exact);
    let [one, two] = &found.multipliers.0[..] else { panic!("{:?}", found.multipliers) };
    let scale = 1.0 + trace.abs();
    assert!((one + two).im.abs() < 1e-12 && ((one + two).re - trace).abs() < tolerance * scale, "trace {trace}");
    assert!(((one * two).re - determinant).abs() < tolerance * scale, "determinant {determinant}");
    // An impact takes r^2 from the area of neighbouring states: the flight itself keeps it.
    assert_relative_eq!(determinant, capsule.r.powi(4), max_relative = 1e-9);
}

fn is_one_to_one(orbit: &Orbit) -> bool {
    orbit.period == 1 && orbit.pattern.letters() == "LR"
}

#[test]
fn the_orbit_of_the_literatures_capsule_is_the_closed_form() {
    let p = capsule(0.55, FRAC_PI_4);
    let found = orbits::orbits(&at(p), &Search::default()).unwrap();
    let stable: Vec<_> = found.iter().filter(|orbit| orbit.is_stable()).collect();
    let [orbit] = stable[..] else { panic!("{} stable orbits", stable.len()) };
    assert!(is_one_to_one(orbit));
    compare(orbit, &p, 1e-9);
    // Brute force with bisected impacts: 6.431569 and 4.582409 m/s.
    let exact = Capsule::of(&p).main_orbit();
    assert!((exact.left_speed - 6.431_569).abs() < 1e-6 && (exact.right_speed - 4.582_409).abs() < 1e-6, "{exact:?}");
}

#[test]
fn the_period_doubling_is_the_root_of_the_closed_form() {
    let doublings = |problem: &videg::dynamics::Problem| -> Vec<f64> {
        let search = Search { periods: 1, ..Search::default() };
        let branches = orbits::branches(problem, &search, &()).unwrap();
        let marks = branches.iter().flat_map(|branch| &branch.marks);
        let marks = marks.filter(|mark| mark.kind == Bifurcation::PeriodDoubling && is_one_to_one(&mark.orbit));
        marks.map(|mark| mark.orbit.point.value).collect()
    };
    let by_travel = root(0.45, 0.5, |s| Capsule::of(&capsule(s, FRAC_PI_4)).doubling());
    let length = capsule(by_travel, FRAC_PI_4).cylinder_length;
    let found = doublings(&over(capsule(0.55, FRAC_PI_4), "cylinder.length", 0.4, 0.6));
    assert!(found.iter().any(|value| (value - length).abs() < 1e-6), "{found:?} against {length}");
    let by_inclination = root(1.1, 1.3, |beta| Capsule::of(&capsule(0.55, beta)).doubling());
    let found = doublings(&over(capsule(0.55, FRAC_PI_4), "cylinder.inclination", 0.5, 1.4));
    assert!(found.iter().any(|value| (value - by_inclination).abs() < 1e-6), "{found:?} against {by_inclination}");
}

#[test]
fn every_point_of_a_branch_is_the_closed_form() {
    let problem = over(capsule(0.55, FRAC_PI_4), "excitation.frequency", 2.2, 3.0);
    let search = Search { periods: 1, ..Search::default() };
    let branches = orbits::branches(&problem, &search, &()).unwrap();
    let points: Vec<_> =
        branches.iter().flat_map(|branch| &branch.orbits).filter(|orbit| is_one_to_one(orbit)).collect();
    assert!(points.len() > 40 && points.iter().any(|orbit| !orbit.is_stable()));
    // Near a grazing impact the closed form itself is badly conditioned.
    for orbit in points.into_iter().filter(|orbit| orbit.least_speed > 0.3) {
        compare(orbit, &problem.at(orbit.point.value), 1e-8);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn orbits_of_random_capsules_are_the_closed_form(
        travel in 0.02_f64..1.0, inclination in 0.1_f64..1.5, restitution in 0.2_f64..0.95,
        frequency in 0.5_f64..20.0, strength in 0.5_f64..4.0, mass in 0.02_f64..1.0, phase in -PI..PI,
    ) {
        // The swing of the cylinder is of the order of the travel, so that impacts on both sides are common.
        let w = TAU * frequency;
        let amplitude = mass * w * w * travel * strength / 4.0;
        let p = with_travel(
            Parameters { cylinder_mass: mass, amplitude, frequency, restitution, inclination, ..Parameters::default() },
            travel,
        );
        let found = orbits::orbits(&at(p), &Search { periods: 1, starts: 12, ..Search::default() }).unwrap();
        // Beside a fold two orbits are too near to each other to be told apart, far from stability digits are lost.
        let is_clear = |orbit: &&Orbit| {
            let away = |value: &nalgebra::Complex<f64>| (value.re - 1.0).hypot(value.im) > 0.05;
            orbit.multipliers.largest() < 50.0 && orbit.multipliers.0.iter().all(away)
        };
        for orbit in found.iter().filter(|orbit| is_one_to_one(orbit)).filter(is_clear) {
            compare(orbit, &p, 1e-7);
        }
        // Times are counted from where the excitation has its initial phase.
        let shifted = orbits::orbits(&at(Parameters { phase, ..p }), &Search { periods: 1, starts: 12, ..Search::default() });
        let stable = |orbits: &[Orbit]| {
            let stable: Vec<Orbit> = orbits.iter().filter(|orbit| is_one_to_one(orbit)).filter(|orbit| orbit.is_stable()).cloned().collect();
            stable
        };
        for (a, b) in stable(&found).iter().zip(stable(&shifted.unwrap())).take(1) {
            let time = |orbit: &Orbit| orbit.impacts.iter().find(|impact| impact.side == Side::Left).unwrap().time;
            if (a.voltage_gain - b.voltage_gain).abs() < 1e-9 * a.voltage_gain {
                let late = (time(a) - time(&b) - phase / TAU + 0.5).rem_euclid(1.0) - 0.5;
                prop_assert!(late.abs() < 1e-9, "{late}");
            }
        }
    }
}
