//! A run of the harvester alone: the mechanics, C(t), the gains that the paper counts, and the contacts.

mod contacts;
mod table;

pub use contacts::{ContactSummary, Contacts};
pub use table::{Column, Points, Table, TableError, TableOptions, table};

use crate::cosim::{
    CircuitRequest, CosimError, Coupling, Flows, HarvesterFmu, Master, MechanicsSummary, Observer, Outcome,
    TimeProgress, Trace, instantiate,
};
use crate::progress::Progress;
use crate::scenario::Scenario;
use fmu_import::{Fmu, Instance};

/// What to run.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// The FMU `VibroImpactHarvester`.
    pub harvester: &'a Fmu,
    /// The case with its settings. Those of a circuit are left out with a warning.
    pub scenario: &'a Scenario,
}

/// Results of a run.
#[derive(Debug)]
pub struct Results {
    /// Impacts and gains.
    pub mechanics: MechanicsSummary,
    /// Mean flows of energy over the averaging window.
    pub flows: Flows,
    /// How long the membranes were deflected, and how far.
    pub contacts: Contacts,
    /// Warnings about the validity of the numbers.
    pub warnings: Vec<String>,
    /// What a figure shows.
    pub trace: Trace,
}

/// Runs the harvester alone.
///
/// # Errors
/// A setting that neither harvester nor circuit takes; errors of the FMU.
pub fn run(options: &Options<'_>, progress: &dyn Progress) -> Result<Results, CosimError> {
    Simulation::new(options)?.run(&mut (), progress)
}

/// An instance of the FMU `VibroImpactHarvester` in `scenario`, initialised at 0 s, for a caller who steps it to any time.
///
/// # Errors
/// A setting that the harvester does not take.
pub fn instance(harvester: &Fmu, scenario: &Scenario) -> Result<Instance, CosimError> {
    instantiate(harvester, None, &scenario.settings)
}

/// A simulation, initialised and ready to run.
pub struct Simulation<'a> {
    master: Master,
    scenario: &'a Scenario,
    circuit: CircuitRequest,
}

impl<'a> Simulation<'a> {
    /// Initialises the harvester.
    pub fn new(options: &Options<'a>) -> Result<Self, CosimError> {
        let &Options { harvester: fmu, scenario } = options;
        let (mechanical, circuit) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
        let harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
        Ok(Self { master: Master::new(harvester, Vec::new(), scenario, Coupling::default())?, scenario, circuit })
    }

    /// Runs to the end and shows each communication point to `recorder`.
    pub fn run(self, recorder: &mut dyn Observer, progress: &dyn Progress) -> Result<Results, CosimError> {
        let Self { master, scenario, circuit } = self;
        let (mut trace, mut time) = (Trace::of(scenario), TimeProgress::new(progress, scenario.until));
        let mut contacts = Contacts::new(trace.detail_from());
        let outcome = master.run(&mut [recorder, &mut trace, &mut contacts, &mut time])?;
        let Outcome { mechanics, flows, mut warnings, .. } = outcome;
        warnings.extend(circuit.names().map(|names| format!("{names} left out: simulate runs no circuit, cosim does")));
        Ok(Results { mechanics, flows, contacts, warnings, trace })
    }
}
