//! Harvester and embedded circuit in one process, without communication steps: the energies of [`crate::cosim`] in its limit of small
//! steps, as fast as C(t) can be worked out.
//!
//! The harvester goes from knot to knot of C(t): begins, peaks and ends of pulses. Between two knots the circuit gets C(t) as straight
//! lines, as many as keep their distance from C(t) below a bound; at the knots C(t) is exact, and the circuit is exact on each line.

mod film;
mod impacts;

use std::collections::HashMap;

use thiserror::Error;
use videg_circuit::{Circuit, Ledger, Settings};
use videg_model::{
    ContactLaw, Harvester, MembraneLaw, ModelError, Parameters, Pulse, PulseChange, PulseShape, Setup, Side,
};

use crate::cosim::{Averages, CircuitSample, Gains, Powers};
pub use film::{Film, OVER_LIMITS, Watch};
pub use impacts::Impacts;

/// Bound of the distance of the straight lines from C(t), over C(t), unless another is asked for.
pub const TOLERANCE: f64 = 1e-3;

const SIDES: [Side; 2] = [Side::Left, Side::Right];

/// Most lines between two knots.
const MOST: f64 = 1e4;

/// Why a coupled run failed.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum CoupledError {
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Circuit(#[from] videg_circuit::Error),
    #[error(
        "contact.electrostaticFeedback = true: the voltages do not act back in a sweep; allowed: false, or videg cosim"
    )]
    Feedback,
}

/// When a run ends, what it averages over, and how closely the circuit follows C(t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// End of the run, s.
    pub until: f64,
    /// Averaging window, s.
    pub window: [f64; 2],
    /// Bound of the distance of the lines from C(t), over C(t).
    pub tolerance: f64,
}

/// Results of a coupled run.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// Of the mechanics, over the window.
    pub averages: Averages,
    /// Of the circuit, over the window.
    pub powers: Powers,
    /// The circuit at the end.
    pub circuit: CircuitSample,
    /// Straight lines that the circuit was given.
    pub lines: u64,
}

/// Runs the harvester of `setup` with a circuit of `settings` from 0 s on, both membranes charged.
///
/// # Errors
/// Parameters that harvester or circuit refuse; electrostatic feedback; more events than can be resolved.
pub fn run<'a>(setup: impl Into<Setup<'a>>, settings: &Settings, times: &Times) -> Result<Results, CoupledError> {
    run_watched(setup, settings, times, &mut ())
}

/// The same, while `watch` looks at the films.
///
/// # Errors
/// As [`run`].
pub fn run_watched<'a>(
    setup: impl Into<Setup<'a>>,
    settings: &Settings,
    times: &Times,
    watch: &mut impl Watch,
) -> Result<Results, CoupledError> {
    let setup = setup.into();
    if setup.parameters.electrostatic_feedback {
        return Err(CoupledError::Feedback);
    }
    let harvester = Harvester::new(setup, 0.0)?;
    let circuit = Circuit::new(settings.parameters(), capacitance(&harvester))?;
    let pulses = SharedPulses::of(setup.parameters);
    let tolerance = times.tolerance;
    let (samples, deflections) = (Vec::new(), Vec::new());
    Coupled { harvester, circuit, pulses, tolerance, samples, deflections, watch, lines: 0 }.run(times)
}

struct Coupled<'w, W> {
    harvester: Harvester,
    circuit: Circuit,
    pulses: Option<SharedPulses>,
    tolerance: f64,
    /// C(t) of a piece, F.
    samples: Vec<[f64; 2]>,
    /// Of the same, m, if they are watched.
    deflections: Vec<[f64; 2]>,
    watch: &'w mut W,
    lines: u64,
}

