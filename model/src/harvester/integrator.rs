//! The harvester as differential equations with events, for an integrator of someone else's.
//!
//! The integrator sets the continuous states; between events their derivatives are Eq. (7) and a free (or carried)
//! ball. It watches [`Harvester::event_indicators`] for a change of sign and calls [`Harvester::handle_events`] there,
//! which does what an event does in [`Harvester::advance`]. The two ways of running must not be mixed in one harvester.

use super::Harvester;
use super::inputs::{check_force, finite};
use crate::accounting::batch::Batch;
use crate::error::ModelError;
use crate::motion::cylinder::{CylinderMotion, Drive};
use crate::motion::side::Side;
use crate::motion::{Ball, Start};
use crate::paper::gap::gap;
use crate::parameters::ContactLaw;

/// Phase-noise samples that an integrator may be behind: it may pause at an event before the event is handled.
pub const MAX_LAG: f64 = 1e6;

/// Gap, in units of s/2, below which an approaching ball meets the membrane: integrators find the instant from either
/// side, to their tolerance.
const CONTACT: f64 = 1e-9;

/// Gap that a ball is left with after an impact or a release, in units of the rounding of the positions, and speed that one has
/// that begins to slide, in units of the rounding of the velocities. The event
/// indicator is then on its positive side, so that the next crossing changes its sign however soon it comes.
const CLEARANCE: f64 = 8.0;

impl Harvester {
    /// Takes the continuous states `z_M`, m, `z_M'`, m/s, `z_m`, m, `z_m'`, m/s, and the energy that the damper has taken, J, at
    /// `time`, s, under the external `force`, N. Nothing happens to them: an event waits for [`Harvester::handle_events`].
    ///
    /// # Errors
    /// A value that is not finite; the compliant law.
    pub fn place(&mut self, time: f64, states: [f64; 5], force: f64) -> Result<(), ModelError> {
        for value in states {
            finite("continuous state", value)?;
        }
        finite("time", time)?;
        check_force([force, 0.0])?;
        if self.parameters.contact_law == ContactLaw::Compliant {
            return Err(ModelError::CompliantExchange);
        }
        let [position, velocity, ball_position, ball_velocity, damping] = states;
        let external = force / self.parameters.cylinder_mass;
        let drive = Drive { external, external_rate: 0.0, ..self.motion.cylinder.drive };
        self.time = time;
        self.leave_to_integrator();
        self.motion.cylinder = CylinderMotion::new(time, position, velocity, drive, self.motion.cylinder.load);
        self.motion.cylinder.damped = damping / self.parameters.cylinder_mass;
        self.motion.last = Start { time, position: ball_position, velocity: ball_velocity };
        self.forget_search();
        Ok(())
    }

    /// From now on an integrator sets the states.
    pub(super) fn leave_to_integrator(&mut self) {
        self.noise.pass_singly();
        self.motion.leave_to_integrator();
    }

    /// `z_M`, `z_M'`, `z_m`, `z_m'` (m, m/s) and the energy that the damper has taken, J.
    pub fn states(&self) -> [f64; 5] {
        let [cylinder, ball] = [self.cylinder_position(), self.ball_position()];
        [cylinder, self.cylinder_velocity(), ball, self.ball_velocity(), self.energies().damping]
    }

    /// Time derivatives of [`Harvester::states`]: Eq. (7), a ball that is free or carried by the membrane, and the power of the
    /// damper.
    pub fn derivatives(&self) -> [f64; 5] {
        let [cylinder, ball] = [self.cylinder_acceleration(), self.ball_acceleration()];
        [self.cylinder_velocity(), cylinder, self.ball_velocity(), ball, self.damping_power()]
    }

    /// The gaps between ball and membrane, m, left and right, Eq. (8). While the ball rests on a membrane there is no gap: in its
    /// place stands the acceleration, m/s^2, that presses the ball on, whose change of sign is the release. The third is for
    /// friction: the relative speed, m/s, of a ball that slides, and the acceleration, m/s^2, that one which sticks can still
    /// stand; 1 without friction.
    pub fn event_indicators(&self) -> [f64; 3] {
        let [left, right] = Side::BOTH.map(|side| match self.motion.ball.support() {
            Some(rests_on) if rests_on == side => self.pressing(side),
            _ => gap(self.motion.half_travel, side.sign(), self.relative_displacement()),
        });
        let friction = match &self.motion.ball {
            _ if self.motion.mount.friction == 0.0 => 1.0,
            Ball::Stuck => self.motion.mount.friction - self.carrying_acceleration().abs(),
            Ball::Free => self.motion.slip * self.relative_rate(),
            Ball::Resting(_) | Ball::InContact(_) => 1.0,
        };
        [left, right, friction]
    }

    /// `z_M'` - `z_m'`, m/s.
    fn relative_rate(&self) -> f64 {
        self.cylinder_velocity() - self.ball_velocity()
    }

    /// Acceleration, m/s^2, that the cylinder must give a ball that it carries, against gravity.
    fn carrying_acceleration(&self) -> f64 {
        self.cylinder_acceleration() + self.motion.mount.incline
    }

    /// Acceleration, m/s^2, that holds the ball on the membrane at `side`, friction included.
    fn pressing(&self, side: Side) -> f64 {
        side.sign() * self.carrying_acceleration() + self.motion.mount.friction
    }

