//! Options that several verbs share.

use std::path::PathBuf;

use clap::Args;
use fmu_import::ModelDescription;

use super::output;
use super::results::OutputOptions;
use crate::cosim::{CircuitRequest, CosimError};
use crate::scenario::{CaseFile, Request, Scenario, ScenarioError, Setting};

/// What to run.
#[derive(Args)]
pub struct CaseOptions {
    /// Published case: fig9 to fig15, table3-2hz, table3-5hz, capsule-1-1, capsule-2-1, capsule-3-1, capsule-friction,
    /// capsule-soft [default: fig14]
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// Set a parameter or input, e.g. membrane.restitution=0.7 or load.resistance=1e10; may be repeated. Start
    /// positions and velocities stay those of the case
    #[arg(long = "set", value_name = "VARIABLE=VALUE")]
    settings: Vec<String>,
    /// Case file (TOML) with case, until, step, window and a [set] table
    #[arg(long, value_name = "FILE.toml")]
    case_file: Option<PathBuf>,
}

/// What to run, and for how long.
#[derive(Args)]
pub struct TimedCaseOptions {
    #[command(flatten)]
    case: CaseOptions,
    /// End of the run, s [default: 100]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    until: Option<f64>,
}

/// What to run, how, and where results go.
#[derive(Args)]
pub struct RunOptions {
    #[command(flatten)]
    case: TimedCaseOptions,
    /// Communication step, s; the master also stops at impacts and peaks of C(t) [default: 1e-3]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Averaging window, s [default: 50,100, or the second half of a shorter run]
    #[arg(long, value_name = "S,S", value_parser = parse_window, allow_hyphen_values = true)]
    window: Option<Window>,
    #[command(flatten)]
    pub output: OutputOptions,
    /// Print one JSON object on stdout instead of the table
    #[arg(long)]
    pub json: bool,
}

/// An averaging window, s. A type of its own, because clap would take a plain array for a repeated option.
#[derive(Clone, Copy)]
pub struct Window(pub [f64; 2]);

/// Reads two times with a comma between them.
pub fn parse_window(text: &str) -> Result<Window, String> {
    let times: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match times.as_deref() {
        Some(&[from, to]) => Ok(Window([from, to])),
        _ => Err("two times with a comma between them are expected, e.g. 50,100".to_owned()),
    }
}

/// The settings of the harvester. Those of a circuit are left out with a warning that the `verb` runs none.
pub fn mechanical(description: &ModelDescription, scenario: &Scenario, verb: &str) -> Result<Vec<Setting>, CosimError> {
    let (mechanical, circuit) = CircuitRequest::split(description, &scenario.settings)?;
    if let Some(names) = circuit.names() {
        output::warn(&[format!("{names} left out: {verb} runs no circuit")]);
    }
    Ok(mechanical)
}

impl CaseOptions {
    /// Resolves the options.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        self.request()?.resolve()
    }

    fn request(&self) -> Result<Request, ScenarioError> {
        Ok(Request {
            case: self.case.clone(),
            file: self.case_file.as_deref().map(CaseFile::read).transpose()?,
            settings: self.settings.iter().map(|text| Setting::parse(text)).collect::<Result<_, _>>()?,
            ..Request::default()
        })
    }
}

impl TimedCaseOptions {
    /// Resolves the options.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        self.request()?.resolve()
    }

    /// Resolves the options, with an averaging window.
    pub fn scenario_within(&self, window: Option<Window>) -> Result<Scenario, ScenarioError> {
        Request { window: window.map(|Window(window)| window), ..self.request()? }.resolve()
    }

    fn request(&self) -> Result<Request, ScenarioError> {
        Ok(Request { until: self.until, ..self.case.request()? })
    }
}

impl RunOptions {
    /// Resolves the options.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        self.scenario_with(Vec::new())
    }

    /// Resolves the options, with `more` settings on top of theirs.
    pub fn scenario_with(&self, more: Vec<Setting>) -> Result<Scenario, ScenarioError> {
        let mut request = self.case.request()?;
        request.settings.extend(more);
        Request { step: self.step, window: self.window.map(|Window(window)| window), ..request }.resolve()
    }
}
