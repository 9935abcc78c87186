//! The deflection of a membrane in time after an impact, under the impulsive law.
//!
//! The paper's impact takes no time; C(t) needs a pulse of finite length. Loading follows the paper's own energy
//! balance, Eq. (9) with the upper limit left free: m x'' = -f(x) from x = 0 to delta. Unloading is its mirror image
//! stretched by 1/r, so that the membrane is left with the velocity that Eq. (11) gives the ball. For f = K x^n all pulses
//! have one shape; under another law of the membrane each has its own.

use std::sync::{Arc, OnceLock};

use crate::membrane::Membrane;
use crate::membrane::loading::Loading;
use crate::motion::side::Side;
use crate::numerics::roots::{convex_root, short_root_near};
use crate::numerics::series::hypergeometric;
use crate::shared::Shared;

/// Changes of a pulse per unit of what is moved, to first order.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct PulseChange {
    /// Of the time of the impact, s.
    pub start: f64,
    /// Of the relative speed of the impact, m/s.
    pub speed: f64,
    /// Of the largest deflection, m.
    pub peak: f64,
}

/// One pulse: an impact and what it does to the membrane.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Pulse {
    /// Time of the impact, s.
    pub start: f64,
    /// Relative speed of the impact, m/s.
    pub speed: f64,
    /// Largest deflection delta, m, Eq. (10).
    pub peak: f64,
    /// First-order changes, as [`Harvester::sensitivities`](crate::Harvester::sensitivities) has them.
    pub change: PulseChange,
}

/// Deflection and its rate at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deflection {
    /// Deflection x, m.
    pub value: f64,
    /// dx/dt, m/s.
    pub rate: f64,
}

/// The shape that all pulses of one exponent n share: y = x / delta against the fraction of the loading time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseShape {
    pub(crate) exponent: f64,
    /// Loading time times impact speed over delta: sqrt(pi) Gamma(1 + 1/(n+1)) / Gamma(1/2 + 1/(n+1)).
    loading: f64,
    /// Length of the unloading over that of the loading.
    pub(crate) stretch: f64,
}

impl PulseShape {
    /// Smallest restitution by which a pulse is stretched: at r = 0 the mirror image would never end.
    pub const MIN_RESTITUTION: f64 = 0.01;

    /// Shape for force exponent n of Eq. (2) and restitution r of Eq. (11).
    pub fn new(exponent: f64, restitution: f64) -> Self {
        // The two series meet where y^(n+1) = 1/2; each converges there at least as fast as 2^-k.
        let half = 0.5_f64.powf(1.0 / (exponent + 1.0));
        let loading = half * lower_series(exponent, 0.5) + upper_series(exponent, 0.5) * 0.5_f64.sqrt();
        Self { exponent, loading, stretch: 1.0 / restitution.max(Self::MIN_RESTITUTION) }
    }

    /// Time from the impact to the largest deflection, s.
    pub fn loading_time(&self, pulse: &Pulse) -> f64 {
        if pulse.speed > 0.0 { self.loading * pulse.peak / pulse.speed } else { 0.0 }
    }

    /// Time of the largest deflection, s.
    pub fn peak_time(&self, pulse: &Pulse) -> f64 {
        pulse.start + self.loading_time(pulse)
    }

    /// Time at which the membrane is flat again, s.
    pub fn end_time(&self, pulse: &Pulse) -> f64 {
        pulse.start + self.loading_time(pulse) * (1.0 + self.stretch)
    }

    /// Deflection at `time`, s; zero before and after the pulse.
    pub fn at(&self, pulse: &Pulse, time: f64) -> Deflection {
        self.follow(pulse, self.loading_time(pulse), time, |fraction| self.loading_curve(fraction))
    }

    /// The same of a pulse with this `loading_time`, s, and the `curve` of x over delta and of x' over the speed against the
    /// fraction of that time.
    fn follow(&self, pulse: &Pulse, loading_time: f64, time: f64, curve: impl Fn(f64) -> (f64, f64)) -> Deflection {
        let elapsed = time - pulse.start;
        if elapsed <= 0.0 || elapsed >= loading_time * (1.0 + self.stretch) {
            return Deflection::default();
        }
        if elapsed <= loading_time {
            let (y, slope) = curve(elapsed / loading_time);
            return Deflection { value: pulse.peak * y, rate: pulse.speed * slope };
        }
        let (y, slope) = curve(1.0 - (elapsed - loading_time) / (loading_time * self.stretch));
        Deflection { value: pulse.peak * y, rate: -pulse.speed * slope / self.stretch }
    }

