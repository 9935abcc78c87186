//! What `videg dynamics` says: report, table and JSON.

use std::path::PathBuf;

use serde::Serialize;
use serde_json::{Value, json};
use videg_report::{KeyNumber, Report, Section};

use super::format::{Sheet, significant};
use super::results::Identity;
use super::{drawn, output, parameter_table, run_output};
use crate::artefact::Picture;
use crate::cosim::Device;
use crate::dynamics::orbits::{Branch, End, Orbit};
use crate::dynamics::{Basins, Diagram, Motion, Problem, periods};
use crate::scenario::{Scenario, Setting};

/// What was found.
pub struct Found {
    /// Periods before the section.
    pub transient: u32,
    /// The motion from the start of the case.
    pub motion: Motion,
    /// Its largest Lyapunov exponent, 1/s, if there is one.
    pub exponent: Option<f64>,
    pub diagram: Option<Diagram>,
    /// Whether orbits were searched for.
    pub has_orbits: bool,
    pub orbits: Vec<Orbit>,
    pub branches: Vec<Branch>,
    pub basins: Option<Basins>,
}

/// Keys of `--json`.
#[derive(Serialize)]
pub struct Output<'a> {
    case: &'a str,
    description: &'a str,
    settings: &'a [Setting],
    /// Variable of `--vary`.
    vary: Option<&'static str>,
    /// Periods after which the motion comes back.
    recurrence: Option<usize>,
    /// V/s.
    average_voltage_gain: f64,
    /// 1/s.
    lyapunov_exponent: Option<f64>,
    orbits: Vec<Value>,
    branches: Vec<Value>,
    attractors: Vec<Value>,
    files: &'a [PathBuf],
    request: &'a Identity,
}

impl<'a> Output<'a> {
    pub fn new(
        request: &'a Identity,
        scenario: &'a Scenario,
        problem: &Problem,
        found: &Found,
        files: &'a [PathBuf],
    ) -> Self {
        let attractors = found.basins.iter().flat_map(|basins| &basins.attractors);
        let attractor = |(attractor, share): &(crate::dynamics::Attractor, f64)| {
            json!({
                "recurrence": attractor.recurrence, "average_voltage_gain": attractor.gain,
                "mean_displacement": attractor.displacement, "share": share,
            })
        };
        Self {
            request,
            case: &scenario.name,
            description: &scenario.description,
            settings: &scenario.settings,
            vary: problem.varied.as_ref().map(|varied| varied.quantity.name),
            recurrence: found.motion.recurrence(),
            average_voltage_gain: found.motion.own_gain(),
            lyapunov_exponent: found.exponent,
            orbits: found.orbits.iter().map(orbit).collect(),
            branches: found.branches.iter().map(branch).collect(),
            attractors: attractors.map(attractor).collect(),
            files,
        }
    }
}

fn orbit(orbit: &Orbit) -> Value {
    let [left, right] = orbit.pattern.counts();
    let multipliers: Vec<_> = orbit.multipliers.0.iter().map(|value| [value.re, value.im]).collect();
    let impacts = orbit.impacts.iter().map(|impact| {
        let side = if impact.side == videg_model::Side::Left { "left" } else { "right" };
        json!({ "side": side, "time_periods": impact.time, "speed": impact.speed })
    });
    json!({
        "impacts_left": left, "impacts_right": right, "order": orbit.pattern.letters(), "periods": orbit.period,
        "rests": orbit.pattern.rests(), "stable": orbit.is_stable(), "multipliers": multipliers,
        "average_voltage_gain": orbit.voltage_gain, "impacts": impacts.collect::<Vec<_>>(),
    })
}

fn branch(branch: &Branch) -> Value {
    let bifurcations =
        branch.marks.iter().map(|mark| json!({ "kind": mark.kind.words(), "value": mark.orbit.point.value }));
    let value = |orbit: Option<&Orbit>| orbit.map(|orbit| orbit.point.value);
    json!({
        "name": branch.name(), "points": branch.orbits.len(),
        "from": value(branch.orbits.first()), "to": value(branch.orbits.last()),
        "ends": branch.ends.map(End::words), "bifurcations": bifurcations.collect::<Vec<_>>(),
    })
}

