//! The tables of a crosscheck, as text and in the HTML report.

use super::format::{Sheet, significant};
use super::{drawn, output, parameter_table, run_output};
use crate::cosim::{Device, Energies};
use crate::crosscheck::figures::{OVERLAY_CAPTION, SWEEP_CAPTION};
use crate::crosscheck::{Agreement, ComparedCircuit, Crosscheck, QuantityCheck, Solver, SweepCurve};
use videg_report::{self, KeyNumber, Report, Section};

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

/// A value of a check in the unit of its table.
fn value(check: &QuantityCheck, value: Option<f64>) -> String {
    let (_, factor) = scaled(check.unit);
    value.map_or_else(String::new, |value| number(factor * value))
}

fn number(value: f64) -> String {
    significant(value, 5)
}

/// Unit that people read, and the factor to it.
fn scaled(unit: &'static str) -> (&'static str, f64) {
    match unit {
        "J" => ("mJ", 1e3),
        "C" => ("uC", 1e6),
        other => (other, 1.0),
    }
}

fn unit(check: &QuantityCheck) -> String {
    scaled(check.unit).0.to_owned()
}

fn solvers(check: &QuantityCheck) -> String {
    let text = |agreement: &Agreement| {
        let verdict = if agreement.agree { "agree" } else { "FAILED" };
        format!("{verdict}: {:.1e} of {:.0e}", agreement.deviation, agreement.tolerance)
    };
    check.agreement.as_ref().map(text).unwrap_or_default()
}

fn verdict(holds: bool) -> &'static str {
    if holds { "holds" } else { "does not hold" }
}

/// Quantity, unit, values and agreement of a check.
fn cells(check: &QuantityCheck) -> Vec<String> {
    let mut row = vec![check.name.clone(), unit(check), value(check, check.analytic)];
    row.extend(Solver::ALL.map(|solver| value(check, check.values.get(solver))));
    row.push(solvers(check));
    row
}

/// Whether every solver was asked, not ngspice and one other alone.
fn is_by_all(check: &QuantityCheck) -> bool {
    check.values.get(Solver::Ideal).is_some()
}

/// The quantities by every solver, as text. Claims have a table of their own: a terminal is not wide enough for both.
pub fn check_table(found: &Crosscheck) -> String {
    let checks = found.checks.iter().filter(|check| check.agreement.is_some() && is_by_all(check));
    Sheet::new(HEADINGS.into_iter().take(8), &[], checks.map(cells).collect()).narrow(" ")
}

/// The quantities by ngspice and one other, closed form or embedded solver, as text.
pub fn pair_table(found: &Crosscheck) -> String {
    let rows = found.checks.iter().filter(|check| !is_by_all(check)).map(|check| {
        let other = value(check, check.values.get(Solver::Exponential).or(check.analytic));
        vec![check.name.clone(), unit(check), other, value(check, check.values.get(Solver::Batch)), solvers(check)]
    });
    let headings = ["ngspice against closed form or embedded solver", "unit", "other", "ngspice", "solvers"];
    Sheet::new(headings, &[], rows.collect()).text()
}

/// The claims of the paper and of the closed forms, and whether they hold, as text.
pub fn claim_table(found: &Crosscheck) -> String {
    let rows = found.checks.iter().filter_map(|check| {
        let claim = check.claim.as_ref()?;
        Some(vec![
            claim.says.clone(),
            unit(check),
            value(check, check.analytic),
            value(check, check.values.get(Solver::Batch)),
            format!("{:+.2} %", 100.0 * claim.deviation),
            verdict(claim.holds).to_owned(),
        ])
    });
    Sheet::new(["claim", "unit", "closed form", "ngspice", "deviation", "verdict"], &[], rows.collect()).text()
}

