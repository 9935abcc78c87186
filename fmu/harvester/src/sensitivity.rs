//! Partial derivatives, in closed form and finite whatever the motion does; [`videg_model::Sensitivities`] say how.
//!
//! - During initialisation: of initial values with respect to parameters and inputs.
//! - In model exchange afterwards: with respect to states and input at the present point, Eq. (7) and a free or carried
//!   ball.
//! - In co-simulation afterwards: with respect to `externalForce`, of the outputs at the end of the last step when the force
//!   of that step is shifted by a constant; before the first step, of the initial values. The change is part of the
//!   state and comes back with it. With respect to a continuous state, which no importer can set there, at the
//!   communication point, as in model exchange.
//!
//! Under the compliant law there are none.
//!
//! The voltages have no influence but on the electric fields: an impulsive impact takes no time in which they could do
//! work on the ball.

use videg_model::{ContactLaw, Direction, Harvester as Model, Sensitivities, Side};

use crate::harvester::Harvester;
use crate::variables::STATES;

impl Harvester {
    /// d `unknown` / d `known`; NaN under the compliant law, of which none are known.
    pub(crate) fn partial(&self, unknown: &str, known: &str) -> f64 {
        if self.parameters.contact_law == ContactLaw::Compliant {
            return f64::NAN; // none; the exporter makes an error of it
        }
        match (unknown, known) {
            ("left.electricField", "left.voltage") => return self.read(|model| field_per_volt(model, Side::Left)),
            ("right.electricField", "right.voltage") => return self.read(|model| field_per_volt(model, Side::Right)),
            _ => {}
        }
        let (is_force, is_state) = (known == "externalForce", STATES.contains(&known));
        if is_state || self.placed {
            return self.partial_at_point(unknown, known);
        }
        if is_force {
            let is_foreseen = ["impact.nextTime", "pulse.nextKnot"].contains(&unknown);
            return self.read(|model| {
                let pending = if is_foreseen { self.pending(model) } else { None };
                self.of_output(&pending.as_ref().unwrap_or(model).sensitivities(), unknown)
            });
        }
        Direction::of_parameter(known).map_or(0.0, |direction| self.initial_partial(unknown, &direction))
    }

    /// Of calculated parameters and initial values along `direction`.
    fn initial_partial(&self, unknown: &str, direction: &Direction) -> f64 {
        let (p, d) = (&self.parameters, &direction.parameters);
        match unknown {
            "membrane.radius" => p.prestretch * d.initial_radius + d.prestretch * p.initial_radius,
            "membrane.thickness" => {
                p.membrane_thickness() * (d.initial_thickness / p.initial_thickness - 2.0 * d.prestretch / p.prestretch)
            }
            "ball.travel" => d.travel(),
            _ => {
                let moved = Model::along(p, self.start_time, self.external_force, direction);
                moved.map_or(f64::NAN, |model| self.of_output(&model.sensitivities(), unknown))
            }
        }
    }

    /// With respect to states and force at the present point, between events.
    fn partial_at_point(&self, unknown: &str, known: &str) -> f64 {
        let resting = self.model().is_some_and(|model| model.resting().is_some());
        let is = |name: &str| f64::from(known == name);
        let by_force = is("externalForce") / self.parameters.cylinder_mass; // Eq. (7)
        // z_M - z_m and its rate; a ball at rest moves with the cylinder.
        let displacement =
            if resting { [0.0; 2] } else { [is(STATES[0]) - is(STATES[2]), is(STATES[1]) - is(STATES[3])] };
        // m z_m' and M z_M': changes of the kinetic energies per change of the velocities.
        let ball = self.read(|model| self.parameters.ball_mass * model.ball_velocity());
        let cylinder = self.read(|model| self.parameters.cylinder_mass * model.cylinder_velocity());
        let next_time = |which: usize| {
            self.read(|model| {
                let pending = self.pending(model);
                let by = pending.as_ref().unwrap_or(model).next_times_by_displacement()[which];
                by[0] * displacement[0] + by[1] * displacement[1]
            })
        };
        match unknown {
            "cylinder.position" => is(STATES[0]),
            "cylinder.velocity" | "der(cylinder.position)" => is(STATES[1]),
            "ball.position" => is(if resting { STATES[0] } else { STATES[2] }),
            "ball.velocity" | "der(ball.position)" => is(if resting { STATES[1] } else { STATES[3] }),
            "relativeDisplacement" => displacement[0],
            "der(cylinder.velocity)" => by_force,
            "der(ball.velocity)" if resting => by_force,
            "impact.nextTime" => next_time(0),
            "pulse.nextKnot" => next_time(1),
            "energy.kinetic" => ball * is(if resting { STATES[1] } else { STATES[3] }),
            "energy.wall" if resting => ball * is(STATES[1]),
            "energy.cylinderKinetic" | "energy.excitation" => cylinder * is(STATES[1]),
            // Capacitances follow the pulses of impacts that have been, and so do the sums over them.
            _ => 0.0,
        }
    }

    /// The change of one output at the present voltages.
    fn of_output(&self, changes: &Sensitivities, name: &str) -> f64 {
        let energies = &changes.energies;
        match name {
            "cylinder.position" => changes.cylinder[0],
            "cylinder.velocity" | "der(cylinder.position)" => changes.cylinder[1],
            "der(cylinder.velocity)" => changes.cylinder[2],
            "ball.position" => changes.ball[0],
            "ball.velocity" | "der(ball.position)" => changes.ball[1],
            "der(ball.velocity)" => changes.ball[2],
            "relativeDisplacement" => changes.relative_displacement,
            "left.deflection" => changes.deflection[0],
            "right.deflection" => changes.deflection[1],
            "left.areaRatio" => changes.area_ratio[0],
            "right.areaRatio" => changes.area_ratio[1],
            "left.capacitance" | "membrane.restCapacitance" => changes.capacitance[0],
            "right.capacitance" => changes.capacitance[1],
            "impact.lastVelocity" => changes.last_speed,
            "impact.nextTime" => changes.next_impact,
            "pulse.nextKnot" => changes.next_knot,
            "gain.voltage" => changes.voltage_gain,
            "gain.energyEq13" => changes.energy,
            "left.electricField" => changes.field_per_volt[0] * self.voltages[0],
            "right.electricField" => changes.field_per_volt[1] * self.voltages[1],
            "left.stretch" => changes.stretch[0],
            "right.stretch" => changes.stretch[1],
            "energy.kinetic" => energies.ball,
            "energy.cylinderKinetic" => energies.cylinder,
            "energy.elastic" => energies.elastic,
            "energy.impactLoss" => energies.impact_loss,
            "energy.excitation" => energies.excitation,
            "energy.electrical" => energies.electrical,
            "energy.wall" => energies.wall,
            // Impacts of the impulsive law take no time: none of contact.time.
            _ => 0.0,
        }
    }
}

fn field_per_volt(model: &Model, side: Side) -> f64 {
    model.membrane().field(model.deflection(side).value, 1.0)
}