/// Rows of orbits.
fn orbit_table(orbits: &[Orbit]) -> Sheet {
    let row = |orbit: &Orbit| {
        let multipliers: Vec<_> = orbit.multipliers.0.iter().map(|value| complex(value.re, value.im)).collect();
        vec![
            orbit.name(),
            orbit.pattern.letters().to_owned(),
            stability(orbit).to_owned(),
            significant(orbit.multipliers.largest(), 6),
            multipliers.join(", "),
            significant(orbit.voltage_gain, 6),
        ]
    };
    let columns = ["orbit, left:right", "order", "stability", "largest multiplier", "multipliers", "<U> (V/s)"];
    Sheet::new(columns, &[0, 1, 2, 4], orbits.iter().map(row).collect())
}

fn stability(orbit: &Orbit) -> &'static str {
    if orbit.is_stable() { "stable" } else { "unstable" }
}

fn complex(re: f64, im: f64) -> String {
    let shown = significant(re, 5);
    if im == 0.0 { shown } else { format!("{shown}{}{}i", if im < 0.0 { "-" } else { "+" }, significant(im.abs(), 5)) }
}

/// Rows of bifurcations.
fn bifurcation_table(problem: &Problem, branches: &[Branch]) -> Sheet {
    let axis = problem.varied.as_ref().map(crate::dynamics::Varied::label).unwrap_or_default();
    let rows = branches.iter().enumerate().flat_map(|(number, branch)| {
        branch.marks.iter().map(move |mark| {
            let value = significant(mark.orbit.point.value, 9);
            vec![number.to_string(), branch.name(), mark.kind.words().to_owned(), value]
        })
    });
    Sheet::new(["branch", "orbit, left:right", "bifurcation", &axis], &[1, 2], rows.collect())
}

/// The report.
pub fn report(
    scenario: &Scenario,
    problem: &Problem,
    found: &Found,
    device: &Device,
    pictures: Vec<Picture>,
) -> anyhow::Result<Report> {
    let subtitle = format!("{}.", scenario.description);
    let answer = Section::new("Result").keys(keys(found));
    let answer =
        pictures.into_iter().fold(answer, |section, picture| section.drawing(picture.drawing, picture.caption));
    let report =
        output::report(format!("Dynamics of {}", scenario.name), subtitle).section(answer.text(summary(found)));
    let section = Section::new("Periodic orbits");
    let report = match (found.has_orbits, found.orbits.is_empty()) {
        (false, _) => report,
        (true, true) => report.section(section.text(format!("{NO_ORBITS}."))),
        (true, false) => {
            let legend = Section::new("How orbits are named, and what a multiplier is").text(ORBITS);
            report.section(section.table(orbit_table(&found.orbits).html()).folded(legend))
        }
    };
    let report = if found.branches.is_empty() {
        report
    } else {
        let legend = Section::new("What happens at a bifurcation").text(BRANCHES);
        let table = bifurcation_table(problem, &found.branches).html();
        report.section(Section::new("Bifurcations").table(table).folded(legend))
    };
    let drawn = drawn::section(device, None)?;
    Ok(drawn.into_iter().fold(report, Report::section).section(parameter_table::section(device, scenario)))
}

/// What the motion is, in big type.
fn keys(found: &Found) -> Vec<KeyNumber> {
    let motion = match found.motion.recurrence() {
        Some(count) => KeyNumber::new("the motion comes back after", periods(Some(count), ""), ""),
        None => KeyNumber::new("the motion", "does not come back", ""),
    };
    let (exponent, kind) = exponent(found);
    let mut keys = vec![
        motion.note(format!("from the start of the case, after {} periods", found.transient)).main(),
        KeyNumber::new("<U>, Eq. (15)", significant(found.motion.own_gain(), 5), "V/s"),
        KeyNumber::new("largest Lyapunov exponent", exponent, "1/s").note(kind),
    ];
    if found.has_orbits {
        let stable = found.orbits.iter().filter(|orbit| orbit.is_stable()).count();
        keys.push(
            KeyNumber::new("periodic orbits", found.orbits.len().to_string(), "").note(format!("{stable} stable")),
        );
    }
    keys.extend(found.basins.iter().map(|basins| {
        KeyNumber::new("attractors", basins.attractors.len().to_string(), "").note("of the starts in the map of basins")
    }));
    keys
}

