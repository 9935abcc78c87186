//! The harvester's side of a run: C(t) in pieces between its knots.

use videg_model::{ContactLaw, Harvester, ModelError, Pulse, Setup, Side};

use crate::CoupledError;
use crate::averages::Gains;
use crate::pulses::SharedPulses;

const SIDES: [Side; 2] = [Side::Left, Side::Right];

/// Most lines between two knots.
const MOST_LINES: f64 = 1e4;

/// C(t) between two of its knots as straight lines.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece<'a> {
    /// Length, s.
    pub length: f64,
    /// Begin, inner ends and end of the lines, evenly spaced, F.
    pub capacitances: &'a [[f64; 2]],
    /// Deflections there, m; empty if nobody looks at them.
    pub deflections: &'a [[f64; 2]],
    /// Whether one membrane moves one way only, and the other one is flat.
    pub is_monotone: bool,
}

impl Piece<'_> {
    /// Capacitances at the end, F.
    pub fn end(&self) -> [f64; 2] {
        self.capacitances[self.capacitances.len() - 1]
    }

    /// Deflections at the end of line number `k`, m; 0 if nobody looks at them.
    pub fn deflection(&self, k: usize) -> [f64; 2] {
        self.deflections.get(k).copied().unwrap_or_default()
    }
}

/// Takes C(t), piece by piece.
pub(crate) trait Follower {
    /// Why it can follow no further.
    type Error: From<ModelError>;

    /// Whether it looks at deflections.
    fn looks(&self) -> bool;

    /// Whether it needs to know of a monotone piece no more than that it ends with `last`, F.
    fn needs_ends_only(&self, last: [f64; 2]) -> bool;

    /// Takes the next piece.
    fn take(&mut self, piece: Piece<'_>) -> Result<(), Self::Error>;
}

/// The harvester, on its way.
pub(crate) struct Mechanics {
    harvester: Harvester,
    pulses: Option<SharedPulses>,
    tolerance: f64,
    /// C(t) of a piece, F.
    capacitances: Vec<[f64; 2]>,
    /// Of the same, m, if somebody looks at them.
    deflections: Vec<[f64; 2]>,
}

impl Mechanics {
    /// At 0 s. The lines are off by at most `tolerance` times C(t).
    pub fn new(setup: Setup<'_>, tolerance: f64) -> Result<Self, CoupledError> {
        if tolerance.is_nan() || tolerance <= 0.0 {
            return Err(CoupledError::Tolerance { tolerance });
        }
        if setup.parameters.electrostatic_feedback {
            return Err(CoupledError::Feedback);
        }
        let harvester = Harvester::new(setup, 0.0)?;
        let mut start = Self {
            pulses: SharedPulses::of(setup.parameters),
            harvester,
            tolerance,
            capacitances: vec![],
            deflections: vec![],
        };
        start.sample(true);
        Ok(start)
    }

    /// The harvester where it is now.
    pub fn harvester(&self) -> &Harvester {
        &self.harvester
    }

    /// C(t) at 0 s, before anything is followed.
    pub fn start(&self) -> Piece<'_> {
        self.piece(0.0, false)
    }

    /// Goes on to `time`, s, with `follower`; the sums there.
    pub fn follow<F: Follower>(&mut self, time: f64, follower: &mut F) -> Result<Gains, F::Error> {
        while self.harvester.time() < time {
            let now = self.harvester.time();
            let (end, _) = self.harvester.smooth_until(time);
            self.capacitances.clear();
            self.deflections.clear();
            let half = self.half_pulse(end);
            let is_monotone = half.is_some();
            match half {
                Some((side, pulse, rises)) => self.sample_pulse(side, &pulse, rises, end, follower)?,
                None => self.sample_until(end, follower.looks())?,
            }
            follower.take(self.piece(end - now, is_monotone))?;
        }
        Ok(Gains::from(self.harvester.totals()))
    }

