//! Lines of equal value over the cells of a map, by marching squares.

use std::collections::BTreeMap;

type Point = (f64, f64);

/// An edge between two neighbours: whether it goes up, and its lower left end.
type Edge = (bool, usize, usize);

/// Values at the middles of cells, row by row from the lowest y. In between they are bilinear.
pub(super) struct Grid<'g> {
    pub xs: &'g [f64],
    pub ys: &'g [f64],
    pub values: &'g [f64],
}

impl Grid<'_> {
    /// Lines along which the value is `level`, from edge to edge or closed. None pass a cell without a value.
    pub(super) fn lines(&self, level: f64) -> Vec<Vec<Point>> {
        let mut next: BTreeMap<Edge, Vec<Edge>> = BTreeMap::new();
        for j in 1..self.ys.len() {
            for i in 1..self.xs.len() {
                for (from, to) in self.segments(i - 1, j - 1, level) {
                    next.entry(from).or_default().push(to);
                    next.entry(to).or_default().push(from);
                }
            }
        }
        let mut lines = Vec::new();
        // Lines with ends first, so that the rest is closed.
        let ends: Vec<Edge> = next.iter().filter(|(_, others)| others.len() == 1).map(|(edge, _)| *edge).collect();
        let all: Vec<Edge> = next.keys().copied().collect();
        for start in ends.into_iter().chain(all) {
            let line = walk(&mut next, start);
            if line.len() > 1 {
                lines.push(line.into_iter().map(|edge| self.crossing(edge, level)).collect());
            }
        }
        lines
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.values.get(j * self.xs.len() + i).copied().unwrap_or(f64::NAN)
    }

    /// Pieces of the lines within the square whose lower left corner is a middle, as pairs of the edges that they join.
    fn segments(&self, i: usize, j: usize, level: f64) -> Vec<(Edge, Edge)> {
        let corners = [self.at(i, j), self.at(i + 1, j), self.at(i + 1, j + 1), self.at(i, j + 1)];
        if corners.iter().any(|value| !value.is_finite()) {
            return Vec::new();
        }
        let edges = [(false, i, j), (true, i + 1, j), (false, i, j + 1), (true, i, j)];
        let above = corners.map(|value| value >= level);
        let crossed: Vec<Edge> = (0..4).filter(|k| above[*k] != above[(k + 1) % 4]).map(|k| edges[k]).collect();
        match crossed[..] {
            [from, to] => vec![(from, to)],
            [bottom, right, top, left] => {
                // At a saddle, the middle belongs to two of the corners.
                let middle = corners.iter().map(|value| value / 4.0).sum::<f64>() >= level;
                if middle == above[0] { vec![(bottom, right), (top, left)] } else { vec![(bottom, left), (right, top)] }
            }
            _ => Vec::new(),
        }
    }

    /// Where the value on an edge is `level`.
    fn crossing(&self, (is_up, i, j): Edge, level: f64) -> Point {
        let (right, top) = if is_up { (i, j + 1) } else { (i + 1, j) };
        let (from, to) = (self.at(i, j), self.at(right, top));
        let share = ((level - from) / (to - from)).clamp(0.0, 1.0);
        let along = |values: &[f64], a: usize, b: usize| values[a] + share * (values[b] - values[a]);
        (along(self.xs, i, right), along(self.ys, j, top))
    }

    /// The value at a point; beyond the outer middles and beside gaps, that of the nearest cell.
    pub(super) fn value(&self, (x, y): Point) -> f64 {
        let ((i, u), (j, v)) = (place(self.xs, x), place(self.ys, y));
        let row = |j: usize| {
            let (left, right) = (self.at(i, j), self.at((i + 1).min(self.xs.len() - 1), j));
            left + u * (right - left)
        };
        let (below, above) = (row(j), row((j + 1).min(self.ys.len() - 1)));
        let value = below + v * (above - below);
        if value.is_finite() { value } else { self.at(i + usize::from(u > 0.5), j + usize::from(v > 0.5)) }
    }
}

/// Index of the last of `middles` that is not above `at`, and the share of the way to the next one.
fn place(middles: &[f64], at: f64) -> (usize, f64) {
    let index = middles.partition_point(|middle| *middle <= at).saturating_sub(1);
    let (Some(&from), Some(&to)) = (middles.get(index), middles.get(index + 1)) else { return (index, 0.0) };
    (index, ((at - from) / (to - from)).clamp(0.0, 1.0))
}

/// Takes the line that begins at `start` out of `next`.
fn walk(next: &mut BTreeMap<Edge, Vec<Edge>>, start: Edge) -> Vec<Edge> {
    let mut line = vec![start];
    let mut here = start;
    while let Some(to) = next.get_mut(&here).and_then(Vec::pop) {
        if let Some(back) = next.get_mut(&to)
            && let Some(index) = back.iter().position(|edge| *edge == here)
        {
            back.swap_remove(index);
        }
        line.push(to);
        here = to;
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(count: u32, from: f64, to: f64) -> Vec<f64> {
        (0..count).map(|k| from + (to - from) * f64::from(k) / f64::from(count - 1)).collect()
    }

    #[test]
    fn a_line_of_a_cone_is_one_closed_circle() {
        let (xs, ys) = (even(61, -1.5, 1.5), even(41, -1.2, 1.3));
        let values: Vec<f64> = ys.iter().flat_map(|y| xs.iter().map(move |x: &f64| x.hypot(*y))).collect();
        let grid = Grid { xs: &xs, ys: &ys, values: &values };
        let lines = grid.lines(1.0);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        let off = lines[0].iter().map(|(x, y)| (x.hypot(*y) - 1.0).abs()).fold(0.0, f64::max);
        let round: f64 = lines[0].windows(2).map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1)).sum();
        assert!(off < 2e-3 && (round / std::f64::consts::TAU - 1.0).abs() < 2e-3, "{off} {round}");
        assert!((grid.value((0.31, -0.47)) - 0.31_f64.hypot(0.47)).abs() < 2e-3);
        assert!(grid.lines(9.0).is_empty());
    }

    #[test]
    fn lines_of_random_values_pass_each_crossed_edge_once_and_separate_high_from_low() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let (xs, ys) = (even(23, 0.0, 22.0), even(17, 0.0, 16.0));
        let values: Vec<f64> = (0..23 * 17).map(|_| random()).collect();
        let grid = Grid { xs: &xs, ys: &ys, values: &values };
        let lines = grid.lines(0.5);
        let is_crossed = |a: f64, b: f64| usize::from((a >= 0.5) != (b >= 0.5));
        let across: usize = values.chunks(23).flat_map(|row| row.windows(2)).map(|p| is_crossed(p[0], p[1])).sum();
        let up: usize = (0..16)
            .flat_map(|j| (0..23).map(move |i| (i, j)))
            .map(|(i, j)| is_crossed(grid.at(i, j), grid.at(i, j + 1)))
            .sum();
        let points: usize = lines.iter().map(|line| line.len() - usize::from(line.first() == line.last())).sum();
        assert_eq!(points, across + up);
        for point in lines.iter().flatten() {
            assert!((grid.value(*point) - 0.5).abs() < 1e-12, "{point:?}");
        }
    }

    #[test]
    fn no_line_passes_a_gap() {
        let axis = even(3, 0.0, 2.0);
        let values = [0.0, 0.0, 0.0, 1.0, f64::NAN, 1.0, 1.0, 1.0, 1.0];
        let grid = Grid { xs: &axis, ys: &axis, values: &values };
        assert!(grid.lines(0.5).is_empty());
        assert_eq!(grid.value((0.2, 0.9)), 1.0);
    }
}
