//! ngspice as a circuit that the master can step: the shared library, in a process of its own.

use std::path::Path;
use std::time::Duration;

use super::{CircuitSample, CircuitSlave, CosimError};
use crate::ngspice::live::{Job, Ramp, Worker};
use crate::ngspice::{CapacitanceSource, Elements, NgspiceError, PICO, Run, TrapezoidalLedger};

/// Real time that ngspice may take from one communication point to the next. It takes some 10 us for a time step of its
/// own; a step of this length hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// The circuit in ngspice, which takes its own time steps between the communication points.
pub struct NgspiceCircuit {
    label: String,
    worker: Worker,
    ledger: TrapezoidalLedger,
}

impl NgspiceCircuit {
    /// A circuit of `elements` for the time from 0 to `run.until`, s, both membranes charged, at `capacitance` (left,
    /// right), F. `program` is the command-line tool of this crate, which runs the shared library of ngspice.
    ///
    /// # Errors
    /// A number that cannot be put into a netlist, or a program that cannot be started.
    pub fn new(
        label: &str,
        program: &Path,
        elements: &Elements,
        capacitance: [f64; 2],
        run: &Run,
    ) -> Result<Self, CosimError> {
        let netlist = elements.netlist(CapacitanceSource::External, capacitance, run);
        let netlist = netlist.map_err(|cause| failed(label, cause))?;
        let job = Job {
            netlist: netlist.text().lines().map(str::to_owned).collect(),
            sources: vec!["vcl".to_owned(), "vcr".to_owned()],
            vectors: elements.vectors().iter().map(|&name| name.to_owned()).collect(),
            longest_step: run.max_step,
            // Not the end of the run: there ngspice would end the analysis without a word.
            stop: 2.0 * run.until,
        };
        let worker = Worker::start(program, &job, PATIENCE).map_err(|cause| failed(label, cause))?;
        Ok(Self { label: label.to_owned(), worker, ledger: TrapezoidalLedger::new(elements, capacitance) })
    }
}

fn failed(label: &str, cause: impl Into<NgspiceError>) -> CosimError {
    CosimError::Ngspice { label: label.to_owned(), cause: Box::new(cause.into()) }
}

impl CircuitSlave for NgspiceCircuit {
    fn label(&self) -> &str {
        &self.label
    }

    fn step(&mut self, time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError> {
        let pico = |capacitance: [f64; 2]| capacitance.map(|c| c / PICO).to_vec();
        let ramp = Ramp { from: time, to: time + step, start: pico(start), end: pico(end) };
        let ledger = &mut self.ledger;
        self.worker.step(&ramp, |time, values| ledger.add(time, values)).map_err(|cause| failed(&self.label, cause))
    }

    fn sample(&self) -> Result<CircuitSample, CosimError> {
        Ok(self.ledger.sample())
    }
}
