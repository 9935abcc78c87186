//! What is foreseen: the next impact, beyond a release, too, the next knot of C(t), and how their times change to first
//! order.

use super::events::{Event, Search};
use super::phase::{Noise, phase, xi};
use super::tangent::{ParameterChange, bounded, grazes};
use super::{Harvester, Side};
use crate::compliant::Touch;
use crate::cylinder::{CylinderMotion, Drive, DriveChange};

impl Harvester {
    /// Time of the next impact, s, if the external force goes on as it is: of a ball that rests, after its release. None
    /// during a contact under the compliant law, and if no impact is foreseen within at least one excitation period (from
    /// the release on, if the ball rests), or, with phase noise, within at least 256 hold intervals if those are shorter;
    /// within the present hold interval under the compliant law, with a Wiener process, and if hold intervals are longer than
    /// a period.
    pub fn next_impact(&self) -> Option<f64> {
        if self.is_due() {
            return self.after_due()?.next_impact();
        }
        match self.search.found {
            Some(Event::Impact { time, .. }) => Some(time),
            _ => self.search.after_release.filter(|time| time.is_finite()),
        }
    }

    /// The next time, s, at which a capacitance has a kink or an extremum, or the ball becomes free: the peak or the end of
    /// a pulse, an impact, or the release of a resting ball; under the compliant law up to where the present contact is foreseen
    /// under the present force and voltages, which is at most one excitation period.
    pub fn next_knot(&self) -> Option<f64> {
        if self.is_due() {
            return self.after_due()?.next_knot();
        }
        let pulses = self.pulse_knots().map(|knot| knot.time);
        let knots = pulses.chain(self.next_impact()).chain(self.next_release()).chain(self.touch_knot());
        knots.min_by(f64::total_cmp)
    }

    fn next_release(&self) -> Option<f64> {
        let Some(Event::Release { time }) = self.search.found else { return None };
        Some(time)
    }

    /// Whether something happens at the present time, under a force or a voltage just set.
    pub(super) fn is_due(&self) -> bool {
        let contact = self.touch.as_ref().map(Touch::end);
        contact.or(self.search.found.map(Event::time)).is_some_and(|time| time <= self.time)
    }

    /// This harvester after what is due at its present time.
    pub(super) fn after_due(&self) -> Option<Self> {
        let mut ahead = self.clone();
        ahead.advance_through_events(self.time, |_| {}).ok()?;
        Some(ahead)
    }

    /// This harvester when its ball has just been released, if that is what comes next.
    fn at_release(&self) -> Option<Self> {
        let time = self.next_release()?;
        let mut ahead = self.clone();
        ahead.go_to(time, &mut |_| {}).ok()?;
        ahead.next_event(time + ahead.horizon(), false);
        Some(ahead)
    }

    pub(super) fn look_beyond_release(&mut self) {
        if self.search.after_release.is_some() {
            return;
        }
        let ahead = self.at_release();
        self.search.after_release = ahead.map(|ahead| ahead.next_impact().unwrap_or(f64::INFINITY));
    }

    /// The next impact, unless it grazes: time, side and relative speed.
    fn foreseen(&self) -> Option<(f64, Side, f64)> {
        let Search { found: Some(Event::Impact { time, side }), speed, .. } = self.search else { return None };
        (!grazes(side, speed, self.foreseen_motion().acceleration(time))).then_some((time, side, speed))
    }

    /// Change of [`Harvester::next_impact`].
    pub(super) fn next_impact_change(&self) -> f64 {
        let Some((release, side)) = self.next_release().zip(self.ball.resting) else {
            return self.foreseen().map_or(0.0, |(time, side, speed)| self.delay(time, side, speed));
        };
        let impact = self.at_release().and_then(|ahead| ahead.foreseen());
        impact.map_or(0.0, |(time, hit, speed)| {
            // The ball goes straight on from where, and as fast as, the wall lets it go.
            let ([from, velocity], [to, _]) = (self.cylinder_change(release), self.cylinder_change(time));
            let velocity = velocity + self.acceleration_before(release) * self.release_change(release);
            let displacement = to - from - velocity * (time - release) + side.sign() * self.tangent.half_travel();
            self.delay_by(displacement, hit, speed)
        })
    }

