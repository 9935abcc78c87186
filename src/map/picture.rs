//! The figure of a map.

use super::axis::{Axis, labelled};
use super::best::Point;
use super::error::MapError;
use super::plan::Plan;
use super::work::Map;
use crate::artefact::Picture;
use videg_report::{Figure, HeatMap, Panel, Scale, Series, Style};

/// What is drawn of a map.
pub struct Layers<'m> {
    plan: &'m Plan,
    unit: String,
    axes: [Vec<f64>; 2],
    values: Vec<f64>,
    /// The most that is taken of any limit of the film.
    over: Vec<f64>,
    grid_best: Vec<(f64, f64)>,
    best: Vec<(f64, f64)>,
    admissible: Vec<(f64, f64)>,
}

impl<'m> Layers<'m> {
    /// The layers of `map`.
    pub fn new(plan: &'m Plan, map: &Map) -> Self {
        let (factor, unit) = scaled_unit(plan, map);
        let rounding = 1e-5 * factor * largest(plan, map);
        let value = |cell| {
            let value = factor * plan.number(cell, &plan.of);
            // What no colour tells from 0 would, by its sign, put 0 into the middle of the colours.
            if value.abs() < rounding { 0.0 } else { value }
        };
        let at = |point: &Point| vec![(point.at[0], point.at[1])];
        let admissible = map.admissible.as_ref().filter(|point| **point != map.best).map_or(Vec::new(), at);
        Self {
            plan,
            unit,
            axes: plan.axes.each_ref().map(Axis::values),
            values: map.cells.iter().map(value).collect(),
            over: map.cells.iter().map(|cell| plan.over_limits(cell)).collect(),
            grid_best: at(&map.grid_best),
            best: at(&map.best),
            admissible,
        }
    }

    /// The map with its contours, and the part in which a limit of the film is exceeded.
    pub fn ground(&self, title: &str) -> Panel<'_> {
        let [x, y] = &self.plan.axes;
        let [xs, ys] = &self.axes;
        let scale = Scale::Quantity(labelled(&self.plan.of, &self.unit));
        let map = HeatMap { xs, ys, values: &self.values, scale };
        let mut panel = Panel::new(title, x.label(), y.label()).height(360.0).map(map).contours();
        if self.over.iter().any(|share| *share > 1.0) {
            panel = panel.hatched("a limit of the film is exceeded", &self.over, 1.0);
        }
        panel = if x.is_log() { panel.log_x() } else { panel };
        if y.is_log() { panel.log_y() } else { panel }
    }

    /// The same with the best points.
    pub fn panel(&self, title: &str) -> Panel<'_> {
        let points = |label: &str, points, style, color| Series::points(label, points).style(style).color(color);
        let panel = self
            .ground(title)
            .series(points("best of the grid", &self.grid_best, Style::Crosses, 6))
            .series(points("best", &self.best, Style::Pins, 1));
        if self.admissible.is_empty() {
            return panel;
        }
        panel.series(points("best within the limits", &self.admissible, Style::Pins, 0))
    }
}

/// Draws a map with its best points.
///
/// # Errors
/// Values that cannot be drawn.
pub fn picture(plan: &Plan, map: &Map, caption: &str) -> Result<Picture, MapError> {
    let layers = Layers::new(plan, map);
    Picture::new("map", &Figure::new("").caption(caption).panel(layers.panel("")), caption)
}

/// The largest value of a map, without its sign.
fn largest(plan: &Plan, map: &Map) -> f64 {
    let values = map.cells.iter().map(|cell| plan.number(cell, &plan.of).abs());
    values.filter(|value| value.is_finite()).fold(map.best.value.abs(), f64::max)
}

/// Factor and unit in which the values of a map are readable: W become mW, uW or nW.
pub fn scaled_unit(plan: &Plan, map: &Map) -> (f64, String) {
    let largest = largest(plan, map);
    let prefixed = [(1.0, "W"), (1e3, "mW"), (1e6, "uW"), (1e9, "nW")];
    match prefixed.into_iter().find(|(factor, _)| factor * largest >= 1.0).filter(|_| plan.unit == "W") {
        Some((factor, unit)) => (factor, unit.to_owned()),
        None => (1.0, plan.unit.clone()),
    }
}
