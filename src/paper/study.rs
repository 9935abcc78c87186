//! The harvester FMU of the items, and runs of it on all cores.

use super::PaperError;
use crate::cosim::{Averages, Gains, read, references};
use crate::progress::Progress;
use crate::scenario::{Request, Setting};
use crate::threads;
use fmu_import::{Fmu, Instance, Logging};

/// Size of the large ensembles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Effort {
    /// As many samples as the paper, and fine grids.
    #[default]
    Full,
    /// Fewer samples and coarser grids, for a look.
    Quick,
}

impl Effort {
    pub(super) fn of<T>(self, full: T, quick: T) -> T {
        match self {
            Self::Full => full,
            Self::Quick => quick,
        }
    }
}

/// The harvester FMU, the effort and the observer of all items.
pub struct Study<'a> {
    /// The harvester FMU.
    pub fmu: &'a Fmu,
    /// Size of the large ensembles.
    pub effort: Effort,
    /// Follows the parts of the present item.
    pub observer: &'a dyn Progress,
}

/// A run of the harvester from 0 s to the end of an averaging window.
#[derive(Debug, Clone)]
pub struct Run {
    /// Settings that differ from the start values of the FMU.
    pub settings: Vec<Setting>,
    /// Averaging window, s; the run ends with it.
    pub window: [f64; 2],
}

impl Study<'_> {
    /// Averages of each run, in their order; the error is that of the first run that failed.
    pub fn averages(&self, runs: &[Run]) -> Result<Vec<Averages>, PaperError> {
        self.each(runs, |run| self.average(run))
    }

    /// Settings of a case of the paper.
    pub(super) fn case(name: &str) -> Result<Vec<Setting>, PaperError> {
        Ok(Request { case: Some(name.to_owned()), ..Request::default() }.resolve()?.settings)
    }

    /// An instance with `settings`, initialised at 0 s.
    pub(super) fn start(&self, settings: &[Setting]) -> Result<Instance, PaperError> {
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

    /// Values of variables of an instance, in the order of `names`.
    pub(super) fn reals<const N: usize>(&self, instance: &Instance, names: [&str; N]) -> Result<[f64; N], PaperError> {
        Ok(read(instance, &references(self.fmu, names)?)?)
    }

    /// `z_M - z_m`, m, and its rate, m/s.
    pub(super) fn relative_motion(&self, instance: &Instance) -> Result<[f64; 2], PaperError> {
        let [displacement, cylinder, ball] =
            self.reals(instance, ["relativeDisplacement", "cylinder.velocity", "ball.velocity"])?;
        Ok([displacement, cylinder - ball])
    }

    /// The sums that averages are made of.
    pub(super) fn gains(&self, instance: &Instance) -> Result<Gains, PaperError> {
        let [voltage, energy] = self.reals(instance, ["gain.voltage", "gain.energyEq13"])?;
        let (count, mut impacts) = (self.fmu.description().variable("impact.count")?, [0]);
        instance.get_integer(&[count.value_reference], &mut impacts)?;
        Ok(Gains { voltage, energy, impacts: impacts[0] })
    }

    /// Does `work` for each of `tasks` on all cores; results are in the order of the tasks. The error is that of
    /// the first task that failed.
    pub(super) fn each<T: Sync, R: Send>(
        &self,
        tasks: &[T],
        work: impl Fn(&T) -> Result<R, PaperError> + Send + Sync,
    ) -> Result<Vec<R>, PaperError> {
        threads::map(tasks, self.observer, work)
    }

    fn average(&self, run: &Run) -> Result<Averages, PaperError> {
        let [from, to] = run.window;
        let mut instance = self.start(&run.settings)?;
        if from > 0.0 {
            instance.do_step(0.0, from)?;
        }
        let before = self.gains(&instance)?;
        instance.do_step(from, to - from)?;
        let after = self.gains(&instance)?;
        instance.terminate()?;
        Ok(Averages::over(run.window, &before, &after))
    }
}
