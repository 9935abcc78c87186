//! What shows of a series: the part within the axes, thinned out to the pixels.

use super::axis::Axis;
use super::clip::{Window, clip};
use super::figure::{Data, Series, Style};
use super::layout::whole;
use super::reduce::{is_finite, reduce_markers, reduce_within};

type Point = (f64, f64);

/// Pixel columns for each nominal px, for screens of twice the density and for print.
const DENSITY: f64 = 2.0;
/// Values are cut here so that differences of coordinates stay finite.
const LARGEST: f64 = 1e300;

/// What shows of a series.
pub(super) struct Trace {
    pub parts: Vec<Vec<Point>>,
    pub key: Key,
}

/// How a series or a reference line looks; the number is the colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Key {
    Line(usize),
    Dot(usize),
    Dashes,
}

/// The part of a series within the x range, thinned out; still as high as it is.
pub(super) fn trace(series: &Series, x: &Axis, width: f64) -> Trace {
    let color = series.color.unwrap_or(0);
    let open = Window { x: (x.low, x.high), y: (f64::NEG_INFINITY, f64::INFINITY) };
    if series.style == Style::Markers {
        let dots = finite(&series.data).filter(|p| open.contains(p)).collect();
        return Trace { parts: vec![dots], key: Key::Dot(color) };
    }
    let points = series.data.iter().map(|(x, y)| (cut(x), cut(y)));
    let mut kept = reduce_within(points, open.x, whole(width * DENSITY));
    if series.style == Style::Steps {
        kept = stairs(&kept);
    }
    Trace { parts: clip(&kept, open), key: Key::Line(color) }
}

/// Cuts a trace to the y range, once that is known.
pub(super) fn finish(trace: &mut Trace, series: &Series, (x, y): (&Axis, &Axis), (width, height): Point) {
    let window = Window { x: (x.low, x.high), y: (y.low, y.high) };
    let parts = std::mem::take(&mut trace.parts);
    trace.parts = if series.style == Style::Markers {
        let dots = parts.into_iter().flatten().filter(|p| window.contains(p));
        let cells = (whole(width * DENSITY), whole(height * DENSITY));
        vec![reduce_markers(dots, (window.x, window.y), cells)]
    } else {
        let lines = parts.iter().flat_map(|part| clip(part, window));
        lines.map(|line| without_flats(&line)).collect()
    };
}

pub(super) fn finite<'d>(data: &'d Data<'_>) -> impl Iterator<Item = Point> + 'd {
    data.iter().filter(is_finite).map(|(x, y)| (cut(x), cut(y)))
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
}
