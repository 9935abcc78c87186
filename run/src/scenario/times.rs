//! End, communication step and averaging window of a run.

use super::{CaseFile, Request, ScenarioError};

/// Duration of a run unless something else is asked for, s: that of the paper (Section 4.2).
const DEFAULT_UNTIL: f64 = 100.0;
/// Communication step unless something else is asked for, s.
const DEFAULT_STEP: f64 = 1e-3;
/// Bounds of the duration, s: below, a figure cannot show it; above, times lose their digits.
const SHORTEST: f64 = 1e-6;
const LONGEST: f64 = 1e9;
/// Largest number of communication points of the grid: 1e9 rows are 240 to 480 GB of CSV.
const MAX_STEPS: f64 = 1e9;

/// Times of a run, checked.
pub(super) struct Times {
    /// End, s.
    pub until: f64,
    /// Communication step, s.
    pub step: f64,
    /// Averaging window, s.
    pub window: [f64; 2],
    /// Name of the end where the user gave it.
    pub until_place: String,
}

/// The times of `request`, or else those of its `file`, or else the defaults.
///
/// # Errors
/// A duration, step or window that makes no sense.
pub(super) fn resolve(request: &Request, file: &CaseFile) -> Result<Times, ScenarioError> {
    let until = request.until.or(file.until).unwrap_or(DEFAULT_UNTIL);
    let step = request.step.or(file.step).unwrap_or_else(|| DEFAULT_STEP.min(until));
    let window = request.window.or(file.window).unwrap_or_else(|| default_window(until));
    let is_in_file = |option: bool, key: bool| file.origin(option || !key);
    let said = || is_in_file(request.until.is_some(), file.until.is_some()).key("until");
    let until_place = request.until_place.clone().unwrap_or_else(said);
    check_end(until, &until_place)?;
    let place = is_in_file(request.step.is_some(), file.step.is_some()).key("step");
    check_step(step, &place, until, &until_place)?;
    let place = is_in_file(request.window.is_some(), file.window.is_some()).key("window");
    check_window(window, &place, until, &until_place)?;
    Ok(Times { until, step, window, until_place })
}

/// 50 to 100 s, as the paper averages; of a shorter run its second half.
fn default_window(until: f64) -> [f64; 2] {
    if until >= 100.0 { [50.0, 100.0] } else { [until / 2.0, until] }
}

fn fail(name: impl Into<String>, value: f64, bound: String) -> Result<(), ScenarioError> {
    Err(ScenarioError::Time { name: name.into(), value, bound })
}

fn check_end(until: f64, place: &str) -> Result<(), ScenarioError> {
    if (SHORTEST..=LONGEST).contains(&until) {
        return Ok(());
    }
    fail(place, until, format!("must lie from {SHORTEST} to {LONGEST:e} s"))
}

/// Checks that a `step`, s, that an FMU proposes divides a run up to `until`, s, into no more parts than allowed.
///
/// # Errors
/// What is allowed.
pub fn check_proposed_step(step: f64, until: f64) -> Result<(), String> {
    let least = until / MAX_STEPS;
    if step >= least { Ok(()) } else { Err(format!("must be at least {least:e} s for a run of {until} s")) }
}

fn check_step(step: f64, place: &str, until: f64, end: &str) -> Result<(), ScenarioError> {
    if !(step > 0.0 && step <= until) {
        return fail(place, step, format!("must lie above 0 and not above {end} = {until} s"));
    }
    if until / step > MAX_STEPS {
        return fail(place, step, format!("must be at least {end} / {MAX_STEPS:e} = {:e} s", until / MAX_STEPS));
    }
    Ok(())
}

fn check_window([from, to]: [f64; 2], place: &str, until: f64, end: &str) -> Result<(), ScenarioError> {
    if !(from >= 0.0 && from < until) {
        return fail(format!("{place} start"), from, format!("must lie from 0 to below {end} = {until} s"));
    }
    if !(to > from && to <= until) {
        let bound = format!("must lie above its start {from} s and not above {end} = {until} s");
        return fail(format!("{place} end"), to, bound);
    }
    Ok(())
}
