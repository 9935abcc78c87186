//! Results under both laws of contact, as table, text, figure and report.

use serde::Serialize;

use crate::cli::format::{self, Sheet};
use crate::cli::picture::{self, Points};
use crate::cli::run_output;
use crate::cosim::MechanicsSummary;
use crate::scenario::Scenario;
use crate::simulate::{ContactSummary, Results};
use videg_report::{Figure, KeyNumber, Panel, Report, ReportError, Section, Series, render_svg};

/// Results under one law.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LawResult {
    /// Impacts and gains.
    #[serde(flatten)]
    pub mechanics: MechanicsSummary,
    /// Contacts.
    #[serde(flatten)]
    pub contacts: ContactSummary,
}

impl LawResult {
    /// The results of `run`.
    pub fn new(run: &Results) -> Self {
        Self { mechanics: run.mechanics, contacts: run.contacts.summary() }
    }
}

/// Both laws, by name.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Laws {
    /// Impacts take no time.
    pub impulsive: LawResult,
    /// Impacts take time.
    pub compliant: LawResult,
}

/// A row of the table: quantity, unit, units in one SI unit, and how to read it.
type Quantity = (&'static str, &'static str, f64, fn(&LawResult) -> Option<f64>);

const QUANTITIES: [Quantity; 9] = [
    ("<U>, Eq. (15)", "V/s", 1.0, |law| Some(law.mechanics.average_voltage_gain)),
    ("P, Eq. (14)", "mW", 1e3, |law| Some(law.mechanics.average_power_eq13)),
    ("impacts, whole run", "1", 1.0, |law| Some(f64::from(law.mechanics.impacts))),
    ("contacts that ended", "1", 1.0, |law| Some(f64::from(law.contacts.contacts))),
    ("mean contact duration", "ms", 1e3, |law| law.contacts.mean_contact_duration),
    ("largest contact duration", "ms", 1e3, |law| law.contacts.largest_contact_duration),
    ("time in contact, both membranes", "s", 1.0, |law| Some(law.contacts.time_in_contact)),
    ("largest deflection", "mm", 1e3, |law| Some(law.contacts.largest_deflection)),
    ("largest C(t)", "pF", 1e12, |law| Some(law.contacts.largest_capacitance)),
];

const HEADINGS: [&str; 6] = ["quantity", "unit", "impulsive", "compliant", "difference", "in per cent"];

/// The definition of a contact, for the reader of the durations.
const CONTACTS: &str = "A contact lasts as long as its membrane is deflected, from communication point to communication point; \
    those include impacts and ends of pulses. Under the impulsive law that is the pulse after an impact, while the ball is gone \
    already, under the compliant law the time for which the ball is in the membrane. Impacts within a pulse make one contact.";

const CAPTION: &str = "(a) Relative displacement and (b) capacitance of one membrane in the last seconds of the run under both \
    laws; (c) the deepest contact of each in (b), from its start.";

/// Both laws side by side.
pub fn table(laws: &Laws) -> Sheet {
    let row = |&(name, unit, scale, value): &Quantity| {
        let [impulsive, compliant] =
            [&laws.impulsive, &laws.compliant].map(|law| value(law).map(|value| value * scale));
        let shown = |value: Option<f64>| value.map_or_else(String::new, |value| number(unit, value));
        let pair = impulsive.zip(compliant);
        let relative = pair.filter(|(impulsive, _)| *impulsive != 0.0);
        vec![
            name.to_owned(),
            unit.to_owned(),
            shown(impulsive),
            shown(compliant),
            shown(pair.map(|(impulsive, compliant)| compliant - impulsive)),
            relative.map_or_else(String::new, |(impulsive, compliant)| per_cent(impulsive, compliant)),
        ]
    };
    Sheet::new(HEADINGS, &[0, 1], QUANTITIES.iter().map(row).collect())
}

/// The relative change of a value; the heading says in which unit.
fn per_cent(before: f64, after: f64) -> String {
    format!("{:+.3}", 100.0 * (after / before - 1.0))
}

/// A count as it is, anything else with six digits.
fn number(unit: &str, value: f64) -> String {
    if unit == "1" { format!("{value}") } else { format::significant(value, 6) }
}

