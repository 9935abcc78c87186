//! `videg simulate`: the harvester FMU alone.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::isolation::IsolationOptions;
use super::options::RunOptions;
use super::progress::TimeBar;
use super::simulate_contacts::Contacts;
use super::simulate_law::{self, Law};
use super::{Verdict, format, output, picture, settings, simulate_both, time_series};
use crate::cosim::{Coupling, CsvRecorder, HarvesterFmu, Master, MechanicsSummary, Outcome, Trace};
use crate::scenario::{Scenario, Setting};
use fmu_import::Fmu;
use videg_report::{self, Column, Report, Section};

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    run: RunOptions,
    /// Law of the contact between ball and membrane, the same as --set contact.law=LAW; both: run one after the other and
    /// compare [default: impulsive]
    #[arg(long, value_enum)]
    law: Option<Law>,
    #[command(flatten)]
    isolation: IsolationOptions,
}

/// What `--json` says of every run: what was run, and the mechanics.
#[derive(Serialize)]
pub struct RunOutput<'a> {
    case: &'a str,
    description: &'a str,
    until: f64,
    step: f64,
    window: [f64; 2],
    #[serde(flatten)]
    mechanics: MechanicsSummary,
    paper: Paper,
    settings: &'a [Setting],
    warnings: &'a [String],
    files: &'a [PathBuf],
}

impl<'a> RunOutput<'a> {
    /// The output of a run of `scenario` that came to `mechanics`.
    pub fn new(
        scenario: &'a Scenario,
        mechanics: MechanicsSummary,
        warnings: &'a [String],
        files: &'a [PathBuf],
    ) -> Self {
        Self {
            case: &scenario.name,
            description: &scenario.description,
            until: scenario.until,
            step: scenario.step,
            window: scenario.window,
            mechanics,
            paper: Paper { average_voltage_gain: scenario.paper.voltage_gain, average_power: scenario.paper.power },
            settings: &scenario.settings,
            warnings,
            files,
        }
    }
}

/// What the paper prints; absent where it prints nothing.
#[derive(Serialize)]
struct Paper {
    /// `<U>`, V/s.
    average_voltage_gain: Option<f64>,
    /// P, W.
    average_power: Option<f64>,
}

/// A run of the harvester alone.
pub struct Mechanics {
    /// What it came to.
    pub summary: MechanicsSummary,
    /// What a figure shows.
    pub trace: Trace,
    /// How long the membranes were deflected, and how far.
    pub contacts: Contacts,
    /// What the user should know before believing the numbers.
    pub warnings: Vec<String>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> anyhow::Result<Verdict> {
    let options = &arguments.run;
    let scenario = simulate_law::scenario(arguments.law, options)?;
    let fmu = arguments.isolation.open_own("VibroImpactHarvester")?;
    if arguments.law == Some(Law::Both) {
        return simulate_both::run(options, &fmu, &scenario);
    }
    let folder = output::folder(options.output.as_deref(), "simulate", &scenario)?;
    let csv = folder.join("timeseries.csv");
    let Mechanics { summary: mechanics, trace, warnings, .. } = follow(&fmu, &scenario, &csv)?;
    let files = write_files(&folder, &csv, &trace, &scenario, &mechanics, &warnings)?;
    let result = RunOutput::new(&scenario, mechanics, &warnings, &files);
    let json = serde_json::to_string_pretty(&result)?;
    output::write(&folder.join("result.json"), &json)?;
    if options.json {
        output::print_json(&json)?;
    } else {
        output::print(&text(&scenario, &mechanics, &files))?;
    }
    output::warn(&warnings);
    Ok(Verdict::Passed)
}

/// Runs the harvester alone and writes the time series to `csv`.
pub fn follow(fmu: &Fmu, scenario: &Scenario, csv: &Path) -> anyhow::Result<Mechanics> {
    let (mechanical, electrical) = settings::split(fmu.description(), scenario)?;
    let harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
    let circuit: Vec<_> = electrical.iter().map(|setting| setting.name.as_str()).collect();
    output::warn(time_series::warning(scenario, false).as_slice());
    let mut recorder = CsvRecorder::create(csv, false)?;
    let detail = picture::DETAIL.min(scenario.until);
    let mut trace = Trace::new(scenario.until, detail);
    let mut contacts = Contacts::new(scenario.until - detail);
    let mut bar = TimeBar::new(scenario.name.clone(), scenario.until);
    let master = Master::new(harvester, Vec::new(), scenario, Coupling::default())?;
    let Outcome { mechanics: summary, mut warnings, .. } =
        master.run(&mut [&mut recorder, &mut trace, &mut contacts, &mut bar])?;
    if !circuit.is_empty() {
        warnings.push(format!("{} left out: simulate runs no circuit, cosim does", circuit.join(", ")));
    }
    bar.finish();
    recorder.finish()?;
    Ok(Mechanics { summary, trace, contacts, warnings })
}

fn write_files(
    folder: &Path,
    csv: &Path,
    trace: &Trace,
    scenario: &Scenario,
    mechanics: &MechanicsSummary,
    warnings: &[String],
) -> anyhow::Result<Vec<PathBuf>> {
    let svg = picture::simulate(trace, scenario)?;
    let (figure, html) = (folder.join("figure.svg"), folder.join("report.html"));
    output::write(&figure, &svg)?;
    let result = Section::new("Result").table(report_table(scenario, mechanics));
    let result = warnings.iter().cloned().fold(result, Section::warning);
    let page = Report::new(
        format!("Simulation of {}", scenario.name),
        format!(
            "{}; 0 to {} s, averages over {} to {} s.",
            scenario.description, scenario.until, scenario.window[0], scenario.window[1]
        ),
    )
    .command(output::command_line())
    .generated_by(concat!("videg ", env!("CARGO_PKG_VERSION")))
    .section(result)
    .section(Section::new("Motion, capacitances and gains").figure(svg, figure_caption()));
    output::write(&html, &videg_report::render_html(&page)?)?;
    Ok(vec![csv.to_owned(), figure, html, folder.join("result.json")])
}

fn figure_caption() -> &'static str {
    "(a) Relative displacement, (b) capacitances, (c) velocities in the last seconds of the run; (d) sum of the voltage \
     gains U_DE4 - U_in since its start."
}

