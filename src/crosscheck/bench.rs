//! Runs circuits in the solvers, several at once.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use videg_circuit::Settings;

use crate::cosim::{CircuitSlave as _, NgspiceCircuit};
use crate::ngspice::{CapacitanceTable, Elements, Ngspice, NgspiceError, Run, Waveforms};
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
    /// Runs the circuit of `settings` over the whole table in `solver`, whatever diodes the settings choose.
    ///
    /// # Errors
    /// What the solver says.
    pub fn run(&self, solver: Solver, settings: &Settings) -> Result<Waveforms, NgspiceError> {
        let parameters = Settings { exponential: solver != Solver::Ideal, ..*settings }.parameters();
        match solver {
            Solver::Ideal | Solver::Exponential => Waveforms::embedded(&parameters, self.table),
            Solver::Batch => {
                let run = Run::new(self.table.until(), self.table.growth());
                self.ngspice.simulate(&Elements::new(&parameters, self.table.growth())?, self.table, &run)
            }
            Solver::Live => self.live(&Elements::new(&parameters, self.table.growth())?),
        }
    }

    /// Steps the shared library from row to row of the table.
    fn live(&self, elements: &Elements) -> Result<Waveforms, NgspiceError> {
        let run = Run::new(self.table.until(), self.table.growth());
        let name = Solver::Live.name();
        let mut circuit = NgspiceCircuit::new(name, self.program, elements, self.table.initial(), &run)?;
        let mut samples = vec![circuit.sample()?];
        let rows = self.table.rows().zip(self.table.rows().skip(1));
        for ((time, start), (next, end)) in rows {
            circuit.step(time, next - time, start, end)?;
            samples.push(circuit.sample()?);
        }
        Ok(Waveforms { time: self.table.times().to_vec(), samples, points: None })
    }
}

/// Something to do, with a name for the progress bar.
pub struct Task<'a, T> {
    name: String,
    work: Box<dyn FnOnce() -> Result<T, NgspiceError> + Send + 'a>,
}

impl<'a, T> Task<'a, T> {
    /// A task.
    pub fn new(name: impl Into<String>, work: impl FnOnce() -> Result<T, NgspiceError> + Send + 'a) -> Self {
        Self { name: name.into(), work: Box::new(work) }
    }
}

/// Follows the tasks: their number, how many are done, names of those that run.
pub trait Watch: Sync {
    /// A task has begun or ended.
    fn show(&self, total: usize, done: usize, running: &[&str]);
}

/// Nobody watches.
impl Watch for () {
    fn show(&self, _total: usize, _done: usize, _running: &[&str]) {}
}

/// What the threads share.
struct Queue<'a, T> {
    waiting: VecDeque<(usize, Task<'a, T>)>,
    running: Vec<(usize, String)>,
    results: Vec<Option<T>>,
    done: usize,
    failure: Option<NgspiceError>,
}

/// Runs `tasks` on as many threads as the machine has cores, the first ones first; results in the same order.
///
/// # Errors
/// That of the first task that fails; tasks that have not begun by then are left.
pub fn in_parallel<T: Send>(tasks: Vec<Task<'_, T>>, watch: &dyn Watch) -> Result<Vec<T>, NgspiceError> {
    let total = tasks.len();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let queue = Mutex::new(Queue {
        waiting: tasks.into_iter().enumerate().collect(),
        running: Vec::new(),
        results: std::iter::repeat_with(|| None).take(total).collect(),
        done: 0,
        failure: None,
    });
    threads::share(cores.min(total), || work_off(&queue, total, watch));
    let queue = queue.into_inner().unwrap_or_else(PoisonError::into_inner);
    match queue.failure {
        Some(failure) => Err(failure),
        None => Ok(queue.results.into_iter().flatten().collect()),
    }
}

fn work_off<T>(queue: &Mutex<Queue<'_, T>>, total: usize, watch: &dyn Watch) {
    let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let show = |queue: &Queue<'_, T>| {
        let names: Vec<&str> = queue.running.iter().map(|(_, name)| name.as_str()).collect();
        watch.show(total, queue.done, &names);
    };
    loop {
        let mut held = lock();
        let Some((index, task)) = held.waiting.pop_front() else { return };
        held.running.push((index, task.name));
        show(&held);
        drop(held);
        let result = (task.work)();
        let mut held = lock();
        held.running.retain(|(other, _)| *other != index);
        held.done += 1;
        match result {
            Ok(result) => held.results[index] = Some(result),
            Err(error) => {
                held.waiting.clear();
                held.failure.get_or_insert(error);
            }
        }
        show(&held);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_tasks() {
        let tasks = (0..20).map(|k| Task::new(format!("{k}"), move || Ok(k))).collect();
        assert_eq!(in_parallel(tasks, &()).unwrap(), (0..20).collect::<Vec<_>>());
    }

    #[test]
    fn the_failure_of_a_task_is_the_failure_of_all() {
        let fail = || Err::<i32, _>(NgspiceError::Table { row: 7, reason: "test".to_owned() });
        let tasks = vec![Task::new("good", || Ok(1)), Task::new("bad", fail), Task::new("good", || Ok(2))];
        assert!(in_parallel(tasks, &()).unwrap_err().to_string().contains("row 7"));
    }
}
