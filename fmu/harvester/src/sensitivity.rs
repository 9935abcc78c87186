//! Partial derivatives, finite whatever the motion does; [`videg_model::Sensitivities`] say how. Each
//! row of the table reads its own from a [`Change`].
//!
//! - During initialisation: of initial values with respect to parameters and inputs.
//! - In model exchange afterwards: with respect to states and input at the present point, Eq. (7) and a free or carried
//!   ball.
//! - In co-simulation afterwards: with respect to `externalForce`, of the outputs at the end of the last step when the force
//!   of that step is shifted by a constant; before the first step, of the initial values. The change is part of the
//!   state and comes back with it. With respect to a continuous state, which no importer can set there, at the
//!   communication point, as in model exchange.
//!
//! With friction, a suspension, reaction, the compliant law or another law of the membrane than Eq. (2), and with respect to
//! parameters of these, scale and offset of a recording and n of Eq. (2), they are taken by differences, to some nine digits. There
//! are none with respect to a state during a contact that lasts.
//!
//! The voltages have no influence but on the electric fields: an impulsive impact takes no time in which they could do
//! work on the ball. Under the compliant law with electrostatic feedback what they do to the motion is left out.

use fmu_export::Variable;
use videg_model::{Direction, Energies, ExcitationKind, Harvester as Model, Parameters, Sensitivities, Side};

use crate::harvester::Harvester;
use crate::variables::{DAMPING, FORCE, STATES, VOLTAGES};

/// What changes by one unit.
enum Known {
    /// A state or the force at the present point, between events; changes of `z_M` - `z_m`, m, and its rate, m/s.
    Point([f64; 2]),
    /// The same, by differences.
    Displaced,
    /// The force of the last step.
    Force,
    Voltage(Side),
    Parameter(Box<Direction>),
}

/// How all that the slave shows changes, per unit of one variable.
pub(crate) struct Change<'a> {
    slave: &'a Harvester,
    known: Known,
    /// Of what the model shows, but for the predicted times at the present point, which take a search; none if the
    /// parameters contradict each other.
    model: Option<Sensitivities>,
}

impl Harvester {
    /// What `read` finds in the change by one unit of `known`; NaN where no change is known.
    pub(crate) fn partial(&self, known: &Variable<Self>, read: impl FnOnce(&Change) -> f64) -> f64 {
        read(&self.change(known.name()))
    }

    /// The same of something that follows from the parameters alone: `read` gets these and their change.
    pub(crate) fn partial_by_parameters(
        &self,
        known: &Variable<Self>,
        read: fn(&Parameters, &Parameters) -> f64,
    ) -> f64 {
        self.partial(known, |change| match &change.known {
            Known::Parameter(direction) => read(&self.parameters, &direction.parameters),
            _ => 0.0,
        })
    }

    fn change(&self, name: &str) -> Change<'_> {
        if let Some(side) = [Side::Left, Side::Right].into_iter().find(|side| VOLTAGES[side.index()] == name) {
            return Change { slave: self, known: Known::Voltage(side), model: Some(Sensitivities::default()) };
        }
        match Direction::of_parameter(name) {
            Some(direction) if !self.placed => {
                let (start, force) = (self.start_time, self.external_force);
                let along = |setup| Model::along(setup, start, force, &direction).ok();
                let model = self.setup().ok().and_then(along).map(|model| model.sensitivities());
                Change { slave: self, known: Known::Parameter(Box::new(direction)), model }
            }
            _ if name == FORCE && !self.placed => {
                Change { slave: self, known: Known::Force, model: self.model().map(Model::sensitivities) }
            }
            _ => self.change_at_point(name),
        }
    }

    /// With respect to the state or force `name` at the present point. Capacitances follow the pulses of impacts that have
    /// been, and so do the sums over them.
    fn change_at_point(&self, name: &str) -> Change<'_> {
        if name == DAMPING {
            let energies = Energies { damping: 1.0, excitation: 1.0, ..Energies::default() };
            let model = Some(Sensitivities { energies, ..Sensitivities::default() });
            return Change { slave: self, known: Known::Displaced, model };
        }
        let state = STATES.iter().position(|state| *state == name);
        if let Some(model) = self.model().filter(|model| !model.has_closed_changes()) {
            return Change { slave: self, known: Known::Displaced, model: model.differences_at_point(state) };
        }
        let rests = self.model().is_some_and(|model| model.resting().is_some());
        let [cylinder, cylinder_rate, ball, ball_rate] = STATES.map(|state| f64::from(state == name));
        let yields = if self.parameters.excitation_kind == ExcitationKind::Force { 1.0 } else { 0.0 };
        let by_force = f64::from(name == FORCE) * yields / self.parameters.cylinder_mass; // Eq. (7)
        // A ball at rest moves with the cylinder.
        let [ball, ball_rate] = if rests { [cylinder, cylinder_rate] } else { [ball, ball_rate] };
        let displacement = [cylinder - ball, cylinder_rate - ball_rate];
        // m z_m' and M z_M': changes of the kinetic energies per change of the velocities.
        let of_ball = self.read(|model| self.parameters.ball_mass * model.ball_velocity()) * ball_rate;
        let of_cylinder = self.read(|model| self.parameters.cylinder_mass * model.cylinder_velocity()) * cylinder_rate;
        let weight = self.parameters.ball_mass * self.parameters.incline();
        let model = Sensitivities {
            cylinder: [cylinder, cylinder_rate, by_force],
            ball: [ball, ball_rate, if rests { by_force } else { 0.0 }],
            relative_displacement: displacement[0],
            energies: Energies {
                ball: of_ball,
                wall: if rests { of_ball + weight * ball } else { 0.0 },
                cylinder: of_cylinder,
                excitation: of_cylinder,
                gravity: -weight * ball,
                ..Energies::default()
            },
            // A shaker bears the force.
            mount_force: f64::from(name == FORCE) * (yields - 1.0),
            ..Sensitivities::default()
        };
        Change { slave: self, known: Known::Point(displacement), model: Some(model) }
    }
}

impl Change<'_> {
    /// Of something that the model shows; NaN if there is no model.
    pub(crate) fn shown(&self, read: impl FnOnce(&Sensitivities) -> f64) -> f64 {
        self.model.as_ref().map_or(f64::NAN, read)
    }

    /// Of the next impact (0) or knot (1), which `shown` reads, under the inputs as they are set.
    pub(crate) fn next(&self, which: usize, shown: fn(&Sensitivities) -> f64) -> f64 {
        let predicted = |read: &dyn Fn(&Model) -> f64| {
            self.slave.read(|model| read(self.slave.pending(model).as_ref().unwrap_or(model)))
        };
        match self.known {
            Known::Point([displacement, rate]) => predicted(&|model| {
                let by = model.next_times_by_displacement()[which];
                by[0] * displacement + by[1] * rate
            }),
            Known::Force => predicted(&|model| shown(&model.sensitivities())),
            Known::Voltage(_) | Known::Parameter(_) | Known::Displaced => self.shown(shown),
        }
    }

    /// Of the electric field in a membrane.
    pub(crate) fn field(&self, side: Side) -> f64 {
        let slave = self.slave;
        match self.known {
            Known::Voltage(changed) if changed == side => {
                slave.read(|model| model.membrane().field(model.deflection(side).value, 1.0))
            }
            Known::Voltage(_) | Known::Point(_) => 0.0,
            Known::Force | Known::Parameter(_) | Known::Displaced => {
                self.shown(|changes| changes.field_per_volt[side.index()] * slave.voltages[side.index()])
            }
        }
    }
}
