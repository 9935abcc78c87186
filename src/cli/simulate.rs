//! `videg simulate`: the harvester FMU alone.

mod both;
mod both_report;
mod law;

use std::path::Path;

use clap::Args;

use super::isolation::IsolationOptions;
use super::options::RunOptions;
use super::progress::TimeBar;
use super::run_output::{self, RunOutput, file_list, heading};
use super::{Exit, drawn, energy_flow, excitation, output, parameter_table, picture, time_series};
use crate::cosim::{CsvRecorder, Device};
use crate::scenario::Scenario;
use crate::simulate::{Options, Results, Simulation};
use fmu_import::Fmu;
use law::Law;
use videg_report::Report;

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    run: RunOptions,
    /// Contact law of ball and membrane, the same as --set contact.law=LAW; both: run and compare both laws [default:
    /// impulsive]
    #[arg(long, value_enum)]
    law: Option<Law>,
    #[command(flatten)]
    isolation: IsolationOptions,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    let options = &arguments.run;
    let scenario = law::scenario(arguments.law, options)?;
    let fmu = arguments.isolation.open_own("VibroImpactHarvester")?;
    if arguments.law == Some(Law::Both) {
        return both::run(options, &fmu, &scenario);
    }
    let folder = output::folder(options.output.as_deref(), "simulate", &scenario)?;
    let csv = folder.join("timeseries.csv");
    let results = record(&fmu, &scenario, &csv)?;
    let svg = picture::simulate(&results.trace, &scenario)?;
    let page = report(&scenario, &results, &Device::of(&fmu, &scenario)?, svg.clone())?;
    let Results { mechanics, warnings, .. } = results;
    let text = run_output::mechanics(&scenario, &mechanics).text();
    let files = run_output::write(&folder, &[csv], &svg, &videg_report::render_html(&page)?)?;
    let output = RunOutput::new(&scenario, mechanics, &warnings, &files);
    let text = [heading("simulate", &scenario), text, file_list(&files)];
    run_output::conclude(&folder, options.json, &output, &text, &warnings)?;
    Ok(Exit::Passed)
}

const CAPTION: &str = "(a) Relative displacement, (b) capacitances, (c) velocities in the last seconds of the run; (d) sum \
    of the voltage gains U_DE4 - U_in since its start.";

/// The HTML report.
fn report(scenario: &Scenario, results: &Results, device: &Device, svg: String) -> anyhow::Result<Report> {
    let Results { mechanics, flows, warnings, .. } = results;
    let keys = [
        run_output::voltage_gain(scenario, mechanics).main(),
        run_output::impact_rate(scenario, mechanics, device),
        run_output::power("P, Eq. (14)", mechanics.average_power_eq13, 0.0),
    ];
    let answer = run_output::result(warnings).keys(keys).figure(svg, CAPTION);
    let report = run_output::report(format!("Simulation of {}", scenario.name), scenario)
        .section(answer.table(run_output::mechanics(scenario, mechanics).html()));
    let drawn = drawn::section(device, None)?;
    let flow = energy_flow::section(flows, device, scenario.window, &energy_flow::PAPER)?;
    let report = drawn.into_iter().chain(flow).fold(report, Report::section);
    excitation::described(report.section(parameter_table::section(device, scenario)), device, scenario.until)
}

/// Runs the harvester alone and writes the time series to `csv`.
fn record(fmu: &Fmu, scenario: &Scenario, csv: &Path) -> anyhow::Result<Results> {
    let simulation = Simulation::new(&Options { harvester: fmu, scenario })?;
    output::warn(time_series::warning(scenario, false).as_slice());
    let mut recorder = CsvRecorder::create(csv, None)?;
    let results = simulation.run(&mut recorder, &TimeBar::new(&scenario.name))?;
    recorder.finish()?;
    Ok(results)
}
