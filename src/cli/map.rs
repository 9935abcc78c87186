//! `videg map`: a quantity over two variables of harvester and circuit, its best point, and the limits of the film.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use super::interruption::Interruption;
use super::isolation::IsolationOptions;
use super::map_report::{self as page, Found};
use super::message::say;
use super::progress::RunBar;
use super::results::RESULT;
use super::run_output::file_list;
use super::sweep_options::{Common, Execution, What};
use super::{Exit, output, reproduce_files as files, run_output};
use crate::map::{self, MapError, Outcome, Plan, picture};
use crate::sweep::{self, Design, Engine, POWERS, Sampling, System, Vary};

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    /// Variable on the horizontal axis, a parameter of harvester or circuit: name=from:to:count, with log: before from for equal ratios
    #[arg(value_name = "X=VALUES")]
    x: String,
    /// Variable on the vertical axis
    #[arg(value_name = "Y=VALUES")]
    y: String,
    /// Case file (TOML) with case, until, window and a [set] table
    #[arg(value_name = "FILE.toml")]
    file: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
    /// What to map: `net_power`, `load_power`, `supply_power`, `average_voltage_gain`, or any other number that a sweep records
    #[arg(long, value_name = "NAME", default_value = POWERS[0])]
    of: String,
    /// Runs of each point, whose mean is mapped; sample i has the same noise at all points [default: 1]
    #[arg(long, value_name = "N")]
    samples: Option<u64>,
    /// Seed of the noise of the first sample; each further one takes the next [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    #[command(flatten)]
    execution: Execution,
    /// Folder for results, figure and report; the same command with the same folder resumes [default: out/map-CASE, or if another map is there
    /// out/map-CASE-DIGEST]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object on stdout instead of the table
    #[arg(long)]
    json: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let started = Instant::now();
    let plan = arguments.plan()?;
    let name = plan.sweep.name().to_owned();
    let default = || sweep::free_folder(&plan.sweep, &Path::new("out").join(format!("map-{}", output::safe(&name))));
    let folder = arguments.output.clone().map_or_else(default, Ok)?;
    let harvester = || IsolationOptions::default().open_own("VibroImpactHarvester");
    let engine = Engine::System(Box::new(System::new(&plan.sweep, harvester)?));
    let options = arguments.execution.options(&plan.sweep, &engine, &folder);
    let bar = RunBar::new(&format!("map {name}"), interruption.defer());
    let stopped = |message: &str| {
        say(message);
        Ok(Exit::Stopped(u8::try_from(interruption.signal())?))
    };
    let Outcome { report, map } = match map::run(&plan, &options, &bar) {
        Err(error @ MapError::Stopped) => return stopped(&error.to_string()),
        Err(error @ MapError::AllFailed { .. }) => {
            say(&error.to_string());
            return Ok(Exit::Failed);
        }
        outcome => outcome?,
    };
    drop(bar);
    match map {
        Some(map) => {
            let found = Found { plan: &plan, map: &map, report: &report, elapsed: started.elapsed() };
            let drawn = picture(&plan, &map, &page::caption(&found))?;
            let mut paths = [&report.files[..], &files::write(&folder, &[], std::slice::from_ref(&drawn))?].concat();
            let html = videg_report::render_html(&page::report(&found, drawn))?;
            let path = folder.join("map.html");
            output::write(&path, html)?;
            paths.extend([path, folder.join(RESULT)]);
            let text = page::text(&found, &paths);
            let json = run_output::json(&page::Output::new(&found, &paths))?;
            output::write(&folder.join(RESULT), &json)?;
            run_output::show(arguments.json, &json, &text, &page::warnings(&found))?;
            Ok(Exit::Passed)
        }
        None if report.is_complete() => {
            let how = "`videg sweep merge` puts the shards together; the same command without --shard and with the merged folder \
                       as --output draws the map";
            output::print(&format!("{} runs; {how}\n\n{}", report.runs, file_list(&report.files)))?;
            Ok(Exit::Passed)
        }
        None => stopped(&format!(
            "interrupted after {} of {} runs; the same command without --fresh goes on from there",
            report.done, report.runs
        )),
    }
}

impl Arguments {
    /// The map that was asked for, checked.
    fn plan(&self) -> anyhow::Result<Plan> {
        let [x, y] = [Vary::parse(&self.x)?, Vary::parse(&self.y)?];
        let what = What {
            files: self.file.iter().cloned().collect(),
            common: self.common.clone(),
            sampling: Sampling { samples: self.samples, seed: self.seed, ..Sampling::default() },
            ..What::default()
        };
        let description = sweep::system_description()?;
        let file = what.sweep_file()?;
        if let Some(other) = file.vary.first() {
            anyhow::bail!("{}: a map varies its two axes alone", other.origin.entry("vary", &other.name));
        }
        if let Some(design) = file.sampling.design.filter(|design| *design != Design::Grid) {
            anyhow::bail!("{}: a map is over a grid", file.case.origin(false).value("design", &design.to_string()));
        }
        let sweep = what.request(file, &description, None, None)?;
        Ok(Plan::new(map::Request { sweep, x, y, of: self.of.clone() })?)
    }
}
