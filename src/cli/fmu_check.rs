//! `videg fmu check`: whether an FMU loads, runs, and keeps the promises of its model description.

use std::path::Path;

use serde::Serialize;

use super::isolation::IsolationOptions;
use super::message::one_line;
use super::{Exit, fmu_check3, output};
use fmu_import::{Archive, FmiError, Fmu, Instance, Kind, Logging};

/// Step of the trial run if the FMU proposes none, s.
const STEP: f64 = 1e-3;
/// Number of steps of the trial run.
const STEPS: u32 = 10;

/// A check by name: says what it left out, or why it failed.
type Task = (&'static str, fn(&mut Instance) -> Result<String, Trouble>);

/// Why a check failed.
enum Trouble {
    /// The FMU does not keep its promises.
    Failed(String),
    /// It took its process down.
    Ended(FmiError),
}

impl From<FmiError> for Trouble {
    fn from(error: FmiError) -> Self {
        if matches!(error, FmiError::Isolated(_)) { Self::Ended(error) } else { Self::Failed(error.to_string()) }
    }
}

/// One check and its result.
#[derive(Serialize)]
struct CheckResult {
    name: &'static str,
    passed: bool,
    /// Why it failed, or what was left out.
    detail: String,
}

#[derive(Serialize)]
struct Output<'a> {
    file: &'a Path,
    passed: bool,
    checks: Vec<CheckResult>,
}

/// Runs the checks; what was found goes to stdout, as text or as one JSON object.
///
/// # Errors
/// An FMU that cannot be opened, or that took its process down.
pub fn run(file: &Path, isolation: &IsolationOptions, json: bool) -> anyhow::Result<Exit> {
    let mut archive = Archive::open(file)?;
    let description = archive.description()?;
    let (checks, end) = if description.is_fmi_3() {
        let checks = fmu_check3::checks(&mut archive, &description).into_iter();
        let result = |(name, found): (_, Result<String, String>)| CheckResult {
            name,
            passed: found.is_ok(),
            detail: found.unwrap_or_else(|reason| reason),
        };
        (checks.map(result).collect(), None)
    } else {
        checks(&isolation.open(file)?)
    };
    let passed = checks.iter().all(|check| check.passed);
    let line = |CheckResult { name, passed, detail }: &CheckResult| {
        let mark = if *passed { "ok    " } else { "FAILED" };
        let colon = if detail.is_empty() { "" } else { ": " };
        one_line(&format!("{mark}  {name}{colon}{detail}"))
    };
    let output = Output { file, passed, checks };
    output::show(json, &output, || output.checks.iter().map(line).collect::<Vec<_>>().join("\n"))?;
    match end {
        Some(error) => Err(error.into()),
        None => Ok(if passed { Exit::Passed } else { Exit::Failed }),
    }
}

/// All checks, in the order in which a simulation needs them; the first that fails ends the list.
fn checks(fmu: &Fmu) -> (Vec<CheckResult>, Option<FmiError>) {
    let tasks: [Task; 6] = [
        ("initialises with its start values", |instance| done(initialize(instance))),
        ("outputs are finite after initialisation", finite_outputs),
        ("steps", |instance| done(step(instance, 0..STEPS))),
        ("outputs are finite after the steps", finite_outputs),
        ("saved state restores to the bit", rollback),
        ("terminates, resets and initialises again", |instance| {
            done(instance.terminate().and_then(|()| instance.reset()).and_then(|()| initialize(instance)))
        }),
    ];
    let (mut checks, mut end) = (Vec::new(), None);
    let mut passes = |name, result: Result<String, Trouble>| {
        let passed = result.is_ok();
        let detail = result.unwrap_or_else(|trouble| match trouble {
            Trouble::Failed(reason) => reason,
            Trouble::Ended(error) => end.insert(error).to_string(),
        });
        checks.push(CheckResult { name, passed, detail });
        passed
    };
    let first = "library loads and instantiates";
    match fmu.instantiate("check", Logging::default()) {
        Err(error) => _ = passes(first, Err(error.into())),
        Ok(mut instance) => {
            passes(first, Ok(String::new()));
            if tasks.into_iter().all(|(name, task)| passes(name, task(&mut instance))) {
                passes("is freed", done(instance.free()));
            }
        }
    }
    (checks, end)
}

fn done<T>(result: Result<T, FmiError>) -> Result<String, Trouble> {
    Ok(result.map(|_| String::new())?)
}

fn initialize(instance: &mut Instance) -> Result<(), FmiError> {
    instance.setup_experiment(0.0, None, None)?;
    instance.enter_initialization_mode()?;
    instance.exit_initialization_mode()
}

fn step(instance: &mut Instance, steps: std::ops::Range<u32>) -> Result<(), FmiError> {
    let step = instance.description().default_experiment.step_size.unwrap_or(STEP);
    steps.into_iter().try_for_each(|k| instance.do_step(f64::from(k) * step, step))
}

/// Value references and names of the real outputs.
fn outputs(instance: &Instance) -> (Vec<u32>, Vec<String>) {
    let outputs = instance.description().output_variables();
    let reals = outputs.filter(|variable| matches!(variable.kind, Kind::Real { .. }));
    reals.map(|variable| (variable.value_reference, variable.name.clone())).unzip()
}

fn values(instance: &Instance, references: &[u32]) -> Result<Vec<f64>, FmiError> {
    let mut values = vec![0.0; references.len()];
    instance.get_real(references, &mut values)?;
    Ok(values)
}

fn finite_outputs(instance: &mut Instance) -> Result<String, Trouble> {
    let (references, names) = outputs(instance);
    let values = values(instance, &references)?;
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(String::new()),
        Some(index) => Err(Trouble::Failed(format!("{} = {}", names[index], values[index]))),
    }
}

/// Runs on from a saved state twice; both runs must give the same bits.
fn rollback(instance: &mut Instance) -> Result<String, Trouble> {
    if !instance.description().co_simulation.can_get_and_set_fmu_state {
        return Ok("left out, the FMU cannot save its state".to_owned());
    }
    let (references, names) = outputs(instance);
    let state = instance.save_state()?;
    step(instance, STEPS..2 * STEPS)?;
    let first = values(instance, &references)?;
    instance.restore_state(&state)?;
    step(instance, STEPS..2 * STEPS)?;
    let second = values(instance, &references)?;
    match first.iter().zip(&second).position(|(a, b)| a.to_bits() != b.to_bits()) {
        None => Ok(String::new()),
        Some(index) => Err(Trouble::Failed(format!("{} = {} and then {}", names[index], first[index], second[index]))),
    }
}
