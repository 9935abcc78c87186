//! The master: one harvester, any number of circuits.

use super::adaptive::StepControl;
use super::signal::{Curve, Line};
use super::{
    Averages, CircuitSample, CircuitSlave, CosimError, Coupling, CouplingSummary, ElementEnergy, EnergyBalance, Flows,
    Gains, HarvesterFmu, HarvesterSample, MechanicsSummary, Method, Powers, Schedule,
};
use crate::scenario::Scenario;

/// State at one communication point.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    /// Time, s.
    pub time: f64,
    /// Whether the harvester announced the time: an impact, or a kink or peak of C(t).
    pub is_knot: bool,
    /// The harvester.
    pub harvester: &'a HarvesterSample,
    /// The circuits, in their order.
    pub circuits: &'a [CircuitSample],
    /// Waveforms of the first circuit that were asked for.
    pub probes: &'a [f64],
}

/// Watches a run.
pub trait Observer {
    /// Takes the state at a communication point; the first is the start. An error ends the run.
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError>;
}

impl Observer for () {
    fn observe(&mut self, _row: &Row<'_>) -> Result<(), CosimError> {
        Ok(())
    }
}

/// Result of a run.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The mechanics.
    pub mechanics: MechanicsSummary,
    /// The circuits at the end, in their order.
    pub circuits: Vec<CircuitSample>,
    /// Elements of the first circuit with their energies, if it has a ledger of them.
    pub elements: Vec<ElementEnergy>,
    /// Powers of the circuits over the averaging window, in their order.
    pub powers: Vec<Powers>,
    /// The coupling of the harvester with the first circuit.
    pub coupling: CouplingSummary,
    /// The energy balance of harvester and first circuit, with electrostatic feedback.
    pub balance: Option<EnergyBalance>,
    /// Mean flows of energy of harvester and first circuit over the averaging window.
    pub flows: Flows,
    /// Warnings of the harvester, before and in the run.
    pub warnings: Vec<String>,
}

/// The master, ready to run.
pub struct Master {
    harvester: HarvesterFmu,
    circuits: Vec<Box<dyn CircuitSlave>>,
    schedule: Schedule,
    scenario: Scenario,
    coupling: CouplingSummary,
    control: Option<StepControl>,
}

/// A communication point with the data for the next step.
struct Point {
    time: f64,
    /// Whether the harvester announced the time.
    is_knot: bool,
    harvester: HarvesterSample,
    /// dC/dt, F/s.
    capacitance_rate: [f64; 2],
    impacts: i32,
    circuits: Vec<CircuitSample>,
    probes: Vec<f64>,
    /// Energy that the mechanics gave so far, J, if the harvester sums it up.
    electrical_work: Option<f64>,
    /// Last C(t) that the circuits were given, F.
    given: [f64; 2],
    /// Voltages over the step that led here, V.
    voltage: [Line; 2],
    /// Length of that step, s.
    step: f64,
}

/// Largest ratio of a step to the one before at which voltages are extrapolated: beyond it, the jump of a diode would count
/// as a slope.
const REACH: f64 = 10.0;

impl Master {
    /// A master for `harvester` and `circuits`, all initialised at 0 s.
    ///
    /// # Errors
    /// A coupling that makes no sense, or an adaptive one with a circuit that cannot go back.
    pub fn new(
        harvester: HarvesterFmu,
        mut circuits: Vec<Box<dyn CircuitSlave>>,
        scenario: &Scenario,
        coupling: Coupling,
    ) -> Result<Self, CosimError> {
        coupling.check()?;
        if coupling.tolerance.is_some() {
            // A circuit that cannot go back says so before the run.
            circuits.iter_mut().try_for_each(|circuit| circuit.save())?;
        }
        let schedule = Schedule::new(scenario.step, scenario.until, scenario.window);
        let control = coupling.tolerance.map(|tolerance| StepControl::new(tolerance, scenario.step));
        let (scenario, coupling) = (scenario.clone(), CouplingSummary::new(coupling));
        Ok(Self { harvester, circuits, schedule, scenario, coupling, control })
    }

