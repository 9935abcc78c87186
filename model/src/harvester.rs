//! The vibro-impact harvester: from event to event, exactly under the impulsive law.

mod contact;
mod copy;
mod course;
mod dues;
mod energy;
mod events;
mod exchange;
mod foreseen;
mod occurrence;
mod snapshot;
mod tangent;

pub use self::energy::Energies;
pub use self::occurrence::{Impact, Occurrence, Peak};
pub use self::snapshot::Snapshot;
pub use self::tangent::{Direction, GRAZING_SPEED, Sensitivities};

use self::course::hold_at;
use self::dues::Dues;
use self::energy::Ledger;
use self::events::{Event, Search};
use self::tangent::Tangent;
use crate::compliant::{Ramp, Touch};
use crate::cylinder::{CylinderMotion, Drive};
use crate::error::ModelError;
use crate::flight::{Flight, Side};
use crate::holds::Holds;
use crate::membrane::Membrane;
use crate::noise;
use crate::parameters::{ContactLaw, NoiseModel, OutsideGap, Parameters};
use crate::pulse::{Deflection, Knot, PulseShape, Pulses};

/// Largest force, voltage and rate of these, in SI units. Far beyond any use, and small enough that no energy of a run up to
/// 1e9 s is infinite, whatever the parameters.
const MAX_INPUT: f64 = 1e18;

/// Farthest start from t = 0, s: times have digits below a microsecond up to there.
const MAX_START: f64 = 1e9;

/// Sums over all impacts so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Totals {
    /// Impacts resolved one by one; under the compliant law, contacts begun. Of a chattering sequence, the endless tail that is summed in closed form is not
    /// counted here; its gains are contained below.
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

/// The ball since its last event: straight on while free, carried by the membrane while resting.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball {
    since: f64,
    position: f64,
    velocity: f64,
    resting: Option<Side>,
}

/// The phase noise: sample number and, read as a Wiener process, its value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Noise {
    sample: u64,
    walk: f64,
}

/// The harvester: state at one time, moved forward by [`Harvester::advance`].
#[derive(Debug, PartialEq)]
pub struct Harvester {
    parameters: Parameters,
    membrane: Membrane,
    shape: PulseShape,
    time: f64,
    cylinder: CylinderMotion,
    ball: Ball,
    noise: Noise,
    holds: Holds,
    search: Search,
    pulses: [Pulses; 2],
    /// The present contact, under the compliant law.
    touch: Option<Touch>,
    /// Voltages across the membranes, V, for the Maxwell force.
    voltages: [Ramp; 2],
    totals: Totals,
    ledger: Ledger,
    tangent: Tangent,
    /// Its states are placed by an integrator.
    placed: bool,
    /// Up to here, s, nothing happens and nothing more is to be foreseen: on the way only the time changes.
    calm_until: f64,
    /// Second in which events are being counted, and their number: the budget.
    second: f64,
    second_events: u64,
}

