//! The impact that is foreseen, and how its time changes to first order.

use super::events::Event;
use super::phase::{Noise, phase, xi};
use super::tangent::{ParameterChange, bounded, grazes};
use super::{Harvester, Side};
use crate::cylinder::{CylinderMotion, Drive, DriveChange};

impl Harvester {
    /// The next impact, unless it grazes: time, side and relative speed.
    fn foreseen(&self) -> Option<(f64, Side, f64)> {
        let Some(Event::Impact { time, side }) = self.search.found else { return None };
        let cylinder = self.foreseen_motion();
        let speed = side.sign() * (cylinder.velocity(time) - self.ball.velocity);
        (!grazes(side, speed, cylinder.acceleration(time))).then_some((time, side, speed))
    }

    pub(super) fn next_impact_change(&self) -> f64 {
        self.foreseen().map_or(0.0, |(time, side, speed)| self.delay(time, side, speed))
    }

    pub(super) fn next_knot_change(&self, next_impact_change: f64) -> f64 {
        let shape = self.tangent.parameters.map(|change| change.shape).unwrap_or_default();
        let pulses = self.pulse_knots().map(|knot| (knot.time, knot.change(&self.shape, &shape)));
        let next_impact = self.next_impact().map(|time| (time, next_impact_change));
        pulses.chain(next_impact).min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, change)| change)
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
        let xi = [&Noise { sample, ..self.noise }, &self.noise].map(|noise| xi(&self.parameters, noise));
        let drive = DriveChange { phase: change.drive.phase + (xi[0] - xi[1]) * change.intensity, ..change.drive };
        let [position, velocity] = motion.change(time, &drive);
        [from[0] + from[1] * (time - motion.start) + position, from[1] + velocity]
    }
}
