//! Against brute force: every hold interval by itself, looked at in many places. Each flight and each rest starts from the
//! state that the harvester has then, so that chaos does not separate the two.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // numbers of hold intervals

use core::f64::consts::TAU;

use crate::noise::blocks::LONGEST;
use crate::noise::normal::normal;
use crate::{Case, Harvester, Parameters};

/// Places in a hold interval that are looked at.
const PLACES: u32 = 8;

/// How long before an impact it must be predicted, s: 100 hold intervals of the paper.
const NOTICE: f64 = 1e-3;

/// The cylinder in one hold interval after the other.
#[derive(Clone)]
struct Path {
    p: Parameters,
    force: [f64; 2],
    sample: u64,
    start: f64,
    position: f64,
    velocity: f64,
}

impl Path {
    fn new(harvester: &Harvester, force: [f64; 2]) -> Self {
        let (p, time) = (*harvester.parameters(), harvester.time());
        let mut sample = (time / p.noise_hold).floor() as u64;
        while (sample + 1) as f64 * p.noise_hold <= time {
            sample += 1;
        }
        let [position, velocity, ..] = harvester.states();
        Self { p, force, sample, start: time, position, velocity }
    }

    fn end(&self) -> f64 {
        (self.sample + 1) as f64 * self.p.noise_hold
    }

    /// Position, velocity and acceleration.
    fn at(&self, time: f64) -> [f64; 3] {
        let p = &self.p;
        let (omega, tau) = (TAU * p.frequency, time - self.start);
        let phase = p.phase + p.phase_noise * normal(p.seed, self.sample);
        let [from, to] = [self.start, time].map(|t| (TAU * (p.frequency * t).fract() + phase).sin_cos());
        let a = p.amplitude / p.cylinder_mass;
        let [e, rate] =
            [(self.force[0] + self.force[1] * self.start) / p.cylinder_mass, self.force[1] / p.cylinder_mass];
        [
            self.position
                + tau * (self.velocity - a / omega * from.0)
                + a / (omega * omega) * (from.1 - to.1)
                + tau * tau * (e / 2.0 + rate * tau / 6.0),
            self.velocity + a / omega * (to.0 - from.0) + tau * (e + rate * tau / 2.0),
            a * to.1 + e + rate * tau,
        ]
    }

    fn next(&mut self) {
        let [position, velocity, _] = self.at(self.end());
        (self.start, self.position, self.velocity) = (self.end(), position, velocity);
        self.sample += 1;
    }

    /// The first time up to `until` at which `is_over` holds, to rounding.
    fn first(mut self, until: f64, is_over: impl Fn(f64, [f64; 3]) -> bool) -> Option<(f64, [f64; 3])> {
        while self.start < until {
            let (begin, length) = (self.start, self.end() - self.start);
            for k in 1..=PLACES {
                // Not the end itself, at which the next interval begins.
                let [mut low, mut high] =
                    [k - 1, k].map(|k| begin + length * (1.0 - 1e-9) * f64::from(k) / f64::from(PLACES));
                if is_over(high, self.at(high)) {
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        if is_over(middle, self.at(middle)) { high = middle } else { low = middle }
                    }
                    return Some((high, self.at(high)));
                }
            }
            self.next();
        }
        None
    }
}

/// What was compared.
#[derive(Debug, Default)]
struct Tally {
    flights: u32,
    rests: u32,
}

/// Checks the impact or release that comes next, if there is one within `patience`, s. The harvester goes there.
fn check_next(harvester: &mut Harvester, force: [f64; 2], patience: f64, tally: &mut Tally) {
    let (from, before) = (harvester.time(), *harvester.totals());
    let [position, _, ball, ball_velocity, _] = harvester.states();
    let half = 0.5 * harvester.parameters().travel();
    let (path, until) = (Path::new(harvester, force), from + patience);
    let resting = harvester.resting();
    let expected = match resting {
        Some(side) => path.first(until, |_, [.., a]| side.sign() * a < 0.0),
        None => path.first(until, |time, [z, v, _]| {
            let (dz, approach) = (z - ball - ball_velocity * (time - from), v - ball_velocity);
            dz.abs() >= half && dz * approach > 0.0
        }),
    };
    let dz = position - ball;
    let Some((time, [_, velocity, _])) = expected else {
        harvester.advance(until).unwrap();
        assert_eq!(harvester.totals().events(), before.events(), "from {from} s, where dz = {dz} m");
        return;
    };
    // Long intervals are passed one by one, and only the present one is looked at.
    let Parameters { noise_hold: hold, frequency, .. } = *harvester.parameters();
    let seen = if hold > LONGEST / frequency { (time / hold).floor() * hold } else { from };
    harvester.advance((time - NOTICE).max(from).max(seen)).unwrap();
    let predicted = harvester.next_impact();
    harvester.advance((time - 1e-9).max(from)).unwrap();
    assert_eq!(harvester.totals().events(), before.events(), "too early, before {time} s");
    harvester.advance(time + 1e-9).unwrap();
    assert!(harvester.totals().events() > before.events(), "missed at {time} s");
    if resting.is_some() {
        assert_eq!(harvester.totals().releases, before.releases + 1);
        tally.rests += 1;
        return;
    }
    assert!((harvester.totals().last_speed - (velocity - ball_velocity).abs()).abs() < 1e-7);
    assert!(predicted.is_some_and(|predicted| (predicted - time).abs() < 1e-9), "{predicted:?} predicted for {time} s");
    tally.flights += 1;
}

