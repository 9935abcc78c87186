//! Polylines cut to a window.

use super::reduce::is_finite;

type Point = (f64, f64);

/// A rectangle in data coordinates; sides may be infinite.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    pub x: (f64, f64),
    pub y: (f64, f64),
}

impl Window {
    pub(super) fn contains(&self, &(x, y): &Point) -> bool {
        self.x.0 <= x && x <= self.x.1 && self.y.0 <= y && y <= self.y.1
    }
}

/// The parts of a line that lie in the window; points that are not finite split it.
///
/// A point without neighbours comes back as a line of one point.
pub(super) fn clip(points: &[Point], window: Window) -> Vec<Vec<Point>> {
    let mut lines = Vec::new();
    for run in points.split(|p| !is_finite(p)) {
        match run {
            [] => {}
            [only] if window.contains(only) => lines.push(vec![*only]),
            run => clip_run(run, window, &mut lines),
        }
    }
    lines
}

fn clip_run(run: &[Point], window: Window, lines: &mut Vec<Vec<Point>>) {
    let mut line: Vec<Point> = Vec::new();
    for (&from, &to) in run.iter().zip(run.iter().skip(1)) {
        let Some((start, end)) = clip_segment(from, to, window) else {
            close(&mut line, lines);
            continue;
        };
        if line.last() != Some(&start) {
            close(&mut line, lines);
            line.push(start);
        }
        line.push(end);
        if end != to {
            close(&mut line, lines);
        }
    }
    close(&mut line, lines);
}

fn close(line: &mut Vec<Point>, lines: &mut Vec<Vec<Point>>) {
    if !line.is_empty() {
        lines.push(std::mem::take(line));
    }
}

/// The part of a segment in the window, by the algorithm of Liang and Barsky (ACM TOG 3 (1984) 1).
fn clip_segment(from: Point, to: Point, window: Window) -> Option<(Point, Point)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let sides =
        [(-dx, from.0 - window.x.0), (dx, window.x.1 - from.0), (-dy, from.1 - window.y.0), (dy, window.y.1 - from.1)];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (outward, room) in sides {
        if outward == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if outward < 0.0 {
            enter = enter.max(room / outward);
        } else {
            leave = leave.min(room / outward);
        }
    }
    if enter > leave {
        return None;
    }
    // Rounding must not carry a cut end out of the window again, however long the segment is.
    let within = |value: f64, side: (f64, f64)| value.clamp(side.0, side.1);
    let at = |t: f64| (within(from.0 + t * dx, window.x), within(from.1 + t * dy, window.y));
    let start = if window.contains(&from) { from } else { at(enter) };
    let end = if window.contains(&to) { to } else { at(leave) };
    Some((start, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Window = Window { x: (0.0, 1.0), y: (0.0, 1.0) };

    #[test]
    fn a_line_inside_is_untouched() {
        let line = [(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)];
        assert_eq!(clip(&line, UNIT), [line.to_vec()]);
    }

    #[test]
    fn a_peak_above_the_window_leaves_and_returns_at_the_edge() {
        let parts = clip(&[(0.0, 0.0), (0.5, 2.0), (1.0, 0.0)], UNIT);
        assert_eq!(parts, [vec![(0.0, 0.0), (0.25, 1.0)], vec![(0.75, 1.0), (1.0, 0.0)]]);
    }

    #[test]
    fn a_segment_across_the_window_keeps_its_middle() {
        assert_eq!(clip(&[(-1.0, 0.5), (2.0, 0.5)], UNIT), [vec![(0.0, 0.5), (1.0, 0.5)]]);
    }

    #[test]
    fn not_a_number_splits_and_lone_points_stay() {
        let parts = clip(&[(0.1, 0.1), (0.2, f64::NAN), (0.3, 0.3), (0.4, 0.4)], UNIT);
        assert_eq!(parts, [vec![(0.1, 0.1)], vec![(0.3, 0.3), (0.4, 0.4)]]);
    }

    #[test]
    fn outside_is_nothing_and_infinite_sides_do_not_cut() {
        assert!(clip(&[(2.0, 0.0), (3.0, 1.0)], UNIT).is_empty());
        let open = Window { y: (f64::NEG_INFINITY, f64::INFINITY), ..UNIT };
        assert_eq!(clip(&[(0.0, -9.0), (1.0, 9.0)], open), [vec![(0.0, -9.0), (1.0, 9.0)]]);
    }
}