    /// Does what is due at the present time: a fresh phase-noise sample; the next sample of the recording; an impact, Eqs. (10) to (13); a release. True if
    /// continuous states have changed. A ball beyond a membrane and approaching it counts as meeting it. A second call at the
    /// same time changes nothing more.
    ///
    /// # Errors
    /// More events than can be resolved; a time more than 1e6 hold intervals of the phase noise after the sample due.
    pub fn handle_events(&mut self) -> Result<bool, ModelError> {
        self.tangent.fresh = false;
        self.check_lag()?;
        while let Some(due) = self.noise.limit().filter(|due| *due <= self.time * (1.0 + f64::EPSILON)) {
            self.next_noise_sample(due.min(self.time));
        }
        self.take_next_sample();
        self.settle_friction(self.time);
        let changed = match self.motion.ball {
            Ball::Resting(side) if self.pressing(side) > 0.0 => false,
            Ball::Stuck if self.carrying_acceleration().abs() <= self.motion.mount.friction => false,
            Ball::Resting(_) | Ball::Stuck => self.let_go()?,
            Ball::Free | Ball::InContact(_) => {
                let touched = self.impact_if_touching()?;
                self.turn_if_halted()? || touched
            }
        };
        self.forget_search();
        Ok(changed)
    }

    /// The recording goes on with the segment of the present time.
    fn take_next_sample(&mut self) {
        let due = self.motion.cylinder.drive.recorded.end;
        if due <= self.time + f64::EPSILON * self.time.abs() {
            let recorded = self.motion.recorded_at(due.max(self.time));
            self.restart(self.time, Drive { recorded, ..self.motion.drive_at(self.time) });
        }
    }

    /// The next time, s, at which an event is due whatever the states do: a fresh phase-noise sample, a sample of the
    /// recording, or the peak, end or overtaking of a pulse, where a capacitance has a kink.
    pub fn next_time_event(&self) -> Option<f64> {
        let knots = self.pulses.next_knots(self.time).map(|knot| knot.time);
        let sample = Some(self.motion.cylinder.drive.recorded.end).filter(|end| *end < f64::INFINITY);
        knots.chain(self.noise.limit()).chain(sample).min_by(f64::total_cmp)
    }

    /// That the integrator has not passed over more samples of the phase noise than it may.
    fn check_lag(&self) -> Result<(), ModelError> {
        let (time, hold) = (self.time, self.noise.hold());
        match self.noise.limit().filter(|due| time - due > MAX_LAG * hold) {
            Some(due) => Err(ModelError::NoiseLag { time, due, limit: MAX_LAG, hold }),
            None => Ok(()),
        }
    }

    fn let_go(&mut self) -> Result<bool, ModelError> {
        let support = self.motion.ball.support();
        self.budget.spend(self.time)?;
        self.release(self.time);
        if let Some(side) = support {
            self.clear(side);
        }
        self.set_out();
        Ok(true)
    }

    /// A ball that slid comes to a halt on the cylinder, or turns.
    fn turn_if_halted(&mut self) -> Result<bool, ModelError> {
        let slip = self.motion.slip;
        if slip == 0.0 || slip * self.relative_rate() > 0.0 {
            return Ok(false);
        }
        self.budget.spend(self.time)?;
        self.turn(self.time, self.relative_displacement());
        self.set_out();
        Ok(true)
    }

    /// Makes a ball that begins to slide a little faster than the cylinder, so that the indicator of friction is on its positive
    /// side.
    fn set_out(&mut self) {
        let rounding =
            f64::EPSILON * (self.cylinder_velocity().abs() + self.motion.half_travel * self.parameters.frequency);
        self.motion.last.velocity -= self.motion.slip * CLEARANCE * rounding;
    }

    fn impact_if_touching(&mut self) -> Result<bool, ModelError> {
        let dz = self.relative_displacement();
        let side = Side::of(dz);
        let (wall, ball) = (self.cylinder_velocity(), self.ball_velocity());
        let gap = gap(self.motion.half_travel, side.sign(), dz);
        if gap > CONTACT * self.motion.half_travel {
            return Ok(false);
        }
        if side.sign() * (wall - ball) <= 4.0 * f64::EPSILON * (wall.abs() + ball.abs()) {
            // The integrator's error has left a ball that recedes beyond the membrane. Left there, it might turn round
            // without the change of sign that an impact is recognised by.
            if gap < 0.0 {
                self.clear(side);
            }
            return Ok(gap < 0.0);
        }
        self.budget.spend(self.time)?;
        let mut batch = Batch::EMPTY;
        self.impact(self.time, side, side.sign() * (wall - ball), &mut batch);
        batch.settle(&self.membrane, &mut self.pulses, &mut self.ledger);
        if !self.motion.ball.is_carried() {
            self.clear(side);
        }
        Ok(true)
    }

    /// Moves the ball just inside the membrane at `side`.
    fn clear(&mut self, side: Side) {
        let (position, half_travel) = (self.cylinder_position(), self.motion.half_travel);
        let rounding = f64::EPSILON * (position.abs() + half_travel);
        self.motion.last.position = position - side.sign() * (half_travel - CLEARANCE * rounding);
    }

    /// The future is the integrator's: no impact is predicted.
    pub(super) fn forget_search(&mut self) {
        let (position, velocity) = (self.ball_position(), self.ball_velocity());
        let here = self.motion.cylinder.at(self.time);
        self.calm_until = f64::NEG_INFINITY;
        self.motion.forget_search(&here, [here.position - position, here.velocity - velocity]);
    }
}