    /// y and dy/d(t v / delta) = sqrt(1 - y^(n+1)) at `fraction` (0 to 1) of the loading time.
    ///
    /// Inverts t v / delta = integral of dy / sqrt(1 - y^(n+1)) by Newton's method. The integral is close to y at small
    /// y and close to a multiple of q = sqrt(1 - y^(n+1)) below its end, so each half is nearly linear in its own variable.
    fn loading_curve(&self, fraction: f64) -> (f64, f64) {
        let power = self.exponent + 1.0;
        let target = fraction.clamp(0.0, 1.0) * self.loading;
        let half = 0.5_f64.powf(1.0 / power);
        if target <= half * lower_series(self.exponent, 0.5) {
            let y = convex_root(target, half, |y| {
                let w = y.powf(power);
                (y * lower_series(self.exponent, w) - target, 1.0 / (1.0 - w).sqrt())
            });
            return (y, (1.0 - y.powf(power)).max(0.0).sqrt());
        }
        let rest = self.loading - target;
        let q = convex_root(rest * power / 2.0, 0.5_f64.sqrt(), |q| {
            let complement = q * q;
            let slope = 2.0 / power * (1.0 - complement).powf(1.0 / power - 1.0);
            (q * upper_series(self.exponent, complement) - rest, slope)
        });
        ((1.0 - q * q).powf(1.0 / power), q)
    }
}

/// Integral of dy / sqrt(1 - y^(n+1)) from 0 to y, over y, at w = y^(n+1): 2F1(1/2, a; 1 + a; w) with a = 1 / (n+1).
fn lower_series(exponent: f64, w: f64) -> f64 {
    let a = 1.0 / (exponent + 1.0);
    hypergeometric(w, |k| (0.5 + k) / (1.0 + k) * (a + k) / (a + k + 1.0))
}

/// The same integral from y to 1, over q = sqrt(1 - y^(n+1)), at c = q^2: 2a 2F1(1 - a, 1/2; 3/2; c) with a = 1 / (n+1).
fn upper_series(exponent: f64, complement: f64) -> f64 {
    let a = 1.0 / (exponent + 1.0);
    2.0 * a * hypergeometric(complement, |k| (1.0 - a + k) / (1.0 + k) * (0.5 + k) / (1.5 + k))
}

/// A time at which the deflection of a membrane has an extremum or a kink.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Knot<'a> {
    /// Time, s.
    pub(crate) time: f64,
    pub(crate) pulse: &'a Pulse,
    pub(crate) kind: KnotKind<'a>,
}

/// What a pulse does at a knot.
#[derive(Debug, Clone, Copy)]
pub(crate) enum KnotKind<'a> {
    Peaks,
    Ends,
    /// From here on this one is larger.
    Meets(&'a Pulse),
}

/// A pulse under way.
#[derive(Debug, Clone)]
pub(crate) struct Running {
    pub(crate) pulse: Pulse,
    own: Option<Arc<Own>>,
}

/// The way of a pulse whose law of the membrane has no shape that all pulses share: worked out when somebody asks for it.
#[derive(Debug)]
struct Own {
    membrane: Shared<Membrane>,
    loading: OnceLock<Loading>,
}

impl PartialEq for Running {
    /// The way follows from the pulse.
    fn eq(&self, other: &Self) -> bool {
        self.pulse == other.pulse
    }
}

impl Running {
    pub(crate) fn new(membrane: &Shared<Membrane>, pulse: Pulse) -> Self {
        let own =
            (!membrane.is_power()).then(|| Arc::new(Own { membrane: membrane.clone(), loading: OnceLock::new() }));
        Self { pulse, own }
    }

    fn loading(&self) -> Option<&Loading> {
        let Own { membrane, loading } = self.own.as_deref()?;
        Some(loading.get_or_init(|| Loading::new(membrane, self.pulse.peak)))
    }

    fn loading_time(&self, shape: &PulseShape) -> f64 {
        self.loading().map_or_else(|| shape.loading_time(&self.pulse), Loading::time)
    }

