//! The sweep that a user asks for, from options and sweep file.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Args;

use super::options::{Window, mechanical, parse_window};
use crate::scenario::{self, CaseFile, Scenario, ScenarioError, Setting};
use crate::sweep::{POWERS, Request, Sampling, SweepFile, Times, Vary, is_electrical};
use fmu_import::{Bounds, ModelDescription};

/// Options that describe a sweep. An option wins over the same key of the file.
#[derive(Args, Default)]
pub struct What {
    /// Sweep file (TOML): a case file that may also have design, points, samples, seeds, record and a [vary] table
    #[arg(value_name = "FILE.toml")]
    pub file: Option<PathBuf>,
    /// Published case: fig9 to fig15, table3-2hz, table3-5hz, capsule-1-1, capsule-2-1, capsule-3-1, capsule-friction,
    /// capsule-soft [default: fig14]
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// Set a parameter or input of harvester or circuit in all runs; may be repeated
    #[arg(long = "set", value_name = "VARIABLE=VALUE")]
    settings: Vec<String>,
    /// Vary a parameter or input of harvester or circuit: name=from:to:count for a grid, name=from:to for the other designs, with log: before
    /// from for equal ratios; name=a,b,c for any type; may be repeated
    #[arg(long, value_name = "VARIABLE=VALUES")]
    vary: Vec<String>,
    #[command(flatten)]
    pub sampling: Sampling,
    /// End of a run, s [default: 100]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Communication step, s [default: from edge to edge of the window; of other FMUs their own, or 1/1000 of the run]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Averaging window, s [default: 50,100, or the second half of a shorter run]
    #[arg(long, value_name = "S,S", value_parser = parse_window, allow_hyphen_values = true)]
    window: Option<Window>,
    /// Record a variable at the end of each run, or `net_power`, `load_power`, `supply_power` over the window; may be repeated
    #[arg(long, value_name = "VARIABLE")]
    record: Vec<String>,
}

impl What {
    /// The sweep of the model that `description` is of, with what `file` says and the `fingerprint` of an FMU that is
    /// not our own and what it may take.
    pub fn request<'a>(
        &self,
        file: SweepFile,
        description: &'a ModelDescription,
        fingerprint: Option<String>,
        isolation: Option<Bounds>,
    ) -> anyhow::Result<Request<'a>> {
        let is_harvester = description.variable("gain.voltage").is_ok();
        let model = &description.model_name;
        let has_case = self.case.is_some() || file.case.case.is_some();
        let place = || file.case.origin(self.case.is_some()).key("case");
        anyhow::ensure!(is_harvester || !has_case, "{}: {model} is not the harvester, of which the cases are", place());
        let in_file = self.in_file(&file);
        let step = self.step.or(file.case.step);
        let SweepFile { case, sampling, record, vary } = file;
        let name = case.name.clone();
        let scenario = self.scenario(case, description, is_harvester)?;
        let step =
            if is_harvester { step } else { Some(step.map_or_else(|| own_step(description, scenario.until), Ok)?) };
        let asked = self.vary.iter().map(|text| Vary::parse(text)).collect::<Result<_, _>>()?;
        let vary: Vec<Vary> = [vary, asked].concat();
        let has_circuit = description.variable(POWERS[0]).is_ok();
        let settings =
            if is_harvester { mechanical(description, &scenario, "sweep")? } else { scenario.changes().to_vec() };
        let mut record = if self.record.is_empty() { record } else { self.record.clone() };
        let mut named = settings.iter().map(|it| &it.name).chain(vary.iter().map(|it| &it.name));
        let is_electrical = |name: &String| description.variable(name).is_ok_and(is_electrical);
        if has_circuit && record.is_empty() && named.any(is_electrical) {
            record = POWERS.map(str::to_owned).to_vec();
        }
        Ok(Request {
            description,
            fmu: fingerprint,
            isolation,
            settings,
            times: Times { until: scenario.until, step, window: scenario.window },
            name: name.unwrap_or(if is_harvester { scenario.name } else { model.clone() }),
            vary,
            sampling: self.sampling.clone().or(sampling),
            record,
            in_file,
        })
    }

    /// Keys of the file that no option overrides, with the path.
    fn in_file(&self, file: &SweepFile) -> Vec<(&'static str, PathBuf)> {
        let Some(path) = &file.case.path else { return Vec::new() };
        let (own, said) = (&self.sampling, &file.sampling);
        let keys = [
            ("design", own.design.is_none() && said.design.is_some()),
            ("points", own.points.is_none() && said.points.is_some()),
            ("samples", own.samples.is_none() && said.samples.is_some()),
            ("seed-variable", own.seed_variable.is_none() && said.seed_variable.is_some()),
            ("record", self.record.is_empty() && !file.record.is_empty()),
        ];
        keys.into_iter().filter(|(_, is_there)| *is_there).map(|(key, _)| (key, path.clone())).collect()
    }

    fn scenario(
        &self,
        file: CaseFile,
        description: &ModelDescription,
        is_harvester: bool,
    ) -> Result<Scenario, ScenarioError> {
        let own_end = || description.default_experiment.stop_time.filter(|_| !is_harvester);
        let proposed = if self.until.is_none() && file.until.is_none() { own_end() } else { None };
        let until = self.until.or(proposed);
        let settings = self.settings.iter().map(|text| Setting::parse(text)).collect::<Result<_, _>>()?;
        let window = self.window.map(|Window(window)| window);
        let until_place = proposed.map(|_| format!("DefaultExperiment of {}: stopTime", description.model_name));
        let case = self.case.clone();
        scenario::Request { case, file: Some(file), settings, until, step: self.step, window, until_place }.resolve()
    }
}

/// The step that an FMU proposes, s, or a thousandth of the run.
fn own_step(description: &ModelDescription, until: f64) -> anyhow::Result<f64> {
    let Some(step) = description.default_experiment.step_size else { return Ok(until / 1000.0) };
    let model = &description.model_name;
    scenario::check_proposed_step(step, until)
        .map_err(|bound| anyhow!("DefaultExperiment of {model}: stepSize = {step} s: {bound}, or give --step"))?;
    Ok(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times of a sweep without options, of an FMU whose default experiment has these attributes.
    fn request(experiment: &str) -> Result<Times, String> {
        let attributes = "startTime=\"0\" stopTime=\"1e1\"";
        let text = include_str!("../../fmu/import/src/testdata/good.xml").replace(attributes, experiment);
        let description = ModelDescription::parse(text.as_bytes(), "good.xml").unwrap();
        let made = What::default().request(SweepFile::default(), &description, None, None);
        made.map(|request| request.times).map_err(|error| error.to_string())
    }

    #[test]
    fn times_that_an_fmu_proposes_are_taken_or_blamed_on_it() {
        let times = |experiment: &str| request(experiment).map(|times| (times.until, times.step));
        assert_eq!(times("stopTime=\"10\""), Ok((10.0, Some(0.01))));
        assert_eq!(times("stopTime=\"10\" stepSize=\"0.5\""), Ok((10.0, Some(0.5))));
        for step in ["1e-12", "0", "-1", "NaN"] {
            let message = times(&format!("stopTime=\"1\" stepSize=\"{step}\"")).unwrap_err();
            assert!(
                message.contains(": stepSize = ") && message.ends_with("for a run of 1 s, or give --step"),
                "{message}"
            );
        }
        let message = times("stopTime=\"0\"").unwrap_err();
        assert!(
            message.starts_with("DefaultExperiment of ") && message.contains(": stopTime = 0 s: must lie"),
            "{message}"
        );
    }
}