    fn piece(&self, length: f64, is_monotone: bool) -> Piece<'_> {
        Piece { length, capacitances: &self.capacitances, deflections: &self.deflections, is_monotone }
    }

    /// Goes on to `end`, s, over a stretch on which C(t) is smooth.
    fn sample_until(&mut self, end: f64, looks: bool) -> Result<(), ModelError> {
        let start = self.harvester.time();
        let is_flat = SIDES.into_iter().all(|side| self.is_flat(side));
        let count = if is_flat { 1 } else { self.count(end)? };
        self.sample(looks);
        for k in 1..=count {
            let next = if k == count { end } else { start + (end - start) * (f64::from(k) / f64::from(count)) };
            self.harvester.advance(next)?;
            self.sample(looks);
        }
        balance(&mut self.capacitances);
        Ok(())
    }

    fn sample(&mut self, looks: bool) {
        self.capacitances.push(SIDES.map(|side| self.harvester.capacitance(side)));
        if looks {
            self.deflections.push(SIDES.map(|side| self.harvester.deflection(side).value));
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

    /// The pulse whose rise, or whose fall, goes on from now to `end`, s, and nothing else does, if all pulses have one shape.
    fn half_pulse(&self, end: f64) -> Option<(Side, Pulse, bool)> {
        let shape = self.pulses.as_ref()?.shape();
        let of_side = |side: Side| self.harvester.pulses(side).map(move |pulse| (side, *pulse));
        let mut all = SIDES.into_iter().flat_map(of_side);
        let (side, pulse) = all.next().filter(|_| all.next().is_none())?;
        let (now, peak) = (self.harvester.time(), shape.peak_time(&pulse));
        let rises = now == pulse.start && end == peak;
        let falls = now == peak && end == shape.end_time(&pulse);
        (rises || falls).then_some((side, pulse, rises))
    }

    /// Goes on to `end`, s, with half a pulse. C(t) is worked out without the harvester.
    fn sample_pulse<F: Follower>(
        &mut self,
        side: Side,
        pulse: &Pulse,
        rises: bool,
        end: f64,
        follower: &F,
    ) -> Result<(), ModelError> {
        let membrane = self.harvester.membrane();
        let (rest, peak) = (membrane.rest_capacitance(), membrane.capacitance(pulse.peak));
        let both = |here: f64, other: f64| match side {
            Side::Left => [here, other],
            Side::Right => [other, here],
        };
        let ends_only = follower.needs_ends_only(both(if rises { peak } else { rest }, rest));
        let count = if ends_only { 1 } else { lines(6.0 * (peak - rest) / rest, self.tolerance) };
        let shares = self.pulses.as_mut().map_or(&[][..], |shared| shared.deflections(count));
        self.capacitances.extend(shares.iter().map(|share| both(membrane.capacitance(pulse.peak * share), rest)));
        if follower.looks() {
            self.deflections.extend(shares.iter().map(|share| both(pulse.peak * share, 0.0)));
        }
        if !rises {
            self.capacitances.reverse();
            self.deflections.reverse();
        }
        balance(&mut self.capacitances);
        self.harvester.advance(end)
    }

    /// Lines that stay close to C(t) up to `end`, s: a chord of the length h is off by at most h^2/8 times the curvature, here that of
    /// the cubic through values and rates at both ends.
    fn count(&self, end: f64) -> Result<u32, ModelError> {
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
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 1 to MOST_LINES
    let count = (curvature / (8.0 * tolerance)).sqrt().ceil().clamp(1.0, MOST_LINES) as u32;
    count
}

/// Moves inner samples of C(t) by a twelfth of the second difference, so that the lines lie as much above C(t) as below: the error of
/// energies is of the fourth order then.
fn balance(samples: &mut [[f64; 2]]) {
    let Some(mut before) = samples.first().copied() else { return };
    for k in 1..samples.len() - 1 {
        let [here, after] = [samples[k], samples[k + 1]];
        samples[k] = [0, 1].map(|j| here[j] - (before[j] - 2.0 * here[j] + after[j]) / 12.0);
        before = here;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use videg_model::{Membrane, Parameters};

    #[test]
    fn lines_are_as_close_to_a_pulse_as_they_say() {
        let p = Parameters::default();
        let membrane = Membrane::new(&p);
        let mut pulses = SharedPulses::of(&p).unwrap();
        for (peak, tolerance) in [(1e-3, 1e-3), (4e-3, 1e-2), (7e-3, 1e-3), (1e-2, 1e-3), (1e-2, 1e-4), (2e-2, 1e-3)] {
            let at = |share: f64| membrane.capacitance(peak * share);
            let count = lines(6.0 * (at(1.0) - at(0.0)) / at(0.0), tolerance);
            let mut moved: Vec<_> = pulses.deflections(count).iter().map(|share| [at(*share), 0.0]).collect();
            balance(&mut moved);
            let exact: Vec<f64> = pulses.deflections(20 * count).iter().map(|share| at(*share)).collect();
            let off = |k: usize| {
                let (line, share) = ((k / 20).min(moved.len() - 2), (k as f64) / 20.0);
                let share = share - line as f64;
                (moved[line][0] * (1.0 - share) + moved[line + 1][0] * share) / exact[k] - 1.0
            };
            let largest = (0..exact.len()).map(|k| off(k).abs()).fold(0.0, f64::max);
            assert!(largest <= tolerance, "{peak} m: {largest:e} with {tolerance:e}");
        }
    }
}