    /// Runs to the end, showing each communication point to `observers`.
    pub fn run(mut self, observers: &mut [&mut dyn Observer]) -> Result<Outcome, CosimError> {
        let window = self.scenario.window;
        let mut point = self.start()?;
        let energies_at_start = self.harvester.energies()?;
        let (mut gains, mut ledgers, mut mechanical) = ([None; 2], [None, None], [None; 2]);
        loop {
            let harvester = &point.harvester;
            let (time, is_knot) = (point.time, point.is_knot);
            let row = Row { time, is_knot, harvester, circuits: &point.circuits, probes: &point.probes };
            observers.iter_mut().try_for_each(|observer| observer.observe(&row))?;
            for (gain, edge) in gains.iter_mut().zip(window) {
                if gain.is_none() && point.time >= edge {
                    let (voltage, energy) = (harvester.voltage_gain(), harvester.energy_eq13());
                    *gain = Some(Gains { voltage, energy, impacts: point.impacts });
                }
            }
            for (ledger, edge) in ledgers.iter_mut().zip(window) {
                if ledger.is_none() && point.time >= edge {
                    *ledger = Some(point.circuits.iter().map(|circuit| circuit.ledger).collect::<Vec<_>>());
                }
            }
            for (energies, edge) in mechanical.iter_mut().zip(window) {
                if energies.is_none() && point.time >= edge {
                    *energies = self.harvester.energies()?;
                }
            }
            if point.time >= self.scenario.until {
                break;
            }
            let next = self.advance(&point)?;
            self.book(&point, &next);
            point = next;
        }
        let [start, end] = gains.map(Option::unwrap_or_default);
        let averages = Averages::over(window, &start, &end);
        let [impacts, events] = self.harvester.counts()?;
        let energies = energies_at_start.zip(self.harvester.energies()?);
        self.harvester.terminate()?;
        let mechanics = MechanicsSummary {
            impacts,
            events,
            average_voltage_gain: averages.voltage_gain,
            average_power_eq13: averages.power,
            voltage_gain: point.harvester.voltage_gain(),
            energy_eq13: point.harvester.energy_eq13(),
        };
        let coupling = self.coupling;
        let balance = energies
            .filter(|_| self.harvester.feels_voltage())
            .zip(point.circuits.first())
            .map(|((start, end), circuit)| EnergyBalance::new(start, end, &circuit.ledger));
        let [before, after] = ledgers.map(Option::unwrap_or_default);
        let powers = before.iter().zip(&after).map(|(before, after)| Powers::over(window, before, after)).collect();
        let ledgers = [before.first(), after.first()];
        let flows = Flows::over(window, mechanical, ledgers);
        let elements = self.circuits.first_mut().map_or_else(|| Ok(Vec::new()), |circuit| circuit.elements())?;
        let mut warnings = self.harvester.warnings();
        warnings.extend(self.circuits.iter().flat_map(|circuit| circuit.notes().iter().cloned()));
        Ok(Outcome { mechanics, circuits: point.circuits, elements, powers, coupling, balance, flows, warnings })
    }

    fn start(&self) -> Result<Point, CosimError> {
        let harvester = self.harvester.sample()?;
        let voltage = [Line { start: 0.0, rate: 0.0 }; 2];
        self.point(0.0, harvester.capacitance(), voltage, 0.0)
    }

    /// State at `time`, s, after a `step`, s, in which the circuits were given C(t) up to `given`, F, and the harvester
    /// `voltage`, V.
    fn point(&self, time: f64, given: [f64; 2], voltage: [Line; 2], step: f64) -> Result<Point, CosimError> {
        Ok(Point {
            time,
            is_knot: false,
            harvester: self.harvester.sample()?,
            capacitance_rate: self.harvester.capacitance_rate()?,
            impacts: self.harvester.counts()?[0],
            circuits: self.circuits.iter().map(|circuit| circuit.sample()).collect::<Result<_, _>>()?,
            probes: self.circuits.first().map_or_else(Vec::new, |circuit| circuit.probes().1.to_vec()),
            electrical_work: self.harvester.electrical_work()?,
            given,
            voltage,
            step,
        })
    }