impl<W: Watch> Coupled<'_, W> {
    fn run(mut self, times: &Times) -> Result<Results, CoupledError> {
        self.watch.begin(self.harvester.membrane());
        self.watch.look(deflections(&self.harvester), self.circuit.voltage());
        let [from, to] = times.window;
        let before = self.at(from)?;
        let after = self.at(to)?;
        self.at(times.until)?;
        Ok(Results {
            averages: Averages::over(times.window, &before.0, &after.0),
            powers: Powers::over(times.window, &before.1, &after.1),
            circuit: CircuitSample::from(&self.circuit),
            lines: self.lines,
        })
    }

    /// Goes on to `time`, s; the sums there.
    fn at(&mut self, time: f64) -> Result<(Gains, Ledger), CoupledError> {
        while self.harvester.time() < time {
            let now = self.harvester.time();
            let knot = self.harvester.next_knot().filter(|knot| *knot > now).unwrap_or(f64::INFINITY);
            self.piece(knot.min(self.harvester.known_until()).min(time))?;
        }
        let totals = self.harvester.totals();
        let impacts = i32::try_from(totals.impacts).unwrap_or(i32::MAX);
        Ok((Gains { voltage: totals.voltage_gain, energy: totals.energy, impacts }, self.circuit.ledger()))
    }

    /// Goes on to `end`, s, over a stretch on which C(t) is smooth.
    fn piece(&mut self, end: f64) -> Result<(), CoupledError> {
        if let Some((side, pulse, rises)) = self.half_pulse(end) {
            return self.follow(side, &pulse, rises, end);
        }
        let start = self.harvester.time();
        let is_flat = SIDES.into_iter().all(|side| self.is_flat(side));
        let count = if is_flat { 1 } else { self.count(end)? };
        self.samples.clear();
        self.deflections.clear();
        self.sample();
        for k in 1..=count {
            let next = if k == count { end } else { start + (end - start) * (f64::from(k) / f64::from(count)) };
            self.harvester.advance(next)?;
            self.sample();
        }
        self.give(end - start)
    }

    fn sample(&mut self) {
        self.samples.push(capacitance(&self.harvester));
        if W::LOOKS {
            self.deflections.push(deflections(&self.harvester));
        }
    }

    /// Whether the membrane at `side` is flat now, and stays so until the next knot.
    fn is_flat(&self, side: Side) -> bool {
        match self.harvester.parameters().contact_law {
            ContactLaw::Impulsive => self.harvester.pulses(side).next().is_none(),
            ContactLaw::Compliant => {
                let deflection = self.harvester.deflection(side);
                deflection.value == 0.0 && deflection.rate == 0.0
            }
        }
    }

    /// Gives the circuit the samples of C(t), which are evenly spaced over `length`, s, as straight lines. Inner knots are moved by a twelfth of the
    /// second difference, so that the lines lie as much above C(t) as below: the error of energies is of the fourth order then.
    /// Lines that the circuit can take as one are given as one.
    fn give(&mut self, length: f64) -> Result<(), CoupledError> {
        let Self { circuit, samples, deflections, watch, lines, .. } = self;
        let step = length / (samples.len() - 1) as f64;
        let mut before = samples[0];
        for k in 1..samples.len() - 1 {
            let [here, after] = [samples[k], samples[k + 1]];
            samples[k] = [0, 1].map(|j| here[j] - (before[j] - 2.0 * here[j] + after[j]) / 12.0);
            before = here;
        }
        let mut start = 0;
        while start + 1 < samples.len() {
            let goes_on = |k: usize| circuit.is_path_independent(samples[k + 1]) && !turns(&samples[start..=k + 1]);
            let end = (start + 1..samples.len() - 1).find(|k| !goes_on(*k)).unwrap_or(samples.len() - 1);
            circuit.advance((end - start) as f64 * step, samples[end])?;
            if W::LOOKS {
                watch.look(deflections[end], circuit.voltage());
            }
            *lines += 1;
            start = end;
        }
        Ok(())
    }

    /// The pulse whose rise, or whose fall, goes on from now to `end`, s, and nothing else does, if all pulses have one shape.
    fn half_pulse(&self, end: f64) -> Option<(Side, Pulse, bool)> {
        let shape = &self.pulses.as_ref()?.shape;
        let of_side = |side: Side| self.harvester.pulses(side).map(move |pulse| (side, *pulse));
        let mut all = SIDES.into_iter().flat_map(of_side);
        let (side, pulse) = all.next().filter(|_| all.next().is_none())?;
        let (now, peak) = (self.harvester.time(), shape.peak_time(&pulse));
        let rises = now == pulse.start && end == peak;
        let falls = now == peak && end == shape.end_time(&pulse);
        (rises || falls).then_some((side, pulse, rises))
    }

    /// Goes on to `end`, s, with half a pulse. C(t) is worked out without the harvester, which is still at the begin.
    fn follow(&mut self, side: Side, pulse: &Pulse, rises: bool, end: f64) -> Result<(), CoupledError> {
        let length = end - self.harvester.time();
        let membrane = self.harvester.membrane();
        let (rest, peak) = (membrane.rest_capacitance(), membrane.capacitance(pulse.peak));
        let mut last = [rest; 2];
        if rises {
            last[side.index()] = peak;
        }
        if self.circuit.is_path_independent(last) {
            self.harvester.advance(end)?;
            self.lines += 1;
            self.circuit.advance(length, last)?;
            let peak = if rises { pulse.peak } else { 0.0 };
            self.watch.look(at(side, peak), self.circuit.voltage());
            return Ok(());
        }
        let count = lines(6.0 * (peak - rest) / rest, self.tolerance);
        let Some(shared) = &mut self.pulses else { return Ok(()) };
        let shares = shared.deflections(count);
        self.samples.clear();
        self.samples.extend(shares.iter().map(|share| {
            let mut both = [rest; 2];
            both[side.index()] = membrane.capacitance(pulse.peak * share);
            both
        }));
        if W::LOOKS {
            self.deflections.clear();
            self.deflections.extend(shares.iter().map(|share| at(side, pulse.peak * share)));
        }
        if !rises {
            self.samples.reverse();
            self.deflections.reverse();
        }
        self.harvester.advance(end)?;
        self.give(length)
    }

    /// Lines that stay close to C(t) up to `end`, s: a chord of the length h is off by at most h^2/8 times the curvature, here that of
    /// the cubic through values and rates at both ends.
    fn count(&self, end: f64) -> Result<u32, CoupledError> {
        let length = end - self.harvester.time();
        let mut ahead = self.harvester.clone();
        // What happens at the end changes rates there.
        ahead.advance(end.next_down().max(self.harvester.time()))?;
        let curvature = |side: Side| {
            let [c0, c1] = [&self.harvester, &ahead].map(|harvester| harvester.capacitance(side));
            let [r0, r1] = [&self.harvester, &ahead].map(|harvester| length * harvester.capacitance_rate(side));
            let ends = [6.0 * (c1 - c0) - 4.0 * r0 - 2.0 * r1, 6.0 * (c0 - c1) + 2.0 * r0 + 4.0 * r1];
            ends[0].abs().max(ends[1].abs()) / c0.min(c1)
        };
        let largest = SIDES.into_iter().map(curvature).fold(0.0, f64::max);
        Ok(lines(largest, self.tolerance))
    }
}

