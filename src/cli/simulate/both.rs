//! `videg simulate --law both`: the harvester FMU under the impulsive and under the compliant law, side by side.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde::Serialize;

use super::both_report::{self, LawResult, Laws};
use super::law::Law;
use super::{Arguments, record};
use crate::cli::results::Results as Claimed;
use crate::cli::run_output::{self, RunOutput, file_list, heading};
use crate::cli::{Exit, excitation, parameter_table};
use crate::cosim::{Device, SeriesOptions};
use crate::scenario::Scenario;
use crate::simulate::Results;
use fmu_import::Fmu;

/// The keys of `--json`: the run under the impulsive law, and both laws.
#[derive(Serialize)]
struct Output<'a> {
    #[serde(flatten)]
    run: RunOutput<'a>,
    laws: &'a Laws,
}

/// Runs both laws of the harvester `fmu`.
pub fn run(arguments: &Arguments, fmu: &Fmu, scenario: &Scenario, claimed: Claimed<'_>) -> anyhow::Result<Exit> {
    let series = &arguments.series.options();
    let folder = &claimed.folder;
    let (impulsive, impulsive_series) = under(Law::Impulsive, fmu, scenario, series, folder)?;
    let (compliant, compliant_series) = under(Law::Compliant, fmu, scenario, series, folder)?;
    let written: Vec<_> = impulsive_series.into_iter().chain(compliant_series).collect();
    let laws = Laws { impulsive: LawResult::new(&impulsive), compliant: LawResult::new(&compliant) };
    let warnings = warnings([&impulsive, &compliant], &laws);
    let svg = both_report::figure([&impulsive, &compliant], scenario)?;
    let report = both_report::report(scenario, &laws, &warnings, svg.clone());
    // Both runs have one excitation.
    let device = Device::of(fmu, scenario)?;
    let report = report.section(parameter_table::section(&device, scenario));
    let html = videg_report::render_html(&excitation::described(report, &device, scenario.until)?)?;
    let files = run_output::write(folder, &written, &svg, &html)?;
    let run = RunOutput::new(&claimed.identity, scenario, impulsive.mechanics, &warnings, &files);
    let words = both_report::words(scenario, &laws).join("\n");
    let table = both_report::table(&laws).text();
    let text = [heading("simulate", scenario), table, words, file_list(&files)];
    let json = run_output::json(&Output { run, laws: &laws })?;
    run_output::conclude(claimed, arguments.run.json, &json, &text, &warnings)?;
    Ok(Exit::Passed)
}

/// The run under `law`, and its time series.
fn under(
    law: Law,
    fmu: &Fmu,
    scenario: &Scenario,
    series: &SeriesOptions,
    folder: &Path,
) -> anyhow::Result<(Results, Option<PathBuf>)> {
    let mut scenario = scenario.clone();
    scenario.settings.push(law.setting());
    let name = format!("timeseries-{}", law.name());
    record(fmu, &scenario, series, (folder, &name)).with_context(|| format!("--law both, {} law", law.name()))
}

/// Warnings of both runs, shared ones once, and those about durations.
fn warnings([impulsive, compliant]: [&Results; 2], laws: &Laws) -> Vec<String> {
    let new = compliant.warnings.iter().filter(|warning| !impulsive.warnings.contains(warning));
    let shared = impulsive.warnings.iter().chain(new).cloned();
    let overlaps = [("impulsive", &laws.impulsive), ("compliant", &laws.compliant)].map(|(law, found)| {
        let (impacts, contacts) = (found.mechanics.impacts, found.contacts.contacts);
        // The last contact of each membrane may not have ended.
        (i64::from(impacts) > i64::from(contacts) + 2).then(|| {
            format!(
                "{law} law: {contacts} contacts ended in {impacts} impacts, since pulses overlap (the slower an impact, the \
                 longer its pulse); the durations are those of series of impacts, not of single ones"
            )
        })
    });
    shared.chain(overlaps.into_iter().flatten()).collect()
}
