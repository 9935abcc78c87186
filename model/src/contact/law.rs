//! The forces of a contact: membrane with hysteresis, Maxwell force, and what accelerates the wall.

use super::point::{Point, Recoil};
use crate::membrane::Membrane;
use crate::motion::cylinder::CylinderMotion;
use crate::motion::flight::Flight;
use crate::motion::mount::Mount;
use crate::motion::side::Side;
use crate::paper::excitation;
use crate::parameters::{ExcitationKind, Parameters};

/// A voltage that is linear in time.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Ramp {
    /// Time at which it has `value`, s.
    pub start: f64,
    /// V.
    pub value: f64,
    /// V/s.
    pub rate: f64,
}

impl Ramp {
    /// Voltage at `time`, s.
    pub(crate) fn at(&self, time: f64) -> f64 {
        self.value + self.rate * (time - self.start)
    }

    /// Whether it has this `value`, V, at `time`, s, and this `rate`, V/s.
    pub(crate) fn is(&self, time: f64, value: f64, rate: f64) -> bool {
        self.at(time) == value && self.rate == rate
    }

    /// Whether it stays at `value`, V.
    pub(crate) fn stays_at(&self, value: f64) -> bool {
        self.value == value && self.rate == 0.0
    }
}

/// On which branch of the membrane's force a contact is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Phase {
    /// Deeper than ever in this contact: the force is K x^n.
    Loading,
    /// Anywhere below the largest deflection of this contact: r^2 K x^n. With friction, on the way back only.
    Unloading,
    /// The same with friction, on the way in again.
    Reloading,
    /// The same, held by friction: neither the push nor the membrane overcomes it.
    Stuck,
    /// At rest at the largest deflection: the push is less than K x^n, so it goes no deeper, and more than r^2 K x^n, so it
    /// does not come back. The force balances the push, as friction does.
    Held,
}

impl Phase {
    /// Whether the ball does not move relative to the cylinder.
    pub(crate) fn is_at_rest(self) -> bool {
        matches!(self, Self::Held | Self::Stuck)
    }

    /// Sign of the rate that friction acts against, in a contact with friction.
    pub(super) fn direction(self) -> f64 {
        match self {
            Self::Loading | Self::Reloading => 1.0,
            Self::Unloading => -1.0,
            Self::Held | Self::Stuck => 0.0,
        }
    }
}

/// Everything that acts during a contact; deflection x is counted from the membrane's rest plane, inwards.
pub(crate) struct Law<'a> {
    pub(crate) parameters: &'a Parameters,
    pub(crate) membrane: &'a Membrane,
    /// The cylinder as it would move without the contact.
    pub(crate) cylinder: &'a CylinderMotion,
    pub(crate) mount: &'a Mount,
    /// The ball likewise, relative to the cylinder.
    pub(crate) flight: &'a Flight,
    pub(crate) side: Side,
    pub(crate) voltage: Ramp,
}

