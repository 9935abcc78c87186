//! Partial derivatives of calculated parameters and initial outputs with respect to the parameters, in closed form.
//!
//! They hold at the start, where no membrane is pressed in yet. After initialisation no output depends on an input of
//! the same communication point (an impact and a step act through the state), which the variable table says. So they are
//! finite whatever the motion does, grazing included; at an impact they are those of the state after it.

use fmi2_export::Variable;
use videg_model::{Harvester as Model, OutsideGap, Parameters};

use crate::slave::Harvester;

impl Harvester {
    /// d `unknown` / d `known` at the start.
    pub(crate) fn partial(&self, unknown: &Variable<Self>, known: &Variable<Self>) -> f64 {
        let (p, known) = (&self.parameters, known.name());
        match unknown.name() {
            "membrane.radius" => match known {
                "membrane.prestretch" => p.initial_radius,
                "membrane.initialRadius" => p.prestretch,
                _ => 0.0,
            },
            "membrane.thickness" => match known {
                "membrane.initialThickness" => p.membrane_thickness() / p.initial_thickness,
                "membrane.prestretch" => -2.0 * p.membrane_thickness() / p.prestretch,
                _ => 0.0,
            },
            "membrane.restCapacitance" | "left.capacitance" | "right.capacitance" => {
                self.read(|model| rest_capacitance(model, known))
            }
            "ball.travel" => travel(known),
            "cylinder.position" => f64::from(known == "initial.cylinderPosition"),
            "cylinder.velocity" => f64::from(known == "initial.cylinderVelocity"),
            "ball.position" => self.read(|model| ball_position(model, p, known)),
            "ball.velocity" => self.read(|model| ball_velocity(model, p, known)),
            "relativeDisplacement" => {
                let cylinder = f64::from(known == "initial.cylinderPosition");
                cylinder - self.read(|model| ball_position(model, p, known))
            }
            // Deflections are 0 and area ratios 1 at the start, whatever the parameters.
            _ => 0.0,
        }
    }
}

/// Of `C_2` = `eps_0` `eps_r` pi lambda^4 `R_1`^2 / `h_1`, Eq. (1): each parameter enters with a power.
fn rest_capacitance(model: &Model, known: &str) -> f64 {
    let (p, capacitance) = (model.parameters(), model.membrane().rest_capacitance());
    match known {
        "membrane.relativePermittivity" => capacitance / p.relative_permittivity,
        "membrane.prestretch" => 4.0 * capacitance / p.prestretch,
        "membrane.initialRadius" => 2.0 * capacitance / p.initial_radius,
        "membrane.initialThickness" => -capacitance / p.initial_thickness,
        _ => 0.0,
    }
}

/// Of s = d + 2 w - 2 `r_b`.
fn travel(known: &str) -> f64 {
    match known {
        "cylinder.length" => 1.0,
        "frame.width" => 2.0,
        "ball.radius" => -2.0,
        _ => 0.0,
    }
}

/// Of `z_m` at the start: as set, or on the membrane at `z_M` - dz with dz = +s/2 or -s/2.
fn ball_position(model: &Model, p: &Parameters, known: &str) -> f64 {
    let dz = p.cylinder_position - p.ball_position;
    let put_there = p.outside_gap == OutsideGap::Project && dz.abs() > p.travel() / 2.0;
    if !put_there && !touches(model) {
        return f64::from(known == "initial.ballPosition");
    }
    f64::from(known == "initial.cylinderPosition") - model.relative_displacement().signum() * travel(known) / 2.0
}

/// Of `z_m'` at the start: as set, or after an impact at the start by Eq. (11), or that of the wall.
fn ball_velocity(model: &Model, p: &Parameters, known: &str) -> f64 {
    if model.resting().is_some() {
        return f64::from(known == "initial.cylinderVelocity");
    }
    if !touches(model) {
        return f64::from(known == "initial.ballVelocity");
    }
    match known {
        "initial.cylinderVelocity" => 1.0 + p.restitution,
        "initial.ballVelocity" => -p.restitution,
        "membrane.restitution" => p.cylinder_velocity - p.ball_velocity,
        _ => 0.0,
    }
}

/// Whether the start is a contact.
fn touches(model: &Model) -> bool {
    model.totals().impacts > 0 || model.resting().is_some()
}
