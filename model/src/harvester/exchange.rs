//! The harvester as differential equations with events, for an integrator of someone else's.
//!
//! The integrator places the continuous states; between events their derivatives are Eq. (7) and a free (or carried)
//! ball. It watches [`Harvester::event_indicators`] for a change of sign and calls [`Harvester::handle_events`] there,
//! which does what an event does in [`Harvester::advance`]. The two ways of running must not be mixed in one harvester.

use super::dues::Dues;
use super::events::Search;
use super::input::{finite, within};
use super::snapshot::MAX_LAG;
use super::{Ball, Harvester};
use crate::cylinder::{CylinderMotion, Drive};
use crate::error::ModelError;
use crate::flight::{Flight, Side};
use crate::parameters::ContactLaw;

/// Gap, in units of s/2, below which an approaching ball meets the membrane: integrators find the instant from either
/// side, to their tolerance.
const CONTACT: f64 = 1e-9;

/// Gap that a ball is left with after an impact or a release, in units of the rounding of the positions. The event
/// indicator is then on its positive side, so that the next crossing changes its sign however soon it comes.
const CLEARANCE: f64 = 8.0;

impl Harvester {
    /// Takes the continuous states `z_M`, m, `z_M'`, m/s, `z_m`, m, `z_m'`, m/s, at `time`, s, under the external `force`,
    /// N. Nothing happens to them: an event waits for [`Harvester::handle_events`].
    ///
    /// # Errors
    /// A value that is not finite; the compliant law.
    pub fn place(&mut self, time: f64, states: [f64; 4], force: f64) -> Result<(), ModelError> {
        for value in states {
            finite("continuous state", value)?;
        }
        finite("time", time)?;
        within("externalForce", force, "N")?;
        if self.parameters.contact_law == ContactLaw::Compliant {
            return Err(ModelError::CompliantExchange);
        }
        let [position, velocity, ball_position, ball_velocity] = states;
        let drive =
            Drive { external: force / self.parameters.cylinder_mass, external_rate: 0.0, ..self.cylinder.drive };
        self.time = time;
        self.placed = true;
        self.cylinder = CylinderMotion::new(time, position, velocity, drive);
        self.ball = Ball { since: time, position: ball_position, velocity: ball_velocity, ..self.ball };
        self.forget_search();
        Ok(())
    }

    /// `z_M`, `z_M'`, `z_m`, `z_m'` (m, m/s).
    pub fn states(&self) -> [f64; 4] {
        [self.cylinder_position(), self.cylinder_velocity(), self.ball_position(), self.ball_velocity()]
    }

    /// `z_m''`, m/s^2: that of the cylinder while the ball rests, that of the forces of a contact, else 0.
    pub fn ball_acceleration(&self) -> f64 {
        if self.resting().is_some() { self.cylinder_acceleration() } else { self.touch_acceleration() }
    }

    /// Time derivatives of [`Harvester::states`]: Eq. (7), and a ball that is free or carried by the membrane.
    pub fn derivatives(&self) -> [f64; 4] {
        [self.cylinder_velocity(), self.cylinder_acceleration(), self.ball_velocity(), self.ball_acceleration()]
    }

    /// The gaps between ball and membrane, m, left and right. While the ball rests on a membrane there is no gap: in its
    /// place stands the acceleration, m/s^2, that presses the ball on, whose change of sign is the release.
    pub fn event_indicators(&self) -> [f64; 2] {
        [Side::Left, Side::Right].map(|side| match self.ball.resting {
            Some(rests_on) if rests_on == side => side.sign() * self.cylinder_acceleration(),
            _ => self.half_travel() - side.sign() * self.relative_displacement(),
        })
    }

    /// Does what is due at the present time: a fresh phase-noise sample; an impact, Eqs. (10) to (13); a release. True if
    /// continuous states have changed. A ball beyond a membrane and approaching it counts as meeting it. A second call at the same time changes nothing more.
    ///
    /// # Errors
    /// More events than can be resolved; a time more than 1e6 hold intervals of the phase noise after the sample due.
    pub fn handle_events(&mut self) -> Result<bool, ModelError> {
        self.tangent.fresh = false;
        self.check_lag()?;
        while let Some(due) = self.noise_limit().filter(|due| *due <= self.time * (1.0 + f64::EPSILON)) {
            self.next_noise_sample(due.min(self.time));
        }
        let changed = match self.ball.resting {
            Some(side) => self.release_if_pulled(side)?,
            None => self.impact_if_touching()?,
        };
        self.forget_search();
        Ok(changed)
    }

    /// The next time, s, at which an event is due whatever the states do: a fresh phase-noise sample, or the peak or end of
    /// a pulse, where a capacitance has a kink.
    pub fn next_time_event(&self) -> Option<f64> {
        self.pulse_knots().map(|knot| knot.time).chain(self.noise_limit()).min_by(f64::total_cmp)
    }

    /// That the integrator has not passed over more samples of the phase noise than it may.
    fn check_lag(&self) -> Result<(), ModelError> {
        let (time, hold) = (self.time, self.parameters.noise_hold);
        match self.noise_limit().filter(|due| time - due > MAX_LAG * hold) {
            Some(due) => Err(ModelError::NoiseLag { time, due, limit: MAX_LAG, hold }),
            None => Ok(()),
        }
    }

    fn release_if_pulled(&mut self, side: Side) -> Result<bool, ModelError> {
        if side.sign() * self.cylinder_acceleration() > 0.0 {
            return Ok(false);
        }
        self.spend(self.time)?;
        self.ball = self.ball_at(self.time);
        self.book_release(0.0);
        self.totals.releases += 1;
        self.clear(side);
        Ok(true)
    }

    fn impact_if_touching(&mut self) -> Result<bool, ModelError> {
        let dz = self.relative_displacement();
        let side = if dz > 0.0 { Side::Left } else { Side::Right };
        let (wall, ball) = (self.cylinder_velocity(), self.ball_velocity());
        let gap = self.half_travel() - dz.abs();
        if gap > CONTACT * self.half_travel() {
            return Ok(false);
        }
        if side.sign() * (wall - ball) <= 4.0 * f64::EPSILON * (wall.abs() + ball.abs()) {
            // The integrator's error has put a ball that recedes beyond the membrane. Left there, it might turn round
            // without the change of sign that an impact is recognised by.
            if gap < 0.0 {
                self.clear(side);
            }
            return Ok(gap < 0.0);
        }
        self.spend(self.time)?;
        let mut dues = Dues::NONE;
        self.impact(self.time, side, side.sign() * (wall - ball), &mut dues);
        self.settle_dues(&mut dues);
        if self.ball.resting.is_none() {
            self.clear(side);
        }
        Ok(true)
    }

    /// Puts the ball just inside the membrane at `side`.
    fn clear(&mut self, side: Side) {
        let position = self.cylinder_position();
        let rounding = f64::EPSILON * (position.abs() + self.half_travel());
        self.ball.position = position - side.sign() * (self.half_travel() - CLEARANCE * rounding);
    }

    /// The future is the integrator's: no impact is foreseen.
    fn forget_search(&mut self) {
        let (position, velocity) = (self.ball_position(), self.ball_velocity());
        let here = self.cylinder.at(self.time);
        self.calm_until = f64::NEG_INFINITY;
        let motion = [here.position - position, here.velocity - velocity];
        let flight = Flight::new(&self.cylinder, &here, motion, self.half_travel());
        self.search = Search::none(flight);
    }
}