/// Number of chords that are off by at most `tolerance` where the curvature is `curvature` at most, over one piece of the length 1.
fn lines(curvature: f64, tolerance: f64) -> u32 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 1 to MOST
    let count = (curvature / (8.0 * tolerance)).sqrt().ceil().clamp(1.0, MOST) as u32;
    count
}

/// Whether one of the capacitances, or their sum, which had not turned round before, does so at the last knot but one of
/// `samples`. From the first on: between a rise and a fall, two samples may be equal.
fn turns(samples: &[[f64; 2]]) -> bool {
    let [first, .., here, after] = samples else { return false };
    let steps = |a: &[f64; 2], b: &[f64; 2]| [b[0] - a[0], b[1] - a[1], b[0] + b[1] - a[0] - a[1]];
    steps(first, here).iter().zip(steps(here, after)).any(|(so_far, next)| so_far * next < 0.0)
}

/// Pulses of one shape: deflections at even times, by their number.
struct SharedPulses {
    shape: PulseShape,
    deflections: HashMap<u32, Vec<f64>>,
}

impl SharedPulses {
    /// Those of a power law under the impulsive law; none under others.
    fn of(p: &Parameters) -> Option<Self> {
        let is_shared = p.contact_law == ContactLaw::Impulsive && p.membrane_law == MembraneLaw::Power;
        let shape = PulseShape::new(p.stiffness_exponent, p.restitution);
        is_shared.then(|| Self { shape, deflections: HashMap::new() })
    }

