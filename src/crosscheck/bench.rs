//! Runs circuits in the solvers, several at once.

use std::path::Path;

use videg_circuit::Settings;

use crate::cosim::{CircuitSlave as _, NgspiceCircuit};
use crate::ngspice::{CapacitanceTable, Elements, Ngspice, NgspiceError, Outcome, Run, Waveforms};
use crate::threads;

/// What solves a circuit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// The embedded solver with ideal diodes: exact.
    Ideal,
    /// The embedded solver with ngspice's diodes.
    Exponential,
    /// The program ngspice.
    Batch,
    /// ngspice's shared library, step by step.
    Live,
}

impl Solver {
    /// All, in the order of the tables.
    pub const ALL: [Self; 4] = [Self::Ideal, Self::Exponential, Self::Batch, Self::Live];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ideal => "embedded, ideal diodes",
            Self::Exponential => "embedded, exponential diodes",
            Self::Batch => "ngspice, batch",
            Self::Live => "ngspice, live",
        }
    }

    /// Name in CSV columns and keys.
    pub fn key(self) -> &'static str {
        match self {
            Self::Ideal => "embedded_ideal",
            Self::Exponential => "embedded_exponential",
            Self::Batch => "ngspice_batch",
            Self::Live => "ngspice_live",
        }
    }
}

/// Hears which part of a run is done, from 0 to 1.
pub type Progress<'a> = &'a dyn Fn(f64);

/// What every run of a crosscheck has in common.
#[derive(Debug, Clone, Copy)]
pub struct Bench<'a> {
    /// C(t).
    pub table: &'a CapacitanceTable,
    /// ngspice as a program.
    pub ngspice: &'a Ngspice,
    /// The command-line tool of this crate, which runs ngspice's shared library.
    pub program: &'a Path,
}

impl Bench<'_> {
    /// Runs the circuit of `settings` over the table in `solver`, whatever diodes the settings choose, as far as the solver
    /// gets; `progress` hears which part is done.
    ///
    /// # Errors
    /// Anything but that ngspice stops.
    pub fn run(&self, solver: Solver, settings: &Settings, progress: Progress<'_>) -> Result<Outcome, NgspiceError> {
        let parameters = Settings { exponential: solver != Solver::Ideal, ..*settings }.parameters();
        match solver {
            Solver::Ideal | Solver::Exponential => Waveforms::embedded(&parameters, self.table).map(Outcome::from),
            Solver::Batch => {
                let run = Run::new(self.table.until(), self.table.growth());
                self.ngspice.follow(&Elements::new(&parameters, self.table.growth())?, self.table, &run, progress)
            }
            Solver::Live => self.live(&Elements::new(&parameters, self.table.growth())?, progress),
        }
    }

    /// Steps the shared library from row to row of the table, again with changes where it finds no way on.
    fn live(&self, elements: &Elements, progress: Progress<'_>) -> Result<Outcome, NgspiceError> {
        let run = Run::new(self.table.until(), self.table.growth());
        let mut outcome = self.attempt(elements, &run, progress)?;
        for (change, changed) in run.changed() {
            if !outcome.stop.as_ref().is_some_and(NgspiceError::is_lost) {
                break;
            }
            let again = self.attempt(elements, &changed, progress)?;
            outcome.repeated.push(format!("{change} from 0 s to {} s", self.table.until()));
            outcome = Outcome { repeated: outcome.repeated, ..again };
        }
        Ok(outcome)
    }

    fn attempt(&self, elements: &Elements, run: &Run, progress: Progress<'_>) -> Result<Outcome, NgspiceError> {
        let name = Solver::Live.name();
        let mut circuit = NgspiceCircuit::new(name, self.program, elements, self.table.initial(), run)?;
        let mut samples = vec![circuit.sample()?];
        let rows = self.table.rows().zip(self.table.rows().skip(1));
        let mut stop = None;
        for ((time, start), (next, end)) in rows {
            if let Err(error) = circuit.step(time, next - time, start, end) {
                stop = Some(NgspiceError::from(error));
                break;
            }
            samples.push(circuit.sample()?);
            progress(next / self.table.until());
        }
        match stop {
            Some(error) if !error.is_stop() => Err(error),
            stop => {
                let time = self.table.times()[..samples.len()].to_vec();
                Ok(Outcome { waveforms: Waveforms { time, samples, points: None }, repeated: Vec::new(), stop })
            }
        }
    }
}

/// One of the runs that are shared among threads.
pub(crate) type Task<'a, T> = threads::Task<'a, T, NgspiceError>;