impl Harvester {
    /// The harvester at `start`, s, in its initial state.
    ///
    /// # Errors
    /// A parameter out of bounds ([`Parameters::validate`]); a start time beyond 1e9 s before or after zero, or, with
    /// phase noise, beyond 2^52 hold intervals.
    pub fn new(parameters: &Parameters, start: f64) -> Result<Self, ModelError> {
        let mut harvester = Self::before_events(parameters, start)?;
        harvester.rest_if_started_at_rest();
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
        harvester.rest_if_started_at_rest();
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
        let dz = p.cylinder_position - position;
        let flight = Flight::new(&cylinder, &cylinder.at(start), dz, p.ball_velocity, half);
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

    /// The membrane that a ball that starts beyond it is put on.
    fn projected_side(&self) -> Option<Side> {
        let dz = self.parameters.cylinder_position - self.parameters.ball_position;
        let is_put = self.parameters.outside_gap == OutsideGap::Project && dz.abs() >= self.half_travel();
        is_put.then_some(if dz > 0.0 { Side::Left } else { Side::Right })
    }

    /// Moves on to `time`, s, through every event up to and including it. How a run is split into calls changes nothing.
    ///
    /// # Errors
    /// A time that is not finite or lies in the past; more events than can be resolved.
    #[inline]
    pub fn advance(&mut self, time: f64) -> Result<(), ModelError> {
        self.advance_with(time, |_| {})
    }

    /// Moves on as [`Harvester::advance`] does, and shows each impact and each largest deflection to `show`.
    ///
    /// # Errors
    /// As [`Harvester::advance`].
    #[inline]
    pub fn advance_with(&mut self, time: f64, show: impl FnMut(&Occurrence)) -> Result<(), ModelError> {
        if self.time <= time && time < self.calm_until {
            self.time = time;
            return Ok(());
        }
        self.advance_through_events(time, show)
    }

    fn advance_through_events(&mut self, time: f64, mut show: impl FnMut(&Occurrence)) -> Result<(), ModelError> {
        finite("time", time)?;
        if time < self.time {
            return Err(ModelError::Backwards { from: self.time, to: time });
        }
        self.calm_until = f64::NEG_INFINITY; // until it is known anew; an error on the way leaves nothing foreseen
        let mut dues = Dues::NONE;
        let passed = self.pass_events(time, &mut dues, &mut show);
        self.settle_dues(&mut dues);
        passed?;
        self.follow_noise(time);
        self.time = time;
        self.look_ahead();
        Ok(())
    }

    /// Does what events up to `time`, s, do, but for the credit of impacts in `dues`.
    fn pass_events(
        &mut self,
        time: f64,
        dues: &mut Dues,
        show: &mut impl FnMut(&Occurrence),
    ) -> Result<(), ModelError> {
        while let Some(event) = self.next_event(time, true).filter(|event| event.time() <= time) {
            let turn = self.turn_at(event);
            self.process(event, dues)?;
            let (impact, peak) = (self.impact_of(event), turn.or_else(|| self.peak_after(event)));
            impact.map(Occurrence::Impact).iter().chain(&peak.map(Occurrence::Peak)).for_each(&mut *show);
        }
        Ok(())
    }

    /// Sets the external force on the cylinder from now on: `force`, N, growing by `rate`, N/s. Setting the
    /// constant force again that acts already changes nothing in the motion, to the last bit.
    /// [`Harvester::sensitivities`] are counted from here.
    ///
    /// # Errors
    /// A force or rate that is not finite, or beyond 1e18 N or N/s.
    #[inline]
    pub fn set_external_force(&mut self, force: f64, rate: f64) -> Result<(), ModelError> {
        within("externalForce", force, "N")?;
        within("derivative of externalForce", rate, "N/s")?;
        self.forget_changes();
        self.push(force, rate);
        Ok(())
    }

    #[inline]
    fn push(&mut self, force: f64, rate: f64) {
        // Nothing pushes, as before: two quotients less for each step of a caller that sets its inputs anew.
        if [force, rate, self.cylinder.drive.external, self.cylinder.drive.external_rate] == [0.0; 4] {
            return;
        }
        let (mass, drive) = (self.parameters.cylinder_mass, &self.cylinder.drive);
        let (external, external_rate) = (force / mass, rate / mass);
        let present = drive.external + drive.external_rate * (self.time - self.cylinder.start);
        if external != present || external_rate != drive.external_rate {
            self.restart(self.time, Drive { external, external_rate, ..*drive });
            self.look_ahead();
        }
    }

    /// Makes the next impact known; what is found does not depend on the steps.
    fn look_ahead(&mut self) {
        self.next_event(self.time + self.horizon(), false);
        self.calm_until = self.calm();
    }

    fn half_travel(&self) -> f64 {
        self.parameters.travel() / 2.0
    }

    fn ball_at(&self, time: f64) -> Ball {
        let (position, velocity) = (self.ball_position_at(time), self.ball_velocity_at(time));
        Ball { since: time, position, velocity, resting: None }
    }

    fn relative_displacement_at(&self, time: f64) -> f64 {
        if let Some(touch) = &self.touch {
            return touch.side.sign() * (self.half_travel() + touch.at(time).x);
        }
        match self.ball.resting {
            Some(side) => side.sign() * self.half_travel(),
            None => self.search.flight.derivative(0, time - self.search.flight.start),
        }
    }

    fn ball_position_at(&self, time: f64) -> f64 {
        if self.touch.is_some() {
            return self.cylinder_position_at(time) - self.relative_displacement_at(time);
        }
        match self.ball.resting {
            Some(side) => self.cylinder.position(time) - side.sign() * self.half_travel(),
            None => self.ball.position + self.ball.velocity * (time - self.ball.since),
        }
    }

    fn ball_velocity_at(&self, time: f64) -> f64 {
        if let Some(touch) = &self.touch {
            return self.cylinder_velocity_at(time) - touch.side.sign() * touch.at(time).v;
        }
        if self.ball.resting.is_some() { self.cylinder.velocity(time) } else { self.ball.velocity }
    }

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
        self.cylinder_position_at(self.time)
    }

