//! The master: one harvester, any number of circuits.

use super::{CircuitSample, CircuitSlave, CosimError, HarvesterFmu, HarvesterSample, MechanicsSummary, Schedule};
use crate::scenario::Scenario;

/// What holds at one communication point.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    /// Time, s.
    pub time: f64,
    /// The harvester.
    pub harvester: &'a HarvesterSample,
    /// The circuits, in their order.
    pub circuits: &'a [CircuitSample],
}

/// Watches a run.
pub trait Observer {
    /// Takes what holds at a communication point; the first is the start.
    ///
    /// # Errors
    /// If it cannot be kept; the run ends.
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError>;
}

/// The master, ready to run.
pub struct Master {
    harvester: HarvesterFmu,
    circuits: Vec<Box<dyn CircuitSlave>>,
    schedule: Schedule,
    scenario: Scenario,
}

/// Running sums of the harvester at an edge of the averaging window.
#[derive(Debug, Clone, Copy, Default)]
struct Gain {
    voltage: f64,
    energy: f64,
}

impl Master {
    /// A master for `harvester` and `circuits`, all initialised at 0 s.
    pub fn new(harvester: HarvesterFmu, circuits: Vec<Box<dyn CircuitSlave>>, scenario: &Scenario) -> Self {
        let schedule = Schedule::new(scenario.step, scenario.until, scenario.window);
        Self { harvester, circuits, schedule, scenario: scenario.clone() }
    }

    /// Runs to the end, showing each communication point to `observers`, and sums up.
    ///
    /// # Errors
    /// What a subsystem or an observer says.
    pub fn run(
        mut self,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(MechanicsSummary, Vec<CircuitSample>), CosimError> {
        let [from, to] = self.scenario.window;
        let mut now = 0.0;
        let mut harvester = self.harvester.sample()?;
        let mut samples = self.circuit_samples()?;
        let mut gains = [None; 2];
        loop {
            let row = Row { time: now, harvester: &harvester, circuits: &samples };
            observers.iter_mut().try_for_each(|observer| observer.observe(&row))?;
            for (gain, edge) in gains.iter_mut().zip([from, to]) {
                if gain.is_none() && now >= edge {
                    *gain = Some(Gain { voltage: harvester.voltage_gain(), energy: harvester.energy_eq13() });
                }
            }
            if now >= self.scenario.until {
                break;
            }
            let next = self.schedule.next(now, harvester.next_knot());
            if let Some(circuit) = samples.first() {
                self.harvester.set_voltage(circuit.voltage)?;
            }
            harvester = self.step(now, next, &harvester)?;
            samples = self.circuit_samples()?;
            now = next;
        }
        let [start, end] = gains.map(Option::unwrap_or_default);
        let [impacts, events] = self.harvester.counts()?;
        self.harvester.terminate()?;
        let summary = MechanicsSummary {
            impacts,
            events,
            average_voltage_gain: (end.voltage - start.voltage) / (to - from),
            average_power_eq13: (end.energy - start.energy) / (to - from),
            voltage_gain: harvester.voltage_gain(),
            energy_eq13: harvester.energy_eq13(),
        };
        Ok((summary, samples))
    }

    /// Steps the harvester from `now` to `next`, s, then the circuits with the capacitances at both ends.
    fn step(&mut self, now: f64, next: f64, before: &HarvesterSample) -> Result<HarvesterSample, CosimError> {
        let step = next - now;
        self.harvester.step(now, step)?;
        let after = self.harvester.sample()?;
        for circuit in &mut self.circuits {
            circuit.step(now, step, before.capacitance(), after.capacitance())?;
        }
        Ok(after)
    }

    fn circuit_samples(&self) -> Result<Vec<CircuitSample>, CosimError> {
        self.circuits.iter().map(|circuit| circuit.sample()).collect()
    }
}