/// Goes on through the bounces of a chattering sequence that are too low for the places that are looked at.
fn leave_low_bounces(harvester: &mut Harvester) {
    while harvester.resting().is_none() {
        let [_, velocity, _, ball, _] = harvester.states();
        let gap = 0.5 * harvester.parameters().travel() - harvester.relative_displacement().abs();
        if gap > 1e-7 || (velocity - ball).abs() > 1e-3 {
            return;
        }
        harvester.advance(harvester.time() + 2e-6).unwrap();
    }
}

fn compare(p: &Parameters, force: [f64; 2], until: f64, tally: &mut Tally) {
    let mut harvester = Harvester::new(p, 0.0).unwrap();
    harvester.set_external_force(force[0], force[1]).unwrap();
    while harvester.time() < until {
        leave_low_bounces(&mut harvester);
        check_next(&mut harvester, force, 0.05, tally);
    }
}

#[test]
fn impacts_are_those_of_brute_force_one_by_one() {
    let fig14 = (Case::find("fig14").unwrap().parameters)();
    let mut tally = Tally::default();
    for (seed, sigma) in (1..).zip([0.1, 0.5, 1.0, 4.0, 10.0]) {
        for (restitution, gamma) in [(1.0, 5.0), (0.5, 1.0), (0.5, 5.0)] {
            let p = Parameters { restitution, phase_noise: sigma, seed, ..fig14 };
            let p = Parameters { amplitude: p.amplitude * gamma / p.normalized_amplitude(), ..p };
            compare(&p, [0.0, 0.0], 2.0, &mut tally);
        }
    }
    assert!(tally.flights > 200, "{tally:?}");
}

#[test]
fn impacts_under_an_external_force_and_with_other_hold_times_are_those_of_brute_force() {
    let fig14 = (Case::find("fig14").unwrap().parameters)();
    for (hold, force) in [(1e-5, [0.05, -0.1]), (3.3e-4, [0.0, 0.0]), (7e-3, [-0.02, 0.03]), (0.31, [0.0, 0.0])] {
        let p = Parameters { phase_noise: 0.7, noise_hold: hold, ..fig14 };
        let mut tally = Tally::default();
        compare(&p, force, 3.0, &mut tally);
        assert!(tally.flights > 5, "hold {hold}: {tally:?}");
    }
}

#[test]
fn in_long_hold_intervals_a_ball_that_comes_back_before_the_end_is_not_missed() {
    let mut tally = Tally::default();
    for seed in 1..=40 {
        let p = Parameters { phase_noise: 1.0, noise_hold: 0.05, restitution: 1.0, seed, ..Parameters::default() };
        compare(&p, [0.0, 0.0], 4.0, &mut tally);
    }
    assert!(tally.flights > 500, "{tally:?}");
}

#[test]
fn a_ball_at_rest_is_released_as_by_brute_force() {
    let table3 = (Case::find("table3-2hz").unwrap().parameters)();
    for sigma in [0.05, 0.3] {
        let p = Parameters { phase_noise: sigma, ..table3 };
        let mut tally = Tally::default();
        compare(&p, [0.0, 0.0], 1.0, &mut tally);
        assert!(tally.rests > 20, "sigma {sigma}: {tally:?}");
    }
}

/// The ball is thrown such that it just touches, or just misses, the membrane in a hold interval far ahead.
#[test]
fn a_graze_in_the_middle_of_a_block_is_found_or_passed_by_as_the_largest_dz_says() {
    // Noise too weak to change the sign of the acceleration, so that dz has one maximum, at some 20 ms.
    let p =
        Parameters { phase_noise: 0.3, phase: core::f64::consts::PI, cylinder_velocity: 0.08, ..Parameters::default() };
    let half = 0.5 * p.travel();
    let free = Harvester::new(&Parameters { cylinder_length: 1.0, ..p }, 0.0).unwrap();
    let mut path = Path::new(&free, [0.0, 0.0]);
    let mut largest = 0.0_f64;
    while path.start < 0.03 {
        // Inside an interval dz is a parabola to rounding.
        let ([z, v, a], length) = (path.at(path.start), path.end() - path.start);
        let top = (-v / a).clamp(0.0, length);
        largest = largest.max(z).max(path.at(path.start + top)[0]);
        path.next();
    }
    assert!(largest > 1e-4);
    for (excess, impacts) in [(1e-13, 1), (-1e-13, 0), (1e-9, 1), (-1e-9, 0)] {
        let mut harvester = Harvester::new(&Parameters { ball_position: largest - half - excess, ..p }, 0.0).unwrap();
        harvester.advance(0.03).unwrap();
        assert_eq!(harvester.totals().impacts.min(1), impacts, "{excess:e} m");
    }
}

#[test]
fn the_cylinder_moves_as_in_closed_form_through_many_blocks() {
    let p = Parameters { phase_noise: 2.0, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    let mut path = Path::new(&harvester, [0.0, 0.0]);
    harvester.advance(10.0).unwrap();
    while path.end() <= 10.0 {
        path.next();
    }
    let ([z, v, a], [position, velocity, ..]) = (path.at(10.0), harvester.states());
    // What remains is rounding of the times here: of k h, and of the fraction of its product with the frequency.
    assert!((position - z).abs() < 2e-11 && (velocity - v).abs() < 1e-11, "{position} {z}, {velocity} {v}");
    assert!((harvester.cylinder_acceleration() - a).abs() < 1e-11);
}