/// The differences between the laws, a sentence each, and the definition of a contact.
pub fn words(scenario: &Scenario, laws: &Laws) -> Vec<String> {
    let phrase = |digits: usize, scale: f64, unit: &str, value: fn(&LawResult) -> f64| {
        let [before, after] = [&laws.impulsive, &laws.compliant].map(|law| scale * value(law));
        let shown = |value| format::significant(value, digits);
        format!("{} {unit} instead of {} {unit}{}", shown(after), shown(before), change(before, after))
    };
    let gain = phrase(6, 1.0, "V/s", |law| law.mechanics.average_voltage_gain);
    let deflection = phrase(4, 1e3, "mm", |law| law.contacts.largest_deflection);
    let capacitance = phrase(4, 1e12, "pF", |law| law.contacts.largest_capacitance);
    let time = phrase(4, 1.0, "s", |law| law.contacts.time_in_contact);
    let Laws { impulsive, compliant } = laws;
    let impacts = [impulsive, compliant].map(|law| law.mechanics.impacts);
    let mut words = vec![
        format!("The compliant law gives a <U> of {gain}."),
        format!("There are {} impacts instead of {}.", impacts[1], impacts[0]),
    ];
    if impulsive.contacts.contacts > 0 && compliant.contacts.contacts > 0 {
        let mean = phrase(4, 1e3, "ms", |law| law.contacts.mean_contact_duration.unwrap_or_default());
        words.push(format!("A contact lasts {mean} on average."));
        words.push(format!("The time in contact, of both membranes together, is {time} in {} s.", scenario.until));
    }
    words.push(format!("The largest deflection is {deflection}, the largest C(t) {capacitance}."));
    words.push(CONTACTS.to_owned());
    words
}

/// The relative change of a value in parentheses; empty without a reference value.
fn change(before: f64, after: f64) -> String {
    let per_cent = 100.0 * (after / before - 1.0);
    let part = format::significant(per_cent.abs(), 3);
    match per_cent {
        more if more > 0.0 && more.is_finite() => format!(" ({part} % higher)"),
        less if less < 0.0 => format!(" ({part} % lower)"),
        _ => String::new(),
    }
}

/// Relative displacement and C(t) of one membrane under both laws, in detail, and a contact of each.
pub fn figure(runs: [&Results; 2], scenario: &Scenario) -> Result<String, ReportError> {
    // The membrane that is hit more often.
    let hit = |side: usize| runs.iter().map(|run| run.contacts.ended()[side]).sum::<u32>();
    let side = usize::from(hit(1) > hit(0));
    let which = ["left", "right"][side];
    let displacement =
        runs.map(|run| picture::points(&run.trace.detail, |point| 1e3 * point.harvester.relative_displacement()));
    let capacitance =
        runs.map(|run| picture::points(&run.trace.detail, |point| 1e12 * point.harvester.capacitance()[side]));
    let contact = [0, 1].map(|k| deepest_contact(runs[k], side, &capacitance[k]));
    let [from, to] = picture::detail_range(&runs[0].trace, scenario);
    let ylabel = format!("C {which} (pF)");
    let above = Panel::new("(a)", "", "z_M - z_m (mm)").x_range(from, to).height(130.0).share_x_with_next();
    let below = Panel::new("(b)", "time (s)", ylabel.clone()).x_range(from, to).height(150.0);
    let alone = Panel::new("(c)", "time since the start of the contact (ms)", ylabel).height(150.0);
    let figure = Figure::new(picture::title(scenario))
        .panel(pair(above, &displacement))
        .panel(pair(below, &capacitance))
        .panel(pair(alone, &contact));
    render_svg(&figure.caption(CAPTION))
}

/// Both laws in one panel.
fn pair<'a>(panel: Panel<'a>, lines: &'a [Points; 2]) -> Panel<'a> {
    let names = ["impulsive law", "compliant law"];
    names.into_iter().zip(lines).fold(panel, |panel, (name, line)| panel.series(Series::points(name, line)))
}

/// The part of `line` in the contact to show of `side`, over the time since its start, ms.
fn deepest_contact(run: &Results, side: usize, line: &Points) -> Points {
    let Some([from, to]) = run.contacts.shown(side) else { return Points::new() };
    let within = line.iter().filter(|(time, _)| (from..=to).contains(time));
    within.map(|&(time, value)| (1e3 * (time - from), value)).collect()
}

/// The HTML report.
pub fn report(scenario: &Scenario, laws: &Laws, warnings: &[String], svg: String) -> Report {
    let gain = |name: &str, law: &LawResult| {
        KeyNumber::new(format!("<U>, {name}"), format::significant(law.mechanics.average_voltage_gain, 5), "V/s")
    };
    let keys = [gain("impulsive law", &laws.impulsive), gain("compliant law", &laws.compliant)];
    let result =
        run_output::result(warnings).keys(keys).figure(svg, CAPTION).table(table(laws).html()).folded(
            Section::new("The differences in words, and what a contact is").text(words(scenario, laws).join(" ")),
        );
    run_output::report(format!("Simulation of {} under both laws of contact", scenario.name), scenario).section(result)
}
