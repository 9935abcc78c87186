//! How a chattering sequence ends.

use super::Motion;
use super::cylinder::CylinderState;
use super::side::Side;
use super::suspended::Suspension;

/// How exactly the motion is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Accuracy {
    /// To rounding.
    Exact,
    /// By an integrator with tolerances, which cannot follow bounces so low.
    Integrated,
}

impl Accuracy {
    /// Height of a bounce, in units of s/2, below which a ball may count as resting; and the relative change of the wall's
    /// acceleration over the rest of a chattering sequence below which it counts as constant, so that the rest is a geometric
    /// series.
    fn bounds(self) -> [f64; 2] {
        match self {
            Self::Exact => [1e-9, 1e-5],
            Self::Integrated => [1e-6, 1e-3],
        }
    }
}

/// How a chattering sequence ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tail {
    /// Endless bounces in a time so short that they are a geometric series.
    Summed {
        /// Speed at which the ball returns to the membrane over that at which it left: 1 without friction.
        slower: f64,
    },
    /// Bounces lower than rounding; what they would still gain is left out.
    Unresolved,
}

impl Motion {
    /// Whether a ball that leaves the `wall` at `side` with relative speed `rebound`, m/s, comes to rest there, because that
    /// pushes and the next bounce is lower than rounding, or at least very low, with all that follow so short that the push is
    /// constant meanwhile. Up to `limit`, s, the phase of the force is known; a recording has a line up to the next sample.
    #[inline]
    pub fn end_of_bounces(&self, side: Side, rebound: f64, wall: &CylinderState, limit: f64) -> Option<Tail> {
        let push = side.sign() * self.free_acceleration(wall);
        let friction = self.mount.deceleration();
        // Friction acts against a ball that leaves, and against one that returns.
        let leaving = push + friction;
        if leaving <= 0.0 {
            return (leaving == 0.0 && rebound == 0.0 && side.sign() * wall.jerk > 0.0).then_some(Tail::Unresolved);
        }
        let [highest, tolerance] = self.accuracy.bounds();
        let (highest, unresolved) = (highest * self.half_travel, 4.0 * self.flight.rounding_at_start());
        if rebound * rebound > 2.0 * leaving * highest.max(unresolved) {
            return None;
        }
        self.end_of_low_bounces(rebound, [leaving, push - friction], wall, limit, [highest, unresolved, tolerance])
    }

    /// The same of a bounce that is low; accelerations of a ball that leaves and of one that returns, m/s^2.
    #[cold]
    fn end_of_low_bounces(
        &self,
        rebound: f64,
        [leaving, returning]: [f64; 2],
        wall: &CylinderState,
        limit: f64,
        [highest, unresolved, tolerance]: [f64; 3],
    ) -> Option<Tail> {
        let CylinderState { time, jerk, .. } = *wall;
        let limit = limit.min(self.cylinder.drive.recorded.end);
        let height = rebound * rebound / (2.0 * leaving);
        if returning > 0.0 {
            let slower = (returning / leaving).sqrt();
            // Flights of (1 + 1 / q) v / a, (1 + 1 / q) v q r / a, ..., where q v is the speed of the return: their sum.
            let duration = (1.0 + 1.0 / slower) * rebound / (leaving * (1.0 - self.restitution * slower));
            let Suspension { stiffness, damping } = self.cylinder.load.suspension;
            let by_mount = stiffness * wall.acceleration.abs() + damping * jerk.abs();
            let curvature = self.cylinder.drive.amplitude * self.cylinder.drive.omega().powi(2) + by_mount;
            let change = duration * (jerk.abs() + 0.5 * duration * curvature);
            if height <= highest && change <= tolerance * returning && time + duration <= limit {
                return Some(Tail::Summed { slower });
            }
        }
        (height <= unresolved).then_some(Tail::Unresolved)
    }
}
