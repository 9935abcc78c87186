//! The tables of a crosscheck, as text and in the HTML report.

use super::crosscheck::Finished;
use super::crosscheck_picture::{OVERLAY_CAPTION, SWEEP_CAPTION};
use super::{format, output, run_output};
use crate::cosim::Energies;
use crate::crosscheck::{Agreement, Check, Claim, Compared, Solver};
use videg_report::{self, Column, Report, ReportError, Section, Table};

/// Significant digits of values.
const DIGITS: usize = 5;

const HEADINGS: [&str; 9] = [
    "quantity",
    "unit",
    "closed form",
    "embedded ideal",
    "embedded exponential",
    "ngspice batch",
    "ngspice live",
    "solvers",
    "claim",
];

/// Unit that people read, and the factor to it.
fn scaled(unit: &'static str) -> (&'static str, f64) {
    match unit {
        "J" => ("mJ", 1e3),
        "C" => ("uC", 1e6),
        other => (other, 1.0),
    }
}

fn solvers(agreement: &Agreement) -> String {
    let verdict = if agreement.agree { "agree" } else { "FAILED" };
    format!("{verdict}: {:.1e} of {:.0e}", agreement.deviation, agreement.tolerance)
}

fn claim(claim: &Claim) -> String {
    let verdict = if claim.holds { "holds" } else { "does not hold" };
    format!("{verdict}: {} ({:+.2} %)", claim.says, 100.0 * claim.deviation)
}

fn cells(check: &Check) -> Vec<String> {
    let (unit, factor) = scaled(check.unit);
    let value =
        |value: Option<f64>| value.map_or_else(String::new, |value| format::significant(factor * value, DIGITS));
    let mut row = vec![check.name.clone(), unit.to_owned(), value(check.analytic)];
    row.extend(Solver::ALL.map(|solver| value(check.values.get(solver))));
    row.push(check.agreement.as_ref().map(solvers).unwrap_or_default());
    row.push(check.claim.as_ref().map(claim).unwrap_or_default());
    row
}

/// The quantities that every solver was asked for, as text. Claims have a table of their own: a terminal is not wide
/// enough for both.
pub fn check_table(finished: &Finished) -> String {
    let headings: Vec<_> = HEADINGS.iter().map(|heading| heading.replace(' ', "\n")).collect();
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut table = format::table(&headings[..headings.len() - 1]);
    for check in finished.checks.iter().filter(|check| check.agreement.is_some() && by_all(check)) {
        let row = cells(check);
        table.add_row(format::row(&row[..row.len() - 1]));
    }
    table.to_string()
}

/// Whether more was asked than ngspice and one other.
fn by_all(check: &Check) -> bool {
    check.values.embedded_ideal.is_some()
}

/// The quantities by ngspice and one other, closed form or embedded solver, as text.
pub fn pair_table(finished: &Finished) -> String {
    let mut table =
        format::table(&["ngspice against closed form or embedded solver", "unit", "other", "ngspice", "solvers"]);
    for check in finished.checks.iter().filter(|check| !by_all(check)) {
        let (unit, factor) = scaled(check.unit);
        let value = |value: Option<f64>| value.map(|v| format::significant(factor * v, DIGITS)).unwrap_or_default();
        let other = value(check.values.embedded_exponential.or(check.analytic));
        let verdict = check.agreement.as_ref().map(solvers).unwrap_or_default();
        let row = [check.name.clone(), unit.to_owned(), other, value(check.values.ngspice_batch), verdict];
        table.add_row(format::row(&row));
    }
    table.to_string()
}

/// What the paper and the closed forms say, and whether it holds, as text.
pub fn claim_table(finished: &Finished) -> String {
    let mut table = format::table(&["claim", "unit", "closed form", "ngspice", "deviation", "verdict"]);
    for check in &finished.checks {
        let Some(claim) = &check.claim else { continue };
        let (unit, factor) = scaled(check.unit);
        let value = |value: Option<f64>| value.map(|v| format::significant(factor * v, DIGITS)).unwrap_or_default();
        let verdict = if claim.holds { "holds" } else { "does not hold" };
        let row = [
            claim.says.clone(),
            unit.to_owned(),
            value(check.analytic),
            value(check.values.ngspice_batch),
            format!("{:+.2} %", 100.0 * claim.deviation),
            verdict.to_owned(),
        ];
        table.add_row(format::row(&row));
    }
    table.to_string()
}

