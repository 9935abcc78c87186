//! Output that the verbs with a run share: JSON, tables, report and files.

use std::path::{Path, PathBuf};

use serde::Serialize;
use videg_report::{KeyNumber, Report, Section};

use super::format::{Sheet, deviation, significant};
use super::results::{Identity, Results};
use super::{output, terminal};
use crate::cosim::{Device, MechanicsSummary};
use crate::scenario::{PaperValues, Scenario, Setting};

/// The keys of `--json` for every run: scenario and mechanics.
#[derive(Serialize)]
pub struct RunOutput<'a> {
    case: &'a str,
    description: &'a str,
    until: f64,
    step: f64,
    window: [f64; 2],
    #[serde(flatten)]
    mechanics: MechanicsSummary,
    paper: PaperValues,
    settings: &'a [Setting],
    warnings: &'a [String],
    files: &'a [PathBuf],
    request: &'a Identity,
}

impl<'a> RunOutput<'a> {
    /// The output of a run of `scenario`.
    pub fn new(
        request: &'a Identity,
        scenario: &'a Scenario,
        mechanics: MechanicsSummary,
        warnings: &'a [String],
        files: &'a [PathBuf],
    ) -> Self {
        let Scenario { name, description, settings, until, step, window, paper, .. } = scenario;
        let (until, step, window, paper) = (*until, *step, *window, *paper);
        Self { request, case: name, description, until, step, window, mechanics, paper, settings, warnings, files }
    }
}

/// The table of the mechanics beside the paper's values.
pub fn mechanics(scenario: &Scenario, mechanics: &MechanicsSummary) -> Sheet {
    let compared = |quantity: &str, unit: &str, paper: Option<f64>, found: f64, scale: f64| {
        let printed = paper.map_or_else(String::new, |paper| significant(paper * scale, 4));
        let difference = paper.map_or_else(String::new, |paper| deviation(found, paper));
        vec![quantity.to_owned(), unit.to_owned(), printed, significant(found * scale, 6), difference]
    };
    let count = |quantity: &str, number: i32| {
        vec![quantity.to_owned(), "1".to_owned(), String::new(), number.to_string(), String::new()]
    };
    let rows = vec![
        compared("<U>, Eq. (15)", "V/s", scenario.paper.voltage_gain, mechanics.average_voltage_gain, 1.0),
        compared("P, Eq. (14)", "mW", scenario.paper.power, mechanics.average_power_eq13, 1e3),
        count("impacts, whole run", mechanics.impacts),
        count("events computed", mechanics.events),
    ];
    Sheet::new(["quantity", "unit", "paper", "videg", "deviation"], &[0, 1], rows)
}

/// The line above the tables.
pub fn heading(verb: &str, scenario: &Scenario) -> String {
    let [from, to] = scenario.window;
    let Scenario { name, description, until, .. } = scenario;
    format!("{verb} {name}: {description}\n0 to {until} s, averages over {from} to {to} s")
}

/// An HTML report of a run, with nothing but its heading.
pub fn report(title: String, scenario: &Scenario) -> Report {
    let [from, to] = scenario.window;
    let subtitle = format!("{}; 0 to {} s, averages over {from} to {to} s.", scenario.description, scenario.until);
    output::report(title, subtitle)
}

/// The section of a report with the `warnings` of a run.
pub fn result(warnings: &[String]) -> Section {
    warnings.iter().cloned().fold(Section::new("Result"), Section::warning)
}

/// A mean power in big type: W, mW or uW by the size of the `largest` that it stands with.
pub fn power(label: &str, watt: f64, largest: f64) -> KeyNumber {
    let (unit, factor) = match largest.abs() {
        large if large >= 0.1 => ("W", 1.0),
        small if small < 1e-6 && small > 0.0 => ("uW", 1e6),
        _ => ("mW", 1e3),
    };
    let value = if watt.is_nan() { "-".to_owned() } else { significant(factor * watt, 4) };
    KeyNumber::new(label, value, unit)
}

/// `<U>` in big type, beside the paper's.
pub fn voltage_gain(scenario: &Scenario, mechanics: &MechanicsSummary) -> KeyNumber {
    let found = mechanics.average_voltage_gain;
    let number = KeyNumber::new("<U>, Eq. (15)", significant(found, 5), "V/s");
    match scenario.paper.voltage_gain {
        Some(paper) => number.note(format!("paper: {paper} ({})", deviation(found, paper))),
        None => number,
    }
}