/// The Lyapunov exponent, and what it says.
fn exponent(found: &Found) -> (String, &'static str) {
    match found.exponent {
        Some(exponent) if exponent > 0.0 => (significant(exponent, 4), "neighbours part"),
        Some(exponent) => (significant(exponent, 4), "neighbours do not part"),
        None => ("-".to_owned(), "not found where films are viscous, or pressed in at the start of each period"),
    }
}

/// What is said where the search finds nothing.
const NO_ORBITS: &str = "no isolated periodic orbit was found at the parameters of the case";
const ORBITS: &str = "Periodic orbits, named by their impacts on the left and on the right membrane in one round. The order is L and R, \
    l and r where the ball comes to rest; such an orbit forgets its neighbours, and a multiplier is 0. A multiplier is the factor \
    by which a small distance from the orbit grows in one round. The search is thorough, not complete.";
const BRANCHES: &str = "Bifurcations of the branches: at a fold a branch turns back (a multiplier is +1), at a branch point another one crosses it, \
    at a period doubling (-1) an orbit of twice the period begins, and at grazing the ball touches a membrane without speed; beyond, the order \
    of impacts is another.";
/// Caption of the multipliers.
pub const MULTIPLIERS: &str =
    "Largest modulus of the multipliers of each branch: solid below 1, where the orbit is stable, dashed above.";

fn summary(found: &Found) -> String {
    let never = "the motion does not come back";
    let recurrence = match found.motion.recurrence() {
        Some(_) => format!("the motion comes back after {}", periods(found.motion.recurrence(), never)),
        None => never.to_owned(),
    };
    let (exponent, kind) = exponent(found);
    format!(
        "From the start of the case, after {} periods: {recurrence}; <U> = {} V/s; largest Lyapunov exponent {exponent} 1/s: {kind}.",
        found.transient,
        significant(found.motion.own_gain(), 6)
    )
}

/// Caption of the section.
pub fn section_caption(found: &Found) -> String {
    format!(
        "Relative displacement and velocity at the start of each period, when the excitation has its initial phase: {} periods \
         after {}.",
        found.motion.flashes.len() - 1,
        found.transient
    )
}

/// Caption of the diagram.
pub fn diagram_caption(found: &Found, diagram: &Diagram) -> String {
    let crate::dynamics::Periods { transient, taken } = diagram.periods;
    let orbits = if found.branches.is_empty() {
        ""
    } else {
        " Lines are periodic orbits, solid where they are stable, with marks at their bifurcations."
    };
    format!(
        "Relative displacement at the start of each period: {taken} periods after {transient}; (a) from the start of the case, \
         (b) each motion going on from the one before along the parameter; (c) <U> of Eq. (15) over the {taken} periods.{orbits}"
    )
}

/// Caption of the basins.
pub fn basins_caption(basins: &Basins) -> String {
    format!(
        "Which motion a start leads to within {} periods: periods after which it comes back, <U> and mean relative displacement \
         at the starts of the periods.",
        basins.periods.transient
    )
}

/// The parts of the text on stdout.
pub fn text(scenario: &Scenario, problem: &Problem, found: &Found, files: &[PathBuf]) -> Vec<String> {
    let mut parts = vec![format!("dynamics {}: {}\n{}", scenario.name, scenario.description, summary(found))];
    if found.has_orbits {
        parts.push(if found.orbits.is_empty() { NO_ORBITS.to_owned() } else { orbit_table(&found.orbits).text() });
    }
    if !found.branches.is_empty() {
        parts.push(bifurcation_table(problem, &found.branches).text());
    }
    parts.push(run_output::file_list(files));
    parts
}
