//! `videg reproduce`: the tables and figures of the paper, as data, pictures and one report.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow};
use clap::Args;
use serde::Serialize;

use super::format::Sheet;
use super::interruption::Interruption;
use super::progress::ItemBar;
use super::reproduce_report::{self as page, Chapter};
use super::results::{Identity, OutputOptions, RESULT, flag, listed};
use super::{Exit, output, packaging, picture, reproduce_files as files, run_output};
use crate::cosim::{Cosimulation, Options, SeriesOptions, SeriesRecorder};
use crate::crosscheck;
use crate::ngspice::Ngspice;
use crate::paper::{self, Artefact, Effort, Finding, ITEMS, Item, Study, Verdict};
use crate::progress::{Progress, during};
use crate::scenario::Request;
use fmu_import::{Fmu, nearest_name};
use videg_system::folders;

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    /// Items to make, e.g. table2 fig14; all: every item [default: all]
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    #[command(flatten)]
    output: OutputOptions,
    /// Use fewer samples and coarser grids, for a quick look
    #[arg(long)]
    quick: bool,
    /// Print one JSON object on stdout instead of the table
    #[arg(long)]
    json: bool,
}

/// Made beside the items of the paper: the energy audit and the comparison with ngspice.
const AUDIT: &str = "audit";
const CROSSCHECK: &str = "crosscheck";
/// The name of every item.
pub const ALL: &str = "all";

/// The file with all numbers.
const SUMMARY: &str = "summary.csv";

/// End of the run of the crosscheck, s, and that of a quick one.
const CROSSCHECKED: [f64; 2] = [10.0, 5.0];

#[derive(Serialize)]
struct Output<'a> {
    request: &'a Identity,
    quick: bool,
    /// Whether each difference from the paper has a known reason, and the solvers of the crosscheck agree.
    passed: bool,
    items: &'a [Chapter],
    warnings: &'a [String],
    report: &'a Path,
}

/// Everything made so far.
struct Reproduction<'a> {
    folder: &'a Path,
    chapters: Vec<Chapter>,
    warnings: Vec<String>,
    /// Whether the solvers of the crosscheck disagree, or ngspice stopped.
    solvers_disagree: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments, interruption: &Interruption) -> anyhow::Result<Exit> {
    let wanted = Wanted::new(&arguments.names)?;
    let all = arguments.names.is_empty() || wanted.names_it(ALL);
    let items = listed(if all { &[] } else { &arguments.names });
    let identity = Identity::new("reproduce", [("items", items), ("quick", flag(arguments.quick))]);
    let folder = arguments.output.folder(&identity)?;
    let shown = folder.display();
    let kept =
        format!("what is in {shown} is complete, of this run or an earlier one; the same command makes all anew");
    interruption.tell(&kept);
    make(arguments, &wanted, &identity, &folder).map_err(|error| anyhow!("{error:#}; {kept}"))
}

/// Makes what is wanted.
fn make(arguments: &Arguments, wanted: &Wanted, identity: &Identity, folder: &Path) -> anyhow::Result<Exit> {
    let fmu = packaging::open("VibroImpactHarvester")?;
    let effort = if arguments.quick { Effort::Quick } else { Effort::Full };
    let mut made = Reproduction { folder, chapters: Vec::new(), warnings: Vec::new(), solvers_disagree: false };
    let bar = ItemBar::new(wanted.count());
    let study = Study { fmu: &fmu, effort, observer: &bar };
    for item in paper::reproduce(&study, |name| wanted.has(name)) {
        let (item, artefact) = item?;
        made.add(item, artefact)?;
    }
    if wanted.has(AUDIT) {
        during(&bar, AUDIT, "where the energy goes", || made.audit(&fmu))?;
    }
    if wanted.has(CROSSCHECK) {
        let (must, until) = (wanted.names_it(CROSSCHECK), CROSSCHECKED[usize::from(arguments.quick)]);
        during(&bar, CROSSCHECK, "against ngspice", || made.crosscheck(&fmu, must, until, &bar))?;
    }
    drop(bar);
    let passed = !made.solvers_disagree && !made.findings().any(|finding| finding.verdict == Verdict::Differs);
    let report = page::write(folder, &made.chapters, &made.warnings, &fmu, arguments.quick)?;
    files::summary(&folder.join(SUMMARY), made.findings())?;
    let (items, warnings) = (&made.chapters[..], &made.warnings[..]);
    let result = Output { request: identity, quick: arguments.quick, passed, items, warnings, report: &report };
    let json = run_output::json(&result)?;
    output::write(&folder.join(RESULT), &json)?;
    run_output::show(arguments.json, &json, &[made.text(&report)], warnings)?;
    Ok(if passed { Exit::Passed } else { Exit::Failed })
}

/// Names of all that is made, with their titles.
pub fn items() -> impl Iterator<Item = (&'static str, &'static str)> {
    let beside = [(AUDIT, "Where the energy goes"), (CROSSCHECK, "Comparison with ngspice")];
    ITEMS.iter().map(|item| (item.name, item.title)).chain(beside)
}

fn all_names() -> impl Iterator<Item = &'static str> {
    items().map(|(name, _)| name)
}

/// Names of the items to make.
struct Wanted {
    names: Vec<String>,
}

