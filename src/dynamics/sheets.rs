//! The data of sections, diagrams, basins and orbits as CSV files.

use videg_model::Side;

use super::basins::Basins;
use super::diagram::Diagram;
use super::motion::Motion;
use super::orbits::{Branch, Orbit};
use crate::artefact::Sheet;

/// The points of a section, whose first one is after `transient` periods.
pub fn section(name: &str, motion: &Motion, transient: u32) -> Sheet {
    let flashes = motion.flashes.iter().enumerate();
    let rows = flashes.map(|(k, flash)| vec![f64::from(transient) + k as f64, flash.displacement, flash.velocity]);
    Sheet::new(name, ["period (1)", "displacement (m)", "velocity (m/s)"], rows)
}

/// Every flash of the periodic or chaotic motions over `axis`: one row each until the motion comes back.
pub fn diagram(name: &str, axis: &str, diagram: &Diagram) -> Sheet {
    let columns = [axis, "way (1)", "displacement (m)", "velocity (m/s)", "<U> (V/s)", "recurrence (periods)"];
    let rows = diagram.ways.iter().zip([0.0, 1.0, 2.0]).flat_map(|(motions, way)| {
        diagram.xs.iter().zip(motions).flat_map(move |(&x, motion)| {
            let (recurrence, gain) = (motion.recurrence(), motion.own_gain());
            let taken = motion.flashes.iter().take(recurrence.unwrap_or(usize::MAX));
            let recurrence = recurrence.map_or(f64::NAN, |n| n as f64);
            taken.map(move |flash| vec![x, way, flash.displacement, flash.velocity, gain, recurrence])
        })
    });
    Sheet::new(name, columns, rows)
}

/// Each start and what it leads to.
pub fn basins(name: &str, basins: &Basins) -> Sheet {
    let columns = [
        "displacement at 0 s (m)",
        "velocity at 0 s (m/s)",
        "attractor (1)",
        "recurrence (periods)",
        "<U> (V/s)",
        "mean displacement (m)",
    ];
    let starts = basins.ys.iter().flat_map(|&y| basins.xs.iter().map(move |&x| (x, y)));
    let rows = starts.zip(&basins.ends).map(|((x, y), end)| {
        let kind = basins.kind(end).map_or(f64::NAN, |kind| kind as f64);
        vec![x, y, kind, end.recurrence.map_or(f64::NAN, |n| n as f64), end.gain, end.displacement]
    });
    Sheet::new(name, columns, rows)
}

/// Columns of an orbit: words, and numbers.
const ORBIT: [&str; 14] = [
    "impacts (left:right)",
    "order of impacts",
    "stability",
    "periods (1)",
    "largest multiplier (1)",
    "multiplier 1, real part (1)",
    "multiplier 1, imaginary part (1)",
    "multiplier 2, real part (1)",
    "multiplier 2, imaginary part (1)",
    "least impact speed (m/s)",
    "least gap at a turn (m)",
    "<U> (V/s)",
    "displacement (m)",
    "velocity (m/s)",
];
/// How many of these are words.
const WORDS: usize = 3;

fn cells(orbit: &Orbit) -> (Vec<String>, Vec<f64>) {
    let stability = if orbit.is_stable() { "stable" } else { "unstable" };
    let multiplier = |k: usize| orbit.multipliers.0.get(k).map_or([f64::NAN; 2], |value| [value.re, value.im]);
    let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
    let flash = orbit.flashes.first().copied().unwrap_or([f64::NAN; 2]);
    let numbers = [
        &[f64::from(orbit.period), orbit.multipliers.largest()][..],
        &multiplier(0),
        &multiplier(1),
        &[finite(orbit.least_speed), finite(orbit.least_gap), orbit.voltage_gain],
        &flash,
    ];
    let words = [orbit.pattern.to_string(), orbit.pattern.letters().to_owned(), stability.to_owned()];
    (words.into(), numbers.concat())
}

/// Orbits, one a row.
pub fn orbits(name: &str, orbits: &[Orbit]) -> Sheet {
    Sheet::with_words(name, ORBIT, orbits.iter().map(cells))
}

/// Impacts of orbits, one a row.
pub fn impacts(name: &str, orbits: &[Orbit]) -> Sheet {
    let columns = ["impacts (left:right)", "side", "orbit (1)", "time (periods)", "relative speed (m/s)"];
    let rows = orbits.iter().enumerate().flat_map(|(number, orbit)| {
        orbit.impacts.iter().map(move |impact| {
            let side = if impact.side == Side::Left { "left" } else { "right" };
            (vec![orbit.pattern.to_string(), side.to_owned()], vec![number as f64, impact.time, impact.speed])
        })
    });
    Sheet::with_words(name, columns, rows)
}

/// Orbits of branches over `axis`, one a row.
pub fn branches(name: &str, axis: &str, branches: &[Branch]) -> Sheet {
    let columns = ORBIT[..WORDS].iter().copied().chain(["branch (1)", axis]).chain(ORBIT[WORDS..].iter().copied());
    let rows = branches
        .iter()
        .enumerate()
        .flat_map(|(number, branch)| branch.orbits.iter().map(move |orbit| numbered(cells(orbit), number, orbit)));
    Sheet::with_words(name, columns, rows)
}

/// Bifurcations of branches over `axis`, one a row.
pub fn bifurcations(name: &str, axis: &str, branches: &[Branch]) -> Sheet {
    let columns = ["bifurcation"].into_iter().chain(ORBIT[..WORDS].iter().copied());
    let columns = columns.chain(["branch (1)", axis]).chain(ORBIT[WORDS..].iter().copied());
    let rows = branches.iter().enumerate().flat_map(|(number, branch)| {
        branch.marks.iter().map(move |mark| {
            let (mut words, numbers) = numbered(cells(&mark.orbit), number, &mark.orbit);
            words.insert(0, mark.kind.words().to_owned());
            (words, numbers)
        })
    });
    Sheet::with_words(name, columns, rows)
}

fn numbered((words, numbers): (Vec<String>, Vec<f64>), number: usize, orbit: &Orbit) -> (Vec<String>, Vec<f64>) {
    (words, [vec![number as f64, orbit.point.value], numbers].concat())
}
