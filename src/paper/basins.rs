//! Beyond the paper: basins of attraction. Which motion a start leads to, over position and velocity of the ball.

use super::artefact::table;
use super::excitation::{Cylinder, FORCE, FREQUENCY};
use super::{Artefact, Finding, PaperError, Picture, Study};
use crate::dynamics::{Basins, Periods, pictures, sheets};
use videg_report::Table;

/// Periods of each motion.
const PERIODS: Periods = Periods { transient: 200, taken: 32 };
/// Largest relative velocity at the start, m/s.
const FASTEST: f64 = 0.5;

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

/// Makes the maps.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let cylinder = Cylinder::new(study)?;
    let mut artefact = Artefact { text: text(), ..Artefact::default() };
    for plane in &PLANES {
        let parameters = cylinder.saw_tooth(plane.restitution, cylinder.gamma(FORCE, FREQUENCY), FREQUENCY);
        let basins = Basins::new(&parameters, study.effort.of(100, 30), FASTEST, PERIODS, study.observer)?;
        artefact.findings.push(finding(plane, &basins));
        artefact.tables.push(attractors(plane, &basins));
        artefact.pictures.push(picture(plane, &basins)?);
        artefact.sheets.push(sheets::basins(plane.name, &basins));
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
            PERIODS.taken / 2
        ))
}

fn attractors(plane: &Plane, basins: &Basins) -> Table {
    let numbers = ["<U> (V/s)", "mean z_M - z_m (mm)", "share of starts (%)"];
    let rows = basins.attractors.iter().take(2 * pictures::SHOWN).map(|(attractor, share)| {
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
    let caption = format!(
        "Which motion a start leads to within {} periods, A = 0.5 N, f0 = 2 Hz, r = {}: periods after which \
         it comes back, <U> and mean relative displacement at the starts of the periods.",
        PERIODS.transient, plane.restitution
    );
    Ok(pictures::basins(plane.name, &format!("Basins of attraction, {}", plane.place), basins, &caption)?)
}

fn text() -> Vec<String> {
    vec![
        format!(
            "Each start is run for {} periods and looked at for {} more. Two motions are one if they \
             come back, within 1 um, after the same number of periods, with <U> within 0.5 % and mean relative \
             displacement at the starts of the periods within 0.1 mm; motions that never come back are one within 2 % \
             and 5 mm. The cylinder is symmetric: a motion that is not has a mirror image half a period later, with \
             the same <U>.",
            PERIODS.transient, PERIODS.taken
        ),
        "The paper says that with inelastic impacts the difference due to initial conditions becomes almost invisible. \
         In <U> it does: what the starts decide is whether the motion or its mirror image comes about."
            .to_owned(),
    ]
}
