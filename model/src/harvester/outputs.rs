//! What a harvester shows at its present time.

use super::Harvester;
use crate::accounting::ledger::{Energies, Totals};
use crate::contact::Recoil;
use crate::membrane::Membrane;
use crate::motion::Ball;
use crate::motion::pulse::{Deflection, Pulse};
use crate::motion::side::Side;
use crate::parameters::{ContactLaw, ExcitationKind, Parameters};
use crate::sensitivity::Sensitivities;

impl Harvester {
    /// The parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The membrane, the same at both ends.
    pub fn membrane(&self) -> &Membrane {
        &self.membrane
    }

    /// Present time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// `z_M`, m.
    pub fn cylinder_position(&self) -> f64 {
        self.motion.cylinder_position_at(self.time)
    }

    /// `z_M'`, m/s.
    pub fn cylinder_velocity(&self) -> f64 {
        self.motion.cylinder_velocity_at(self.time)
    }

    /// `z_M''`, m/s^2, Eq. (7).
    pub fn cylinder_acceleration(&self) -> f64 {
        self.motion.cylinder.at(self.time).acceleration + self.recoil_acceleration()
    }

    /// What the contact adds to `z_M''`, m/s^2.
    fn recoil_acceleration(&self) -> f64 {
        let p = &self.parameters;
        if p.reaction_ratio() == 0.0 {
            return 0.0;
        }
        let mount = self.motion.cylinder.load.suspension;
        let Recoil { position, velocity } =
            if mount.is_none() { Recoil::default() } else { self.motion.recoil(self.time) };
        mount.acceleration(position, velocity) - self.motion.contact_force(self.forces(), self.time) / p.cylinder_mass
    }

    /// `z_m`, m.
    pub fn ball_position(&self) -> f64 {
        self.motion.ball_position_at(self.time)
    }

    /// `z_m'`, m/s.
    pub fn ball_velocity(&self) -> f64 {
        self.motion.ball_velocity_at(self.time)
    }

    /// `z_m''`, m/s^2: that of the cylinder while it carries the ball, else that of gravity, friction and the forces of a
    /// contact.
    pub fn ball_acceleration(&self) -> f64 {
        if self.resting().is_some() || self.is_stuck() {
            return self.cylinder_acceleration();
        }
        let contact = self.motion.contact_force(self.forces(), self.time) / self.parameters.ball_mass;
        contact + self.motion.ball_acceleration()
    }

    /// Force of the mount on the cylinder, N: of spring and damper, or of the shaker that prescribes the motion. That bears the
    /// external force and, with reaction, the ball, but for impacts that take no time.
    pub fn mount_force(&self) -> f64 {
        let p = &self.parameters;
        if p.excitation_kind == ExcitationKind::Force {
            return -p.suspension_stiffness * self.cylinder_position()
                - p.suspension_damping * self.cylinder_velocity();
        }
        let external = p.cylinder_mass * self.motion.drive_at(self.time).external;
        // Gravity aside, whatever accelerates the ball comes from the cylinder.
        let ball = if p.reaction { p.ball_mass * (self.ball_acceleration() + p.incline()) } else { 0.0 };
        p.cylinder_mass * self.cylinder_acceleration() - external + ball
    }

    /// Power that the damper takes, W.
    pub fn damping_power(&self) -> f64 {
        let velocity = self.cylinder_velocity();
        self.parameters.suspension_damping * velocity * velocity
    }

    /// Change of the force of the mount, in closed form, when that of `z_M''` is `acceleration`, m/s^2: a shaker bears the external force.
    fn mount_force_change(&self, acceleration: f64) -> f64 {
        let p = &self.parameters;
        if p.excitation_kind == ExcitationKind::Force {
            return 0.0;
        }
        let heavier = self.tangent.of(|change| change.of.cylinder_mass);
        p.cylinder_mass * acceleration + heavier * self.cylinder_acceleration() - self.tangent.force
    }

