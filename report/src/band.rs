//! The visible parts of bands and of vertical bars.

use super::axis::Axis;
use super::clip::Window;
use super::figure::{Band, Bars};
use super::metrics::floored;
use super::reduce::reduce_within;
use super::trace::{DENSITY, Space};

type Point = (f64, f64);

/// A side of the window: which coordinate it bounds, where, and whether it is the lower bound.
type Side = (fn(&Point) -> f64, f64, bool);

/// A bar that shows, with its ends and whether they are its own or cut off.
pub(super) struct Whisker {
    pub x: f64,
    pub ends: [(f64, bool); 2],
}

/// All y values of a band or of bars within the x range.
pub(super) fn heights(limits: &[(f64, f64, f64)], space: Space, x: &Axis) -> impl Iterator<Item = f64> {
    let range = x.low..=x.high;
    let inside = limits.iter().filter(move |limit| range.contains(&space.x(limit.0)));
    inside.flat_map(move |&(_, low, high)| [space.y(low), space.y(high)]).filter(|y| y.is_finite())
}

/// The polygons that a band fills within the axes; a limit that is not finite splits it.
pub(super) fn areas(band: &Band, space: Space, (x, y): (&Axis, &Axis), width: f64) -> Vec<Vec<Point>> {
    let limits: Vec<_> = band.limits.iter().map(|&(x, low, high)| (space.x(x), space.y(low), space.y(high))).collect();
    let runs = limits.split(|limit| ![limit.0, limit.1, limit.2].iter().all(|value| value.is_finite()));
    let columns = floored(width * DENSITY);
    let polygon = |run: &[(f64, f64, f64)]| {
        let lower = reduce_within(run.iter().map(|limit| (limit.0, limit.1)), (x.low, x.high), columns);
        let upper = reduce_within(run.iter().map(|limit| (limit.0, limit.2)), (x.low, x.high), columns);
        let outline = lower.into_iter().chain(upper.into_iter().rev()).collect();
        cut_out(outline, Window { x: (x.low, x.high), y: (y.low, y.high) })
    };
    runs.map(polygon).filter(|polygon| polygon.len() > 2).collect()
}

/// The bars within the axes.
pub(super) fn whiskers(bars: &Bars, space: Space, (x, y): (&Axis, &Axis)) -> Vec<Whisker> {
    let inside = y.low..=y.high;
    let end = |value: f64| (value.clamp(y.low, y.high), inside.contains(&value));
    let bars = bars.limits.iter().map(|&(x, low, high)| (space.x(x), space.y(low), space.y(high)));
    let shown = bars.filter(|&(at, low, high)| (x.low..=x.high).contains(&at) && low <= y.high && high >= y.low);
    shown.map(|(x, low, high)| Whisker { x, ends: [end(low), end(high)] }).collect()
}

/// The part of a polygon in the window, side by side as Sutherland and Hodgman do it (CACM 17 (1974) 32).
fn cut_out(polygon: Vec<Point>, window: Window) -> Vec<Point> {
    let sides: [Side; 4] = [
        (|p| p.0, window.x.0, true),
        (|p| p.0, window.x.1, false),
        (|p| p.1, window.y.0, true),
        (|p| p.1, window.y.1, false),
    ];
    sides.into_iter().fold(polygon, |polygon, side| cut_side(&polygon, side))
}

fn cut_side(polygon: &[Point], (coordinate, bound, is_lower): Side) -> Vec<Point> {
    let room = |p: &Point| if is_lower { coordinate(p) - bound } else { bound - coordinate(p) };
    let mut kept = Vec::with_capacity(polygon.len());
    let before = polygon.iter().cycle().skip(polygon.len().saturating_sub(1));
    for (from, to) in before.zip(polygon) {
        let (start, end) = (room(from), room(to));
        if (start < 0.0) != (end < 0.0) {
            let share = start / (start - end);
            kept.push((from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
        }
        if end >= 0.0 {
            kept.push(*to);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::figure::Panel;
    use super::*;

    fn axis(low: f64, high: f64) -> Axis {
        Axis::exact(low, high, 5).unwrap()
    }

    fn space() -> Space {
        Space::of(&Panel::new("", "", ""))
    }

    #[test]
    fn a_band_is_cut_at_the_axes_and_split_at_gaps() {
        let limits = [(0.0, 0.0, 4.0), (2.0, 0.0, 4.0), (3.0, f64::NAN, 1.0), (4.0, 1.0, 2.0), (6.0, 1.0, 2.0)];
        let band = Band { label: String::new(), limits: &limits, color: 0 };
        let areas = areas(&band, space(), (&axis(1.0, 5.0), &axis(0.0, 3.0)), 100.0);
        let inside = |p: &Point| (1.0..=5.0).contains(&p.0) && (0.0..=3.0).contains(&p.1);
        assert_eq!(areas.len(), 2);
        assert!(areas.iter().flatten().all(inside), "{areas:?}");
        assert!(areas[0].contains(&(1.0, 3.0)) && areas[0].contains(&(2.0, 0.0)));
    }

    #[test]
    fn a_bar_that_leaves_the_frame_ends_at_it() {
        let limits = [(1.0, -1.0, 1.0), (2.0, 5.0, 6.0), (9.0, 0.0, 1.0), (3.0, f64::NAN, 1.0)];
        let shown = whiskers(&Bars { limits: &limits, color: 0 }, space(), (&axis(0.0, 4.0), &axis(0.0, 3.0)));
        assert_eq!(shown.len(), 1);
        assert_eq!(shown[0].ends, [(0.0, false), (1.0, true)]);
    }

    #[test]
    fn a_long_band_is_thinned_out() {
        let limits: Vec<_> = (0..100_000).map(|k| (f64::from(k), f64::from(k).sin(), 2.0)).collect();
        let band = Band { label: String::new(), limits: &limits, color: 0 };
        let areas = areas(&band, space(), (&axis(0.0, 1e5), &axis(-1.0, 3.0)), 100.0);
        assert!(areas[0].len() < 2000, "{}", areas[0].len());
    }
}
