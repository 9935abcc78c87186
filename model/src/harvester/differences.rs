//! Changes with parameters that are at their lower bound, by differences: at 0, friction and suspension have no side below.

use core::f64::consts::TAU;

use super::Harvester;
use crate::accounting::ledger::Energies;
use crate::error::ModelError;
use crate::motion::side::Side;
use crate::parameters::Parameters;
use crate::recording::Setup;
use crate::sensitivity::Sensitivities;

/// Step of the differences, in units of what friction and suspension typically are. Truncation and rounding are both below 1e-9.
const STEP: f64 = 1e-5;

/// Parameters whose changes are worked out here.
const ONE_SIDED: [&str; 3] = ["ball.friction", "cylinder.suspensionStiffness", "cylinder.suspensionDamping"];

impl Harvester {
    /// Changes of the harvester at `start`, s, under the external `force`, N, per unit of a parameter that is 0 and cannot be less, upwards;
    /// none if there is no such parameter.
    ///
    /// # Errors
    /// As [`Harvester::along`].
    pub fn change_upwards<'a>(
        setup: impl Into<Setup<'a>>,
        start: f64,
        force: f64,
        name: &str,
    ) -> Result<Option<Sensitivities>, ModelError> {
        let Setup { parameters: p, recording } = setup.into();
        let is_known = ONE_SIDED.contains(&name);
        let Some(quantity) = Parameters::TABLE.iter().find(|quantity| is_known && quantity.name == name) else {
            return Ok(None);
        };
        let omega = TAU * p.frequency;
        let typical = match name {
            "ball.friction" => 1.0,
            "cylinder.suspensionStiffness" => p.cylinder_mass * omega * omega,
            _ => p.cylinder_mass * omega,
        };
        let h = STEP * typical;
        let at = |distance: f64| -> Result<Sensitivities, ModelError> {
            let mut moved = *p;
            (quantity.set)(&mut moved, (quantity.get)(p) + distance);
            let mut harvester = Self::new(moved.with_recording(recording), start)?;
            harvester.set_external_force(force, 0.0)?;
            Ok(harvester.shown())
        };
        let (here, near, far) = (at(0.0)?, at(h)?, at(2.0 * h)?);
        // (4 near - far - 3 here) / 2h, without losing the small differences.
        let slopes = near
            .with(&here, |near, here| (near - here) / h)
            .with(&far.with(&near, |far, near| (far - near) / h), |first, second| 1.5 * first - 0.5 * second);
        Ok(Some(slopes.with(&slopes, |slope, _| if slope.is_finite() { slope } else { 0.0 })))
    }

    /// What sensitivities are the changes of.
    fn shown(&self) -> Sensitivities {
        let deflection = Side::BOTH.map(|side| self.deflection(side).value);
        let of_membrane = |value: &dyn Fn(f64) -> f64| deflection.map(value);
        let (membrane, totals) = (self.membrane(), self.totals());
        Sensitivities {
            cylinder: [self.cylinder_position(), self.cylinder_velocity(), self.cylinder_acceleration()],
            ball: [self.ball_position(), self.ball_velocity(), self.ball_acceleration()],
            relative_displacement: self.relative_displacement(),
            deflection,
            area_ratio: of_membrane(&|x| membrane.area_ratio(x)),
            stretch: of_membrane(&|x| membrane.stretch(x)),
            field_per_volt: of_membrane(&|x| membrane.field(x, 1.0)),
            capacitance: of_membrane(&|x| membrane.capacitance(x)),
            last_speed: totals.last_speed,
            voltage_gain: totals.voltage_gain,
            energy: totals.energy,
            energies: self.energies(),
            // Where there is none, no change.
            next_impact: self.next_impact().unwrap_or(f64::INFINITY),
            next_knot: self.next_knot().unwrap_or(f64::INFINITY),
        }
    }
}

impl Sensitivities {
    /// Each number of this and that of `other`, taken together.
    fn with(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let pair = |a: [f64; 2], b: [f64; 2]| [of(a[0], b[0]), of(a[1], b[1])];
        let triple = |a: [f64; 3], b: [f64; 3]| [of(a[0], b[0]), of(a[1], b[1]), of(a[2], b[2])];
        let (e, f) = (&self.energies, &other.energies);
        Self {
            cylinder: triple(self.cylinder, other.cylinder),
            ball: triple(self.ball, other.ball),
            relative_displacement: of(self.relative_displacement, other.relative_displacement),
            deflection: pair(self.deflection, other.deflection),
            area_ratio: pair(self.area_ratio, other.area_ratio),
            stretch: pair(self.stretch, other.stretch),
            field_per_volt: pair(self.field_per_volt, other.field_per_volt),
            capacitance: pair(self.capacitance, other.capacitance),
            last_speed: of(self.last_speed, other.last_speed),
            voltage_gain: of(self.voltage_gain, other.voltage_gain),
            energy: of(self.energy, other.energy),
            energies: Energies {
                ball: of(e.ball, f.ball),
                cylinder: of(e.cylinder, f.cylinder),
                elastic: of(e.elastic, f.elastic),
                impact_loss: of(e.impact_loss, f.impact_loss),
                friction: of(e.friction, f.friction),
                gravity: of(e.gravity, f.gravity),
                suspension: of(e.suspension, f.suspension),
                damping: of(e.damping, f.damping),
                excitation: of(e.excitation, f.excitation),
                electrical: of(e.electrical, f.electrical),
                wall: of(e.wall, f.wall),
            },
            next_impact: of(self.next_impact, other.next_impact),
            next_knot: of(self.next_knot, other.next_knot),
        }
    }
}