    /// Whether the membrane is flat again at `time`, s.
    fn has_ended(&self, shape: &PulseShape, time: f64) -> bool {
        let Pulse { start, speed, peak, .. } = self.pulse;
        // A force that rises takes most of the speed at the end of the way: a constant one of the same work takes longer.
        let rises = self.own.as_ref().is_some_and(|own| own.membrane.table().is_some());
        (rises && (time - start) * speed > 2.0 * peak * (1.0 + shape.stretch)) || self.end_time(shape) <= time
    }

    /// Time of the largest deflection, s.
    pub(crate) fn peak_time(&self, shape: &PulseShape) -> f64 {
        self.pulse.start + self.loading_time(shape)
    }

    /// Time at which the membrane is flat again, s.
    pub(crate) fn end_time(&self, shape: &PulseShape) -> f64 {
        self.pulse.start + self.loading_time(shape) * (1.0 + shape.stretch)
    }

    /// At least the deflection at `time`, s: under the force law of the paper a membrane is on its way in never faster than when it is
    /// hit, and on its way back never faster than when it is flat again.
    fn bound(&self, shape: &PulseShape, time: f64) -> f64 {
        /// Of the deflection, and of times: more than may be rounding.
        const ROUNDING: [f64; 2] = [1e-9, 8.0 * f64::EPSILON];
        if self.own.is_some() {
            return self.pulse.peak;
        }
        let (elapsed, left) = (time - self.pulse.start, self.end_time(shape) - time);
        let way = self.pulse.speed * (elapsed.min(left / shape.stretch) + ROUNDING[1] * (time.abs() + elapsed.abs()));
        way * (1.0 + ROUNDING[0])
    }

    fn at(&self, shape: &PulseShape, time: f64) -> Deflection {
        match self.loading() {
            None => shape.at(&self.pulse, time),
            Some(loading) => shape.follow(&self.pulse, loading.time(), time, |fraction| loading.at(fraction)),
        }
    }
}

/// Pulses under way on both membranes, the largest peak first. Where they overlap, the larger deflection wins.
#[derive(Debug, PartialEq)]
pub(crate) struct Pulses {
    pub(crate) shape: PulseShape,
    pub(crate) under_way: [Vec<Running>; 2],
}

impl Clone for Pulses {
    fn clone(&self) -> Self {
        Self { shape: self.shape, under_way: self.under_way.clone() }
    }

    /// Takes no memory that is there already.
    fn clone_from(&mut self, source: &Self) {
        self.shape = source.shape;
        self.under_way.clone_from(&source.under_way);
    }
}

impl Pulses {
    /// Pulses kept at a time on a membrane; of more, the one that ends first is dropped.
    pub(crate) const CAPACITY: usize = 256;

    /// Adds the pulse of a new impact at `side`, and forgets those that have ended.
    pub(crate) fn push(&mut self, membrane: &Shared<Membrane>, side: Side, pulse: Pulse) {
        let Self { shape, under_way } = self;
        let list = &mut under_way[side.index()];
        list.retain(|old| !old.has_ended(shape, pulse.start));
        if list.len() >= Self::CAPACITY {
            let ends = list.iter().map(|pulse| pulse.end_time(shape)).enumerate();
            if let Some((first, _)) = ends.min_by(|a, b| a.1.total_cmp(&b.1)) {
                list.remove(first);
            }
        }
        // Largest peak first, so that `largest` can stop early.
        let position = list.partition_point(|old| old.pulse.peak >= pulse.peak);
        list.insert(position, Running::new(membrane, pulse));
    }

    /// Adds the pulses of impacts in their order (time, s, side and relative speed, m/s) with these `peaks`, m, but for those that have
    /// clearly ended when the next one on their side begins.
    pub(crate) fn extend(&mut self, membrane: &Shared<Membrane>, impacts: &[(f64, Side, f64)], peaks: &[f64]) {
        /// Of the duration: what may be rounding.
        const CLEAR: f64 = 1e-9;
        let longest = self.shape.loading * (1.0 + self.shape.stretch) * (1.0 + CLEAR);
        let pulse = |k: usize| {
            let (start, _, speed) = impacts[k];
            Pulse { start, speed, peak: peaks[k], change: PulseChange::default() }
        };
        let mut last: [Option<usize>; 2] = [None; 2];
        for (k, &(time, side, _)) in impacts.iter().enumerate() {
            let Some(before) = last[side.index()].replace(k) else { continue };
            let (start, _, speed) = impacts[before];
            let is_over = membrane.is_power() && longest * peaks[before] < (time - start) * speed;
            if !is_over || self.under_way[side.index()].len() >= Self::CAPACITY {
                self.push(membrane, side, pulse(before));
            }
        }
        for (side, last) in Side::BOTH.into_iter().zip(last) {
            if let Some(last) = last {
                self.push(membrane, side, pulse(last));
            }
        }
    }

