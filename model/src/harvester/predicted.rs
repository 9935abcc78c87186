//! What is predicted: the next impact, beyond a release, too, the next knot of C(t), and how their times change to first
//! order.

use super::Harvester;
use crate::contact::{Contact, Ending};
use crate::motion::Prediction;
use crate::motion::side::Side;
use crate::sensitivity::{bounded, grazes};

/// Releases and turns of the ball after which the next impact is still looked for.
const STARTS: usize = 8;

impl Harvester {
    /// Time of the next impact, s, if the external force goes on as it is: of a ball that rests, or is about to turn against friction, after that. None
    /// during a contact under the compliant law, and if no impact is predicted within at least one excitation period (from
    /// the release on, if the ball rests). On a suspension it is at least a million pieces of its power series, if those are shorter. With
    /// phase noise it is at least 512 hold intervals if those are shorter, or
    /// within the present hold interval under the compliant law, with a Wiener process, and if hold intervals are longer than
    /// a fiftieth of a period.
    pub fn next_impact(&self) -> Option<f64> {
        if self.is_due() {
            return self.after_due()?.next_impact();
        }
        match self.motion.found_impact() {
            Some((time, ..)) => Some(time),
            None => self.motion.search.after_release.filter(|time| time.is_finite()),
        }
    }

    /// The next time, s, at which a capacitance has a kink or an extremum, or the ball becomes free: the peak or the end of
    /// a pulse, or where another one that overlaps it becomes the larger, an impact, or the release of a resting ball; under the compliant law up to where the present contact is predicted
    /// under the present force and voltages, which is at most one excitation period.
    pub fn next_knot(&self) -> Option<f64> {
        if self.is_due() {
            return self.after_due()?.next_knot();
        }
        let pulses = self.pulses.next_knots(self.time).map(|knot| knot.time);
        let knots = pulses.chain(self.next_impact()).chain(self.motion.found_release()).chain(self.contact_knot());
        knots.min_by(f64::total_cmp)
    }

    /// Up to where [`Harvester::next_knot`] knows every knot, s, later than the present time: one excitation period ahead, with phase noise at
    /// most 512 hold intervals, and where these are passed one by one the end of the present one; on a suspension at most a million
    /// pieces of its power series; during a contact as far as
    /// it has been followed.
    pub fn known_until(&self) -> f64 {
        let followed = self.motion.ball.contact().map_or(f64::INFINITY, Contact::end);
        let followed = if followed > self.time { followed } else { f64::INFINITY };
        let ahead = followed.min(self.time + self.horizon());
        if self.noise.in_blocks() {
            return ahead;
        }
        // At the end of an interval the next one has not been entered yet.
        let next = self.time + self.parameters.noise_hold;
        self.noise.limit().map_or(ahead, |end| if end > self.time { end } else { next }.min(ahead))
    }

    /// End, s, of the stretch that begins at the present time and on which both capacitances are smooth as far as is known: the
    /// first [`Harvester::next_knot`] later than the present time, or [`Harvester::known_until`], or `time`. Whether it is
    /// that knot.
    pub fn smooth_until(&self, time: f64) -> (f64, bool) {
        let knot = self.next_knot().filter(|knot| *knot > self.time).unwrap_or(f64::INFINITY);
        let end = knot.min(self.known_until()).min(time);
        (end, end == knot)
    }

    /// Up to where the contact is predicted, s: to where the membrane's force changes its branch, if that is within a period.
    /// With phase noise a contact is followed hold interval by hold interval, whose ends are no knots.
    fn contact_knot(&self) -> Option<f64> {
        let is_hold = |contact: &&Contact| contact.ending() == Ending::Cut && self.noise.limit().is_some();
        self.motion.ball.contact().filter(|contact| !is_hold(contact)).map(Contact::end)
    }

    /// Whether something happens at the present time, under a force or a voltage just set.
    pub(super) fn is_due(&self) -> bool {
        let contact = self.motion.ball.contact().map(Contact::end);
        contact.or(self.motion.search.found.map(Prediction::time)).is_some_and(|time| time <= self.time)
    }

    /// This harvester after what is due at its present time.
    pub(super) fn after_due(&self) -> Option<Self> {
        let mut ahead = self.clone();
        ahead.advance_through_events(self.time, None).ok()?;
        Some(ahead)
    }

    /// This harvester when its ball has just been released, or has turned against friction, if that is what comes next.
    fn at_release(&self) -> Option<Self> {
        let time = self.motion.found_start()?;
        let mut ahead = self.clone();
        ahead.go_to(time, None).ok()?;
        ahead.search_from(time);
        Some(ahead)
    }

    /// Looks as far beyond the release as events are predicted, counted from there and not from the present time, which a caller chooses.
    pub(super) fn look_beyond_release(&mut self) {
        if self.motion.search.after_release.is_none()
            && let Some(mut ahead) = self.at_release()
        {
            let horizon = ahead.time + 1.0 / self.parameters.frequency;
            // Friction may hold the ball some times before it arrives.
            for _ in 0..STARTS {
                let Some(next) = ahead.at_release().filter(|next| next.time < horizon) else { break };
                ahead = next;
            }
            self.motion.search.after_release = Some(ahead.next_impact().unwrap_or(f64::INFINITY));
        }
    }

    /// The next impact, unless it grazes: time, side and relative speed.
    fn resolved_impact(&self) -> Option<(f64, Side, f64)> {
        let impact = self.motion.found_impact();
        impact.filter(|(time, side, speed)| {
            !grazes(
                *side,
                *speed,
                self.motion.predicted_cylinder(&self.noise).at(*time).acceleration + self.motion.mount.incline,
            )
        })
    }

    /// Change of [`Harvester::next_impact`].
    pub(super) fn next_impact_change(&self) -> f64 {
        let changes = self.tangential();
        match self.motion.found_release().zip(self.motion.ball.support()) {
            None => self.resolved_impact().map_or(0.0, |(time, side, speed)| changes.delay(time, side, speed)),
            Some((release, side)) => {
                let impact = self.at_release().and_then(|ahead| ahead.resolved_impact());
                impact.map_or(0.0, |impact| changes.delay_after_release(release, side, impact))
            }
        }
    }

    /// Change of [`Harvester::next_knot`].
    pub(super) fn next_knot_change(&self, next_impact_change: f64) -> f64 {
        let shape = self.tangent.parameters.as_ref().map(|change| change.shape).unwrap_or_default();
        let pulses = self.pulses.next_knots(self.time);
        let pulses = pulses.map(|knot| (knot.time, knot.change(&self.pulses.shape, shape)));
        let next_impact = self.next_impact().map(|time| (time, next_impact_change));
        let release = self.motion.found_release().map(|time| (time, self.tangential().release_change(time)));
        let knots = pulses.chain(next_impact).chain(release);
        knots.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, change)| change)
    }

    /// Changes of [`Harvester::next_impact`] and [`Harvester::next_knot`] per unit of `z_M` - `z_m` and of its rate at the
    /// present time.
    pub fn next_times_by_displacement(&self) -> [[f64; 2]; 2] {
        let next_impact = self.resolved_impact().map_or([0.0; 2], |(time, side, speed)| {
            [1.0, time - self.time].map(|approach| bounded(-side.sign() * approach / speed))
        });
        let is_knot = self.next_impact().is_some() && self.next_impact() == self.next_knot();
        [next_impact, if is_knot { next_impact } else { [0.0; 2] }]
    }
}