    /// `z_M'`, m/s.
    pub fn cylinder_velocity(&self) -> f64 {
        self.cylinder_velocity_at(self.time)
    }

    /// `z_M''`, m/s^2, Eq. (7).
    pub fn cylinder_acceleration(&self) -> f64 {
        self.cylinder.acceleration(self.time) + self.recoil_acceleration()
    }

    /// `z_m`, m.
    pub fn ball_position(&self) -> f64 {
        self.ball_position_at(self.time)
    }

    /// `z_m'`, m/s.
    pub fn ball_velocity(&self) -> f64 {
        self.ball_velocity_at(self.time)
    }

    /// dz = `z_M` - `z_m`, m.
    pub fn relative_displacement(&self) -> f64 {
        self.relative_displacement_at(self.time)
    }

    /// Deflection of the membrane at `side` and its rate.
    pub fn deflection(&self, side: Side) -> Deflection {
        if self.parameters.contact_law == ContactLaw::Compliant {
            return self.touch_deflection(side);
        }
        self.pulses[side.index()].at(&self.shape, self.time)
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
        self.ball.resting.or(self.held())
    }

    /// Sums over all impacts so far.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Time of the next impact, s, if the external force goes on as it is; none while the ball rests or if no
    /// impact is foreseen within at least one excitation period, or, with phase noise, within at least 256 hold intervals if
    /// those are shorter; under the compliant law and with a Wiener process, within the present hold interval.
    pub fn next_impact(&self) -> Option<f64> {
        match self.search.found {
            Some(Event::Impact { time, .. }) => Some(time),
            _ => None,
        }
    }

    /// The next time, s, at which a capacitance has a kink or an extremum: the peak or the end of a pulse, or an impact; under
    /// the compliant law the next turning point or end of the contact, foreseen under the present force and voltages for
    /// at most one excitation period; none while the ball rests or comes back to the largest deflection first.
    pub fn next_knot(&self) -> Option<f64> {
        let knots = self.pulse_knots().map(|knot| knot.time);
        knots.chain(self.next_impact()).chain(self.touch_knot()).min_by(f64::total_cmp)
    }

    /// The next peak or end of a pulse on each membrane.
    fn pulse_knots(&self) -> impl Iterator<Item = Knot<'_>> {
        self.pulses.iter().filter_map(|pulses| pulses.next_knot(&self.shape, self.time))
    }
}

/// Number of the noise sample that holds at the start, s; a start before t = 0 gets sample 0.
fn first_sample(parameters: &Parameters, start: f64) -> Result<u64, ModelError> {
    /// Beyond this the grid of sample times has no digits to tell neighbours apart.
    const MAX_SAMPLES: f64 = 4_503_599_627_370_496.0; // 2^52
    let noisy = parameters.phase_noise > 0.0;
    let max = if noisy { MAX_START.min(MAX_SAMPLES * parameters.noise_hold) } else { MAX_START };
    if !(start >= -MAX_START && start <= max) {
        return Err(ModelError::Bounds { name: "start time", value: start, unit: "s", min: -MAX_START, max });
    }
    Ok(if noisy { hold_at(parameters.noise_hold, start) } else { 0 })
}

/// Phase of the harmonic force under the present noise sample, rad.
fn phase(parameters: &Parameters, noise: &Noise) -> f64 {
    if parameters.phase_noise == 0.0 {
        return parameters.phase;
    }
    parameters.phase + parameters.phase_noise * xi(parameters, noise)
}

/// The factor of the intensity of the phase noise.
fn xi(parameters: &Parameters, noise: &Noise) -> f64 {
    match parameters.noise_model {
        NoiseModel::Held => noise::normal(parameters.seed, noise.sample),
        NoiseModel::Wiener => noise.walk,
    }
}

/// An input, or its rate, within its bounds.
#[inline]
fn within(name: &'static str, value: f64, unit: &'static str) -> Result<(), ModelError> {
    if value.abs() <= MAX_INPUT {
        return Ok(());
    }
    finite(name, value)?;
    Err(ModelError::Bounds { name, value, unit, min: -MAX_INPUT, max: MAX_INPUT })
}

fn finite(name: &'static str, value: f64) -> Result<(), ModelError> {
    if value.is_finite() { Ok(()) } else { Err(ModelError::NotFinite { name, value }) }
}
