//! Runs circuits in the solvers, several at once.

use std::path::Path;

use videg_circuit::Settings;

use super::solver::Solver;
use super::stop::{Repeat, Stop};
use crate::cosim::{CircuitSample, CircuitSlave as _, NgspiceCircuit};
use crate::ngspice::{CapacitanceTable, Elements, Ngspice, NgspiceError, Run, SolverRun, Waveforms};
use crate::progress::Progress;
use crate::threads::{self, Task};

/// The programs of ngspice.
#[derive(Debug, Clone, Copy)]
pub struct Solvers<'a> {
    /// ngspice as a program.
    pub ngspice: &'a Ngspice,
    /// The command-line tool of this crate, which runs ngspice's shared library.
    pub program: &'a Path,
}

/// A circuit to run in a solver.
pub struct Job<'a> {
    /// For the progress bar and for messages.
    pub name: String,
    /// The solver.
    pub solver: Solver,
    /// The circuit; the solver determines its diodes.
    pub settings: Settings,
    /// C(t).
    pub table: &'a CapacitanceTable,
    /// What cannot be judged if ngspice stops.
    pub open: Vec<String>,
    /// Whether only the last row of the waveforms is needed.
    pub last_row: bool,
}

/// The result of a job, as far as the solver got.
pub struct JobResult {
    /// The waveforms, or their last row.
    pub waveforms: Waveforms,
    /// Number of rows of the table that were reached.
    pub rows: usize,
    /// Where ngspice stopped.
    pub stop: Option<Stop>,
    /// Changes with which ngspice was repeated.
    pub repeats: Vec<Repeat>,
}

impl Solvers<'_> {
    /// Runs `jobs` on all cores; results in the same order.
    pub fn run_all(&self, jobs: Vec<Job<'_>>, progress: &dyn Progress) -> Result<Vec<JobResult>, NgspiceError> {
        let tasks = jobs.into_iter().map(|job| Task::new(job.name.clone(), move |part| self.job(&job, part)));
        threads::run(&tasks.collect::<Vec<_>>(), progress)
    }

    fn job(&self, job: &Job<'_>, progress: &dyn Fn(f64)) -> Result<JobResult, NgspiceError> {
        let mut run = self.run(job.solver, &job.settings, job.table, progress)?;
        let stop = Stop::of(&job.name, &run, job.table.until(), &job.open);
        let repeats = Repeat::of(&job.name, &run).collect();
        let rows = run.waveforms.samples.len();
        if job.last_row {
            run.waveforms.keep_last();
        }
        Ok(JobResult { waveforms: run.waveforms, rows, stop, repeats })
    }

    /// Runs the circuit of `settings` over `table` in `solver`, with the diodes of the solver, as far as the solver
    /// gets; `progress` gets the part that is done.
    pub fn run(
        &self,
        solver: Solver,
        settings: &Settings,
        table: &CapacitanceTable,
        progress: &dyn Fn(f64),
    ) -> Result<SolverRun, NgspiceError> {
        let parameters = Settings { exponential: solver != Solver::Ideal, ..*settings }.parameters();
        if matches!(solver, Solver::Ideal | Solver::Exponential) {
            return Waveforms::embedded(&parameters, table).map(SolverRun::from);
        }
        let (elements, run) = (Elements::new(&parameters, table.growth())?, Run::new(table.until(), table.growth()));
        if solver == Solver::Batch {
            return self.ngspice.follow(&elements, table, &run, progress);
        }
        let mut found = self.live(&elements, table, &run, progress)?;
        for (change, changed) in run.changed() {
            if !found.stop.as_ref().is_some_and(NgspiceError::is_step_too_small) {
                break;
            }
            let mut repeated = found.repeated;
            repeated.push(format!("{change} from 0 s to {} s", table.until()));
            found = SolverRun { repeated, ..self.live(&elements, table, &changed, progress)? };
        }
        Ok(found)
    }

    /// Steps the shared library from row to row of the table.
    fn live(
        &self,
        elements: &Elements,
        table: &CapacitanceTable,
        run: &Run,
        progress: &dyn Fn(f64),
    ) -> Result<SolverRun, NgspiceError> {
        let mut found = SolverRun::default();
        let circuit = NgspiceCircuit::new(Solver::Live.name(), self.program, elements, table.initial(), run);
        let mut circuit = match circuit.map_err(NgspiceError::from) {
            Ok(circuit) => circuit,
            Err(error) if error.is_stop() => {
                let voltage = [elements.circuit().supply_voltage; 2];
                found.waveforms.push(0.0, CircuitSample { voltage, ..CircuitSample::default() });
                found.stop = Some(error);
                return Ok(found);
            }
            Err(error) => return Err(error),
        };
        found.waveforms.push(0.0, circuit.sample()?);
        for ((time, start), (next, end)) in table.rows().zip(table.rows().skip(1)) {
            match circuit.step(time, next - time, start, end).map_err(NgspiceError::from) {
                Ok(()) => found.waveforms.push(next, circuit.sample()?),
                Err(error) if error.is_stop() => {
                    found.stop = Some(error);
                    break;
                }
                Err(error) => return Err(error),
            }
            progress(next / table.until());
        }
        Ok(found)
    }
}
