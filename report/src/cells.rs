//! Cells of a map, and clouds of small dots, as compact SVG: one path for each colour.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::axis::Axis;
use super::colors::{Ramp, Rgb, hex, palette};
use super::figure::{HeatMap, Scale};
use super::trace::Space;

/// A map with its cells' edges in axis units.
pub(super) struct Cells<'f> {
    map: &'f HeatMap<'f>,
    xs: Vec<f64>,
    ys: Vec<f64>,
    /// Of a quantity.
    pub ramp: Option<Ramp>,
}

impl<'f> Cells<'f> {
    pub(super) fn new(map: &'f HeatMap<'f>, space: Space) -> Self {
        let xs = edges(&map.xs.iter().map(|&x| space.x(x)).collect::<Vec<f64>>());
        let ys = edges(&map.ys.iter().map(|&y| space.y(y)).collect::<Vec<f64>>());
        let ramp = matches!(map.scale, Scale::Quantity(_)).then(|| Ramp::over(map.values));
        Self { map, xs, ys, ramp }
    }

    /// Ends of the rows, in axis units.
    pub(super) fn y_range(&self) -> [f64; 2] {
        ends(&self.ys)
    }

    /// Paths of all cells in units of the drawing; `place` maps axis units to those.
    pub(super) fn markup(&self, (x, y): (&Axis, &Axis), place: impl Fn(f64, f64) -> (i32, i32)) -> String {
        let mut paths: BTreeMap<Rgb, String> = BTreeMap::new();
        let clamped = |edges: &[f64], axis: &Axis| -> Vec<f64> {
            edges.iter().map(|edge| edge.clamp(axis.low, axis.high)).collect()
        };
        let (xs, ys) = (clamped(&self.xs, x), clamped(&self.ys, y));
        let columns = self.map.xs.len().max(1);
        for (row, values) in ys.windows(2).zip(self.map.values.chunks(columns)) {
            let colors: Vec<Option<Rgb>> = values.iter().map(|&value| self.color(value)).collect();
            let mut first = 0;
            for run in colors.chunk_by(|a, b| a == b) {
                let (from, to) = (first, first + run.len());
                first = to;
                let (Some(Some(color)), Some(&left), Some(&right)) = (run.first(), xs.get(from), xs.get(to)) else {
                    continue;
                };
                rectangle(paths.entry(*color).or_default(), place(left, row[1]), place(right, row[0]));
            }
        }
        let paths = paths.iter().map(|(color, path)| format!("<path fill=\"{}\" d=\"{path}\"/>\n", hex(*color)));
        format!("<g shape-rendering=\"crispEdges\">\n{}</g>\n", paths.collect::<String>())
    }

    fn color(&self, value: f64) -> Option<Rgb> {
        match &self.ramp {
            Some(ramp) => ramp.level(value).map(|level| ramp.color(level)),
            None => value.is_finite().then(|| palette(kind(value))),
        }
    }
}

/// The colours of a ramp from bottom to top, within a rectangle of the drawing.
pub(super) fn ramp_markup(ramp: &Ramp, (left, top): (i32, i32), (right, bottom): (i32, i32)) -> String {
    let mut markup = String::from("<g shape-rendering=\"crispEdges\">\n");
    let count = i32::try_from(Ramp::LEVELS).unwrap_or(1);
    let at = |level: i32| bottom - (bottom - top) * level / count;
    for (level, index) in (0..count).zip(0..) {
        let mut path = String::new();
        rectangle(&mut path, (left, at(level + 1)), (right, at(level)));
        let _ = writeln!(markup, "<path fill=\"{}\" d=\"{path}\"/>", hex(ramp.color(index)));
    }
    markup + "</g>\n"
}

