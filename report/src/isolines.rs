//! Contours of a map with their labels, and hatched parts of it, as SVG.

use std::fmt::Write;

use super::axis::Axis;
use super::canvas::UNITS;
use super::cells::covered;
use super::clip::{Window, clip};
use super::contour::Grid;
use super::figure::HeatMap;
use super::layout::PanelPlan;
use super::metrics::{DIGIT, TEXT_SIZE};
use super::trace::{Shape, Space};

type Point = (f64, f64);

/// Sizes in px.
const LABEL: f64 = 0.85 * TEXT_SIZE;
/// Distance of hatching lines, and of the points that decide where they are drawn.
const HATCHING: f64 = 8.0;
const FINENESS: f64 = 1.0;

/// A map in axis units, with its place in the drawing. The outer cells are continued to the frame, so that lines end there.
struct Ground<'p> {
    xs: Vec<f64>,
    ys: Vec<f64>,
    panel: &'p PanelPlan<'p>,
    /// Left, top, width and height of the frame, px.
    frame: [f64; 4],
}

/// Contours and hatches of a panel; nothing if it has none.
pub(super) fn markup(panel: &PanelPlan) -> String {
    let (Some(map), content) = (&panel.panel.map, panel.panel) else { return String::new() };
    let ground = Ground::new(panel, map);
    let mut markup = String::new();
    for hatch in &content.hatches {
        let values = ground.padded(hatch.values);
        let grid = Grid { xs: &ground.xs, ys: &ground.ys, values: &values };
        let border = lines_path(&ground.drawn(&grid, hatch.above));
        markup += &twice(&ground.hatching(&grid, hatch.above), 0.8, 0.6);
        markup += &twice(&border, 1.6, 1.0);
    }
    if let (true, Some(bar)) = (content.contours, &panel.bar) {
        markup += &ground.contours(map, &bar.axis);
    }
    markup
}

impl<'p> Ground<'p> {
    fn new(panel: &'p PanelPlan<'p>, map: &HeatMap) -> Self {
        let space: Space = panel.space;
        Self {
            xs: continued(map.xs.iter().map(|x| space.x(*x)).collect()),
            ys: continued(map.ys.iter().map(|y| space.y(*y)).collect()),
            panel,
            frame: [panel.frame.0, panel.top + panel.header, panel.frame.1 - panel.frame.0, panel.height],
        }
    }

    /// Values of the cells, with those of the outer ones once more.
    fn padded(&self, values: &[f64]) -> Vec<f64> {
        let columns = self.xs.len() - 2;
        let row = |row: &[f64]| -> Vec<f64> {
            let [first, last] = [row.first(), row.last()].map(|value| value.copied().unwrap_or(f64::NAN));
            std::iter::once(first).chain(row.iter().copied()).chain([last]).collect()
        };
        let rows: Vec<Vec<f64>> = values.chunks(columns.max(1)).map(row).collect();
        rows.first().into_iter().chain(&rows).chain(rows.last()).flatten().copied().collect()
    }

    /// Place in px of a point in axis units.
    fn place(&self, (x, y): Point) -> Point {
        let ([left, top, width, height], PanelPlan { x: across, y: up, .. }) = (self.frame, self.panel);
        let share = |axis: &Axis, value: f64| (value - axis.low) / (axis.high - axis.low);
        (left + width * share(across, x), top + height * (1.0 - share(up, y)))
    }

    /// The point in axis units at a place in px.
    fn point(&self, (across, down): Point) -> Point {
        let ([left, top, width, height], PanelPlan { x, y, .. }) = (self.frame, self.panel);
        let at = |axis: &Axis, share: f64| axis.low + (axis.high - axis.low) * share;
        (at(x, (across - left) / width), at(y, 1.0 - (down - top) / height))
    }

    /// Lines of a level within the frame, px.
    fn drawn(&self, grid: &Grid, level: f64) -> Vec<Vec<Point>> {
        let PanelPlan { x, y, .. } = self.panel;
        let window = Window { x: (x.low, x.high), y: (y.low, y.high) };
        let parts = grid.lines(level).into_iter().flat_map(|line| clip(&line, window));
        parts.map(|part| part.into_iter().map(|point| self.place(point)).collect()).collect()
    }

    /// Contours at the ticks of the colour bar.
    fn contours(&self, map: &HeatMap, bar: &Axis) -> String {
        let values: Vec<f64> = map.values.iter().map(|value| bar.scaled(*value)).collect();
        let values = self.padded(&values);
        let grid = Grid { xs: &self.xs, ys: &self.ys, values: &values };
        let marks = self.panel.traces.iter().filter(|trace| trace.key.shape == Shape::Pin);
        let mut taken: Vec<Point> = marks.flat_map(|trace| &trace.parts).flatten().map(|at| self.place(*at)).collect();
        let (mut path, mut labels) = (String::new(), String::new());
        for &tick in bar.ticks() {
            let mut lines = self.drawn(&grid, tick);
            lines.sort_by(|a, b| length(b).total_cmp(&length(a)));
            path += &lines_path(&lines);
            let text = bar.label(tick);
            for line in lines.iter().take(2) {
                if let Some((at, angle)) = self.label_place(line, &text, &taken) {
                    taken.push(at);
                    labels += &label(&text, at, angle);
                }
            }
        }
        twice(&path, 0.9, 0.7) + &labels
    }

