//! A run of the mechanics: C(t) for every solver, and the impacts that made it.

use fmu_import::Fmu;
use videg_circuit::{Settings, Topology, formulas};

use crate::cosim::{Coupling, HarvesterFmu, ImpactLog, Master, MechanicsSummary, MembraneImpact, Observer, Outcome};
use crate::ngspice::{CapacitanceTable, NgspiceError};
use crate::scenario::{Scenario, Setting};

/// A run of the mechanics.
#[derive(Debug, Clone)]
pub struct MechanicalRun {
    /// C(t), linear between its rows.
    pub table: CapacitanceTable,
    /// Gains by the paper's equations.
    pub summary: MechanicsSummary,
    /// The impacts, in order.
    pub impacts: Vec<MembraneImpact>,
    /// `C_2` of the membranes, left and right, F.
    pub rest: [f64; 2],
    /// `U_in` of the harvester, V.
    pub bias_voltage: f64,
    /// Warnings of the FMU.
    pub warnings: Vec<String>,
}

impl MechanicalRun {
    /// Largest error of C(t) between the rows of the table, relative to the height of the largest pulse.
    pub const TABLE_ERROR: f64 = 1e-4;

    /// Least number of rows, where `--step` is short enough: resolution of the waveforms between the pulses.
    const GRID: f64 = 20_000.0;

    /// Runs `fmu` with `settings` twice: once for the table, once for the impacts. Both see the same motion, because the
    /// division of a run into steps changes no bit of the harvester.
    pub(super) fn new(
        fmu: &Fmu,
        scenario: &Scenario,
        settings: &[Setting],
        observer: &mut dyn Observer,
    ) -> Result<Self, NgspiceError> {
        let mut harvester = HarvesterFmu::new(fmu, scenario, settings)?;
        let table = CapacitanceTable::from_harvester(&mut harvester, scenario.until, Self::TABLE_ERROR, &())?;
        let table = refined(&table, scenario.step.max(scenario.until / Self::GRID))?;
        let harvester = HarvesterFmu::new(fmu, scenario, settings)?;
        let bias_voltage = harvester.bias_voltage();
        let mut log = ImpactLog::new(bias_voltage);
        let master = Master::new(harvester, Vec::new(), scenario, Coupling::default())?;
        let Outcome { mechanics: summary, warnings, .. } = master.run(&mut [&mut log, observer])?;
        let least = |column: &[f64]| column.iter().copied().fold(f64::INFINITY, f64::min);
        let rest = [least(table.left()), least(table.right())];
        Ok(Self { table, summary, impacts: log.impacts, rest, bias_voltage, warnings })
    }

    /// The first `rows` rows, with their impacts. The summary stays that of the whole run.
    #[must_use]
    pub fn truncated(&self, rows: usize) -> Self {
        let table = self.table.part(0, rows - 1);
        let mut impacts = self.impacts.clone();
        impacts.retain(|impact| impact.time <= table.until());
        Self { table, impacts, warnings: self.warnings.clone(), ..*self }
    }

    /// `C_2` and `C_3` of the node on which an impact acts, F: on a shared node the idle membrane lies in parallel.
    pub fn node_capacitances(&self, topology: Topology, impact: &MembraneImpact) -> [f64; 2] {
        let c2 = self.rest[impact.side];
        let idle = match topology {
            Topology::SharedNode => self.rest[1 - impact.side],
            Topology::Isolated => 0.0,
        };
        [c2 + idle, impact.ratio * c2 + idle]
    }

    /// Sum over the impacts of a closed form of the node's `C_2` and `C_3`.
    pub fn sum(&self, topology: Topology, closed_form: impl Fn(f64, f64) -> f64) -> f64 {
        let capacitances = self.impacts.iter().map(|impact| self.node_capacitances(topology, impact));
        capacitances.map(|[c2, c3]| closed_form(c2, c3)).sum()
    }

    /// Largest `C_3` / `C_2`, at least 1.
    pub fn largest_ratio(&self) -> f64 {
        self.impacts.iter().map(|impact| impact.ratio).fold(1.0, f64::max)
    }

    /// The `C_3` / `C_2` for which a voltage of release is chosen.
    pub fn best_ratio(&self) -> f64 {
        formulas::best_release_ratio(self.impacts.iter().map(|impact| impact.ratio).collect())
    }

    /// Smallest scale of deviations of charges, C: about the charge that an impact moves.
    pub fn least_charge(&self, settings: &Settings) -> f64 {
        /// Relative to the charge of the membranes at rest.
        const IMPACT: f64 = 0.1;
        IMPACT * settings.circuit.supply_voltage * self.rest.iter().sum::<f64>()
    }

    /// Scale of deviations of energies, J: the largest of the energies from the supply, to the load and of an impact.
    pub fn energy_scale(&self, settings: &Settings, supply: f64, load: f64) -> f64 {
        supply.abs().max(load.abs()).max(self.least_charge(settings) * settings.circuit.supply_voltage)
    }

    /// Charge, C, that charging and release diode leak by the end of the run. Ideal ones do not.
    pub fn leaked_charge(&self, settings: &Settings) -> f64 {
        2.0 * settings.diode.saturation_current * self.table.until()
    }
}

/// The same C(t) with rows no further apart than `spacing`, s.
fn refined(table: &CapacitanceTable, spacing: f64) -> Result<CapacitanceTable, NgspiceError> {
    let mut refined = CapacitanceTable::default();
    refined.push(0.0, table.initial())?;
    for ((start, a), (end, b)) in table.rows().zip(table.rows().skip(1)) {
        let pieces = ((end - start) / spacing).ceil().max(1.0);
        let mut k = 1.0;
        while k < pieces {
            let part = k / pieces;
            refined.push(start + (end - start) * part, [0, 1].map(|j| a[j] + (b[j] - a[j]) * part))?;
            k += 1.0;
        }
        refined.push(end, b)?;
    }
    Ok(refined)
}