/// Impacts per period of the harmonic excitation, or per second if there is none.
pub fn impact_rate(scenario: &Scenario, mechanics: &MechanicsSummary, device: &Device) -> KeyNumber {
    let rate = f64::from(mechanics.impacts) / scenario.until;
    let note = format!("{} in {} s", mechanics.impacts, scenario.until);
    let harmonic = device.parameters.as_ref().map(|(parameters, _)| parameters);
    match harmonic.filter(|parameters| parameters.cylinder_amplitude() > 0.0) {
        Some(p) => KeyNumber::new("impacts per period", significant(rate / p.frequency, 4), "").note(note),
        None => KeyNumber::new("impacts per second", significant(rate, 4), "").note(note),
    }
}

/// The list of files written.
pub fn file_list(files: &[PathBuf]) -> String {
    file_list_within(files, terminal::width())
}

/// The same for a terminal of these columns, or for none. Where paths are too long for it, it goes folder by folder.
fn file_list_within(files: &[PathBuf], columns: Option<usize>) -> String {
    let lines: Vec<_> = files.iter().map(|file| format!("  {}", file.display())).collect();
    let fits = |columns: usize| lines.iter().all(|line| terminal::columns_of(line) <= columns);
    if columns.is_none_or(fits) {
        return format!("written:\n{}", lines.join("\n"));
    }
    let folder = |file: &PathBuf| file.parent().unwrap_or(Path::new("")).display().to_string();
    let name = |file: &PathBuf| format!("  {}", Path::new(file.file_name().unwrap_or_default()).display());
    let group = |files: &[PathBuf]| {
        let folder = files.first().map(folder).filter(|folder| !folder.is_empty());
        let place = folder.map_or_else(String::new, |folder| format!(" in {folder}"));
        format!("written{place}:\n{}", files.iter().map(name).collect::<Vec<_>>().join("\n"))
    };
    files.chunk_by(|one, other| one.parent() == other.parent()).map(group).collect::<Vec<_>>().join("\n")
}

/// Writes figure and report of a run into `folder`. Returns all files of the run, `series` first and the result, which is
/// yet to be written, last.
pub fn write(folder: &Path, series: &[PathBuf], svg: &str, html: &str) -> anyhow::Result<Vec<PathBuf>> {
    let [figure, report, result] = ["figure.svg", "report.html", "result.json"].map(|name| folder.join(name));
    output::write(&figure, svg)?;
    output::write(&report, html)?;
    Ok([series, &[figure, report, result]].concat())
}

/// Writes the `result` of a run, with which the `results` are complete, and shows it.
pub fn conclude(
    results: Results<'_>,
    is_json: bool,
    result: &str,
    text: &[String],
    warnings: &[String],
) -> anyhow::Result<()> {
    results.complete(result)?;
    show(is_json, result, text, warnings)
}

/// Prints the `result` of a run, or the parts of its `text`; then shows the warnings.
pub fn show(is_json: bool, result: &str, text: &[String], warnings: &[String]) -> anyhow::Result<()> {
    if is_json {
        output::print_json(result)?;
    } else {
        output::print(&text.join("\n\n"))?;
    }
    output::warn(warnings);
    Ok(())
}

/// The result of a run as JSON.
pub fn json(result: &impl Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string_pretty(result)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_with_long_paths_are_listed_folder_by_folder_on_a_narrow_terminal() {
        let files = ["out/long-name/a.csv", "out/long-name/b.csv", "out/long-name/figures/c.svg"].map(PathBuf::from);
        let whole = "written:\n  out/long-name/a.csv\n  out/long-name/b.csv\n  out/long-name/figures/c.svg";
        assert_eq!([None, Some(29)].map(|columns| file_list_within(&files, columns)), [whole, whole]);
        let narrow = "written in out/long-name:\n  a.csv\n  b.csv\nwritten in out/long-name/figures:\n  c.svg";
        assert_eq!(file_list_within(&files, Some(28)), narrow);
        assert_eq!(file_list_within(&["long-name.csv".into()], Some(10)), "written:\n  long-name.csv");
    }
}