/// Rows of the result table: quantity, unit, paper, videg, deviation.
fn rows(scenario: &Scenario, mechanics: &MechanicsSummary) -> Vec<[String; 5]> {
    let compared = |quantity: &str, unit: &str, paper: Option<f64>, found: f64, scale: f64| {
        [
            quantity.to_owned(),
            unit.to_owned(),
            paper.map_or_else(String::new, |paper| format::significant(paper * scale, 4)),
            format::significant(found * scale, 6),
            paper.map_or_else(String::new, |paper| format::deviation(found, paper)),
        ]
    };
    let count = |quantity: &str, number: i32| {
        [quantity.to_owned(), "1".to_owned(), String::new(), number.to_string(), String::new()]
    };
    vec![
        compared("<U>, Eq. (15)", "V/s", scenario.paper.voltage_gain, mechanics.average_voltage_gain, 1.0),
        compared("P, Eq. (14)", "mW", scenario.paper.power, mechanics.average_power_eq13, 1e3),
        count("impacts, whole run", mechanics.impacts),
        count("events computed", mechanics.events),
    ]
}

/// The result table of the mechanics as text.
pub fn text_table(scenario: &Scenario, mechanics: &MechanicsSummary) -> String {
    let mut table = format::table(&["quantity", "unit", "paper", "videg", "deviation"]);
    for cells in rows(scenario, mechanics) {
        table.add_row(format::row(&cells));
    }
    table.to_string()
}

/// The result table of the mechanics in the HTML report.
pub fn report_table(scenario: &Scenario, mechanics: &MechanicsSummary) -> videg_report::Table {
    let table = videg_report::Table::new([
        Column::words("quantity"),
        Column::words("unit"),
        Column::numbers("paper"),
        Column::numbers("videg"),
        Column::numbers("deviation"),
    ]);
    rows(scenario, mechanics).into_iter().fold(table, videg_report::Table::row)
}

/// The line above the tables.
pub fn heading(verb: &str, scenario: &Scenario) -> String {
    let [from, to] = scenario.window;
    format!(
        "{verb} {}: {}\n0 to {} s, averages over {from} to {to} s",
        scenario.name, scenario.description, scenario.until
    )
}

/// The list of files written.
pub fn file_list(files: &[PathBuf]) -> String {
    let shown: Vec<_> = files.iter().map(|file| format!("  {}", file.display())).collect();
    format!("written:\n{}", shown.join("\n"))
}

fn text(scenario: &Scenario, mechanics: &MechanicsSummary, files: &[PathBuf]) -> String {
    let parts = [heading("simulate", scenario), text_table(scenario, mechanics), file_list(files)];
    parts.join("\n\n")
}
