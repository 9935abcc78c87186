//! The sweep that a user asks for, from options and sweep file.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use clap::Args;

use super::options::{Window, mechanical, parse_window};
use super::sweep_cases::{cases, under};
use crate::scenario::{self, CaseFile, Scenario, ScenarioError, Setting};
use crate::sweep::{
    Engine, NamedCase, Options, POWERS, Request, Sampling, Shard, Sweep, SweepFile, Times, Vary, is_electrical,
};
use fmu_import::{Bounds, ModelDescription};

/// What all runs have in common.
#[derive(Args, Clone, Default)]
pub struct Common {
    /// Published case: fig9 to fig15, table3-2hz, table3-5hz, capsule-1-1, capsule-2-1, capsule-3-1, capsule-friction,
    /// capsule-soft [default: fig14]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// Set a parameter or input of harvester or circuit in all runs; may be repeated
    #[arg(long = "set", value_name = "VARIABLE=VALUE")]
    pub settings: Vec<String>,
    /// End of a run, s [default: 100]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// Averaging window, s [default: 50,100, or the second half of a shorter run]
    #[arg(long, value_name = "S,S", value_parser = parse_window, allow_hyphen_values = true)]
    pub window: Option<Window>,
}

/// How many runs at once, and which.
#[derive(Args)]
pub struct Execution {
    /// Run only share I of N; `sweep merge` puts the shards together, and `map` draws those of a map
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub shard: Option<Shard>,
    /// Number of parallel runs [default: one on each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Start again; discards the results in the folder
    #[arg(long)]
    fresh: bool,
}

impl Execution {
    /// The same for `sweep` in `folder`.
    pub fn options<'a>(&self, sweep: &'a Sweep, engine: &'a Engine, folder: &'a Path) -> Options<'a> {
        let options = Options::new(sweep, engine, folder);
        let jobs = self.jobs.map_or(options.jobs, usize::from);
        Options { shard: self.shard, jobs, fresh: self.fresh, ..options }
    }
}

