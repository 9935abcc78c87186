//! Beyond the paper: basins of attraction. Which motion a start leads to, over position and velocity of the ball.

use super::artefact::table;
use super::excitation::{Cylinder, FORCE, FREQUENCY};
use super::stroboscope::{Orbit, Start, Stroboscope, periods};
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study};
use videg_report::{Figure, HeatMap, Panel, Scale, Table};

/// Periods of the transient, and periods that are sampled after it.
const TRANSIENT: u32 = 200;
const TAKEN: u32 = 32;
/// Largest relative velocity at the start, m/s.
const FASTEST: f64 = 0.5;
/// Attractors that have a colour of their own.
const SHOWN: usize = 6;

/// Starts at a coefficient of restitution, and where the paper has it.
struct Plane {
    name: &'static str,
    place: &'static str,
    restitution: f64,
}

const PLANES: [Plane; 3] = [
    Plane { name: "basins-fig14", place: "Figure 14, r = 0.6", restitution: 0.6 },
    Plane { name: "basins-fig15", place: "Figure 15, r = 0.3", restitution: 0.3 },
    Plane { name: "basins-r08", place: "r = 0.8", restitution: 0.8 },
];

/// A motion by its rule: after how many periods it comes back, `<U>`, and where it is at their starts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Attractor {
    /// Periods; none if it does not come back.
    recurrence: Option<usize>,
    /// `<U>`, V/s.
    gain: f64,
    /// Mean relative displacement at the starts of the periods, m: tells a motion from its mirror image.
    displacement: f64,
}

impl Attractor {
    fn of(orbit: &Orbit) -> Self {
        let recurrence = orbit.recurrence();
        let count = recurrence.unwrap_or(TAKEN as usize);
        let (gain, displacement) = (orbit.voltage_gain(count), orbit.mean_displacement(count));
        Self { recurrence, gain, displacement }
    }

    /// The same: within 0.5 % of `<U>` and 0.1 mm, but for the fluctuations of a motion that does not come back, 2 %
    /// and 5 mm.
    fn is_like(&self, other: &Self) -> bool {
        let [gain, displacement] = if self.recurrence.is_some() { [5e-3, 1e-4] } else { [0.02, 5e-3] };
        self.recurrence == other.recurrence
            && (self.gain - other.gain).abs() <= gain * self.gain
            && (self.displacement - other.displacement).abs() <= displacement
    }

    fn periods(&self) -> String {
        periods(self.recurrence, "aperiodic")
    }

    fn label(&self) -> String {
        format!("{}, {:.0} V/s, {:+.1} mm", self.periods(), self.gain, 1e3 * self.displacement)
    }
}

/// The plane of starts and what each leads to.
struct Basins {
    /// Relative displacement, m.
    xs: Vec<f64>,
    /// Relative velocity, m/s.
    ys: Vec<f64>,
    /// Row by row from the lowest velocity.
    ends: Vec<Attractor>,
    /// By falling share.
    attractors: Vec<(Attractor, f64)>,
}

impl Basins {
    fn new(study: &Study<'_>, cylinder: &Cylinder, restitution: f64) -> Result<Self, PaperError> {
        let count = study.effort.of(100_u32, 30);
        let middle = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(count) - 1.0;
        let xs: Vec<f64> = (0..count).map(|k| middle(k) * cylinder.travel() / 2.0).collect();
        let ys: Vec<f64> = (0..count).map(|k| middle(k) * FASTEST).collect();
        let gamma = cylinder.gamma(FORCE, FREQUENCY);
        let start = |displacement: f64, velocity: f64| Start {
            displacement,
            velocity,
            ..Start::saw_tooth(cylinder, restitution, gamma, FREQUENCY)
        };
        let starts: Vec<Start> = ys.iter().flat_map(|&y| xs.iter().map(move |&x| start(x, y))).collect();
        let ends = study.each(&starts, |start| {
            let orbit = Stroboscope::new(study, &start.settings(cylinder), FREQUENCY)?.take(TRANSIENT, TAKEN)?;
            Ok(Attractor::of(&orbit))
        })?;
        let attractors = by_share(&ends);
        Ok(Self { xs, ys, ends, attractors })
    }

    /// Number of the attractor in order of share.
    fn kind(&self, end: &Attractor) -> f64 {
        self.attractors.iter().position(|(attractor, _)| attractor.is_like(end)).map_or(f64::NAN, |index| index as f64)
    }
}