/// An energy that is compared: heading and value.
type Energy = (&'static str, fn(&Energies) -> f64);

const ENERGIES: [Energy; 7] = [
    ("supply, mJ", |energy| energy.supply),
    ("Zener, mJ", |energy| energy.zener),
    ("diode, mJ", |energy| energy.diode),
    LEAKAGE,
    ("load, mJ", |energy| energy.load),
    ("converted, mJ", |energy| energy.converted),
    ("surplus, mJ", |energy| energy.surplus),
];

/// A column only where films leak.
const LEAKAGE: Energy = ("leakage, mJ", |energy| energy.leakage);

/// The paper's circuit, the switch and the storage.
pub fn comparison(found: &Crosscheck) -> Sheet {
    let leaks = found.compared.iter().any(|circuit| circuit.embedded.energy.leakage > 0.0);
    let shown: Vec<_> = ENERGIES.iter().filter(|(name, _)| leaks || *name != LEAKAGE.0).collect();
    let row = |circuit: &ComparedCircuit, solver: &str, energy: &Energies| {
        let values = shown.iter().map(|(_, value)| value(energy)).chain([circuit.closed_form]);
        let values = values.map(|value| number(1e3 * value));
        [circuit.label.clone(), solver.to_owned()].into_iter().chain(values).collect()
    };
    let rows = found.compared.iter().flat_map(|circuit| {
        [row(circuit, "embedded", &circuit.embedded.energy), row(circuit, "ngspice", &circuit.ngspice.energy)]
    });
    let energies = shown.iter().map(|(name, _)| *name);
    let headings = ["circuit", "solver"].into_iter().chain(energies).chain(["quick release, mJ"]);
    Sheet::new(headings, &[0, 1], rows.collect())
}

/// The best voltages of release.
pub fn sweep(found: &Crosscheck) -> Option<Sheet> {
    let sweep = found.sweep.as_ref()?;
    let row = |curve: &SweepCurve| {
        let (best, top) = curve.best()?;
        let predicted = sweep.predicted[usize::from(curve.circuit.starts_with("isolated"))];
        let witness = curve.witnesses.first().map_or(f64::NAN, |point| point.converted);
        let numbers = [top, predicted, 1e3 * best.converted, 1e3 * best.surplus, 1e3 * witness];
        Some(std::iter::once(curve.circuit.clone()).chain(numbers.map(number)).collect())
    };
    let headings = [
        "circuit",
        "most converted at, V",
        "predicted, V",
        "converted there, mJ",
        "surplus there, mJ",
        "ngspice at the predicted, mJ",
    ];
    Some(Sheet::new(headings, &[0], sweep.voltage.iter().filter_map(row).collect()))
}

/// The HTML report; `figures` are the overlay and, if there is a sweep, that of the sweep.
pub fn html(found: &Crosscheck, device: &Device, figures: Vec<String>) -> anyhow::Result<String> {
    let scenario = &found.scenario;
    let title = format!("Crosscheck of {}", scenario.name);
    let subtitle = format!("{}; 0 to {} s; circuit: {}.", scenario.description, scenario.until, found.label);
    let report = output::report(title, subtitle);
    let mut sections = sections(found, figures);
    sections.splice(1..1, drawn::section(device, Some(&found.settings))?);
    let report = sections.into_iter().fold(report, Report::section);
    let parameters = parameter_table::section(device, scenario);
    let parameters = parameter_table::with_circuit(parameters, &found.settings, scenario);
    Ok(videg_report::render_html(&report.section(parameters))?)
}

/// The verdicts in big type.
fn keys(found: &Crosscheck) -> [KeyNumber; 4] {
    let compared: Vec<_> = found.checks.iter().filter_map(|check| check.agreement.as_ref()).collect();
    let claims: Vec<_> = found.checks.iter().filter_map(|check| check.claim.as_ref()).collect();
    let count = |holds: usize, all: usize| format!("{holds} of {all}");
    let agree = count(compared.iter().filter(|agreement| agreement.agree).count(), compared.len());
    let hold = count(claims.iter().filter(|claim| claim.holds).count(), claims.len());
    let used = compared.iter().map(|agreement| agreement.deviation / agreement.tolerance).fold(0.0, f64::max);
    let verdict = if found.passed() { "agree" } else { "disagree" };
    [
        KeyNumber::new("solvers", verdict, "").note("closed forms, embedded solver and ngspice on one C(t)").main(),
        KeyNumber::new("comparisons within tolerance", agree, ""),
        KeyNumber::new("largest part of a tolerance used", significant(100.0 * used, 3), "%"),
        KeyNumber::new("claims that hold in ngspice", hold, ""),
    ]
}

/// The sections of the report, with those of the `figures` that there are.
pub fn sections(found: &Crosscheck, figures: Vec<String>) -> Vec<Section> {
    let answer = found.warnings.iter().cloned().fold(Section::new("Result"), Section::warning).keys(keys(found));
    let checks = found.checks.iter().map(|check| {
        let claim = check
            .claim
            .as_ref()
            .map(|claim| format!("{}: {} ({:+.2} %)", verdict(claim.holds), claim.says, 100.0 * claim.deviation));
        cells(check).into_iter().chain([claim.unwrap_or_default()]).collect()
    });
    let checks = Sheet::new(HEADINGS, &[0, 1, 7, 8], checks.collect());
    let mechanics = run_output::mechanics(&found.scenario, &found.mechanics.summary);
    let mut figures = figures.into_iter();
    let answer = figures.next().into_iter().fold(answer, |answer, figure| answer.figure(figure, OVERLAY_CAPTION));
    let mut sections = vec![
        found.conclusion.iter().cloned().fold(answer, Section::text),
        Section::new("The paper's circuit, an ideal switch, a storage")
            .table(comparison(found).html())
            .folded(Section::new("What the quick release is").text(QUICK)),
    ];
    if let Some(sheet) = sweep(found) {
        let section = Section::new("Net gain over voltage of release and load");
        let section = figures.next().into_iter().fold(section, |section, figure| section.figure(figure, SWEEP_CAPTION));
        sections.push(section.table(sheet.html()));
    }
    sections.extend([
        Section::new("Claim by claim").table(checks.html()).folded(Section::new("How to read this table").text(LEGEND)),
        Section::new("Mechanics").table(mechanics.html()),
    ]);
    sections
}

const LEGEND: &str = "All solvers get the same piecewise linear C(t). Solvers: the pair that uses up most of its tolerance, \
    relative for energies and charges, V for voltages. Claim: whether what the paper or a closed form says holds in a \
    circuit simulator; one that does not is a finding. \
    U_DE4 is measured on an open circuit, with the pulses of the run in order of their height: a membrane would keep the \
    charge of the highest pulse so far.";

const QUICK: &str = "Quick release: sum over the impacts of (C3 U_in - C2 U_r)(U_r - U_in), the net gain of a cycle that \
    releases its charge at U_r, less what it takes to fill the membranes to U_r once.";
