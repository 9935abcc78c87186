//! What `videg map` says: report, table and JSON.

use std::path::PathBuf;
use std::time::Duration;

use indexmap::IndexMap;
use serde::Serialize;
use videg_coupled::OVER_LIMITS;
use videg_report::{Report, Section};

use super::format::{Sheet, significant};
use super::{output, run_output};
use crate::artefact::Picture;
use crate::map::{ClosedForms, Map, Plan, Point, scaled_unit};
use crate::sweep;

/// A map and how it was made.
pub struct Found<'a> {
    pub plan: &'a Plan,
    pub map: &'a Map,
    pub report: &'a sweep::Report,
    pub elapsed: Duration,
}

/// Output of `--json`.
#[derive(Serialize)]
pub struct Output<'a> {
    case: &'a str,
    of: &'a str,
    unit: &'a str,
    x: AxisOutput<'a>,
    y: AxisOutput<'a>,
    points: u64,
    samples: u64,
    runs: u64,
    failed: u64,
    resumed_from: u64,
    elapsed_s: f64,
    best: Numbers<'a>,
    /// Limits of the film that the best point exceeds.
    best_exceeds: Vec<&'static str>,
    best_of_grid: Numbers<'a>,
    best_within_limits: Option<Numbers<'a>>,
    /// Points of the grid at which a limit is exceeded.
    points_beyond_limits: usize,
    closed_forms: Option<ClosedOutput>,
    files: &'a [PathBuf],
}

#[derive(Serialize)]
struct AxisOutput<'a> {
    name: &'a str,
    unit: &'a str,
    #[serde(flatten)]
    range: sweep::Range,
}

#[derive(Serialize)]
struct ClosedOutput {
    /// V
    best_release_voltage: f64,
    /// W
    net_power_of_quick_release: f64,
    largest_net_power: f64,
}

/// Values of the axes and of all columns, by name.
type Numbers<'a> = IndexMap<&'a str, f64>;

fn numbers<'a>(plan: &'a Plan, point: &Point) -> Numbers<'a> {
    let axes = plan.axes.iter().map(|axis| axis.name.as_str()).zip(point.at);
    axes.chain(plan.names().zip(point.cell.numbers.iter().copied())).collect()
}

impl<'a> Output<'a> {
    pub fn new(found: &Found<'a>, files: &'a [PathBuf]) -> Self {
        let Found { plan, map, report, elapsed } = *found;
        let [x, y] =
            plan.axes.each_ref().map(|axis| AxisOutput { name: &axis.name, unit: &axis.unit, range: axis.range });
        let closed = |forms: ClosedForms| ClosedOutput {
            best_release_voltage: forms.release_voltage,
            net_power_of_quick_release: forms.release_power,
            largest_net_power: forms.largest_power,
        };
        Self {
            case: plan.sweep.name(),
            of: &plan.of,
            unit: &plan.unit,
            x,
            y,
            points: plan.sweep.points(),
            samples: plan.sweep.samples(),
            runs: report.runs,
            failed: report.failed,
            resumed_from: report.resumed_from,
            elapsed_s: elapsed.as_secs_f64(),
            best: numbers(plan, &map.best),
            best_exceeds: exceeded(plan, &map.best).map(|(name, _)| name).collect(),
            best_of_grid: numbers(plan, &map.grid_best),
            best_within_limits: map.admissible.as_ref().map(|point| numbers(plan, point)),
            points_beyond_limits: beyond(found),
            closed_forms: map.closed_forms.map(closed),
            files,
        }
    }
}

/// Limits of the film in the order of [`OVER_LIMITS`].
const LIMITS: [&str; 4] = [
    "area ratio over rupture",
    "electric field over breakdown",
    "Maxwell stress over tension",
    "deflection over the last point measured",
];

/// Names and words of the limits that a point exceeds.
fn exceeded(plan: &Plan, point: &Point) -> impl Iterator<Item = (&'static str, &'static str)> {
    OVER_LIMITS.into_iter().zip(LIMITS).filter(|(name, _)| plan.number(&point.cell, name) > 1.0)
}

fn beyond(found: &Found<'_>) -> usize {
    found.map.cells.iter().filter(|cell| found.plan.over_limits(cell) > 1.0).count()
}

