//! Changes with the harmonic force and its noise.

use super::{ParameterChange, Tangential, bounded};
use crate::motion::cylinder::{CylinderMotion, Drive, DriveChange};
use crate::recording::Segment;

impl Tangential<'_> {
    /// Changes of `z_M`, m, and `z_M'`, m/s, at `time`, s, in the present hold interval or one ahead.
    pub(super) fn change_by_drive(&self, time: f64, change: &ParameterChange) -> [f64; 2] {
        let noise = self.noise;
        let (mut sample, mut motion, mut sum) = (noise.sample, self.motion.cylinder, [0.0; 2]);
        (motion.drive.external, motion.drive.external_rate) = (0.0, 0.0);
        if self.begin() != motion.start {
            motion = CylinderMotion::new(self.begin(), 0.0, 0.0, motion.drive, motion.load);
        }
        while noise.in_blocks() && noise.begin_of(sample + 1) < time {
            let end = noise.begin_of(sample + 1);
            sum = self.carried(sum, &motion, end, sample, change);
            sample += 1;
            let next =
                CylinderMotion::new(end, 0.0, 0.0, Drive { phase: noise.phase(sample), ..motion.drive }, motion.load);
            // The end comes later by the change of the hold time in each interval before.
            sum[1] += (motion.at(end).acceleration - next.at(end).acceleration) * sample as f64 * change.of.noise_hold;
            motion = next;
        }
        self.carried(sum, &motion, time, sample, change)
    }

    /// From here on, s, changes with the harmonic force are those of one motion: the samples of a recording leave them alone.
    pub(super) fn begin(&self) -> f64 {
        let is_one = self.motion.playback.is_some() && self.noise.limit().is_none();
        if is_one { self.tangent.changes.since } else { self.motion.cylinder.start }
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
        let [position, velocity] = motion.change(time, &self.drive_change(sample, change));
        [from[0] + from[1] * (time - motion.start) + position, from[1] + velocity]
    }

    /// Change of the harmonic force in hold interval `sample`.
    fn drive_change(&self, sample: u64, change: &ParameterChange) -> DriveChange {
        let xi = [sample, self.noise.sample].map(|sample| self.noise.xi(sample));
        DriveChange { phase: change.drive.phase + (xi[0] - xi[1]) * change.of.phase_noise, ..change.drive }
    }

    fn sample_of_release(&self) -> u64 {
        self.motion.search.ahead.map_or(self.noise.sample, |ahead| ahead.here.sample)
    }

    /// Whether the release at `time`, s, is at a jump of the force, between two hold intervals of the phase noise.
    fn is_jump(&self, time: f64) -> bool {
        self.noise.limit().is_some() && time == self.noise.begin_of(self.sample_of_release())
    }

    /// dz'', m/s^2, just before the release at `time`, s: zero but at a jump.
    pub(super) fn acceleration_before(&self, time: f64) -> f64 {
        let Some(sample) = self.sample_of_release().checked_sub(1).filter(|_| self.is_jump(time)) else { return 0.0 };
        let CylinderMotion { start, drive, load, .. } = self.motion.predicted_cylinder(self.noise);
        let (phase, external) = (self.noise.phase(sample), drive.external + drive.external_rate * (time - start));
        let cylinder = CylinderMotion::new(time, 0.0, 0.0, Drive { phase, external, ..drive }, load);
        cylinder.at(time).acceleration + self.motion.mount.incline
    }

    /// Change of the release at `time`, s: the acceleration of the wall passes zero there, or jumps at the begin of a hold
    /// interval of the phase noise.
    pub fn release_change(&self, time: f64) -> f64 {
        let (cylinder, sample) = (self.motion.predicted_cylinder(self.noise), self.sample_of_release());
        if self.is_jump(time) {
            return self.tangent.of(|change| sample as f64 * change.of.noise_hold);
        }
        let by_drive = self.tangent.of(|change| cylinder.acceleration_change(time, &self.drive_change(sample, change)));
        let Segment { number, start, .. } = cylinder.drive.recorded;
        if number > 0 && time == start {
            return 0.0; // a jump of the recording
        }
        bounded(-(self.tangent.push + self.tangent.incline() + by_drive) / cylinder.at(time).jerk)
    }
}