impl Wanted {
    fn new(names: &[String]) -> anyhow::Result<Self> {
        let known: Vec<&str> = all_names().chain([ALL]).collect();
        if let Some(unknown) = names.iter().find(|name| !known.contains(&name.as_str())) {
            let hint = nearest_name(unknown, known.iter().copied());
            let hint = hint.map_or_else(String::new, |nearest| format!("did you mean {nearest}? "));
            anyhow::bail!("reproduce {unknown}: no such table or figure; {hint}there are: {}", known.join(", "));
        }
        Ok(Self { names: names.to_vec() })
    }

    fn has(&self, name: &str) -> bool {
        self.names.is_empty() || self.names.iter().any(|wanted| wanted == name || wanted == ALL)
    }

    /// Whether the user gave this name.
    fn names_it(&self, name: &str) -> bool {
        self.names.iter().any(|wanted| wanted == name)
    }

    fn count(&self) -> usize {
        all_names().filter(|name| self.has(name)).count()
    }
}

impl Reproduction<'_> {
    fn add(&mut self, item: &Item, artefact: Artefact) -> anyhow::Result<()> {
        let files = files::write(self.folder, &artefact.sheets, &artefact.pictures)?;
        self.chapters.push(Chapter::new(item.name, item.title, artefact, files));
        Ok(())
    }

    fn subfolder(&self, name: &str) -> anyhow::Result<PathBuf> {
        let folder = self.folder.join(name);
        folders::make(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        Ok(folder)
    }

    /// Fig. 14 coupled with the paper's circuit and with better ones.
    fn audit(&mut self, fmu: &Fmu) -> anyhow::Result<()> {
        let folder = self.subfolder(AUDIT)?;
        let svg = folder.join("figure.svg");
        let scenario = Request { case: Some("fig14".to_owned()), ..Request::default() }.resolve()?;
        let cosimulation = Cosimulation::new(&Options::new(fmu, &scenario))?;
        let series = SeriesOptions::default();
        let mut recorder = SeriesRecorder::create((&folder, "timeseries"), &series, &scenario, Some(&[]))?;
        let results = match cosimulation.run(&mut recorder, &()) {
            Ok(results) => results,
            Err(error) => {
                recorder.discard();
                return Err(error.into());
            }
        };
        let written = recorder.finish()?;
        let drawing = picture::cosim(&results.trace, &scenario, picture::Electrical::Paper)?;
        output::write(&svg, &drawing.svg)?;
        self.warnings.extend(results.warnings.iter().cloned());
        self.chapters.push(Chapter::audit(AUDIT, &results, drawing, written.into_iter().chain([svg]).collect()));
        Ok(())
    }

    /// All claims in ngspice, if it is there. Where it was asked for by name, it must be there. Its run is `until`, s, and so shorter than
    /// that of the verb: it shows that the solvers agree, impact by impact, and ngspice takes the time of all other items together for 100 s.
    fn crosscheck(&mut self, fmu: &Fmu, must: bool, until: f64, progress: &dyn Progress) -> anyhow::Result<()> {
        let ngspice = match Ngspice::find(None) {
            Ok(ngspice) => ngspice,
            Err(error) if must => return Err(error.into()),
            Err(error) => {
                self.warnings.push(format!("the crosscheck is left out: {error}"));
                return Ok(());
            }
        };
        let folder = self.subfolder(CROSSCHECK)?;
        let scenario =
            Request { case: Some("fig14".to_owned()), until: Some(until), ..Request::default() }.resolve()?;
        let program = packaging::program()?;
        let (scenario, ngspice, program) = (&scenario, &ngspice, &program);
        let options = crosscheck::Options { harvester: fmu, scenario, ngspice, program, sweep: false };
        let found = crosscheck::run(&options, progress)?;
        self.solvers_disagree = !found.passed();
        let (files, figures) = crosscheck::files::write(&folder, &found)?;
        self.warnings.extend(found.warnings.iter().cloned());
        self.chapters.push(Chapter::crosscheck(CROSSCHECK, &found, figures, files));
        Ok(())
    }

    fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.chapters.iter().flat_map(|chapter| &chapter.findings)
    }

    fn text(&self, report: &Path) -> String {
        let (compared, beyond): (Vec<_>, Vec<_>) = self.findings().partition(|finding| finding.is_compared());
        let (shown, left) = if compared.is_empty() { (beyond, Vec::new()) } else { (compared, beyond) };
        let rows = shown.into_iter().map(|finding| {
            let [place, quantity, unit, paper, videg, deviation, verdict, _] = page::cells(finding);
            vec![format!("{place}: {quantity}"), unit, paper, videg, deviation, verdict]
        });
        let headings = ["where and what", "unit", "paper", "videg", "deviation", "verdict"];
        let table = Sheet::new(headings, &[5], rows.collect()).text();
        let files: usize = self.chapters.iter().map(|chapter| chapter.files.len()).sum();
        let more = match left.len() {
            0 => format!("these numbers are in {SUMMARY}, with reasons"),
            left => format!("{left} more numbers, of which the paper says nothing, are in {SUMMARY}"),
        };
        let written = run_output::file_list(&[self.folder.join(SUMMARY), report.to_owned()]);
        format!("{table}\n\n{more}; {files} files with data and pictures are beside it\n\n{written}")
    }
}
