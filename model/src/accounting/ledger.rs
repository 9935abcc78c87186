//! The ledger: what impacts gain, and the works on ball and cylinder.
//!
//! For the ball, from any time to any other: kinetic + elastic + impact loss + viscous loss + friction = what they were + wall + electrical +
//! gravity. For the cylinder: kinetic + suspension + damping = what they were + excitation, minus the work of the wall if
//! there is reaction.

use crate::motion::mount::Mount;
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
    /// Rebound speed over impact speed of the last contact under the compliant law that is over; 0 before.
    pub rebound: f64,
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
    /// Work of cylinder and membranes on the ball, J; while the cylinder carries the ball, less its kinetic and potential energy.
    pub wall: f64,
    /// Work of the Maxwell force on the ball, J.
    pub electrical: f64,
    /// Energy lost in contacts that have ended, J.
    pub loss: f64,
    /// Energy lost in viscous films, J, up to the last event of each membrane.
    pub viscous: f64,
    /// Energy lost by friction, J.
    pub friction: f64,
    /// `z_M` and dz, m, up to where the work of friction is contained.
    pub slide: [f64; 2],
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
    /// Energy lost in viscous films.
    pub viscous: f64,
    /// Energy lost by friction between ball and cylinder.
    pub friction: f64,
    /// Work of gravity on the ball.
    pub gravity: f64,
    /// Energy in the spring that holds the cylinder.
    pub suspension: f64,
    /// Energy lost in the damper that holds the cylinder.
    pub damping: f64,
    /// Work of excitation and external force on the cylinder, or of the shaker that moves it.
    pub excitation: f64,
    /// Work of the Maxwell force on the ball: the integral of 1/2 U^2 dC.
    pub electrical: f64,
    /// Work of the cylinder, membranes and friction included, on the ball, with the cylinder's own velocity.
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
    mount: Mount,
    /// Where the ball was at the start, m.
    origin: f64,
}

impl Ledger {
    /// The sums so far of a harvester with these parameters and `C_2`, F.
    pub fn new(p: &Parameters, rest_capacitance: f64, totals: Totals, works: Works) -> Self {
        let Parameters { bias_voltage: bias, ball_mass, restitution, .. } = *p;
        Self {
            totals,
            works,
            bias,
            rest_capacitance,
            ball_mass,
            restitution,
            mount: Mount::new(p),
            origin: p.initial_ball_position(),
        }
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

    /// A contact ends at this relative `speed`, m/s.
    pub fn end_contact(&mut self, speed: f64) {
        let before = self.totals.last_speed;
        if before > impact::GRAZING_SPEED {
            self.totals.rebound = speed / before;
        }
    }

    /// Kinetic and potential energy of a ball at `position`, m, and `velocity`, m/s.
    pub fn mechanical(&self, position: f64, velocity: f64) -> f64 {
        self.kinetic(velocity) - self.gravity(position)
    }

    /// Work of gravity on the ball from the start to `position`, m.
    pub fn gravity(&self, position: f64) -> f64 {
        -self.ball_mass * self.mount.incline * (position - self.origin)
    }

    /// An impact at relative `speed`, m/s: an impulse at the mean of the velocities of the `wall`, m/s, before and after it. `sign`
    /// is that of dz.
    pub fn impact(&mut self, sign: f64, wall: [f64; 2], speed: f64) {
        let r = self.restitution;
        self.works.wall += self.mount.share * self.ball_mass * sign * (1.0 + r) * speed * mean(wall);
        self.works.loss += self.mount.share * (1.0 - r * r) * self.kinetic(speed);
    }

    /// A chattering sequence ends: a ball faster than the `wall` by `slip` takes on its velocity, m/s, before and after that.
    pub fn settle(&mut self, wall: [f64; 2], slip: f64) {
        self.totals.chatters += 1;
        self.works.wall -= self.mount.share * self.ball_mass * slip * mean(wall);
        self.works.loss += self.mount.share * self.kinetic(slip);
    }

    /// The cylinder begins to carry a ball at `position`, m, and `velocity`, m/s: its work is the gain of energy.
    pub fn carry(&mut self, position: f64, velocity: f64) {
        self.works.wall -= self.mechanical(position, velocity);
    }

    /// The cylinder lets go a ball at `position`, m, and `velocity`, m/s.
    pub fn release(&mut self, position: f64, velocity: f64) {
        self.works.wall += self.mechanical(position, velocity);
    }

    /// What friction, with this sign `slip` of dz', has done since it was last asked, where `z_M` and dz, m, are `slide`: loss and
    /// work on the ball, J.
    pub fn friction_since(&self, slip: f64, slide: [f64; 2]) -> [f64; 2] {
        let force = slip * self.ball_mass * self.mount.friction;
        let [wall, distance] = [0, 1].map(|k| slide[k] - self.works.slide[k]);
        [force * distance, force * wall]
    }

    /// Friction acts along a way of this length, m, in a contact, whose work on the ball is booked there.
    pub fn rub(&mut self, way: f64) {
        self.works.friction += self.ball_mass * self.mount.friction * way;
    }

    /// Adds what friction has done up to `slide`.
    pub fn slide(&mut self, slip: f64, slide: [f64; 2]) {
        let [loss, wall] = self.friction_since(slip, slide);
        self.works.friction += loss;
        self.works.wall += wall;
        self.works.slide = slide;
    }
}

fn mean([before, after]: [f64; 2]) -> f64 {
    0.5 * (before + after)
}