/// An energy that is compared: its name, and how to read it.
type Energy = (&'static str, fn(&Energies) -> f64);

const ENERGIES: [Energy; 6] = [
    ("supply", |energy| energy.supply),
    ("Zener", |energy| energy.zener),
    ("diode", |energy| energy.diode),
    ("load", |energy| energy.load),
    ("converted", |energy| energy.converted),
    ("surplus", |energy| energy.surplus),
];

fn comparison_headings() -> Vec<String> {
    let energies = ENERGIES.iter().map(|(name, _)| format!("{name}, mJ"));
    ["circuit", "solver"]
        .map(str::to_owned)
        .into_iter()
        .chain(energies)
        .chain(["quick release, mJ".to_owned()])
        .collect()
}

fn comparison_rows(compared: &[Compared]) -> Vec<Vec<String>> {
    let row = |circuit: &Compared, solver: &str, energy: &Energies| {
        let values = ENERGIES.iter().map(|(_, value)| format::significant(1e3 * value(energy), DIGITS));
        let closed = format::significant(1e3 * circuit.closed_form, DIGITS);
        [circuit.label.clone(), solver.to_owned()].into_iter().chain(values).chain([closed]).collect()
    };
    compared
        .iter()
        .flat_map(|circuit| {
            [row(circuit, "embedded", &circuit.embedded.energy), row(circuit, "ngspice", &circuit.ngspice.energy)]
        })
        .collect()
}

/// The paper's circuit, the switch and the storage, as text.
pub fn comparison_table(finished: &Finished) -> String {
    let headings = comparison_headings();
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut table = format::table(&headings);
    for row in comparison_rows(&finished.compared) {
        table.add_row(format::row(&row));
    }
    table.to_string()
}

const SWEEP: [&str; 6] = [
    "circuit",
    "most converted at, V",
    "predicted, V",
    "converted there, mJ",
    "surplus there, mJ",
    "ngspice at the predicted, mJ",
];

fn sweep_rows(finished: &Finished) -> Option<Vec<Vec<String>>> {
    let sweep = finished.sweep.as_ref()?;
    let row = |curve: &crate::crosscheck::Curve| {
        let (best, top) = curve.best()?;
        let predicted = sweep.predicted[usize::from(curve.circuit.starts_with("isolated"))];
        let witness = curve.witnesses.first().map_or(f64::NAN, |point| point.converted);
        let numbers = [top, predicted, 1e3 * best.converted, 1e3 * best.surplus, 1e3 * witness];
        let numbers = numbers.map(|value| format::significant(value, 5));
        Some(std::iter::once(curve.circuit.clone()).chain(numbers).collect())
    };
    Some(sweep.voltage.iter().filter_map(row).collect())
}

/// The best voltages of release, as text.
pub fn sweep_table(finished: &Finished) -> Option<String> {
    let mut table = format::table(&SWEEP);
    for row in sweep_rows(finished)? {
        table.add_row(format::row(&row));
    }
    Some(table.to_string())
}

fn html_table(headings: &[impl AsRef<str>], words: &[usize], rows: Vec<Vec<String>>) -> Table {
    let columns = headings.iter().enumerate().map(|(k, heading)| {
        let heading = heading.as_ref();
        if words.contains(&k) { Column::words(heading) } else { Column::numbers(heading) }
    });
    rows.into_iter().fold(Table::new(columns), Table::row)
}

/// The HTML report; `figures` are the overlay and, if there is a sweep, that of the sweep.
pub fn html(finished: &Finished, figures: Vec<String>) -> Result<String, ReportError> {
    let scenario = &finished.scenario;
    let report = Report::new(
        format!("Crosscheck of {}", scenario.name),
        format!("{}; 0 to {} s; circuit: {}.", scenario.description, scenario.until, finished.label),
    )
    .command(output::command_line())
    .generated_by(concat!("videg ", env!("CARGO_PKG_VERSION")));
    videg_report::render_html(&sections(finished, figures).into_iter().fold(report, Report::section))
}

/// The sections of the report.
pub fn sections(finished: &Finished, figures: Vec<String>) -> Vec<Section> {
    let mut result = Section::new("Conclusion");
    for warning in &finished.warnings {
        result = result.warning(warning.clone());
    }
    let result = finished.conclusion.iter().fold(result, |section, paragraph| section.text(paragraph.clone()));
    let checks = html_table(&HEADINGS, &[0, 1, 7, 8], finished.checks.iter().map(cells).collect());
    let compared = html_table(&comparison_headings(), &[0, 1], comparison_rows(&finished.compared));
    let mut figures = figures.into_iter();
    let mut sections = vec![
        result,
        Section::new("Claim by claim").text(LEGEND).table(checks),
        Section::new("The paper's circuit, an ideal switch, a storage").text(QUICK).table(compared),
        Section::new("Embedded solver and ngspice").figure(figures.next().unwrap_or_default(), OVERLAY_CAPTION),
        Section::new("Mechanics").table(run_output::mechanics(&finished.scenario, &finished.case.mechanics).html()),
    ];
    if let Some((rows, figure)) = sweep_rows(finished).zip(figures.next()) {
        let section = Section::new("Net gain over voltage of release and load").table(html_table(&SWEEP, &[0], rows));
        sections.push(section.figure(figure, SWEEP_CAPTION));
    }
    sections
}

const LEGEND: &str = "All solvers get the same piecewise linear C(t). Solvers: the pair that uses up most of its tolerance, \
    relative for energies and charges, V for voltages. Claim: whether what the paper or a closed form says holds in a \
    circuit simulator; one that does not is a finding. \
    U_DE4 is measured on an open circuit, with the pulses of the run in order of their height: a membrane would keep the \
    charge of the highest pulse so far.";

const QUICK: &str = "Quick release: sum over the impacts of (C3 U_in - C2 U_r)(U_r - U_in), the net gain of a cycle that \
    releases its charge at U_r, less what it takes to fill the membranes to U_r once.";
