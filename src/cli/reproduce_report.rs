//! The report of `videg reproduce`: one page with the summary first, then each table and figure.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{cosim_report, crosscheck_report, format, output};
use crate::cosim::Results;
use crate::crosscheck::Crosscheck;
use crate::crosscheck::figures::{OVERLAY_CAPTION, SWEEP_CAPTION};
use crate::paper::{Artefact, Finding, Verdict};
use fmu_import::Fmu;
use videg_report::{self, Cell, Column, Drawing, KeyNumber, Section, Table, Tone};

/// One table or figure in the report. Field names are the keys of `--json`.
#[derive(Serialize)]
pub struct Chapter {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// Its numbers beside the paper's.
    pub findings: Vec<Finding>,
    /// The files written.
    pub files: Vec<PathBuf>,
    #[serde(skip)]
    section: Section,
}

impl Chapter {
    /// A table or figure of the paper.
    pub fn new(name: &'static str, title: &'static str, artefact: Artefact, files: Vec<PathBuf>) -> Self {
        let Artefact { findings, text, tables, pictures, .. } = artefact;
        let section = Section::new(title).id(name);
        let section = if findings.is_empty() { section } else { section.text(verdicts(&findings)) };
        let section = section.drawings(pictures.into_iter().map(|picture| (picture.drawing, picture.caption)));
        let numbers = findings.iter().fold(Table::new(columns()), |table, finding| table.row(row(None, finding)));
        let inner = text.into_iter().fold(Section::new("Numbers and explanations"), Section::text);
        let inner = if findings.is_empty() { inner } else { inner.table(numbers) };
        let inner = tables.into_iter().fold(inner, Section::table);
        Self { name, title, findings, files, section: section.folded(inner) }
    }

    /// Where the energy goes.
    pub fn audit(name: &'static str, results: &Results, drawing: Drawing, files: Vec<PathBuf>) -> Self {
        let title = "Energy audit of Figure 14";
        let inner = Section::new("Energies and explanations")
            .table(cosim_report::energies(results).html())
            .text(cosim_report::EXPLANATION.join(" "))
            .text(cosim_report::coupling_lines(results));
        let section = Section::new(title).id(name).drawings([(drawing, cosim_report::FIGURE_CAPTION)]).folded(inner);
        Self { name, title, findings: Vec::new(), files, section }
    }

    /// What ngspice says.
    pub fn crosscheck(name: &'static str, found: &Crosscheck, figures: Vec<String>, files: Vec<PathBuf>) -> Self {
        let title = "Crosscheck with ngspice";
        let lead =
            format!("{}; 0 to {} s; circuit: {}.", found.scenario.description, found.scenario.until, found.label);
        let captions = [OVERLAY_CAPTION, SWEEP_CAPTION].map(str::to_owned);
        let section = Section::new(title).id(name).text(lead).figures(figures.into_iter().zip(captions));
        let section = crosscheck_report::sections(found, Vec::new()).into_iter().fold(section, Section::folded);
        Self { name, title, findings: Vec::new(), files, section }
    }
}

/// The verdicts of the numbers that the paper speaks of, by their frequency in the order of the enumeration.
fn counts<'a>(findings: impl Iterator<Item = &'a Finding> + Clone) -> impl Iterator<Item = (Verdict, usize)> {
    let count = move |verdict| (verdict, findings.clone().filter(|finding| finding.verdict == verdict).count());
    ORDER.into_iter().map(count).filter(|(_, count)| *count > 0)
}

/// From good to bad.
const ORDER: [Verdict; 6] =
    [Verdict::Agrees, Verdict::WithinEnsemble, Verdict::Tail, Verdict::Explained, Verdict::Differs, Verdict::Beyond];

/// One line on the numbers of a chapter.
fn verdicts(findings: &[Finding]) -> String {
    let shown: Vec<_> =
        counts(findings.iter()).map(|(verdict, count)| format!("{}: {count}", verdict.words())).collect();
    shown.join("; ")
}

/// Headings of the summary table.
pub const HEADINGS: [&str; 8] = ["where", "quantity", "unit", "paper", "videg", "deviation", "verdict", "reason"];

/// The row of a finding in the summary table.
pub fn cells(finding: &Finding) -> [String; 8] {
    let deviation = |paper: f64| if paper == 0.0 { String::new() } else { format::deviation(finding.videg, paper) };
    [
        finding.place.clone(),
        finding.quantity.clone(),
        finding.unit.clone(),
        finding.paper.map(|paper| format!("{paper}")).unwrap_or_default(),
        format::significant(finding.videg, 6),
        finding.paper.map(deviation).unwrap_or_default(),
        finding.verdict.words().to_owned(),
        finding.reason.clone(),
    ]
}