    /// Change of [`Harvester::next_knot`].
    pub(super) fn next_knot_change(&self, next_impact_change: f64) -> f64 {
        let shape = self.tangent.parameters.map(|change| change.shape).unwrap_or_default();
        let pulses = self.pulse_knots().map(|knot| (knot.time, knot.change(&self.shape, &shape)));
        let next_impact = self.next_impact().map(|time| (time, next_impact_change));
        let release = self.next_release().map(|time| (time, self.release_change(time)));
        let knots = pulses.chain(next_impact).chain(release);
        knots.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, change)| change)
    }

    fn sample_of_release(&self) -> u64 {
        self.search.ahead.map_or(self.noise.sample, |place| place.sample())
    }

    /// Whether the release at `time`, s, is at a jump of the force, between two hold intervals of the phase noise.
    fn is_jump(&self, time: f64) -> bool {
        self.noise_limit().is_some() && time == self.hold_start(self.sample_of_release())
    }

    /// Acceleration of the wall, m/s^2, just before the release at `time`, s: zero but at a jump.
    fn acceleration_before(&self, time: f64) -> f64 {
        let Some(sample) = self.sample_of_release().checked_sub(1).filter(|_| self.is_jump(time)) else { return 0.0 };
        let CylinderMotion { start, drive, .. } = self.foreseen_motion();
        let phase = phase(&self.parameters, &Noise { sample, ..self.noise });
        let external = drive.external + drive.external_rate * (time - start);
        CylinderMotion::new(time, 0.0, 0.0, Drive { phase, external, ..drive }).acceleration(time)
    }

    /// Change of the release at `time`, s: the acceleration of the wall passes zero there, or jumps at the begin of a hold
    /// interval of the phase noise.
    fn release_change(&self, time: f64) -> f64 {
        let cylinder = self.foreseen_motion();
        let sample = self.sample_of_release();
        let parameters = self.tangent.parameters.as_ref();
        if self.is_jump(time) {
            return parameters.map_or(0.0, |change| sample as f64 * change.hold);
        }
        let by_drive =
            parameters.map_or(0.0, |change| cylinder.acceleration_change(time, &self.drive_change(sample, change)));
        bounded(-(self.tangent.push + by_drive) / cylinder.jerk(time))
    }

    /// Changes of [`Harvester::next_impact`] and [`Harvester::next_knot`] per unit of `z_M` - `z_m` and of its rate at the
    /// present time.
    pub fn next_times_by_displacement(&self) -> [[f64; 2]; 2] {
        let next_impact = match self.foreseen() {
            Some((time, side, speed)) => {
                [1.0, time - self.time].map(|approach| bounded(-side.sign() * approach / speed))
            }
            None => [0.0; 2],
        };
        let is_knot = self.next_impact().is_some() && self.next_impact() == self.next_knot();
        [next_impact, if is_knot { next_impact } else { [0.0; 2] }]
    }

    /// Changes of `z_M`, m, and `z_M'`, m/s, at `time`, s, in the present hold interval or one ahead, with the harmonic
    /// force and its noise.
    pub(super) fn change_by_force(&self, time: f64, change: &ParameterChange) -> [f64; 2] {
        let (mut sample, mut motion, mut sum) = (self.noise.sample, self.cylinder, [0.0; 2]);
        (motion.drive.external, motion.drive.external_rate) = (0.0, 0.0);
        while self.in_blocks() && self.hold_start(sample + 1) < time {
            let end = self.hold_start(sample + 1);
            sum = self.carried(sum, &motion, end, sample, change);
            sample += 1;
            let phase = phase(&self.parameters, &Noise { sample, ..self.noise });
            let next = CylinderMotion::new(end, 0.0, 0.0, Drive { phase, ..motion.drive });
            // The end comes later by the change of the hold time in each interval before.
            sum[1] += (motion.acceleration(end) - next.acceleration(end)) * sample as f64 * change.hold;
            motion = next;
        }
        self.carried(sum, &motion, time, sample, change)
    }

    /// Changes `from` the start of `motion`, in hold interval `sample`, carried on to `time`, s.
    fn carried(
        &self,
        from: [f64; 2],
        motion: &CylinderMotion,
        time: f64,
        sample: u64,
        change: &ParameterChange,
    ) -> [f64; 2] {
        let drive = self.drive_change(sample, change);
        let [position, velocity] = motion.change(time, &drive);
        [from[0] + from[1] * (time - motion.start) + position, from[1] + velocity]
    }

    /// Change of the harmonic force in hold interval `sample`.
    fn drive_change(&self, sample: u64, change: &ParameterChange) -> DriveChange {
        let xi = [&Noise { sample, ..self.noise }, &self.noise].map(|noise| xi(&self.parameters, noise));
        DriveChange { phase: change.drive.phase + (xi[0] - xi[1]) * change.intensity, ..change.drive }
    }
}