    /// Whether friction holds the ball on the cylinder, between the membranes.
    pub fn is_stuck(&self) -> bool {
        self.motion.ball == Ball::Stuck
    }

    /// dz = `z_M` - `z_m`, m.
    pub fn relative_displacement(&self) -> f64 {
        let [dz, _] = self.motion.relative_at(self.time);
        dz
    }

    /// Deflection of the membrane at `side` and its rate.
    pub fn deflection(&self, side: Side) -> Deflection {
        match self.parameters.contact_law {
            ContactLaw::Impulsive => self.pulses.at(side, self.time),
            ContactLaw::Compliant => self.motion.contact_deflection(&self.membrane, side, self.time),
        }
    }

    /// Pulses of the membrane at `side` that have not ended, the largest peak first; none under the compliant law. Where they overlap, the larger
    /// deflection wins.
    pub fn pulses(&self, side: Side) -> impl Iterator<Item = &Pulse> {
        self.pulses.going_on(side, self.time)
    }

    /// Capacitance of the membrane at `side`, F, Eq. (1).
    pub fn capacitance(&self, side: Side) -> f64 {
        self.membrane.capacitance(self.deflection(side).value)
    }

    /// Time derivative of the capacitance at `side`, F/s.
    pub fn capacitance_rate(&self, side: Side) -> f64 {
        let deflection = self.deflection(side);
        self.membrane.capacitance_slope(deflection.value) * deflection.rate
    }

    /// The membrane on which the ball rests: it does not move relative to it. Under the compliant law that is a ball which
    /// the wall's push holds at a deflection; one that swings about its equilibrium does not rest.
    pub fn resting(&self) -> Option<Side> {
        self.motion.resting()
    }

    /// ln(`L_v` / lambda) of the membrane at `side`: how far the dashpot of a viscous film has given way.
    pub fn creep(&self, side: Side) -> f64 {
        self.membrane.viscosity.as_ref().map_or(0.0, |viscosity| self.motion.creep_at(viscosity, side, self.time))
    }

    /// Rebound speed over impact speed of the last impact that is over, 0 before the first: r under the impulsive law. Contacts
    /// slower than [`GRAZING_SPEED`](crate::GRAZING_SPEED) do not count.
    pub fn effective_restitution(&self) -> f64 {
        match self.parameters.contact_law {
            ContactLaw::Impulsive if self.totals().impacts > 0 => self.parameters.restitution,
            _ => self.totals().rebound,
        }
    }

    /// Sums over all impacts so far.
    pub fn totals(&self) -> &Totals {
        &self.ledger.totals
    }

    /// Mechanical energies and works since the start.
    ///
    /// Wall, electrical and loss are integrals and sums on their own, from which the balance of the ball can be audited. The
    /// work of the excitation follows from the cylinder's kinetic energy.
    pub fn energies(&self) -> Energies {
        let (p, mut works) = (&self.parameters, self.ledger.works);
        let (ball, mut elastic) = (self.ledger.kinetic(self.ball_velocity()), 0.0);
        let mut damping = p.cylinder_mass * self.motion.cylinder.at(self.time).damped;
        if let Some((work, stored, lost)) = self.motion.contact_energies(self.forces(), self.time) {
            works.wall += work.wall;
            works.electrical += work.electrical;
            damping += work.damping;
            works.friction +=
                p.ball_mass * self.motion.mount.friction * self.motion.ball.contact().map_or(0.0, |c| c.way(self.time));
            elastic = stored;
            works.loss += lost;
            works.viscous += work.viscous;
        } else if self.motion.ball.is_carried() {
            works.wall += self.ledger.mechanical(self.ball_position(), self.ball_velocity());
        }
        for side in Side::BOTH {
            let [stored, lost] = self.motion.relaxation_energies(&self.membrane, side, self.time);
            elastic += stored;
            works.viscous += lost;
        }
        if self.motion.slip != 0.0 {
            let [loss, wall] = self.ledger.friction_since(self.motion.slip, self.motion.slide_at(self.time));
            works.friction += loss;
            works.wall += wall;
        }
        let of_cylinder = |velocity: f64| 0.5 * p.cylinder_mass * velocity * velocity;
        let cylinder = of_cylinder(self.cylinder_velocity());
        let spring = |position: f64| 0.5 * p.suspension_stiffness * position * position;
        let suspension = spring(self.cylinder_position());
        let gained = cylinder - of_cylinder(p.cylinder_velocity);
        let held = suspension - spring(p.cylinder_position) + damping;
        Energies {
            ball,
            cylinder,
            elastic,
            impact_loss: works.loss,
            viscous: works.viscous,
            friction: works.friction,
            gravity: self.ledger.gravity(self.ball_position()),
            suspension,
            damping,
            excitation: (gained + held) + if p.reaction { works.wall } else { 0.0 },
            electrical: works.electrical,
            wall: works.wall,
        }
    }

