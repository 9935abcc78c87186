//! `videg export`: C(t) of a run for other programs.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;

use super::interruption::Interruption;
use super::isolation::IsolationOptions;
use super::options::TimedCaseOptions;
use super::progress::TimeBar;
use super::results::{Identity, chosen, listed};
use super::{Exit, output};
use crate::export::{self, Format, Options};
use crate::scenario::Scenario;
use crate::simulate::Points;
use videg_system::atomic_file::Batch;
use videg_system::folders;

/// Error of the knots of a netlist, where none is given.
const KNOTS: f64 = 1e-4;
/// Distance of the rows of a table, s, where none is given.
const SAMPLE: f64 = 1e-3;

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    case: TimedCaseOptions,
    /// What reads the file: a simulator of circuits, or a program for tables
    #[arg(long, value_enum, default_value_t = Format::Ngspice)]
    format: Format,
    /// A point each S seconds [default for tables: 1e-3]
    #[arg(long, value_name = "S", allow_negative_numbers = true, conflicts_with = "knots")]
    sample: Option<f64>,
    /// As few points as straight lines between them need for this error, relative to the height of the largest pulse so
    /// far [default for netlists: 1e-4]
    #[arg(long, value_name = "ERROR", allow_negative_numbers = true)]
    knots: Option<f64>,
    /// Variables of the harvester that a table has beside the time, with commas between them [default: left.capacitance,
    /// right.capacitance]
    #[arg(long, value_name = "VARIABLES", value_delimiter = ',')]
    columns: Vec<String>,
    /// File to write [default: out/export-CASE and the settings, with the ending of the format]
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print one JSON object on stdout
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    isolation: IsolationOptions,
}

impl Arguments {
    /// The file to write.
    fn path(&self, scenario: &Scenario) -> anyhow::Result<PathBuf> {
        if let Some(path) = &self.output {
            return Ok(path.clone());
        }
        let number = |number: Option<f64>| number.map(|number| number.to_string());
        let options = [
            ("sample", number(self.sample)),
            ("knots", number(self.knots)),
            ("columns", listed(&self.columns)),
            // Others have an ending of their own.
            ("format", chosen(&self.format, &Format::Ngspice).filter(|_| self.format.is_netlist())),
        ];
        let mut name = Identity::of("export", scenario, options)?.path().into_os_string();
        name.push(".");
        name.push(self.format.extension());
        Ok(name.into())
    }
}

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let scenario = arguments.case.scenario()?;
    let format = arguments.format;
    let points = match (arguments.sample, arguments.knots) {
        (Some(sample), _) => Points::Sample(sample),
        (None, Some(error)) => Points::Knots(error),
        (None, None) if format.is_netlist() => Points::Knots(KNOTS),
        (None, None) => Points::Sample(SAMPLE.min(scenario.until)),
    };
    let harvester = arguments.isolation.open_own("VibroImpactHarvester")?;
    let path = arguments.path(&scenario)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    folders::make(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    interruption.tell("nothing of this run is left");
    let batch = Batch::begin(folder);
    let options = Options {
        harvester: &harvester,
        scenario: &scenario,
        format,
        points,
        columns: &arguments.columns,
        path: &path,
    };
    let exported = export::run(&options, &TimeBar::new(&scenario.name))?;
    batch.commit().with_context(|| format!("cannot give {} its name", path.display()))?;
    interruption.tell("the results are complete");
    output::show(arguments.json, &exported, || {
        let files: Vec<_> = exported.files.iter().map(|file| format!("  {}", file.display())).collect();
        let [left, right] = exported.initial_capacitance.map(|c| 1e12 * c);
        format!(
            "{}: {} rows of {} up to {} s; membrane at rest {:.6} pF, at 0 s left {left:.6} pF, right {right:.6} pF\nwritten:\n{}",
            scenario.name,
            exported.rows,
            exported.columns.join(", "),
            exported.until,
            1e12 * exported.rest_capacitance,
            files.join("\n")
        )
    })?;
    output::warn(&exported.warnings);
    Ok(Exit::Passed)
}
