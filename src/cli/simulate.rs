//! `videg simulate`: the harvester FMU alone.

mod both;
mod both_report;
mod law;

use std::path::{Path, PathBuf};

use clap::Args;

use super::interruption::Interruption;
use super::isolation::IsolationOptions;
use super::options::RunOptions;
use super::progress::TimeBar;
use super::results::{Identity, Results as Claimed};
use super::run_output::{self, RunOutput, file_list, heading};
use super::time_series::TimeSeriesOptions;
use super::{Exit, drawn, energy_flow, excitation, output, parameter_table, picture, time_series};
use crate::cosim::{Device, SeriesOptions, SeriesRecorder};
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
    series: TimeSeriesOptions,
    #[command(flatten)]
    isolation: IsolationOptions,
}

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let options = &arguments.run;
    let scenario = law::scenario(arguments.law, options)?;
    let fmu = arguments.isolation.open_own("VibroImpactHarvester")?;
    let both = arguments.law.filter(|law| *law == Law::Both);
    let options_of_law = [("law", both.map(|law| law.name().to_owned()))];
    let identity = Identity::of("simulate", &scenario, options_of_law.into_iter().chain(arguments.series.distinct()))?;
    let claimed = Claimed::claim(&options.output, identity, interruption)?;
    if both.is_some() {
        return both::run(arguments, &fmu, &scenario, claimed);
    }
    let place = (claimed.folder.as_path(), "timeseries");
    let (results, written) = record(&fmu, &scenario, &arguments.series.options(), place)?;
    let svg = picture::simulate(&results.trace, &scenario)?;
    let page = report(&scenario, &results, &Device::of(&fmu, &scenario)?, svg.clone())?;
    let Results { mechanics, warnings, .. } = results;
    let text = run_output::mechanics(&scenario, &mechanics).text();
    let files = run_output::write(&claimed.folder, written.as_slice(), &svg, &videg_report::render_html(&page)?)?;
    let output = RunOutput::new(&claimed.identity, &scenario, mechanics, &warnings, &files);
    let text = [heading("simulate", &scenario), text, file_list(&files)];
    let json = run_output::json(&output)?;
    run_output::conclude(claimed, options.json, &json, &text, &warnings)?;
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

/// Runs the harvester alone and writes its time series into a folder, under a name.
fn record(
    fmu: &Fmu,
    scenario: &Scenario,
    series: &SeriesOptions,
    place: (&Path, &str),
) -> anyhow::Result<(Results, Option<PathBuf>)> {
    let simulation = Simulation::new(&Options { harvester: fmu, scenario })?;
    output::warn(time_series::warning(series, scenario, false).as_slice());
    let mut recorder = SeriesRecorder::create(place, series, scenario, None)?;
    let results = simulation.run(&mut recorder, &TimeBar::new(&scenario.name))?;
    Ok((results, recorder.finish()?))
}