impl Law<'_> {
    /// Mass that answers to forces between ball and cylinder, kg: m, or with reaction m M / (m + M).
    pub(crate) fn mass(&self) -> f64 {
        self.parameters.ball_mass * (1.0 - self.parameters.recoil_share())
    }

    /// Force of the membrane, N, on this branch; odd in x, so that it is smooth where a step passes zero.
    pub(super) fn spring(&self, phase: Phase, x: f64) -> f64 {
        let force = self.loading(x);
        match phase {
            Phase::Loading => force,
            Phase::Unloading | Phase::Reloading | Phase::Stuck | Phase::Held => self.recovered() * force,
        }
    }

    /// f, N: Eq. (2), or that of another law of the membrane.
    pub(super) fn loading(&self, x: f64) -> f64 {
        self.membrane.force(x)
    }

    /// Force of the membrane, N, at a `point` of the contact, outwards: on the branch of this `phase`, or of the film if it is
    /// viscous.
    pub(super) fn pull_of(&self, phase: Phase, point: &Point) -> f64 {
        match &self.membrane.viscosity {
            Some(viscosity) => self.membrane.strained(viscosity, point.x, point.creep).force,
            None => self.spring(phase, point.x),
        }
    }

    /// r^2: the share of the work of loading that comes back. A viscous film loses what its dashpot takes, and nothing else.
    pub(super) fn recovered(&self) -> f64 {
        if self.membrane.viscosity.is_some() {
            return 1.0;
        }
        self.parameters.restitution * self.parameters.restitution
    }

    /// Work, J, of that force from 0 to `x`, m: Eq. (9).
    pub(crate) fn loading_work(&self, x: f64) -> f64 {
        self.membrane.work(x)
    }

    /// Energy, J, that the membrane gives back from a `point` of the contact, with what a viscous film has stored beside.
    pub(crate) fn elastic(&self, point: &Point) -> f64 {
        match &self.membrane.viscosity {
            Some(viscosity) => self.membrane.strained(viscosity, point.x, point.creep).stored,
            None => self.recovered() * self.loading_work(point.x),
        }
    }

    /// Energy, J, lost in a contact whose largest deflection is `largest`, m.
    pub(crate) fn loss(&self, largest: f64) -> f64 {
        (1.0 - self.recovered()) * self.loading_work(largest)
    }

    /// Maxwell force, N, that pulls the ball inwards at `x`, m, `elapsed` after `time`, s: 1/2 U^2 dC/dx.
    pub(super) fn maxwell(&self, time: f64, elapsed: f64, x: f64) -> f64 {
        if !self.parameters.electrostatic_feedback {
            return 0.0;
        }
        let voltage = self.voltage.at(time) + self.voltage.rate * elapsed;
        0.5 * voltage * voltage * self.membrane.capacitance_slope(x)
    }

    /// Largest deflection, m, with feedback: a Maxwell force may exceed that of a membrane whose exponent is small at any
    /// depth.
    pub(crate) fn deepest(&self) -> f64 {
        /// In units of `R_2`: no membrane reaches that.
        const BOUND: f64 = 100.0;
        BOUND * self.membrane.radius()
    }

    /// Whether `x`, m, is deeper than is resolved.
    pub(crate) fn is_too_deep(&self, x: f64) -> bool {
        self.parameters.electrostatic_feedback && x > self.deepest()
    }

    /// Size of the terms of the push within `length`, s, from `time`, s, on, whose rounding it carries, m/s^2.
    pub(super) fn push_size(&self, time: f64, length: f64) -> f64 {
        let drive = &self.cylinder.drive;
        let external = drive.external + drive.external_rate * (time - self.cylinder.start);
        let given = self.cylinder.load.give * (external.abs() + length * drive.external_rate.abs());
        let recorded = drive.recorded.at(time).abs() + length * drive.recorded.rate.abs();
        // Terms that cancel each other leave their rounding.
        let free = drive.amplitude + given + self.mount.incline.abs() + recorded;
        free + self.cylinder.size_of_mount(time, length)
    }

    /// Force on the ball, N, outwards.
    pub(crate) fn total(&self, phase: Phase, point: &Point) -> f64 {
        match phase {
            Phase::Held | Phase::Stuck => self.mass() * self.push_at(point),
            _ => self.pull_of(phase, point) - self.maxwell(point.time, 0.0, point.x) + self.friction(phase),
        }
    }

    /// Friction on the ball, N, outwards.
    pub(super) fn friction(&self, phase: Phase) -> f64 {
        phase.direction() * self.parameters.ball_mass * self.mount.friction
    }

    /// What friction at most takes from x'', m/s^2.
    pub(super) fn deceleration(&self) -> f64 {
        self.mount.deceleration()
    }

    /// Relative acceleration, m/s^2, inwards, that a free ball would have `elapsed` after `time`, s. The two are kept
    /// apart: their sum has too few digits for short steps late in a run.
    pub(super) fn push(&self, time: f64, elapsed: f64) -> f64 {
        let drive = &self.cylinder.drive;
        if self.cylinder.is_suspended() {
            let since = (time - self.cylinder.start) + elapsed;
            return self.side.sign() * (self.cylinder.suspended_acceleration(since) + self.mount.incline);
        }
        let cosine = (drive.angle(time) + drive.omega() * elapsed).cos();
        let external =
            self.cylinder.load.give * (drive.external + drive.external_rate * (time - self.cylinder.start + elapsed));
        let given = external + (drive.recorded.at(time) + drive.recorded.rate * elapsed);
        self.side.sign() * (excitation::acceleration(drive.amplitude, cosine, given) + self.mount.incline)
    }

    /// The same at a point of the contact, what the mount does against the recoil included.
    pub(super) fn push_at(&self, point: &Point) -> f64 {
        self.push(point.time, 0.0) + if self.recoils() { self.yielding(&point.recoil) } else { 0.0 }
    }

    /// Whether the recoil is a motion of its own: the mount acts against it.
    pub(super) fn recoils(&self) -> bool {
        self.parameters.recoil_share() > 0.0 && self.cylinder.is_suspended()
    }

    /// What the mount adds to x'', m/s^2, because of the recoil.
    pub(super) fn yielding(&self, recoil: &Recoil) -> f64 {
        self.side.sign() * self.cylinder.load.suspension.acceleration(recoil.position, recoil.velocity)
    }

    /// Size of its terms, whose rounding it carries, m/s^2.
    pub(super) fn size_of_yielding(&self, recoil: &Recoil) -> f64 {
        self.cylinder.load.suspension.acceleration(recoil.position.abs(), recoil.velocity.abs()).abs()
    }

    /// Acceleration of the recoil, m/s^2, under this `force` of the contact on the ball, N, outwards.
    pub(super) fn recoil_acceleration(&self, recoil: &Recoil, force: f64) -> f64 {
        self.side.sign() * (self.yielding(recoil) - force / self.parameters.cylinder_mass)
    }

    /// Power, W, that the damper takes because of a recoil at this velocity, m/s, which that of the wall contains.
    pub(super) fn damping_power(&self, recoil: f64, wall: f64) -> f64 {
        self.parameters.suspension_damping * recoil * (2.0 * wall - recoil)
    }

    /// What the contact adds to the cylinder's motion.
    pub(crate) fn recoil(&self, point: &Point) -> Recoil {
        Recoil::new(self.parameters.recoil_share(), self.flight, self.side, point)
    }
}

impl Parameters {
    /// Share of the relative motion that the cylinder makes in a contact: m / (m + M) with reaction, else 0.
    pub(crate) fn recoil_share(&self) -> f64 {
        if self.reaction && self.excitation_kind == ExcitationKind::Force {
            self.ball_mass / (self.ball_mass + self.cylinder_mass)
        } else {
            0.0
        }
    }
}

impl Recoil {
    /// What a contact adds to the cylinder's motion.
    ///
    /// Both forces between the bodies are opposite and equal. They change the relative motion by the difference between x
    /// and the deflection that free bodies would have, of which a free cylinder makes its `share`. A mount acts against the
    /// recoil: that of a suspended cylinder is integrated.
    pub(crate) fn new(share: f64, flight: &Flight, side: Side, &Point { time, x, v, recoil, .. }: &Point) -> Self {
        if share == 0.0 || flight.piece().is_some() {
            return recoil;
        }
        let [dz, rate] = flight.at(time - flight.start);
        let (position, velocity) = (side.sign() * (flight.half_travel() + x) - dz, side.sign() * v - rate);
        Self { position: share * position, velocity: share * velocity }
    }
}
