//! Pictures of sections, diagrams and basins.

use videg_report::{Figure, HeatMap, Panel, Scale, Series, Style};

use super::DynamicsError;
use super::basins::Basins;
use super::branch_lines::{BranchLines, Height};
use super::diagram::{Diagram, WAYS};
use super::motion::Motion;
use super::orbits::Branch;
use crate::artefact::Picture;

/// Distance, mm, of dots that look like one.
const RESOLUTION: f64 = 0.05;
/// Attractors that have a colour of their own.
pub const SHOWN: usize = 6;
/// Colour of dots below branches.
const PALE: usize = 5;

const DISPLACEMENT: &str = "z_M - z_m (mm)";

/// Poincare sections: displacement against velocity, of motions with their titles.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn sections(name: &str, motions: &[(&str, &Motion)], caption: &str) -> Result<Picture, DynamicsError> {
    let dots: Vec<Vec<(f64, f64)>> = motions
        .iter()
        .map(|(_, motion)| motion.flashes.iter().map(|flash| (1e3 * flash.displacement, flash.velocity)).collect())
        .collect();
    let mut figure = Figure::new(if motions.len() == 1 { "Poincare section" } else { "Poincare sections" })
        .caption("Relative displacement against relative velocity, once a period.")
        .columns(motions.len())
        .width(if motions.len() == 1 { 560.0 } else { 360.0 * motions.len() as f64 });
    for ((title, motion), dots) in motions.iter().zip(&dots) {
        let style = if motion.recurrence().is_some() { Style::Markers } else { Style::Dots };
        let panel = Panel::new(*title, DISPLACEMENT, "z_M' - z_m' (m/s)")
            .height(300.0)
            .series(Series::points("", dots).style(style));
        figure = figure.panel(panel);
    }
    Picture::new(name, &figure, caption)
}

/// Displacements over the parameter `axis`, each way, and `<U>`; the branches of orbits over them, if there are any.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn diagram(
    name: &str,
    axis: &str,
    diagram: &Diagram,
    branches: &[Branch],
    caption: &str,
) -> Result<Picture, DynamicsError> {
    let xs = &diagram.xs;
    let mut clouds: Vec<Vec<(f64, f64)>> = diagram.ways.iter().map(|motions| cloud(xs, motions)).collect();
    // Upwards and downwards share a panel, where equal dots would hide each other.
    let upwards = clouds[1].clone();
    clouds[2].retain(|dot| !hidden(*dot, &upwards));
    let taken = diagram.periods.taken as usize;
    let gain = |motion: &Motion| 1e-3 * motion.voltage_gain(taken);
    let gains: Vec<Vec<(f64, f64)>> =
        diagram.ways.iter().map(|motions| xs.iter().copied().zip(motions.iter().map(gain)).collect()).collect();
    let [from, to] = [xs.first(), xs.last()].map(|end| end.copied().unwrap_or_default());
    let panel = |title: &str, label: &str, height: f64| Panel::new(title, axis, label).x_range(from, to).height(height);
    let lines = BranchLines::new(branches, Height::Displacement);
    let dots = |index: usize| {
        let label = if index == 2 { "followed downwards, where that differs" } else { WAYS[index] };
        let color = if branches.is_empty() { index } else { PALE };
        Series::points(label, &clouds[index]).style(Style::Dots).color(color)
    };
    let output = panel("(c)", "<U> (kV/s)", 160.0);
    let output = (0..WAYS.len()).rev().fold(output, |panel, index| {
        panel.series(Series::points(WAYS[index], &gains[index]).style(Style::Dots).color(index))
    });
    let height = if branches.is_empty() { 240.0 } else { 320.0 };
    let first = lines.draw(panel("(a)", DISPLACEMENT, height).share_x_with_next().series(dots(0)));
    let second = panel("(b)", DISPLACEMENT, 240.0)
        .share_x_with_next()
        .series(Series::points(WAYS[1], &clouds[1]).style(Style::Dots).color(1))
        .series(Series::points("followed downwards, where that differs", &clouds[2]).style(Style::Dots).color(2));
    let figure = Figure::new("Bifurcation diagram")
        .caption("Relative displacement once a period, and average voltage gain, over a parameter.")
        .panel(first)
        .panel(second)
        .panel(output);
    Picture::new(name, &figure, caption)
}

/// Modulus of the largest multiplier of each branch over the parameter `axis`.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn multipliers(name: &str, axis: &str, branches: &[Branch], caption: &str) -> Result<Picture, DynamicsError> {
    let lines = BranchLines::new(branches, Height::Multiplier);
    let panel = Panel::new("", axis, "largest modulus of a multiplier (1)").height(300.0).log_y().line("", 1.0);
    let figure = Figure::new("Floquet multipliers")
        .caption("Largest modulus of the multipliers of each branch of periodic orbits over the parameter.")
        .panel(lines.draw(panel.y_range(1e-2, 1e3)));
    Picture::new(name, &figure, caption)
}

/// Which motion a start leads to.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn basins(name: &str, title: &str, basins: &Basins, caption: &str) -> Result<Picture, DynamicsError> {
    let millimetres: Vec<f64> = basins.xs.iter().map(|x| 1e3 * x).collect();
    let shown = basins.attractors.len().min(SHOWN);
    let mut kinds: Vec<String> = basins.attractors.iter().take(shown).map(|(attractor, _)| attractor.label()).collect();
    if basins.attractors.len() > shown {
        kinds.push("others".to_owned());
    }
    let kind = |end| basins.kind(end).map_or(f64::NAN, |kind| kind.min(shown) as f64);
    let values: Vec<f64> = basins.ends.iter().map(kind).collect();
    let map = HeatMap { xs: &millimetres, ys: &basins.ys, values: &values, scale: Scale::Kinds(kinds) };
    let panel = Panel::new("", "z_M - z_m at 0 s (mm)", "z_M' - z_m' at 0 s (m/s)").height(420.0).map(map);
    let figure = Figure::new(title)
        .caption("Which motion a start leads to, over relative displacement and velocity at the start.")
        .panel(panel);
    Picture::new(name, &figure, caption)
}

/// Whether a dot of a cloud, which is sorted by x, is one with this to the eye.
fn hidden(dot: (f64, f64), cloud: &[(f64, f64)]) -> bool {
    let column = cloud.iter().skip(cloud.partition_point(|other| other.0 < dot.0)).take_while(|other| other.0 == dot.0);
    column.map(|other| other.1).any(|y| (y - dot.1).abs() < 1.5 * RESOLUTION)
}

/// Dots to draw, mm: one of those that look alike.
fn cloud(xs: &[f64], motions: &[Motion]) -> Vec<(f64, f64)> {
    let dots = |motion: &Motion| {
        let mut values: Vec<f64> =
            motion.flashes.iter().map(|flash| (1e3 * flash.displacement / RESOLUTION).round()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let column = |(&x, motion): (&f64, &Motion)| dots(motion).into_iter().map(move |value| (x, value * RESOLUTION));
    xs.iter().zip(motions).flat_map(column).collect()
}
