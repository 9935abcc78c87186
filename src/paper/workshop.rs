//! What the items work with: the harvester FMU, and runs of it on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::PaperError;
use crate::cosim::{Averages, Gains};
use crate::scenario::{Request, Setting};
use crate::threads;
use fmu_import::{Fmu, Instance, Logging};

/// How much work the large ensembles may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Effort {
    /// As many samples as the paper, and fine grids.
    #[default]
    Full,
    /// Fewer samples and coarser grids, for a look.
    Quick,
}

/// Watches the work.
pub trait Watch: Sync {
    /// Of `total` parts of the present item, `done` are done.
    fn show(&self, done: usize, total: usize);
}

/// Nobody watches.
impl Watch for () {
    fn show(&self, _done: usize, _total: usize) {}
}

/// What the items work with.
pub struct Workshop<'a> {
    /// The harvester FMU.
    pub fmu: &'a Fmu,
    /// How much work the large ensembles may be.
    pub effort: Effort,
    /// Who watches.
    pub watch: &'a dyn Watch,
}

/// A run of the harvester from 0 s, of which averages are wanted.
#[derive(Debug, Clone)]
pub struct Run {
    /// What differs from the start values of the FMU.
    pub settings: Vec<Setting>,
    /// Averaging window, s; the run ends with it.
    pub window: [f64; 2],
}

impl Workshop<'_> {
    /// Averages of each run, in their order.
    ///
    /// # Errors
    /// The first that failed, in their order.
    pub fn averages(&self, runs: &[Run]) -> Result<Vec<Averages>, PaperError> {
        self.each(runs, |run| self.average(run))
    }

    /// Settings of a case of the paper.
    ///
    /// # Errors
    /// No such case.
    pub fn case(&self, name: &str) -> Result<Vec<Setting>, PaperError> {
        Ok(Request { case: Some(name.to_owned()), ..Request::default() }.resolve()?.settings)
    }

    /// Values of variables of an instance, in the order of `names`.
    ///
    /// # Errors
    /// If the FMU has no such variable, or it is no real number.
    pub fn reals<const N: usize>(&self, instance: &Instance, names: [&str; N]) -> Result<[f64; N], PaperError> {
        let references = names.iter().map(|name| self.reference(name)).collect::<Result<Vec<_>, _>>()?;
        let mut values = [0.0; N];
        instance.get_real(&references, &mut values)?;
        Ok(values)
    }

    /// An instance with `settings`, initialised at 0 s.
    ///
    /// # Errors
    /// A setting that the FMU refuses.
    pub fn start(&self, settings: &[Setting]) -> Result<Instance, PaperError> {
        let mut instance = self.fmu.instantiate("harvester", Logging::default())?;
        instance.begin_initialization(
            0.0,
            None,
            settings,
            |it| self.fmu.description().is_input(&it.name),
            |instance, setting| instance.set_by_name(&setting.name, &setting.value),
        )?;
        instance.exit_initialization_mode()?;
        Ok(instance)
    }

    /// Value reference of the variable called `name`.
    ///
    /// # Errors
    /// If the FMU has no such variable.
    pub fn reference(&self, name: &str) -> Result<u32, PaperError> {
        Ok(self.fmu.description().variable(name)?.value_reference)
    }

    /// Does `work` for each of `tasks` on all cores; the results come in the order of the tasks, whoever did them.
    ///
    /// # Errors
    /// The first that failed, in their order.
    pub fn each<T: Sync, R: Send>(
        &self,
        tasks: &[T],
        work: impl Fn(&T) -> Result<R, PaperError> + Sync,
    ) -> Result<Vec<R>, PaperError> {
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let results = Mutex::new((0..tasks.len()).map(|_| None).collect::<Vec<_>>());
        threads::share(cores.min(tasks.len()), || {
            while let Some((index, task)) = {
                let index = next.fetch_add(1, Ordering::Relaxed);
                tasks.get(index).map(|task| (index, task))
            } {
                let result = work(task);
                let failed = result.is_err();
                results.lock().unwrap_or_else(PoisonError::into_inner)[index] = Some(result);
                if failed {
                    next.store(tasks.len(), Ordering::Relaxed); // the rest is of no use
                }
                self.watch.show(done.fetch_add(1, Ordering::Relaxed) + 1, tasks.len());
            }
        });
        // Tasks are taken in order: what was left out stands behind an error.
        results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect()
    }

    fn average(&self, run: &Run) -> Result<Averages, PaperError> {
        let [from, to] = run.window;
        let mut instance = self.start(&run.settings)?;
        let sums = [self.reference("gain.voltage")?, self.reference("gain.energyEq13")?];
        let impacts = [self.reference("impact.count")?];
        let read = |instance: &Instance| -> Result<Gains, PaperError> {
            let (mut values, mut count) = ([0.0; 2], [0]);
            instance.get_real(&sums, &mut values)?;
            instance.get_integer(&impacts, &mut count)?;
            Ok(Gains { voltage: values[0], energy: values[1], impacts: count[0] })
        };
        if from > 0.0 {
            instance.do_step(0.0, from)?;
        }
        let before = read(&instance)?;
        instance.do_step(from, to - from)?;
        let after = read(&instance)?;
        instance.terminate()?;
        Ok(Averages::over(run.window, &before, &after))
    }
}
