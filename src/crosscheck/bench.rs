//! Runs circuits in the solvers, several at once.

use std::cell::Cell;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

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

type Work<'a, T> = Box<dyn FnOnce(Progress<'_>) -> Result<T, NgspiceError> + Send + 'a>;

/// Something to do, with a name for the progress bar.
pub struct Task<'a, T> {
    name: String,
    work: Work<'a, T>,
}

impl<'a, T> Task<'a, T> {
    /// A task.
    pub fn new(
        name: impl Into<String>,
        work: impl FnOnce(Progress<'_>) -> Result<T, NgspiceError> + Send + 'a,
    ) -> Self {
        Self { name: name.into(), work: Box::new(work) }
    }
}

/// Follows the tasks: their number, how many are done, those that run.
pub trait Watch: Sync {
    /// A task has begun or ended, or got further by a percent.
    fn show(&self, total: usize, done: usize, running: &[Running]);
}

/// Nobody watches.
impl Watch for () {
    fn show(&self, _total: usize, _done: usize, _running: &[Running]) {}
}

/// A task that runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Running {
    /// Its name.
    pub name: String,
    /// How much of it is done, where it tells.
    pub percent: Option<u8>,
    index: usize,
}

/// What the threads share.
struct Queue<'a, T> {
    waiting: VecDeque<(usize, Task<'a, T>)>,
    running: Vec<Running>,
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

/// A part, from 0 to 1, in whole percent.
fn percent(part: f64) -> u8 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 0 to 100
    let percent = (100.0 * part.clamp(0.0, 1.0)) as u8;
    percent
}

fn work_off<T>(queue: &Mutex<Queue<'_, T>>, total: usize, watch: &dyn Watch) {
    let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let show = |queue: &Queue<'_, T>| watch.show(total, queue.done, &queue.running);
    loop {
        let mut held = lock();
        let Some((index, task)) = held.waiting.pop_front() else { return };
        held.running.push(Running { name: task.name, percent: None, index });
        show(&held);
        drop(held);
        let shown = Cell::new(None);
        let result = (task.work)(&|part| {
            let percent = percent(part);
            // A run in steps tells after each.
            if shown.replace(Some(percent)) != Some(percent) {
                let mut held = lock();
                held.running
                    .iter_mut()
                    .filter(|task| task.index == index)
                    .for_each(|task| task.percent = Some(percent));
                show(&held);
            }
        });
        let mut held = lock();
        held.running.retain(|task| task.index != index);
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
        let tasks = (0..20).map(|k| Task::new(format!("{k}"), move |_| Ok(k))).collect();
        assert_eq!(in_parallel(tasks, &()).unwrap(), (0..20).collect::<Vec<_>>());
    }

    #[test]
    fn the_failure_of_a_task_is_the_failure_of_all() {
        let fail = |_: Progress<'_>| Err::<i32, _>(NgspiceError::Table { row: 7, reason: "test".to_owned() });
        let tasks = vec![Task::new("good", |_| Ok(1)), Task::new("bad", fail), Task::new("good", |_| Ok(2))];
        assert!(in_parallel(tasks, &()).unwrap_err().to_string().contains("row 7"));
    }

    #[test]
    fn tasks_tell_how_far_they_are_and_are_named_once_a_percent() {
        #[derive(Default)]
        struct Log(Mutex<Vec<Option<u8>>>);
        impl Watch for Log {
            fn show(&self, total: usize, done: usize, running: &[Running]) {
                assert_eq!(total, 1);
                let percent = running.iter().map(|task| task.percent);
                self.0.lock().unwrap().extend(percent.filter(|_| done == 0));
            }
        }
        let log = Log::default();
        let work = |progress: Progress<'_>| {
            (0..=1000_u32).for_each(|k| progress(f64::from(k) / 1000.0));
            Ok(())
        };
        in_parallel(vec![Task::new("long", work)], &log).unwrap();
        let expected: Vec<_> = std::iter::once(None).chain((0..=100).map(Some)).collect();
        assert_eq!(*log.0.lock().unwrap(), expected);
    }
}
