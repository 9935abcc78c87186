//! Harvesters at their start.

use super::energy::Ledger;
use super::events::Search;
use super::input::within;
use super::phase::{Noise, first_sample, phase, xi};
use super::tangent::{Direction, Tangent};
use super::{Ball, Harvester, Totals};
use crate::compliant::Ramp;
use crate::cylinder::{CylinderMotion, Drive};
use crate::error::ModelError;
use crate::flight::{Flight, Side};
use crate::holds::Holds;
use crate::membrane::Membrane;
use crate::parameters::{OutsideGap, Parameters};
use crate::pulse::{PulseShape, Pulses};

impl Harvester {
    /// The harvester at `start`, s, in its initial state. A ball that starts on a membrane and approaches it has met it:
    /// [`Harvester::present_impact`].
    ///
    /// # Errors
    /// A parameter out of bounds ([`Parameters::validate`]); a start time beyond 1e9 s before or after zero, or, with
    /// phase noise, beyond 2^52 hold intervals.
    pub fn new(parameters: &Parameters, start: f64) -> Result<Self, ModelError> {
        let mut harvester = Self::before_events(parameters, start)?;
        harvester.begin_on_membrane();
        harvester.advance(start)?;
        Ok(harvester)
    }

    /// The harvester at `start`, s, under the external `force`, N, whose [`Harvester::sensitivities`] are those to first
    /// order along `direction`.
    ///
    /// # Errors
    /// As [`Harvester::new`]; a force that is not finite or beyond 1e18 N.
    pub fn along(parameters: &Parameters, start: f64, force: f64, direction: &Direction) -> Result<Self, ModelError> {
        within("externalForce", force, "N")?;
        let mut harvester = Self::before_events(parameters, start)?;
        let xi = xi(parameters, &harvester.noise);
        harvester.tangent = Tangent::along(&harvester, force, direction, xi);
        harvester.begin_on_membrane();
        harvester.advance(start)?;
        harvester.push(force, 0.0);
        Ok(harvester)
    }

    /// The harvester at `start`, s; what happens there is still ahead.
    fn before_events(parameters: &Parameters, start: f64) -> Result<Self, ModelError> {
        parameters.validate()?;
        let p = *parameters;
        let noise = Noise { sample: first_sample(&p, start)?, walk: 0.0 };
        let drive = Drive {
            amplitude: p.amplitude / p.cylinder_mass,
            frequency: p.frequency,
            phase: phase(&p, &noise),
            external: 0.0,
            external_rate: 0.0,
        };
        let cylinder = CylinderMotion::new(start, p.cylinder_position, p.cylinder_velocity, drive);
        let half = p.travel() / 2.0;
        let position = match p.outside_gap {
            OutsideGap::Free => p.ball_position,
            OutsideGap::Project => p.ball_position.clamp(p.cylinder_position - half, p.cylinder_position + half),
        };
        let ball = Ball { since: start, position, velocity: p.ball_velocity, resting: None };
        let projected = p.projected_side().map(|side| side.sign() * half);
        let displacement = projected.unwrap_or(p.cylinder_position - position);
        let motion = [displacement, p.cylinder_velocity - p.ball_velocity];
        let flight = Flight::new(&cylinder, &cylinder.at(start), motion, half);
        Ok(Self {
            parameters: p,
            membrane: Membrane::new(&p),
            shape: PulseShape::new(p.stiffness_exponent, p.restitution),
            time: start,
            cylinder,
            ball,
            noise,
            holds: Holds::new(&p),
            search: Search::new(flight),
            pulses: [Pulses::default(), Pulses::default()],
            touch: None,
            voltages: [Ramp { start, value: p.bias_voltage, rate: 0.0 }; 2],
            totals: Totals::default(),
            ledger: Ledger::default(),
            tangent: Tangent::none(),
            placed: false,
            calm_until: f64::NEG_INFINITY,
            second: 0.0,
            second_events: 0,
        })
    }
}

impl Parameters {
    /// The membrane that a ball that starts beyond it is put on.
    pub(super) fn projected_side(&self) -> Option<Side> {
        let dz = self.cylinder_position - self.ball_position;
        let is_put = self.outside_gap == OutsideGap::Project && dz.abs() >= self.travel() / 2.0;
        is_put.then_some(if dz > 0.0 { Side::Left } else { Side::Right })
    }
}