/// Options that describe a sweep. An option wins over the same key of the file.
#[derive(Args, Default)]
#[allow(rustdoc::broken_intra_doc_links, reason = "comments are help texts")]
pub struct What {
    /// Sweep file (TOML): a case file that may also have design, points, samples, seeds, record and a [vary] table;
    /// or several case files, over which the sweep goes
    #[arg(value_name = "FILE.toml")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "a comment would replace the help of the verb")]
    pub common: Common,
    /// Vary a parameter or input of harvester or circuit: name=from:to:count for a grid, name=from:to for the other designs, with log: before
    /// from for equal ratios; name=a,b,c for any type; case=fig14,my.toml for cases; may be repeated
    #[arg(long, value_name = "VARIABLE=VALUES")]
    pub vary: Vec<String>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "as above")]
    pub sampling: Sampling,
    /// Communication step, s [default: from edge to edge of the window; of other FMUs their own, or 1/1000 of the run]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Record a variable at the end of each run, or `net_power`, `load_power`, `supply_power` over the window; may be repeated
    #[arg(long, value_name = "VARIABLE")]
    pub record: Vec<String>,
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
        let has_case = self.common.case.is_some() || file.case.case.is_some();
        let place = || file.case.origin(self.common.case.is_some()).key("case");
        anyhow::ensure!(is_harvester || !has_case, "{}: {model} is not the harvester, of which the cases are", place());
        let asked = self.vary.iter().map(|text| Vary::parse(text)).collect::<Result<Vec<_>, _>>()?;
        let mut vary = [file.vary.clone(), asked].concat();
        let cases = if is_harvester { cases(&self.files, &mut vary)? } else { Vec::new() };
        anyhow::ensure!(cases.is_empty() || !has_case, "{}: the sweep goes over cases; leave out either", place());
        let in_file = self.in_file(&file);
        let SweepFile { case, sampling, record, .. } = file;
        let Planned { name, settings, cases, times } = if cases.is_empty() {
            self.of_one(case, description, is_harvester)?
        } else {
            self.of_several(&case, cases, description)?
        };
        let has_circuit = description.variable(POWERS[0]).is_ok();
        let mut record = if self.record.is_empty() { record } else { self.record.clone() };
        let of_cases = cases.iter().flat_map(|case| &case.settings);
        let mut named = of_cases.chain(&settings).map(|it| &it.name).chain(vary.iter().map(|it| &it.name));
        let is_electrical = |name: &String| description.variable(name).is_ok_and(is_electrical);
        if has_circuit && record.is_empty() && named.any(is_electrical) {
            record = POWERS.map(str::to_owned).to_vec();
        }
        Ok(Request {
            description,
            fmu: fingerprint,
            isolation,
            settings,
            cases,
            times,
            name,
            vary,
            sampling: self.sampling.clone().or(sampling),
            record,
            in_file,
        })
    }

    /// The sweep file, if there is one; several files are cases.
    pub fn sweep_file(&self) -> Result<SweepFile, ScenarioError> {
        if let [file] = &self.files[..] { SweepFile::read(file) } else { Ok(SweepFile::default()) }
    }

    /// What all runs of a sweep over one case, or of an FMU, have in common.
    fn of_one(&self, case: CaseFile, description: &ModelDescription, is_harvester: bool) -> anyhow::Result<Planned> {
        let (name, step) = (case.name.clone(), self.step.or(case.step));
        let scenario = self.scenario(case, description, is_harvester)?;
        let (until, window) = (scenario.until, scenario.window);
        Ok(if is_harvester {
            let settings = mechanical(description, &scenario, "sweep")?;
            Planned {
                name: name.unwrap_or(scenario.name),
                settings,
                cases: Vec::new(),
                times: Times { until, step, window },
            }
        } else {
            let step = Some(step.map_or_else(|| own_step(description, until), Ok)?);
            let (name, settings) = (name.unwrap_or(description.model_name.clone()), scenario.changes().to_vec());
            Planned { name, settings, cases: Vec::new(), times: Times { until, step, window } }
        })
    }

    /// The same over several `cases` with what the sweep file `on_top` says. Their runs have the same times.
    fn of_several(
        &self,
        on_top: &CaseFile,
        cases: Vec<CaseFile>,
        description: &ModelDescription,
    ) -> anyhow::Result<Planned> {
        let mut planned: Vec<(NamedCase, Times)> = Vec::new();
        for case in cases {
            let case = under(case, on_top);
            let step = self.step.or(case.step);
            let scenario = self.scenario(case, description, true)?;
            let times = Times { until: scenario.until, step, window: scenario.window };
            let case =
                NamedCase { name: scenario.name.clone(), settings: mechanical(description, &scenario, "sweep")? };
            if let Some((first, other)) = planned.first()
                && *other != times
            {
                let [one, two] = [(first, other), (&case, &times)].map(|(case, times)| {
                    let Times { until, window: [from, to], .. } = times;
                    format!("{} runs until {until} s with the window {from},{to} s", case.name)
                });
                anyhow::bail!(
                    "{one}, {two}: all runs of a sweep have the same times, so give --until, --window and --step"
                );
            }
            planned.push((case, times));
        }
        let times = planned.first().map_or(Times { until: 0.0, step: None, window: [0.0; 2] }, |(_, times)| *times);
        let name = on_top.name.clone().unwrap_or_else(|| "cases".to_owned());
        Ok(Planned { name, settings: Vec::new(), cases: planned.into_iter().map(|(case, _)| case).collect(), times })
    }

    /// Keys of the file that no option overrides, with the path.
    fn in_file(&self, file: &SweepFile) -> Vec<(&'static str, PathBuf)> {
        let Some(path) = &file.case.path else { return Vec::new() };
        let (own, said) = (&self.sampling, &file.sampling);
        let keys = [
            ("design", own.design.is_none() && said.design.is_some()),
            ("points", own.points.is_none() && said.points.is_some()),
            ("samples", own.samples.is_none() && said.samples.is_some()),
            ("confidence", own.confidence.is_none() && said.confidence.is_some()),
            ("until-precision", own.until_precision.is_none() && said.until_precision.is_some()),
            ("precision-of", own.precision_of.is_none() && said.precision_of.is_some()),
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
        let proposed = if self.common.until.is_none() && file.until.is_none() { own_end() } else { None };
        let until = self.common.until.or(proposed);
        let settings = self.common.settings.iter().map(|text| Setting::parse(text)).collect::<Result<_, _>>()?;
        let window = self.common.window.map(|Window(window)| window);
        let until_place = proposed.map(|_| format!("DefaultExperiment of {}: stopTime", description.model_name));
        let case = self.common.case.clone();
        scenario::Request { case, file: Some(file), settings, until, step: self.step, window, until_place }.resolve()
    }
}

/// What a sweep goes over, besides what is varied.
struct Planned {
    name: String,
    settings: Vec<Setting>,
    cases: Vec<NamedCase>,
    times: Times,
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