/// The attractors and the part of all starts that each takes.
fn by_share(ends: &[Attractor]) -> Vec<(Attractor, f64)> {
    let mut found: Vec<(Attractor, f64)> = Vec::new();
    for end in ends {
        match found.iter_mut().find(|(attractor, _)| attractor.is_like(end)) {
            Some((_, count)) => *count += 1.0,
            None => found.push((*end, 1.0)),
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found.into_iter().map(|(attractor, count)| (attractor, count / ends.len() as f64)).collect()
}

/// Makes the maps.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let cylinder = Cylinder::new(study)?;
    let mut artefact = Artefact { text: text(), ..Artefact::default() };
    for plane in &PLANES {
        let basins = Basins::new(study, &cylinder, plane.restitution)?;
        artefact.findings.push(finding(plane, &basins));
        artefact.tables.push(attractors(plane, &basins));
        artefact.pictures.push(picture(plane, &basins)?);
        artefact.sheets.push(sheet(plane, &basins));
    }
    Ok(artefact)
}

fn finding(plane: &Plane, basins: &Basins) -> Finding {
    let gains = || basins.attractors.iter().map(|(attractor, _)| attractor.gain);
    let [low, high] = [f64::min, f64::max].map(|pick| gains().reduce(pick).unwrap_or(f64::NAN));
    let never = basins.attractors.iter().filter(|(attractor, _)| attractor.recurrence.is_none());
    let share = never.fold(0.0, |sum, (_, share)| sum + 100.0 * share);
    Finding::new(format!("Basins, {}", plane.place), "motions found", "1", gains().count() as f64)
        // The paper: the difference due to initial conditions becomes almost invisible.
        .agrees_if(high - low <= 0.01 * high)
        .reason(format!(
            "the paper: almost no difference; <U> from {low:.0} to {high:.0} V/s; {share:.1} % of the starts lead to one \
             that does not come back in {} periods",
            TAKEN / 2
        ))
}

fn attractors(plane: &Plane, basins: &Basins) -> Table {
    let numbers = ["<U> (V/s)", "mean z_M - z_m (mm)", "share of starts (%)"];
    let rows = basins.attractors.iter().take(2 * SHOWN).map(|(attractor, share)| {
        [
            attractor.periods(),
            format!("{:.1}", attractor.gain),
            format!("{:+.2}", 1e3 * attractor.displacement),
            format!("{:.2}", 100.0 * share),
        ]
    });
    rows.fold(table(format!("{}: motion comes back after", plane.place), numbers), Table::row)
}

fn picture(plane: &Plane, basins: &Basins) -> Result<Picture, PaperError> {
    let millimetres: Vec<f64> = basins.xs.iter().map(|x| 1e3 * x).collect();
    let shown = basins.attractors.len().min(SHOWN);
    let mut kinds: Vec<String> = basins.attractors.iter().take(shown).map(|(attractor, _)| attractor.label()).collect();
    if basins.attractors.len() > shown {
        kinds.push("others".to_owned());
    }
    let values: Vec<f64> = basins.ends.iter().map(|end| basins.kind(end).min(shown as f64)).collect();
    let map = HeatMap { xs: &millimetres, ys: &basins.ys, values: &values, scale: Scale::Kinds(kinds) };
    let panel = Panel::new("", "z_M - z_m at 0 s (mm)", "z_M' - z_m' at 0 s (m/s)").height(420.0).map(map);
    let figure = Figure::new(format!("Basins of attraction, {}", plane.place))
        .caption("Which motion a start leads to, over relative displacement and velocity at the start.")
        .panel(panel);
    let caption = format!(
        "Which motion a start leads to within {TRANSIENT} periods, A = 0.5 N, f0 = 2 Hz, r = {}: periods after which \
         it comes back, <U> and mean relative displacement at the starts of the periods.",
        plane.restitution
    );
    Picture::new(plane.name, &figure, caption)
}

fn sheet(plane: &Plane, basins: &Basins) -> Sheet {
    let columns = [
        "displacement at 0 s (m)",
        "velocity at 0 s (m/s)",
        "attractor (1)",
        "recurrence (periods)",
        "<U> (V/s)",
        "mean displacement (m)",
    ];
    let starts = basins.ys.iter().flat_map(|&y| basins.xs.iter().map(move |&x| (x, y)));
    let row = |((x, y), end): ((f64, f64), &Attractor)| {
        let recurrence = end.recurrence.map_or(f64::NAN, |n| n as f64);
        vec![x, y, basins.kind(end), recurrence, end.gain, end.displacement]
    };
    Sheet::new(plane.name, columns, starts.zip(&basins.ends).map(row))
}

fn text() -> Vec<String> {
    vec![
        format!(
            "Each start is run for {TRANSIENT} periods and looked at for {TAKEN} more. Two motions are one if they \
             come back, within 1 um, after the same number of periods, with <U> within 0.5 % and mean relative \
             displacement at the starts of the periods within 0.1 mm; motions that never come back are one within 2 % \
             and 5 mm. The cylinder is symmetric: a motion that is not has a mirror image half a period later, with \
             the same <U>."
        ),
        "The paper says that with inelastic impacts the difference due to initial conditions becomes almost invisible. \
         In <U> it does: what the starts decide is whether the motion or its mirror image comes about."
            .to_owned(),
    ]
}
