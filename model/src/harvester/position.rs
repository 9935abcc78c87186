//! Where the ball is, at any time up to the next event.

use super::{Ball, Harvester};

impl Harvester {
    pub(super) fn half_travel(&self) -> f64 {
        self.parameters.travel() / 2.0
    }

    pub(super) fn ball_at(&self, time: f64) -> Ball {
        let (position, velocity) = (self.ball_position_at(time), self.ball_velocity_at(time));
        Ball { since: time, position, velocity, resting: None }
    }

    pub(super) fn relative_displacement_at(&self, time: f64) -> f64 {
        let [dz, _] = self.relative_motion_at(time);
        dz
    }

    /// `z_M` - `z_m`, m, and its rate, m/s.
    pub(super) fn relative_motion_at(&self, time: f64) -> [f64; 2] {
        if let Some(touch) = &self.touch {
            let (sign, point) = (touch.side.sign(), touch.at(time));
            return [sign * (self.half_travel() + point.x), sign * point.v];
        }
        match self.ball.resting {
            Some(side) => [side.sign() * self.half_travel(), 0.0],
            None => self.search.flight.at(time - self.search.flight.start),
        }
    }

    pub(super) fn ball_position_at(&self, time: f64) -> f64 {
        if self.touch.is_some() {
            return self.cylinder_position_at(time) - self.relative_displacement_at(time);
        }
        match self.ball.resting {
            Some(side) => self.cylinder.position(time) - side.sign() * self.half_travel(),
            None => self.ball.position + self.ball.velocity * (time - self.ball.since),
        }
    }

    pub(super) fn ball_velocity_at(&self, time: f64) -> f64 {
        if let Some(touch) = &self.touch {
            return self.cylinder_velocity_at(time) - touch.side.sign() * touch.at(time).v;
        }
        if self.ball.resting.is_some() { self.cylinder.velocity(time) } else { self.ball.velocity }
    }
}
