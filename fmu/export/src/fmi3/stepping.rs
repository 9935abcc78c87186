//! `fmi3DoStep`, which may call the importer back while no reference to the instance is alive, so that it may read.

use super::Function;
use crate::ffi::{check_array, enter, showing, with};
use crate::instance::{Call, Instance, Progress, StepOutcome, UnderWay};
use crate::slave::Slave;
use fmu_abi::fmi3::{
    fmi3Boolean, fmi3False, fmi3Float64, fmi3Instance, fmi3InstanceEnvironment, fmi3IntermediateUpdateCallback,
    fmi3Status, fmi3True,
};

/// Where the outcome goes.
#[derive(Clone, Copy)]
struct Outputs {
    event: *mut fmi3Boolean,
    terminate: *mut fmi3Boolean,
    early: *mut fmi3Boolean,
    time: *mut fmi3Float64,
}

impl Outputs {
    #[inline]
    fn check(self) -> Call {
        let Self { event, terminate, early, time } = self;
        let there = [event, terminate, early].iter().all(|flag| !flag.is_null()) && !time.is_null();
        if there && time.is_aligned() { Ok(()) } else { self.complain() }
    }

    #[cold]
    fn complain(self) -> Call {
        check_array(self.event, 1, "eventHandlingNeeded")?;
        check_array(self.terminate, 1, "terminateSimulation")?;
        check_array(self.early, 1, "earlyReturn")?;
        check_array(self.time, 1, "lastSuccessfulTime")
    }

    /// SAFETY: they are checked, and by contract there is room for one value each.
    unsafe fn write(self, outcome: StepOutcome) {
        unsafe {
            self.event.write(outcome.event.into());
            self.terminate.write(outcome.terminate.into());
            self.early.write(outcome.early.into());
            self.time.write(outcome.time);
        }
    }
}

/// What the importer is called with.
struct Update {
    step: UnderWay,
    callback: fmi3IntermediateUpdateCallback,
    environment: fmi3InstanceEnvironment,
    can_return_early: bool,
}

impl Update {
    /// Lets the importer look. A step that may end early does so here, whether it is asked to or not.
    unsafe fn show(&self) {
        let Some(callback) = self.callback else { return };
        let (mut wants, mut time) = (fmi3False, self.step.time());
        let (set, get, finished, can_return_early) = (fmi3False, fmi3True, fmi3True, self.can_return_early.into());
        // SAFETY: the callback came from the importer with this environment.
        unsafe {
            callback(self.environment, time, set, get, finished, can_return_early, &raw mut wants, &raw mut time);
        }
    }
}

/// `fmi3DoStep`
#[allow(clippy::too_many_arguments)] // Those of the C function.
pub unsafe fn fmi3DoStep<S: Slave>(
    instance: fmi3Instance,
    t: fmi3Float64,
    h: fmi3Float64,
    _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
    event: *mut fmi3Boolean,
    terminate: *mut fmi3Boolean,
    early: *mut fmi3Boolean,
    time: *mut fmi3Float64,
) -> fmi3Status {
    let outputs = Outputs { event, terminate, early, time };
    let mut in_parts = false;
    let step = |i: &mut Instance<S>| {
        outputs.check()?;
        if i.session().wants_events() {
            in_parts = true;
            return Ok(());
        }
        // SAFETY: checked above.
        i.step_through(t, h, |outcome| unsafe { outputs.write(outcome) })
    };
    // SAFETY: contract of this module; so below.
    let status = unsafe { enter(instance, Function::DoStep.row(), step) };
    if in_parts { unsafe { step_in_parts::<S>(instance, t, h, outputs) } } else { status }
}

/// A step from one point where the importer may look to the next.
#[inline(never)]
unsafe fn step_in_parts<S: Slave>(instance: fmi3Instance, t: f64, h: f64, outputs: Outputs) -> fmi3Status {
    let mut update = None;
    let begin = |i: &mut Instance<S>| {
        let progress = i.begin_step(t, h)?;
        update = follow(i, progress, outputs);
        Ok(())
    };
    let name = Function::DoStep.name();
    // SAFETY: contract of this module; so below.
    let mut status = unsafe { with(instance, |i: &mut Instance<S>| i.guarded(name, begin)) };
    while let Some(shown) = update.take() {
        unsafe { showing::<S>(instance, || shown.show()) };
        let resume = |i: &mut Instance<S>| {
            let progress = i.resume_step(shown.step)?;
            update = follow(i, progress, outputs);
            Ok(())
        };
        let resumed = unsafe { with(instance, |i: &mut Instance<S>| i.guarded(name, resume)) };
        status = status.max(resumed); // a warning stays
    }
    status
}

/// Hands the outcome over, or makes what the importer is to be called with.
fn follow<S: Slave>(i: &Instance<S>, progress: Progress, outputs: Outputs) -> Option<Update> {
    match progress {
        Progress::Ended(outcome) => {
            // SAFETY: `fmi3DoStep` has checked them.
            unsafe { outputs.write(outcome) };
            None
        }
        Progress::Update(step) => {
            let session = i.session();
            let (callback, environment) = (session.intermediate_update, session.environment);
            Some(Update { step, callback, environment, can_return_early: session.early_return })
        }
    }
}