    /// The next communication point.
    fn advance(&mut self, from: &Point) -> Result<Point, CosimError> {
        let knot = from.harvester.next_knot();
        let Some(mut control) = self.control else {
            let knot = if self.coupling.master == Method::Plain { f64::INFINITY } else { knot };
            self.coupling.steps += 1;
            return self.step(from, self.schedule.next(from.time, knot));
        };
        self.save()?;
        loop {
            let next = self.schedule.within(from.time, control.step(), knot);
            let to = self.step(from, next)?;
            // An impact that was not announced may hide a pulse.
            let surprise = to.impacts > from.impacts && next < knot;
            let error = if surprise { f64::INFINITY } else { self.error(from, &to) };
            let shortest = next <= self.schedule.within(from.time, 0.0, knot);
            if control.accepts(to.step, error) || shortest {
                self.control = Some(control);
                self.coupling.steps += 1;
                return Ok(to);
            }
            self.coupling.rejected += 1;
            self.restore()?;
        }
    }

    /// Steps all subsystems to `next`, s.
    fn step(&mut self, from: &Point, next: f64) -> Result<Point, CosimError> {
        let (now, step) = (from.time, next - from.time);
        let voltage = self.voltage(from, step);
        if !self.circuits.is_empty() {
            self.harvester.set_voltage(voltage.map(|line| line.start))?;
        }
        if self.harvester.takes_voltage_rates() {
            self.harvester.set_voltage_rate(voltage.map(|line| line.rate))?;
        }
        self.harvester.step(now, step)?;
        let start = from.harvester.capacitance();
        let (start, end) = match self.coupling.master {
            Method::GaussSeidel => (start, self.harvester.sample()?.capacitance()),
            Method::Jacobi => (start, [0, 1].map(|j| start[j] + from.capacitance_rate[j] * step)),
            Method::Plain => (from.given, start),
        };
        for circuit in &mut self.circuits {
            circuit.step(now, step, start, end)?;
        }
        let is_knot = next >= from.harvester.next_knot();
        Ok(Point { is_knot, ..self.point(next, end, voltage, step)? })
    }

    /// The voltages of the harvester for a `step`, s: those of the first circuit, extrapolated from the last step.
    fn voltage(&self, from: &Point, step: f64) -> [Line; 2] {
        let present = from.circuits.first().map_or([0.0; 2], |circuit| circuit.voltage);
        let deaf = self.harvester.feels_voltage() && !self.harvester.takes_voltage_rates();
        let held = deaf || self.coupling.master == Method::Plain || step > REACH * from.step;
        let rate = |j: usize| if held { 0.0 } else { (present[j] - from.voltage[j].start) / from.step };
        [0, 1].map(|j| Line { start: present[j], rate: rate(j) })
    }

    /// Largest error of a signal in the step between two points, relative to its value: of C(t) as the circuits had it, and
    /// of the voltages where the harvester feels them.
    fn error(&self, from: &Point, to: &Point) -> f64 {
        let of_capacitance = (0..2).map(|j| {
            let curve = capacitance(from, to, j);
            let rate = (to.given[j] - curve.value[0]) / to.step;
            curve.deviation(&Line { start: curve.value[0], rate })
        });
        let of_voltage = to.circuits.first().filter(|_| self.harvester.feels_voltage()).map(|circuit| {
            let error = |j: usize| (to.voltage[j].at(to.step) / circuit.voltage[j] - 1.0).abs();
            error(0).max(error(1))
        });
        of_capacitance.chain(of_voltage).fold(0.0, larger)
    }

    fn book(&mut self, from: &Point, to: &Point) {
        let (Some(before), Some(after)) = (from.circuits.first(), to.circuits.first()) else { return };
        let by_harvester = match (from.electrical_work, to.electrical_work) {
            (Some(before), Some(after)) => after - before,
            _ => (0..2).map(|j| capacitance(from, to, j).work(&to.voltage[j])).sum(),
        };
        self.coupling.add(after.ledger.mechanical - before.ledger.mechanical, by_harvester);
    }

    fn save(&mut self) -> Result<(), CosimError> {
        self.harvester.save()?;
        self.circuits.iter_mut().try_for_each(|circuit| circuit.save())
    }

    fn restore(&mut self) -> Result<(), CosimError> {
        self.harvester.restore()?;
        self.circuits.iter_mut().try_for_each(|circuit| circuit.restore())
    }
}

/// C(t) of a membrane (0 left, 1 right) between two communication points, as the harvester has it.
fn capacitance(from: &Point, to: &Point, side: usize) -> Curve {
    let value = [from.harvester.capacitance()[side], to.harvester.capacitance()[side]];
    Curve { step: to.step, value, rate: [from.capacitance_rate[side], to.capacitance_rate[side]] }
}

/// The larger of two; NaN is larger than all numbers.
fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