    /// Time in contact since the start, s, under the compliant law; impacts of the impulsive law take none.
    pub fn contact_time(&self) -> f64 {
        let present = self.motion.ball.contact().map_or(0.0, |contact| self.time - contact.state.since);
        self.ledger.works.contact_time + present
    }

    /// First-order changes of everything, per newton of the external force: that set by the last
    /// [`Harvester::set_external_force`], moved by a constant and held since then. Of a harvester made by
    /// [`Harvester::along`], before that is called: per unit of its direction. Of any other harvester they are zero before.
    ///
    /// They are those of the side that the state is on: after an event at the present time. Events stay in their order, a
    /// ball at rest stays there. Grazing impacts ([`GRAZING_SPEED`](crate::GRAZING_SPEED)) count as none, so that all values
    /// are finite. The membrane is flat at the instant of an impact, and its changes are zero then.
    ///
    /// With friction, a suspension, reaction or the compliant law they are taken by differences of harvesters that begin where the
    /// force was set, to some ten digits; a harvester restored from a snapshot has them with its [`Harvester::origin`] only.
    pub fn sensitivities(&self) -> Sensitivities {
        if let Some(origin) = &self.origin {
            return self.differences(origin);
        }
        let (changes, time) = (self.tangential(), self.time);
        let ([position, velocity], [ball_position, ball_velocity]) =
            (changes.cylinder_change(time), changes.ball_change(time));
        let shape = self.tangent.parameters.as_ref().map(|change| change.shape).unwrap_or_default();
        let deflection = Side::BOTH.map(|side| self.pulses.change_at(side, time, shape));
        let of_membranes = Side::BOTH.map(|side| {
            let value = self.deflection(side).value;
            self.membrane.shown_changes(value, deflection[side.index()], self.tangent.membrane())
        });
        let of_membrane = |k: usize| of_membranes.map(|of_membrane| of_membrane[k]);
        let acceleration = changes.acceleration_change(time);
        let after_due = self.is_due().then(|| self.after_due()).flatten();
        let predicting = after_due.as_ref().unwrap_or(self);
        let next_impact = predicting.next_impact_change();
        let sums = &self.tangent.changes;
        Sensitivities {
            cylinder: [position, velocity, acceleration],
            ball: [ball_position, ball_velocity, changes.ball_acceleration_change(time)],
            relative_displacement: changes.motion_change(time)[0],
            deflection,
            area_ratio: of_membrane(0),
            stretch: of_membrane(1),
            field_per_volt: of_membrane(2),
            capacitance: of_membrane(3),
            last_speed: sums.last_speed,
            rebound: self.tangent.of(|change| change.of.restitution) * f64::from(u8::from(self.totals().impacts > 0)),
            voltage_gain: sums.voltage_gain,
            energy: sums.energy,
            energies: changes.energies_change(time),
            contact_time: 0.0,
            mount_force: self.mount_force_change(acceleration),
            damping_power: 0.0,
            next_impact,
            next_knot: predicting.next_knot_change(next_impact),
        }
    }
}