    /// The pulses of the membrane at `side` that have not ended at `time`, s.
    pub(crate) fn going_on(&self, side: Side, time: f64) -> impl Iterator<Item = &Pulse> {
        let list = self.under_way[side.index()].iter();
        list.filter(move |running| !running.has_ended(&self.shape, time)).map(|running| &running.pulse)
    }

    /// The pulses themselves, of the left and of the right membrane.
    pub(crate) fn lists(&self) -> [Vec<Pulse>; 2] {
        self.under_way.each_ref().map(|list| list.iter().map(|running| running.pulse).collect())
    }

    /// Deflection of the membrane at `side` at `time`, s.
    pub(crate) fn at(&self, side: Side, time: f64) -> Deflection {
        self.largest(side, time).map_or(Deflection::default(), |(_, deflection)| deflection)
    }

    /// The pulse with the largest deflection at `time`, s; none if the membrane is flat.
    pub(crate) fn largest(&self, side: Side, time: f64) -> Option<(&Pulse, Deflection)> {
        self.largest_of(&self.under_way[side.index()], time).map(|(running, deflection)| (&running.pulse, deflection))
    }

    fn largest_of<'a>(&self, pulses: &'a [Running], time: f64) -> Option<(&'a Running, Deflection)> {
        let mut largest: Option<(&Running, Deflection)> = None;
        for running in pulses {
            let value = largest.map_or(0.0, |(_, deflection)| deflection.value);
            if running.pulse.peak <= value {
                break;
            }
            if running.bound(&self.shape, time) <= value {
                continue;
            }
            let deflection = running.at(&self.shape, time);
            if deflection.value > value {
                largest = Some((running, deflection));
            }
        }
        largest
    }

    /// The first time after `time`, s, at which a pulse peaks or ends or becomes the largest, of each membrane that is not flat.
    pub(crate) fn next_knots(&self, time: f64) -> impl Iterator<Item = Knot<'_>> {
        self.under_way.iter().filter_map(move |pulses| {
            let knots = pulses.iter().flat_map(|running| {
                let pulse = &running.pulse;
                let peak = Knot { time: running.peak_time(&self.shape), pulse, kind: KnotKind::Peaks };
                [peak, Knot { time: running.end_time(&self.shape), pulse, kind: KnotKind::Ends }]
            });
            let knot = knots.filter(|knot| knot.time > time).min_by(|a, b| a.time.total_cmp(&b.time))?;
            Some(self.first_meeting(pulses, time, knot.time).unwrap_or(knot))
        })
    }

    /// The first time after `time`, s, and before `end`, s, at which another of the `pulses` becomes the largest, if none peaks or ends
    /// in between.
    fn first_meeting<'a>(&self, pulses: &'a [Running], time: f64, end: f64) -> Option<Knot<'a>> {
        if pulses.len() < 2 {
            return None;
        }
        let (first, _) = self.largest_of(pulses, time)?;
        let (mut found, mut until) = (None, end);
        // What is the largest there has met the first one before, unless another has sooner.
        while let Some((next, _)) = self.largest_of(pulses, until).filter(|(next, _)| *next != first) {
            let meeting = self.meeting([first, next], time);
            if meeting <= time || meeting >= until {
                break;
            }
            found = Some(Knot { time: meeting, pulse: &first.pulse, kind: KnotKind::Meets(&next.pulse) });
            until = meeting;
        }
        found
    }

    /// When the second of `pair`, which is less deep at `time`, s, gets as deep as the first one, before either peaks or ends. They meet
    /// at most once until then, because all pulses follow one force law: of two that are as deep, the one with more energy is
    /// faster. The time does not depend on when it is asked for, and whoever asks there has it behind.
    fn meeting(&self, pair: [&Running; 2], time: f64) -> f64 {
        let corners =
            pair.into_iter().flat_map(|it| [it.pulse.start, it.peak_time(&self.shape), it.end_time(&self.shape)]);
        let before = corners.clone().filter(|corner| *corner <= time).fold(f64::NEG_INFINITY, f64::max);
        let behind = corners.filter(|corner| *corner > time).fold(f64::INFINITY, f64::min);
        let ahead = |time| {
            let [first, second] = pair.map(|it| it.at(&self.shape, time));
            (first.value - second.value, first.rate - second.rate)
        };
        let mut meeting = short_root_near(0.5 * (before + behind), before, behind, ahead);
        let mut step = f64::EPSILON * meeting.abs().max(behind - before);
        while meeting < behind && ahead(meeting).0 >= 0.0 {
            meeting = (meeting + step).min(behind);
            step *= 2.0;
        }
        meeting
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MembraneLaw, Parameters};
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// Few where Miri interprets them, which takes far longer.
    const CASES: u32 = if cfg!(miri) { 2 } else { 256 };

    /// Loading time times impact speed over delta for the linear spring, n = 1: a quarter of a sine's period.
    const LINEAR_LOADING: f64 = core::f64::consts::FRAC_PI_2;

    fn pulse(start: f64, speed: f64, peak: f64) -> Pulse {
        Pulse { start, speed, peak, change: PulseChange::default() }
    }

    #[test]
    fn loading_obeys_the_energy_balance_and_unloading_is_its_mirror_image_stretched_by_the_restitution() {
        for (exponent, restitution) in [(1.0, 1.0), (2.6, 0.6), (4.0, 0.5)] {
            let shape = PulseShape::new(exponent, restitution);
            let pulse = pulse(1.0, 0.4, 0.0026);
            let time = shape.loading_time(&pulse);
            for k in 1..100 {
                let t = time * f64::from(k) / 100.0;
                let x = shape.at(&pulse, 1.0 + t);
                let kinetic = (x.rate / pulse.speed).powi(2);
                assert_relative_eq!(kinetic + (x.value / pulse.peak).powf(exponent + 1.0), 1.0, epsilon = 1e-12);
                let h = time * 1e-4;
                let slope = (shape.at(&pulse, 1.0 + t + h).value - shape.at(&pulse, 1.0 + t - h).value) / (2.0 * h);
                assert_relative_eq!(slope, x.rate, epsilon = 1e-7 * pulse.speed);
                if exponent == 1.0 {
                    assert_relative_eq!(x.value, pulse.peak * (LINEAR_LOADING * t / time).sin(), epsilon = 1e-15);
                }
                let fall = shape.at(&pulse, 1.0 + time + (time - t) / restitution);
                assert_relative_eq!(fall.value, x.value, max_relative = 1e-11);
                assert_relative_eq!(fall.rate, -restitution * x.rate, max_relative = 1e-11);
            }
            assert_relative_eq!(shape.at(&pulse, 1.0 + time).value, pulse.peak, max_relative = 1e-14);
            assert_eq!(shape.at(&pulse, shape.end_time(&pulse) + 1e-9).value, 0.0);
        }
    }

    #[test]
    fn the_loading_time_has_its_closed_form() {
        // sqrt(pi) Gamma(1 + a) / Gamma(1/2 + a), a = 1/(n + 1), with `gamma` of Python's math module.
        for (exponent, expected) in
            [(2.6, 1.341_987_686_916_841_2), (1.0, LINEAR_LOADING), (10.0, 1.120_767_003_918_876)]
        {
            assert_relative_eq!(PulseShape::new(exponent, 1.0).loading, expected, max_relative = 1e-14);
        }
    }

    #[test]
    fn pulses_that_are_added_together_are_those_that_are_added_one_by_one() {
        // Few where Miri interprets them, which takes far longer.
        const MANY: u32 = if cfg!(miri) { 40 } else { 800 };
        let membrane = Shared::new(Membrane::new(&Parameters::default()));
        let none = || Pulses { shape: PulseShape::new(2.6, 0.5), under_way: Default::default() };
        for spacing in [1e-6, 1e-4, 1e-3, 3e-3, 1e-2] {
            let started = |k: u32| {
                let speed = 0.05 + 0.03 * f64::from(k * 7 % 11);
                let side = if k % 5 < 3 { Side::Left } else { Side::Right };
                (spacing * f64::from(k), side, speed)
            };
            let (mut together, mut singly, all) = (none(), none(), (0..MANY).map(started).collect::<Vec<_>>());
            for some in all.chunks(16) {
                let peaks: Vec<f64> = some.iter().map(|(_, _, speed)| membrane.deflection(*speed)).collect();
                together.extend(&membrane, some, &peaks);
                for (&(time, side, speed), &peak) in some.iter().zip(&peaks) {
                    singly.push(&membrane, side, pulse(time, speed, peak));
                }
                assert_eq!(together, singly, "{spacing} s");
            }
        }
    }

    #[test]
    fn the_larger_of_two_overlapping_pulses_wins() {
        let shape = PulseShape::new(2.6, 0.5);
        let mut pulses = Pulses { shape, under_way: Default::default() };
        let membrane = Shared::new(Membrane::new(&Parameters::default()));
        let both = [pulse(0.0, 1.0, 0.004), pulse(0.001, 0.1, 0.001)];
        for pulse in both {
            pulses.push(&membrane, Side::Left, pulse);
        }
        for k in 0..1000 {
            let t = f64::from(k) * 1e-4;
            let [big, small] = both.map(|pulse| shape.at(&pulse, t).value);
            assert_eq!(pulses.at(Side::Left, t).value, big.max(small), "at {t} s");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn no_deflection_is_beyond_its_bound(
            (start, speed) in (-100.0..100.0_f64, 1e-6..10.0_f64), (restitution, exponent) in (0.0..=1.0_f64, 1.0..10.0_f64),
            parts in prop::collection::vec(-0.1..1.1_f64, 50),
        ) {
            let p = Parameters { restitution, stiffness_exponent: exponent, ..Parameters::default() };
            let (membrane, shape) = (Shared::new(Membrane::new(&p)), PulseShape::new(exponent, restitution));
            let running = Running::new(&membrane, pulse(start, speed, membrane.deflection(speed)));
            let duration = running.end_time(&shape) - start;
            let at = |part: f64| {
                let time = start + part * duration;
                (running.at(&shape, time).value, running.bound(&shape, time))
            };
            for (value, bound) in parts.into_iter().map(at) {
                prop_assert!(value <= bound.max(0.0), "{} m beyond {} m", value, bound);
            }
            // A loose bound would pass over nothing.
            for (value, bound) in [1e-4, 1.0 - 1e-4].map(at) {
                prop_assert!(value <= bound && bound < 1.01 * value, "{} m for {} m", bound, value);
            }
        }

        #[test]
        fn from_knot_to_knot_one_pulse_is_the_largest_and_rises_or_falls(
            impacts in prop::collection::vec((0.0..0.05_f64, 0.02..1.0_f64), 1..6),
            (restitution, exponent) in (0.1..1.0_f64, 1.0..4.0_f64), has_own_law in any::<bool>(),
        ) {
            let law = if has_own_law { MembraneLaw::Gent } else { MembraneLaw::Power };
            let p = Parameters { membrane_law: law, restitution, stiffness_exponent: exponent, ..Parameters::default() };
            let (membrane, shape) = (Shared::new(Membrane::new(&p)), PulseShape::new(exponent, restitution));
            let mut pulses = Pulses { shape, under_way: Default::default() };
            let mut impacts = impacts;
            impacts.sort_by(|a, b| a.0.total_cmp(&b.0));
            for &(start, speed) in &impacts {
                pulses.push(&membrane, Side::Left, pulse(start, speed, membrane.deflection(speed)));
            }
            // Pulses begin before what is looked at: those that come are other knots.
            let mut now = impacts[impacts.len() - 1].0;
            while let Some(knot) = pulses.next_knots(now).next() {
                prop_assert!(knot.time > now);
                let part = |part: f64| now + (knot.time - now) * part;
                let at = |part: f64| pulses.largest(Side::Left, now + (knot.time - now) * part).unwrap();
                let (largest, middle) = at(0.5);
                for k in 1..20 {
                    let (other, deflection) = at(f64::from(k) / 20.0);
                    prop_assert!(other == largest && deflection.rate * middle.rate > 0.0, "{} to {}", part(0.0), part(1.0));
                }
                // Halfway to a knot asks for the same one.
                prop_assert_eq!(pulses.next_knots(part(0.5)).next().unwrap().time, knot.time);
                if let KnotKind::Meets(next) = knot.kind {
                    prop_assert!(knot.pulse == largest && pulses.largest(Side::Left, knot.time).unwrap().0 == next);
                }
                now = knot.time;
            }
        }
    }
}