/// Writes the report into `folder`; returns its path.
pub fn write(
    folder: &Path,
    chapters: &[Chapter],
    warnings: &[String],
    fmu: &Fmu,
    quick: bool,
) -> anyhow::Result<PathBuf> {
    let mut report = output::report(
        "The paper, reproduced",
        "Every table and figure of \"Energy harvesting from a DE-based dynamic vibro-impact system\", computed through the \
         FMI 2.0 co-simulation interface of VibroImpactHarvester.fmu, and what lies beyond the paper.",
    )
    .paired()
    .section(summary(chapters, warnings, quick));
    for chapter in chapters {
        report = report.section(chapter.section.clone());
    }
    let path = folder.join("report.html");
    output::write(&path, &videg_report::render_html(&report.section(versions(fmu)))?)?;
    Ok(path)
}

fn summary(chapters: &[Chapter], warnings: &[String], quick: bool) -> Section {
    let rows = chapters.iter().flat_map(|chapter| {
        let compared = chapter.findings.iter().filter(|finding| finding.is_compared());
        compared.map(|finding| row(Some(chapter.name), finding))
    });
    let rows: Vec<_> = rows.collect();
    let legend = "Verdicts: agrees - within what the paper's digits and method allow or, where it prints no number, what it \
                  says in words holds; within ensemble - the motion is chaotic, and the paper's value lies within the \
                  middle 95 % of nearby starts; in the tail - it lies outside of these; explained - the reason beside it \
                  accounts for the difference. Numbers of which the paper says nothing stand with each figure below.";
    let all = chapters.iter().flat_map(|chapter| &chapter.findings);
    let compared = rows.len();
    let keys = counts(all).map(|(verdict, count)| {
        let key = KeyNumber::new(verdict.words(), count.to_string(), "");
        if verdict == Verdict::Agrees {
            key.note(format!("of {compared} numbers that the paper has")).main()
        } else {
            key
        }
    });
    let section = Section::new("Summary").id("summary");
    let section = if quick { section.warning("Made with --quick: fewer samples and coarser grids.") } else { section };
    let section = warnings.iter().cloned().fold(section, Section::warning).keys(keys).thumbnails();
    if rows.is_empty() {
        return section.text("The paper says nothing of the numbers below.");
    }
    let table = rows.into_iter().fold(Table::new(columns()), Table::row);
    section.folded(Section::new("All numbers beside the paper's, and what the verdicts mean").text(legend).table(table))
}

fn columns() -> impl Iterator<Item = Column> {
    ["where", "quantity", "paper", "videg", "deviation", "verdict", "reason"].into_iter().map(|heading| {
        let number = ["paper", "videg", "deviation"].contains(&heading);
        if number { Column::numbers(heading) } else { Column::words(heading) }
    })
}

/// The row of a finding, with a link to the chapter of this id if there is one, and the verdict as a badge.
fn row(chapter: Option<&str>, finding: &Finding) -> [Cell; 7] {
    let [place, quantity, unit, paper, videg, deviation, verdict, reason] = cells(finding);
    let tone = match finding.verdict {
        Verdict::Agrees => Tone::Good,
        Verdict::WithinEnsemble => Tone::Near,
        Verdict::Tail | Verdict::Explained => Tone::Noted,
        Verdict::Differs => Tone::Bad,
        Verdict::Beyond => Tone::Neutral,
    };
    [
        chapter.map_or_else(|| Cell::from(place.clone()), |chapter| Cell::link(place.clone(), chapter)),
        Cell::from(if unit == "1" { quantity } else { format!("{quantity} ({unit})") }),
        Cell::from(paper),
        Cell::from(videg),
        Cell::from(deviation),
        Cell::badge(verdict, tone),
        Cell::from(reason),
    ]
}

fn versions(fmu: &Fmu) -> Section {
    let description = fmu.description();
    let table = [
        ["videg".to_owned(), env!("CARGO_PKG_VERSION").to_owned()],
        [format!("{}.fmu", description.model_name), format!("FMI 2.0, guid {}", description.guid)],
        ["platform".to_owned(), format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)],
    ];
    let rows = Table::new([Column::words("what"), Column::words("version")]);
    Section::new("Versions").id("versions").table(table.into_iter().fold(rows, Table::row))
}