    /// Deflections over the largest one from the begin to the peak, `count` times later.
    fn deflections(&mut self, count: u32) -> &[f64] {
        let Self { shape, deflections } = self;
        deflections.entry(count).or_insert_with(|| {
            let unit = Pulse { start: 0.0, speed: 1.0, peak: 1.0, change: PulseChange::default() };
            let time = shape.loading_time(&unit);
            (0..=count).map(|k| shape.at(&unit, time * (f64::from(k) / f64::from(count))).value).collect()
        })
    }
}

fn capacitance(harvester: &Harvester) -> [f64; 2] {
    SIDES.map(|side| harvester.capacitance(side))
}

fn deflections(harvester: &Harvester) -> [f64; 2] {
    SIDES.map(|side| harvester.deflection(side).value)
}

/// `deflection`, m, of the membrane at `side`, while the other one is flat.
fn at(side: Side, deflection: f64) -> [f64; 2] {
    let mut both = [0.0; 2];
    both[side.index()] = deflection;
    both
}

#[cfg(test)]
mod tests {
    use super::*;
    use videg_model::Membrane;

    #[test]
    fn a_turn_is_seen_in_each_capacitance_and_in_the_sum_and_behind_a_plateau() {
        let turn = |samples: &[[f64; 2]]| turns(&samples.iter().map(|c| c.map(|c| c * 1e-12)).collect::<Vec<_>>());
        assert!(turn(&[[1.0, 1.0], [2.0, 1.0], [1.0, 1.0]]));
        assert!(turn(&[[1.0, 1.0], [1.0, 2.0], [1.0, 2.0], [1.0, 1.0]]));
        assert!(turn(&[[1.0, 5.0], [4.0, 4.0], [5.0, 1.0]]));
        assert!(!turn(&[[1.0, 1.0], [1.0, 1.0], [2.0, 1.0]]));
        assert!(!turn(&[[1.0, 1.0], [2.0, 3.0], [2.0, 3.0], [3.0, 4.0]]));
        assert!(!turn(&[[1.0, 1.0], [2.0, 2.0]]));
    }

    #[test]
    fn lines_are_as_close_to_a_pulse_as_they_say() {
        let p = Parameters::default();
        let membrane = Membrane::new(&p);
        let mut pulses = SharedPulses::of(&p).unwrap();
        for (peak, tolerance) in [(1e-3, 1e-3), (4e-3, 1e-2), (7e-3, 1e-3), (1e-2, 1e-3), (1e-2, 1e-4), (2e-2, 1e-3)] {
            let at = |share: f64| membrane.capacitance(peak * share);
            let count = lines(6.0 * (at(1.0) - at(0.0)) / at(0.0), tolerance);
            let knots: Vec<f64> = pulses.deflections(count).iter().map(|share| at(*share)).collect();
            let exact: Vec<f64> = pulses.deflections(20 * count).iter().map(|share| at(*share)).collect();
            let moved = |k: usize| match k {
                0 => knots[0],
                k if k + 1 == knots.len() => knots[k],
                k => knots[k] - (knots[k - 1] - 2.0 * knots[k] + knots[k + 1]) / 12.0,
            };
            let off = |k: usize| {
                let (line, share) = ((k / 20).min(knots.len() - 2), (k as f64) / 20.0);
                let share = share - line as f64;
                (moved(line) * (1.0 - share) + moved(line + 1) * share) / exact[k] - 1.0
            };
            let largest = (0..exact.len()).map(|k| off(k).abs()).fold(0.0, f64::max);
            assert!(largest <= tolerance, "{peak} m: {largest:e} with {tolerance:e}");
        }
    }
}
