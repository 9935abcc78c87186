//! A run of the mechanics: C(t) for every solver, and the impacts that made it.

use videg_circuit::{Settings, formulas};

use crate::cosim::{CosimError, Coupling, HarvesterFmu, Master, MechanicsSummary, Observer, Outcome, Row};
use crate::ngspice::{CapacitanceTable, NgspiceError};
use crate::scenario::{Scenario, Setting};
use fmu_import::Fmu;

/// An impact of the ball on a membrane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// When, s.
    pub time: f64,
    /// Which membrane: 0 left, 1 right.
    pub side: usize,
    /// `C_3` / `C_2`.
    pub ratio: f64,
}

/// A run of the mechanics.
#[derive(Debug, Clone)]
pub struct Case {
    /// C(t), linear between its rows.
    pub table: CapacitanceTable,
    /// What the run comes to by the paper's equations.
    pub mechanics: MechanicsSummary,
    /// The impacts, in order.
    pub impacts: Vec<Impact>,
    /// `C_2` of the membranes, left and right, F.
    pub rest: [f64; 2],
    /// `U_in` of the harvester, V.
    pub bias_voltage: f64,
    /// What the FMU warned of.
    pub warnings: Vec<String>,
}

impl Case {
    /// Largest error of C(t) between the rows of the table, relative to the height of the largest pulse.
    pub const TABLE_ERROR: f64 = 1e-4;

    /// Rows that a run has at least, where `--step` is short enough: what is kept of the waveforms between the pulses.
    const GRID: f64 = 20_000.0;

    /// Runs `fmu` with `settings` twice: once for the table, once for the impacts. How a run is divided into steps
    /// changes no bit of the harvester, so both see the same motion.
    ///
    /// # Errors
    /// What the FMU says; a table that would be too long.
    pub fn new(
        fmu: &Fmu,
        scenario: &Scenario,
        settings: &[Setting],
        bar: &mut dyn Observer,
    ) -> Result<Self, NgspiceError> {
        let mut harvester = HarvesterFmu::new(fmu, scenario, settings)?;
        let table = CapacitanceTable::from_harvester(&mut harvester, scenario.until, Self::TABLE_ERROR)?;
        let table = refined(&table, scenario.step.max(scenario.until / Self::GRID))?;
        let harvester = HarvesterFmu::new(fmu, scenario, settings)?;
        let bias_voltage = harvester.bias_voltage();
        let mut log = ImpactLog { bias: bias_voltage, gain: 0.0, impacts: Vec::new() };
        let master = Master::new(harvester, Vec::new(), scenario, Coupling::default())?;
        let Outcome { mechanics, warnings, .. } = master.run(&mut [&mut log, bar])?;
        let least = |column: &[f64]| column.iter().copied().fold(f64::INFINITY, f64::min);
        let rest = [least(table.left()), least(table.right())];
        Ok(Self { table, mechanics, impacts: log.impacts, rest, bias_voltage, warnings })
    }

    /// The first `rows` rows, with the impacts that they hold. The mechanics stay those of the whole run.
    #[must_use]
    pub fn cut(&self, rows: usize) -> Self {
        let table = self.table.part(0, rows - 1);
        let mut impacts = self.impacts.clone();
        impacts.retain(|impact| impact.time <= table.until());
        Self { table, impacts, warnings: self.warnings.clone(), ..*self }
    }

    /// Smallest scale of a deviation of charges, C: about as much as an impact moves.
    pub fn least_charge(&self, settings: &Settings) -> f64 {
        /// In units of what the membranes hold at rest.
        const IMPACT: f64 = 0.1;
        IMPACT * settings.circuit.supply_voltage * self.rest.iter().sum::<f64>()
    }

    /// Scale of deviations of energies, J: the largest of what the supply gives, what the load gets, and what an impact moves.
    pub fn energy_scale(&self, settings: &Settings, supply: f64, load: f64) -> f64 {
        supply.abs().max(load.abs()).max(self.least_charge(settings) * settings.circuit.supply_voltage)
    }

    /// Charge, C, that charging and release diode leak by the end of the run. Ideal ones do not.
    pub fn leaked_charge(&self, settings: &Settings) -> f64 {
        2.0 * settings.diode.saturation_current * self.table.until()
    }

    /// The one `C_3` / `C_2` to choose a voltage of release by.
    pub fn best_ratio(&self) -> f64 {
        formulas::best_release_ratio(self.impacts.iter().map(|impact| impact.ratio).collect())
    }
}

/// The same C(t) with rows no further apart than `spacing`, s.
fn refined(table: &CapacitanceTable, spacing: f64) -> Result<CapacitanceTable, NgspiceError> {
    let (mut time, mut left, mut right) = (Vec::new(), Vec::new(), Vec::new());
    let mut push = |at: f64, [l, r]: [f64; 2]| {
        time.push(at);
        left.push(l);
        right.push(r);
    };
    push(0.0, table.initial());
    for ((start, a), (end, b)) in table.rows().zip(table.rows().skip(1)) {
        let pieces = ((end - start) / spacing).ceil().max(1.0);
        let mut k = 1.0;
        while k < pieces {
            let part = k / pieces;
            push(start + (end - start) * part, [0, 1].map(|j| a[j] + (b[j] - a[j]) * part));
            k += 1.0;
        }
        push(end, b);
    }
    CapacitanceTable::new(&time, &left, &right)
}

/// Finds the impacts from the running sum of their gains. Impacts within one communication step count as one.
struct ImpactLog {
    bias: f64,
    gain: f64,
    impacts: Vec<Impact>,
}

impl Observer for ImpactLog {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        let gain = row.harvester.voltage_gain();
        if gain > self.gain {
            // Left is the end that the ball meets when z_M - z_m = +s/2.
            let side = usize::from(row.harvester.relative_displacement() < 0.0);
            let ratio = 1.0 + (gain - self.gain) / self.bias;
            self.impacts.push(Impact { time: row.time, side, ratio });
            self.gain = gain;
        }
        Ok(())
    }
}