/// The best points in columns.
fn table(found: &Found<'_>) -> Sheet {
    let Found { plan, map, .. } = found;
    let mut columns = vec![("best of the grid", Some(&map.grid_best)), ("best", Some(&map.best))];
    if map.admissible.as_ref() != Some(&map.best) {
        columns.push(("within the limits", map.admissible.as_ref()));
    }
    let row = |label: String, unit: &str, value: &dyn Fn(&Point) -> f64, digits: usize| {
        let shown =
            |point: Option<&Point>| point.map_or_else(|| "none".to_owned(), |point| significant(value(point), digits));
        let cells = columns.iter().map(|(_, point)| shown(*point));
        [label, unit.to_owned()].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let (factor, unit) = scaled_unit(plan, map);
    let mut rows = vec![row(plan.of.clone(), &unit, &|point| factor * point.value, 5)];
    for (index, axis) in plan.axes.iter().enumerate() {
        rows.push(row(axis.name.clone(), &axis.unit, &|point| point.at[index], 5));
    }
    for (name, factor, unit) in [
        ("net_power", 1e6, "uW"),
        ("load_power", 1e6, "uW"),
        ("supply_power", 1e6, "uW"),
        ("average_voltage_gain", 1.0, "V/s"),
    ] {
        if name != plan.of {
            rows.push(row(name.to_owned(), unit, &|point| factor * plan.number(&point.cell, name), 5));
        }
    }
    for (words, name) in LIMITS.into_iter().zip(OVER_LIMITS) {
        // A film that is not measured has no last point.
        if columns.iter().filter_map(|(_, point)| *point).any(|point| plan.number(&point.cell, name) > 0.0) {
            rows.push(row(words.to_owned(), "1", &|point| plan.number(&point.cell, name), 3));
        }
    }
    let headings = ["quantity", "unit"].into_iter().chain(columns.iter().map(|(name, _)| *name));
    Sheet::new(headings, &[0, 1], rows)
}

/// What limits the best point, in a sentence.
fn limits(found: &Found<'_>) -> String {
    let Found { plan, map, .. } = found;
    let (points, beyond) = (map.cells.len(), beyond(found));
    let words: Vec<_> = exceeded(plan, &map.best).map(|(_, words)| words).collect();
    match (words.is_empty(), &map.admissible) {
        (true, _) if beyond == 0 => "No point of the map exceeds a limit of the film.".to_owned(),
        (true, _) => {
            format!(
                "The best point is within the limits of the film; {beyond} of {points} points of the grid exceed one."
            )
        }
        (false, Some(_)) => format!(
            "The best point exceeds limits of the film ({}), and so do {beyond} of {points} points of the grid.",
            words.join(", ")
        ),
        (false, None) => {
            format!(
                "No point of the grid is within the limits of the film; the best point exceeds: {}.",
                words.join(", ")
            )
        }
    }
}

/// The closed forms, in a sentence.
fn closed_forms(found: &Found<'_>) -> Option<String> {
    let forms = found.map.closed_forms?;
    Some(format!(
        "Closed forms over all impacts at the best point: a quick release gains most at {} V, {} uW; a slow discharge at C2 gains at \
         most {} uW.",
        significant(forms.release_voltage, 5),
        significant(1e6 * forms.release_power, 5),
        significant(1e6 * forms.largest_power, 5)
    ))
}

/// Caption of the figure.
pub fn caption(found: &Found<'_>) -> String {
    let plan = found.plan;
    let [x, y] = &plan.axes;
    let samples = match plan.sweep.samples() {
        1 => String::new(),
        samples => format!(", mean of {samples} samples with the same noise at all points"),
    };
    let [from, to] = plan.sweep.window();
    format!(
        "{} of {} over {} and {}: {} x {} points{samples}, averages over {from} to {to} s.",
        plan.of,
        plan.sweep.name(),
        x.name,
        y.name,
        x.count,
        y.count
    )
}

pub fn report(found: &Found<'_>, picture: Picture) -> Report {
    let mut numbers = Section::new("Best points").text(limits(found));
    numbers = closed_forms(found).into_iter().fold(numbers, Section::text).table(table(found).html()).text(
        "A limit is taken over the whole run: the largest area ratio over that at which the film ruptures, the largest electric \
         field over the breakdown field at the same stretch, the largest Maxwell stress over the elastic stress, beyond which the film is \
         slack. Above 1 it is exceeded.",
    );
    let lead = headline(found);
    let map = warnings(found).into_iter().fold(Section::new("Map"), Section::warning);
    output::report(format!("Map of {}", found.plan.sweep.name()), lead)
        .section(map.drawing(picture.drawing, picture.caption))
        .section(numbers)
}

/// The best point in a sentence.
fn headline(found: &Found<'_>) -> String {
    let Found { plan, map, .. } = found;
    let (factor, unit) = scaled_unit(plan, map);
    let [x, y] = &plan.axes;
    let at = |point: &Point| {
        let [a, b] = point.at.map(|value| significant(value, 4));
        let value = significant(factor * point.value, 4);
        format!("{value} {unit} at {} = {a} {} and {} = {b} {}", x.name, x.unit, y.name, y.unit)
    };
    let within = match &map.admissible {
        Some(point) if point != &map.best => format!("; within the limits of the film {}", at(point)),
        _ => String::new(),
    };
    format!("Best {}: {}{within}.", plan.of, at(&map.best))
}

pub fn warnings(found: &Found<'_>) -> Vec<String> {
    let sweep::Report { failed, runs, .. } = found.report;
    let failures = format!("{failed} of {runs} runs failed; the column error of sweep.csv says why");
    if *failed > 0 { vec![failures] } else { Vec::new() }
}

/// The parts of the text on stdout.
pub fn text(found: &Found<'_>, files: &[PathBuf]) -> Vec<String> {
    let sweep::Report { runs, failed, resumed_from, .. } = *found.report;
    let seconds = significant(found.elapsed.as_secs_f64(), 3);
    let new = if resumed_from > 0 { format!("{resumed_from} of them were there already; ") } else { String::new() };
    let heading = format!("map {}\n{runs} runs, {failed} of them failed; {new}{seconds} s", caption(found));
    let mut parts = vec![heading, table(found).text(), limits(found)];
    parts.extend(closed_forms(found));
    parts.push(run_output::file_list(files));
    parts
}
