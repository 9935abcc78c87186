//! What acts on cylinder and ball besides excitation and contacts: the cylinder's suspension or the shaker that moves it, gravity
//! along the axis, friction, and whether the ball acts back on the cylinder.

use super::suspended::Suspension;
use crate::parameters::{ExcitationKind, Parameters};

/// What mount and ball do to the cylinder between impacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// The mass that moves as one over M.
    pub mass: f64,
    /// One over that.
    pub share: f64,
    /// Force of the ball on the cylinder over M, m/s^2.
    pub push: f64,
    /// Share of an external force that moves the cylinder: 0 if a shaker prescribes the motion, else 1.
    pub give: f64,
    /// Spring and damper, over M.
    pub suspension: Suspension,
}

/// The same during the whole run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// m / M if the ball acts back on the cylinder, else 0.
    pub ratio: f64,
    /// g sin(beta), m/s^2.
    pub incline: f64,
    /// mu g cos(beta), m/s^2.
    pub friction: f64,
    /// M / (m + M) if the ball acts back, else 1: the share of an impulse in the relative velocity that the ball takes.
    pub share: f64,
    /// What remains, that of the cylinder.
    pub taken: f64,
    /// The load without a ball.
    empty: Load,
}

impl Load {
    /// The cylinder moves as if there were no ball.
    pub const NONE: Self = Self { mass: 1.0, share: 1.0, push: 0.0, give: 1.0, suspension: Suspension::NONE };
}

impl Mount {
    pub fn new(p: &Parameters) -> Self {
        let [stiffness, damping] = [p.suspension_stiffness, p.suspension_damping].map(|value| value / p.cylinder_mass);
        let give = if p.excitation_kind == ExcitationKind::Force { 1.0 } else { 0.0 };
        let empty = Load { give, suspension: Suspension { stiffness, damping }, ..Load::NONE };
        let ratio = p.reaction_ratio();
        let share = 1.0 / (1.0 + ratio);
        Self {
            ratio,
            incline: p.incline(),
            friction: p.friction_acceleration(),
            share,
            taken: ratio / (1.0 + ratio),
            empty,
        }
    }

    /// Load of a ball that slides with this sign of dz', 0 without friction.
    pub fn sliding(&self, slip: f64) -> Load {
        Load { push: -slip * self.friction * self.ratio, ..self.empty }
    }

    /// Load of a ball that the cylinder carries: its mass and its weight.
    pub fn carrying(&self) -> Load {
        Load { mass: 1.0 + self.ratio, share: self.share, push: -self.ratio * self.incline, ..self.empty }
    }

    /// Length of the longest piece of the motion of a suspended cylinder, s, under a force with omega, rad/s.
    pub fn longest_piece(&self, omega: f64) -> f64 {
        self.empty.suspension.over(self.share).piece(omega)
    }

    /// Whether spring or damper hold the cylinder.
    pub fn is_suspended(&self) -> bool {
        !self.empty.suspension.is_none()
    }

    /// What gravity and friction add to dz'', m/s^2, by the ball's own motion.
    pub fn relative(&self, slip: f64) -> f64 {
        self.incline - slip * self.friction
    }

    /// What friction takes from |dz'|, m/s^2, of both bodies.
    pub fn deceleration(&self) -> f64 {
        self.friction * (1.0 + self.ratio)
    }

    /// How a ball without relative velocity goes on where a ball without friction would have this dz'', m/s^2, a sum of terms of this
    /// `size`: the sign of dz' with which it slides, 0 if friction holds it.
    pub fn start_of_slip(&self, acceleration: f64, size: f64) -> f64 {
        let limit = self.deceleration() + self.tolerance(size);
        if acceleration.abs() <= limit { 0.0 } else { acceleration.signum() }
    }

    /// By how much friction is exceeded, m/s^2, before a ball sets out: rounding of terms of this `size`, which would set it out and
    /// halt it again and again.
    pub fn tolerance(&self, size: f64) -> f64 {
        if self.friction == 0.0 { 0.0 } else { 16.0 * f64::EPSILON * (size + self.incline.abs() + self.friction) }
    }
}
