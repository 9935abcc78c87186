//! The ledger: what impacts gain, and the works on ball and cylinder.
//!
//! For the ball, from any time to any other: kinetic + elastic + impact loss = what they were + wall + electrical. For the
//! cylinder: kinetic = what it was + excitation, minus the work of the wall if there is reaction.

use crate::paper::impact;
use crate::parameters::Parameters;

/// Sums over all impacts so far.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Totals {
    /// Impacts resolved one by one; under the compliant law, contacts begun. Of a chattering sequence, the endless tail that is
    /// summed in closed form is not counted here; its gains are contained below.
    pub impacts: u64,
    /// Chattering sequences that ended with the ball at rest on a membrane.
    pub chatters: u64,
    /// Times that a resting ball left a membrane.
    pub releases: u64,
    /// Relative speed of the last impact, m/s.
    pub last_speed: f64,
    /// Sum of `U_DE4` - `U_in`, V: the numerator of Eq. (15).
    pub voltage_gain: f64,
    /// Sum of W, J, Eq. (13): the numerator of Eq. (14).
    pub energy: f64,
}

impl Totals {
    /// Events processed: what the run cost.
    pub fn events(&self) -> u64 {
        self.impacts + self.releases
    }
}

/// Sums of the energy up to the last event.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Works {
    /// Work of the walls on the ball, J; while the ball rests under the impulsive law, less its kinetic energy.
    pub wall: f64,
    /// Work of the Maxwell force on the ball, J.
    pub electrical: f64,
    /// Energy lost in contacts that have ended, J.
    pub loss: f64,
    /// Time in contact under the compliant law, s, of contacts that have ended.
    pub contact_time: f64,
}

/// Mechanical energies and works since the start, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energies {
    /// Kinetic energy of the ball in the laboratory frame.
    pub ball: f64,
    /// Kinetic energy of the cylinder in the laboratory frame.
    pub cylinder: f64,
    /// Energy that the membranes can give back; an impact that takes no time stores none.
    pub elastic: f64,
    /// Energy lost in the membranes.
    pub impact_loss: f64,
    /// Work of excitation and external force on the cylinder.
    pub excitation: f64,
    /// Work of the Maxwell force on the ball: the integral of 1/2 U^2 dC.
    pub electrical: f64,
    /// Work of the walls, membranes included, on the ball, with the walls' own velocity.
    pub wall: f64,
}

/// All sums of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ledger {
    pub totals: Totals,
    pub works: Works,
    bias: f64,
    rest_capacitance: f64,
    ball_mass: f64,
    restitution: f64,
}

impl Ledger {
    /// The sums so far of a harvester with these parameters and `C_2`, F.
    pub fn new(p: &Parameters, rest_capacitance: f64, totals: Totals, works: Works) -> Self {
        let Parameters { bias_voltage: bias, ball_mass, restitution, .. } = *p;
        Self { totals, works, bias, rest_capacitance, ball_mass, restitution }
    }

    /// Adds the gains of impacts whose `C_3` / `C_2` - 1 sum to `excess`.
    #[inline]
    pub fn credit(&mut self, excess: f64) {
        self.totals.voltage_gain += impact::voltage_gain(self.bias, excess);
        self.totals.energy += impact::energy(self.bias, self.rest_capacitance, excess);
    }

    /// Kinetic energy of the ball at `velocity`, m/s.
    pub fn kinetic(&self, velocity: f64) -> f64 {
        0.5 * self.ball_mass * velocity * velocity
    }

    /// Counts an impact at relative `speed`, m/s, or a contact that begins so.
    pub fn count_impact(&mut self, speed: f64) {
        self.totals.impacts += 1;
        self.totals.last_speed = speed;
    }

    /// An impact at relative `speed`, m/s: the impulse m (1 + r) `speed` at the velocity of the `wall`, m/s. `sign` is that of dz.
    pub fn impact(&mut self, sign: f64, wall: f64, speed: f64) {
        let r = self.restitution;
        self.works.wall += self.ball_mass * sign * (1.0 + r) * speed * wall;
        self.works.loss += (1.0 - r * r) * self.kinetic(speed);
    }

    /// A chattering sequence ends: a ball faster than the `wall` by `slip` takes on its velocity, m/s.
    pub fn settle(&mut self, wall: f64, slip: f64) {
        self.totals.chatters += 1;
        self.works.wall -= self.ball_mass * slip * wall;
        self.works.loss += self.kinetic(slip);
    }

    /// The wall, at velocity `wall`, m/s, begins to carry the ball: its work is the gain of kinetic energy.
    pub fn rest(&mut self, wall: f64) {
        self.works.wall -= self.kinetic(wall);
    }

    /// The wall lets the ball go at `velocity`, m/s.
    pub fn release(&mut self, velocity: f64) {
        self.works.wall += self.kinetic(velocity);
        self.totals.releases += 1;
    }
}
