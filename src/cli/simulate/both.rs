//! `videg simulate --law both`: the harvester FMU under the impulsive and under the compliant law, side by side.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde::Serialize;

use super::both_report::{self, LawResult, Laws};
use super::law::Law;
use super::record;
use crate::cli::options::RunOptions;
use crate::cli::run_output::{self, RunOutput, file_list, heading};
use crate::cli::{Exit, excitation, output, parameter_table};
use crate::cosim::Device;
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
pub fn run(options: &RunOptions, fmu: &Fmu, scenario: &Scenario) -> anyhow::Result<Exit> {
    let folder = output::folder(options.output.as_deref(), "simulate", scenario)?;
    let (impulsive, impulsive_csv) = under(Law::Impulsive, fmu, scenario, &folder)?;
    let (compliant, compliant_csv) = under(Law::Compliant, fmu, scenario, &folder)?;
    let laws = Laws { impulsive: LawResult::new(&impulsive), compliant: LawResult::new(&compliant) };
    let warnings = warnings([&impulsive, &compliant], &laws);
    let svg = both_report::figure([&impulsive, &compliant], scenario)?;
    let report = both_report::report(scenario, &laws, &warnings, svg.clone());
    // Both runs have one excitation.
    let device = Device::of(fmu, scenario)?;
    let report = report.section(parameter_table::section(&device, scenario));
    let html = videg_report::render_html(&excitation::described(report, &device, scenario.until)?)?;
    let files = run_output::write(&folder, &[impulsive_csv, compliant_csv], &svg, &html)?;
    let run = RunOutput::new(scenario, impulsive.mechanics, &warnings, &files);
    let words = both_report::words(scenario, &laws).join("\n");
    let table = both_report::table(&laws).text();
    let text = [heading("simulate", scenario), table, words, file_list(&files)];
    run_output::conclude(&folder, options.json, &Output { run, laws: &laws }, &text, &warnings)?;
    Ok(Exit::Passed)
}

/// The run under `law`, and its time series.
fn under(law: Law, fmu: &Fmu, scenario: &Scenario, folder: &Path) -> anyhow::Result<(Results, PathBuf)> {
    let mut scenario = scenario.clone();
    scenario.settings.push(law.setting());
    let csv = folder.join(format!("timeseries-{}.csv", law.name()));
    let run = record(fmu, &scenario, &csv).with_context(|| format!("--law both, {} law", law.name()))?;
    Ok((run, csv))
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