/// Round dots of one colour as one path, each relative to the one before.
pub(super) fn dots_markup(dots: impl Iterator<Item = (i32, i32)>, color: Rgb, diameter: i32) -> String {
    let (mut path, mut before) = (String::from("M0 0"), (0, 0));
    for (x, y) in dots {
        // Writing to a string does not fail.
        let _ = write!(path, "m{} {}h0", x - before.0, y - before.1);
        before = (x, y);
    }
    format!(
        "<path fill=\"none\" stroke=\"{}\" stroke-width=\"{diameter}\" stroke-linecap=\"round\" d=\"{path}\"/>\n",
        hex(color)
    )
}

/// Ends of what a map covers along one axis, from the middles of its cells in axis units.
pub(super) fn covered(middles: impl Iterator<Item = f64>) -> [f64; 2] {
    ends(&edges(&middles.collect::<Vec<f64>>()))
}

/// Index of a kind, which has been checked to be a small whole number.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked with the figure")]
pub(super) fn kind(value: f64) -> usize {
    value as usize
}

fn ends(edges: &[f64]) -> [f64; 2] {
    [edges.first().copied().unwrap_or(f64::NAN), edges.last().copied().unwrap_or(f64::NAN)]
}

/// Half way between the middles, and as far beyond the outer ones; a lone cell is 1 wide.
fn edges(middles: &[f64]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (middles.first(), middles.last()) else { return Vec::new() };
    let between = middles.windows(2).map(|pair| f64::midpoint(pair[0], pair[1]));
    let mut edges: Vec<f64> = std::iter::once(f64::NAN).chain(between).collect();
    let low = edges.get(1).map_or(first - 0.5, |next| 2.0 * first - next);
    let high = if middles.len() > 1 { 2.0 * last - edges.last().unwrap_or(&last) } else { last + 0.5 };
    edges[0] = low;
    edges.push(high);
    edges
}

fn rectangle(path: &mut String, (left, top): (i32, i32), (right, bottom): (i32, i32)) {
    let (width, height) = (right - left, bottom - top);
    if width > 0 && height > 0 {
        // Writing to a string does not fail.
        let _ = write!(path, "M{left} {top}h{width}v{height}h-{width}z");
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::Panel;
    use super::*;

    fn cells(values: &[f64]) -> String {
        let map = HeatMap { xs: &[0.0, 1.0, 2.0], ys: &[0.0, 1.0], values, scale: Scale::Kinds(Vec::new()) };
        let cells = Cells::new(&map, Space::of(&Panel::new("", "", "")));
        let (x, y) = (Axis::exact(-0.5, 2.0, 5).unwrap(), Axis::exact(-0.5, 1.5, 5).unwrap());
        #[expect(clippy::cast_possible_truncation, reason = "small numbers")]
        cells.markup((&x, &y), |x, y| ((10.0 * (x + 0.5)) as i32, (10.0 * (1.5 - y)) as i32))
    }

    #[test]
    fn equal_neighbours_join_and_gaps_stay_empty() {
        let markup = cells(&[0.0, 0.0, 1.0, 1.0, f64::NAN, 1.0]);
        assert!(markup.contains("fill=\"#0072b2\" d=\"M0 10h20v10h-20z\""), "{markup}");
        // The outer column is cut in half by the axis.
        assert!(markup.contains("fill=\"#d55e00\" d=\"M20 10h5v10h-5zM0 0h10v10h-10zM20 0h5v10h-5z\""), "{markup}");
    }

    #[test]
    fn cells_reach_half_way_to_their_neighbours() {
        assert_eq!(edges(&[1.0, 2.0, 3.0]), [0.5, 1.5, 2.5, 3.5]);
        assert_eq!(edges(&[4.0]), [3.5, 4.5]);
        assert!(edges(&[]).is_empty());
    }

    #[test]
    fn dots_are_relative_to_each_other() {
        let markup = dots_markup([(5, 5), (7, 4)].into_iter(), (0, 0, 0), 16);
        assert!(markup.contains("M0 0m5 5h0m2 -1h0"), "{markup}");
    }
}
