//! Fewer points for the same picture.
//!
//! Of all points that fall into one pixel column, a line needs the first, the lowest, the highest
//! and the last, and no others: the drawing covers the same pixels (the M4 aggregation of Jugel et
//! al., Proc. VLDB Endowment 7 (2014) 797). Points are grouped only while they follow each other,
//! so that a curve which runs back and forth in x stays what it is.

use std::collections::HashSet;

type Point = (f64, f64);

/// Reduces a line to what `columns` pixel columns can show, peaks included.
///
/// Keeps at most four points for each passage through a column, in their order, and one point that
/// is not finite for each gap.
pub(super) fn reduce(points: &[Point], columns: usize) -> Vec<Point> {
    let (low, high) = extent(points.iter().filter(|p| is_finite(p)).map(|p| p.0));
    reduce_within(points.iter().copied(), (low, high), columns)
}

/// [`reduce`] for the columns of a given x range; what lies left or right of it counts as one
/// column each, so that the line still enters and leaves the range where it did.
pub(super) fn reduce_within(points: impl Iterator<Item = Point>, range: (f64, f64), columns: usize) -> Vec<Point> {
    let mut reduced = Vec::new();
    let mut run: Option<Run> = None;
    let mut in_gap = false;
    for (index, point) in points.enumerate() {
        if !is_finite(&point) {
            flush(&mut run, &mut reduced);
            if !in_gap {
                reduced.push(point);
            }
            in_gap = true;
            continue;
        }
        in_gap = false;
        let column = cell(point.0, range, columns);
        match &mut run {
            Some(run) if run.column == column => run.add(index, point),
            _ => {
                flush(&mut run, &mut reduced);
                run = Some(Run::new(column, index, point));
            }
        }
    }
    flush(&mut run, &mut reduced);
    reduced
}

/// Markers that would hide behind an earlier one are left out: one for each cell of the grid.
pub(super) fn reduce_markers(
    points: impl Iterator<Item = Point>,
    (x_range, y_range): ((f64, f64), (f64, f64)),
    (columns, rows): (usize, usize),
) -> Vec<Point> {
    let mut taken = HashSet::new();
    points
        .filter(is_finite)
        .filter(|&(x, y)| taken.insert((cell(x, x_range, columns), cell(y, y_range, rows))))
        .collect()
}

/// Lowest and highest value; `(inf, -inf)` if there is none.
pub(super) fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

pub(super) fn is_finite(point: &Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Index of the cell that holds `value`: 0 and `cells + 1` are the outside.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value is clamped to 0..=cells + 1 first, and a float cast saturates"
)]
fn cell(value: f64, (low, high): (f64, f64), cells: usize) -> usize {
    let cells = cells.max(1);
    let position = (value - low) / (high - low) * cells as f64;
    if value == high {
        // The right edge belongs to the last cell.
        cells
    } else {
        (position.floor() + 1.0).clamp(0.0, cells as f64 + 1.0) as usize
    }
}

/// Consecutive points of one column.
struct Run {
    column: usize,
    first: (usize, Point),
    lowest: (usize, Point),
    highest: (usize, Point),
    last: (usize, Point),
}

impl Run {
    fn new(column: usize, index: usize, point: Point) -> Self {
        let only = (index, point);
        Self { column, first: only, lowest: only, highest: only, last: only }
    }

    fn add(&mut self, index: usize, point: Point) {
        let new = (index, point);
        if point.1 < self.lowest.1.1 {
            self.lowest = new;
        }
        if point.1 > self.highest.1.1 {
            self.highest = new;
        }
        self.last = new;
    }
}

fn flush(run: &mut Option<Run>, reduced: &mut Vec<Point>) {
    let Some(run) = run.take() else { return };
    let mut kept = [run.first, run.lowest, run.highest, run.last];
    kept.sort_by_key(|&(index, _)| index);
    let mut previous = None;
    for (index, point) in kept {
        if previous != Some(index) {
            reduced.push(point);
        }
        previous = Some(index);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn noise(n: u32) -> Vec<Point> {
        (0..n).map(f64::from).map(|k| (k, (k * 12.9898).sin() * 43758.5453 % 1.0)).collect()
    }

    #[test]
    fn every_column_keeps_its_extremes() {
        let points = noise(10_000);
        let reduced = reduce(&points, 100);
        for column in 0..100 {
            let inside = |p: &&Point| cell(p.0, (0.0, 9999.0), 100) == column + 1;
            let before = extent(points.iter().filter(inside).map(|p| p.1));
            let after = extent(reduced.iter().filter(inside).map(|p| p.1));
            assert_eq!(before, after, "column {column}");
        }
    }

    #[test]
    fn gaps_stay_and_are_one_point_each() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, f64::NAN), (3.0, 1.0)];
        let reduced = reduce(&points, 1);
        assert_eq!(reduced.len(), 3);
        assert!(reduced[1].1.is_nan());
    }

    #[test]
    fn a_closed_orbit_is_not_collapsed() {
        let orbit: Vec<Point> = (0..=1000).map(|k| f64::from(k) * 0.01).map(|t| (t.cos(), t.sin())).collect();
        let reduced = reduce(&orbit, 50);
        assert!(reduced.len() > 150, "both branches and both turns: {}", reduced.len());
    }

    #[test]
    fn few_or_equal_points_pass_through() {
        assert_eq!(reduce(&[], 10), []);
        assert_eq!(reduce(&[(1.0, 2.0)], 0), [(1.0, 2.0)]);
        assert_eq!(reduce(&[(1.0, 2.0), (1.0, 3.0)], 5), [(1.0, 2.0), (1.0, 3.0)]);
    }

    #[test]
    fn hidden_markers_are_dropped() {
        let cloud: Vec<Point> = noise(5000).into_iter().map(|(_, y)| (y, y)).collect();
        let kept = reduce_markers(cloud.into_iter(), ((-1.0, 1.0), (-1.0, 1.0)), (10, 10));
        assert!(kept.len() <= 10);
    }

    proptest! {
        #[test]
        fn reduction_is_a_subsequence_with_the_same_ends_and_extremes(
            ys in prop::collection::vec(-1e6..1e6_f64, 1..400), columns in 0_usize..60,
        ) {
            let points: Vec<Point> = ys.iter().enumerate().map(|(k, &y)| (k as f64, y)).collect();
            let reduced = reduce(&points, columns);
            prop_assert_eq!(reduced.first(), points.first());
            prop_assert_eq!(reduced.last(), points.last());
            prop_assert!(reduced.windows(2).all(|w| w[0].0 < w[1].0));
            prop_assert!(reduced.iter().all(|p| points.contains(p)));
            prop_assert_eq!(
                extent(reduced.iter().map(|p| p.1)), extent(points.iter().map(|p| p.1))
            );
            prop_assert!(reduced.len() <= 4 * columns.max(1));
        }
    }
}