    /// Where a label has room on a line, and the angle of the line there.
    fn label_place(&self, line: &[Point], text: &str, taken: &[Point]) -> Option<(Point, f64)> {
        let half = 0.5 * DIGIT * LABEL * text.chars().count() as f64 + 2.0;
        let length = length(line);
        let [left, top, width, height] = self.frame;
        [0.5, 0.35, 0.65, 0.2, 0.8].into_iter().find_map(|share| {
            let [before, at, after] = [-half, 0.0, half].map(|shift| along(line, share * length + shift));
            let chord = (after.0 - before.0).hypot(after.1 - before.1);
            // A line that bends has no room for a straight text.
            let is_straight = length > 5.0 * half && chord > 1.8 * half;
            let is_inside =
                (left + half..left + width - half).contains(&at.0) && (top + half..top + height - half).contains(&at.1);
            let is_free = taken.iter().all(|other| (other.0 - at.0).hypot(other.1 - at.1) > 2.0 * half + LABEL);
            let angle = (after.1 - before.1).atan2(after.0 - before.0).to_degrees();
            let upright = if angle.abs() > 90.0 { angle - 180.0_f64.copysign(angle) } else { angle };
            (is_straight && is_inside && is_free).then_some((at, upright))
        })
    }

    /// Slanting lines where the value is above `bound`.
    fn hatching(&self, grid: &Grid, bound: f64) -> String {
        let [left, top, width, height] = self.frame;
        let mut path = String::new();
        let mut shift = HATCHING / 2.0;
        while shift < width + height {
            // From the left or the upper edge down to the left: x + y is constant.
            let (from, to) = ((shift - height).max(0.0), shift.min(width));
            let mut begin = None;
            let mut across = from;
            while across <= to {
                let at = (left + across, top + shift - across);
                let is_inside = across < to && grid.value(self.point(at)) > bound;
                match (begin, is_inside) {
                    (None, true) => begin = Some(at),
                    (Some(start), false) => {
                        path += &lines_path(&[vec![start, at]]);
                        begin = None;
                    }
                    _ => {}
                }
                across = if across < to { (across + FINENESS).min(to) } else { f64::INFINITY };
            }
            shift += HATCHING;
        }
        path
    }
}

/// Middles of cells, and the outer ends of the outer ones.
fn continued(middles: Vec<f64>) -> Vec<f64> {
    let [first, last] = covered(middles.iter().copied());
    std::iter::once(first).chain(middles).chain([last]).collect()
}

fn length(line: &[Point]) -> f64 {
    line.windows(2).map(|pair| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1)).sum()
}

/// The point of a line at a `distance` from its begin, along it.
fn along(line: &[Point], distance: f64) -> Point {
    let mut rest = distance.max(0.0);
    for pair in line.windows(2) {
        let step = length(pair);
        if rest <= step && step > 0.0 {
            let share = rest / step;
            return (pair[0].0 + share * (pair[1].0 - pair[0].0), pair[0].1 + share * (pair[1].1 - pair[0].1));
        }
        rest -= step;
    }
    line.last().copied().unwrap_or_default()
}

fn lines_path(lines: &[Vec<Point>]) -> String {
    let mut path = String::new();
    for (index, (x, y)) in lines.iter().flat_map(|line| line.iter().enumerate()) {
        // Writing to a string does not fail.
        let _ = write!(path, "{}{:.0} {:.0}", if index == 0 { "M" } else { "L" }, x * UNITS, y * UNITS);
    }
    path
}

/// A dark path on a wider light one: it is seen on any colour.
fn twice(path: &str, width: f64, opacity: f64) -> String {
    if path.is_empty() {
        return String::new();
    }
    let pen = |color: &str, width: f64, opacity: f64| {
        let width = width * UNITS;
        format!("<path stroke=\"{color}\" stroke-width=\"{width:.0}\" stroke-opacity=\"{opacity}\" d=\"{path}\"/>\n")
    };
    format!("<g fill=\"none\">\n{}{}</g>\n", pen("#fff", width + 1.2, 0.5 * opacity), pen("#222", width, opacity))
}

/// A text on a light halo. Not every program knows the order of painting, so that the halo is a text of its own.
fn label(text: &str, (x, y): Point, angle: f64) -> String {
    let [x, y, size, halo] = [x, y, LABEL, 2.4].map(|px| px * UNITS);
    let place = format!(
        "x=\"{x:.0}\" y=\"{y:.0}\" dy=\"0.35em\" transform=\"rotate({angle:.1} {x:.0} {y:.0})\" font-size=\"{size:.0}\" \
         text-anchor=\"middle\""
    );
    format!(
        "<text {place} fill=\"#fff\" stroke=\"#fff\" stroke-width=\"{halo:.0}\" aria-hidden=\"true\">{text}</text>\n\
         <text {place} fill=\"#222\">{text}</text>\n"
    )
}
