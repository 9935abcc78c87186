//! The visible part of a series: within the axes, thinned out to the pixels.

use super::axis::Axis;
use super::clip::{Window, clip};
use super::figure::{Data, Panel, Series, Style};
use super::metrics::floored;
use super::reduce::{is_finite, reduce_markers, reduce_within};

type Point = (f64, f64);

/// Pixel columns for each nominal px, for screens of twice the density and for print.
pub(super) const DENSITY: f64 = 2.0;
/// Values are cut here so that differences of coordinates stay finite.
const LARGEST: f64 = 1e300;

/// The visible part of a series.
pub(super) struct Trace {
    pub parts: Vec<Vec<Point>>,
    pub key: Key,
}

/// How a series, a band or a reference line looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Key {
    pub shape: Shape,
    /// Index into the palette; `None` is the grey of reference lines.
    pub color: Option<usize>,
}

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Line,
    Dashes,
    Marker,
    Dot,
    Cross,
    Pin,
    Area,
    Hatch,
    Cell,
}

impl Key {
    pub(super) const REFERENCE: Self = Self { shape: Shape::Dashes, color: None };

    pub(super) const HATCH: Self = Self { shape: Shape::Hatch, color: None };

    pub(super) fn new(shape: Shape, color: usize) -> Self {
        Self { shape, color: Some(color) }
    }

    fn of(series: &Series) -> Self {
        let shape = match series.style {
            Style::Line | Style::Steps => Shape::Line,
            Style::Dashed => Shape::Dashes,
            Style::Markers => Shape::Marker,
            Style::Dots => Shape::Dot,
            Style::Crosses => Shape::Cross,
            Style::Pins => Shape::Pin,
        };
        Self::new(shape, series.color.unwrap_or(0))
    }
}

/// From data to what the axes count: the data, or their logarithms.
#[derive(Debug, Clone, Copy)]
pub(super) struct Space {
    log_x: bool,
    log_y: bool,
}

impl Space {
    pub(super) fn of(panel: &Panel) -> Self {
        Self { log_x: panel.log_x, log_y: panel.log_y }
    }

    pub(super) fn x(self, value: f64) -> f64 {
        if self.log_x { logarithm(value) } else { cut(value) }
    }

    pub(super) fn y(self, value: f64) -> f64 {
        if self.log_y { logarithm(value) } else { cut(value) }
    }

    /// Back to the data.
    pub(super) fn data(self, x: f64, y: f64) -> Point {
        let back = |value: f64, log| if log { 10_f64.powf(value) } else { value };
        (back(x, self.log_x), back(y, self.log_y))
    }

    /// The points of a series; some may be gaps.
    pub(super) fn points<'d>(self, data: &'d Data<'_>) -> impl Iterator<Item = Point> + 'd {
        data.iter().map(move |(x, y)| (self.x(x), self.y(y)))
    }
}

/// The part of a series within the x range, thinned out; still as high as it is.
pub(super) fn trace(series: &Series, space: Space, x: &Axis, width: f64) -> Trace {
    let key = Key::of(series);
    let open = Window { x: (x.low, x.high), y: (f64::NEG_INFINITY, f64::INFINITY) };
    let points = space.points(&series.data);
    if series.style.is_marks() {
        let marks = points.filter(|p| is_finite(p) && open.contains(p)).collect();
        return Trace { parts: vec![marks], key };
    }
    let mut kept = reduce_within(points, open.x, floored(width * DENSITY));
    if series.style == Style::Steps {
        kept = stairs(&kept);
    }
    Trace { parts: clip(&kept, open), key }
}

/// Cuts a trace to the y range, once that is known.
pub(super) fn finish(trace: &mut Trace, series: &Series, (x, y): (&Axis, &Axis), (width, height): Point) {
    let window = Window { x: (x.low, x.high), y: (y.low, y.high) };
    let parts = std::mem::take(&mut trace.parts);
    trace.parts = if series.style.is_marks() {
        // Small dots cover a px or two: finer than a px they would only hide each other.
        let density = if series.style == Style::Dots { 1.0 } else { DENSITY };
        let marks = parts.into_iter().flatten().filter(|p| window.contains(p));
        let cells = (floored(width * density), floored(height * density));
        vec![reduce_markers(marks, (window.x, window.y), cells)]
    } else {
        let lines = parts.iter().flat_map(|part| clip(part, window));
        lines.map(|line| without_flats(&line)).collect()
    };
}

fn logarithm(value: f64) -> f64 {
    if value > 0.0 { value.log10() } else { f64::NAN }
}

fn stairs(points: &[Point]) -> Vec<Point> {
    let mut stairs: Vec<Point> = Vec::with_capacity(2 * points.len());
    for &(x, y) in points {
        if let Some(&(_, held)) = stairs.last() {
            stairs.push((x, held));
        }
        stairs.push((x, y));
    }
    stairs
}

/// A line without the inner points of its level stretches: pulses are mostly baseline.
fn without_flats(line: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::with_capacity(line.len());
    for &point in line {
        if let [.., before, last] = kept[..] {
            let level = before.1 == last.1 && last.1 == point.1;
            if level && (before.0 <= last.0) == (last.0 <= point.0) {
                kept.pop();
            }
        }
        kept.push(point);
    }
    kept
}

/// Limits a finite value; leaves infinity and not-a-number alone, which are gaps.
fn cut(value: f64) -> f64 {
    if value.is_finite() { value.clamp(-LARGEST, LARGEST) } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_stretches_keep_their_ends() {
        let pulse = [(0.0, 1.0), (1.0, 1.0), (2.0, 1.0), (3.0, 2.0), (4.0, 1.0), (5.0, 1.0)];
        let kept = without_flats(&pulse);
        assert_eq!(kept, [(0.0, 1.0), (2.0, 1.0), (3.0, 2.0), (4.0, 1.0), (5.0, 1.0)]);
        let back_and_forth = [(0.0, 1.0), (2.0, 1.0), (-1.0, 1.0)];
        assert_eq!(without_flats(&back_and_forth), back_and_forth);
    }

    #[test]
    fn steps_hold_until_the_next_point() {
        assert_eq!(stairs(&[(0.0, 1.0), (1.0, 2.0)]), [(0.0, 1.0), (1.0, 1.0), (1.0, 2.0)]);
    }

    #[test]
    fn what_has_no_logarithm_is_a_gap() {
        let panel = Panel::new("", "", "").log_y();
        let points = [(1.0, 100.0), (2.0, 0.0), (3.0, -1.0), (-4.0, 10.0)];
        let kept: Vec<Point> = Space::of(&panel).points(&Data::Points(&points)).filter(is_finite).collect();
        assert_eq!(kept, [(1.0, 2.0), (-4.0, 1.0)]);
    }
}
