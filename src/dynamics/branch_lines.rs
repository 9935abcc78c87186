//! Branches of orbits as lines: stable ones solid, unstable ones dashed, with marks at their bifurcations.

use videg_report::{Panel, Series, Style};

use super::orbits::{Bifurcation, Branch, Orbit};

/// A jump, as a part of all that is shown, at which a line is interrupted: the order of impact and section changes there.
const JUMP: f64 = 0.1;
/// Colours of lines, the first ones of the palette; the others are those of the marks.
const COLORS: usize = 4;
const GAP: (f64, f64) = (f64::NAN, f64::NAN);

/// What is drawn over the parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Height {
    /// `z_M` - `z_m`, mm, at the start of each period.
    Displacement,
    /// Largest modulus of a multiplier.
    Multiplier,
}

impl Height {
    fn of(self, orbit: &Orbit) -> Vec<f64> {
        match self {
            Self::Displacement => orbit.flashes.iter().map(|flash| 1e3 * flash[0]).collect(),
            Self::Multiplier => vec![orbit.multipliers.largest()],
        }
    }
}

/// Lines and marks.
pub(super) struct BranchLines {
    /// The lines, then the marks.
    parts: Vec<Part>,
}

struct Part {
    label: String,
    /// Points, with gaps between lines.
    points: Vec<(f64, f64)>,
    style: Style,
    color: usize,
}

const MARKS: [(Bifurcation, Style, usize); 5] = [
    (Bifurcation::PeriodDoubling, Style::Markers, 6),
    (Bifurcation::Fold, Style::Crosses, 6),
    (Bifurcation::Grazing, Style::Crosses, 4),
    (Bifurcation::BranchPoint, Style::Markers, 4),
    (Bifurcation::NeimarkSacker, Style::Markers, 7),
];

impl BranchLines {
    pub(super) fn new(branches: &[Branch], height: Height) -> Self {
        let mut periods: Vec<u32> =
            branches.iter().flat_map(|branch| &branch.orbits).map(|orbit| orbit.period).collect();
        periods.sort_unstable();
        periods.dedup();
        let reach = reach(branches, height);
        let mut parts = Vec::new();
        for (index, period) in periods.into_iter().enumerate() {
            for (kind, style) in [("stable", Style::Line), ("unstable", Style::Dashed)] {
                let own = branches.iter().filter(|branch| branch.orbits.first().is_some_and(|it| it.period == period));
                let points = own.flat_map(|branch| stretches(branch, height, kind == "stable", reach)).collect();
                let unit = if period == 1 { "period" } else { "periods" };
                parts.push(Part { label: format!("{kind}, {period} {unit}"), points, style, color: index % COLORS });
            }
        }
        for (kind, style, color) in MARKS {
            let marks = branches.iter().flat_map(|branch| &branch.marks).filter(|mark| mark.kind == kind);
            let dots = marks.flat_map(|mark| {
                let value = mark.orbit.point.value;
                height.of(&mark.orbit).into_iter().map(move |y| (value, y))
            });
            parts.push(Part { label: kind.words().to_owned(), points: dots.collect(), style, color });
        }
        parts.retain(|part| !part.points.is_empty());
        Self { parts }
    }

    /// Adds them to a panel.
    pub(super) fn draw<'a>(&'a self, panel: Panel<'a>) -> Panel<'a> {
        self.parts.iter().fold(panel, |panel, Part { label, points, style, color }| {
            panel.series(Series::points(label.clone(), points).style(*style).color(*color))
        })
    }
}

fn reach(branches: &[Branch], height: Height) -> f64 {
    let all = branches.iter().flat_map(|branch| &branch.orbits).flat_map(|orbit| height.of(orbit));
    let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| [low.min(y), high.max(y)]);
    high - low
}

/// The stable or the unstable stretches of a branch, a line for each flash of a round.
fn stretches(branch: &Branch, height: Height, is_stable: bool, reach: f64) -> Vec<(f64, f64)> {
    let rows = aligned(branch, height);
    let count = rows.first().map_or(0, Vec::len);
    let mut points = Vec::new();
    for k in 0..count {
        for (pair, ys) in branch.orbits.windows(2).zip(rows.windows(2)) {
            let [a, b] = [(pair[0].point.value, ys[0][k]), (pair[1].point.value, ys[1][k])];
            let is_joined = height == Height::Multiplier || (a.1 - b.1).abs() <= JUMP * reach;
            // A stretch is what its beginning is.
            if pair[0].is_stable() == is_stable && is_joined {
                if points.last() != Some(&a) {
                    points.extend([GAP, a]);
                }
                points.push(b);
            }
        }
        points.push(GAP);
    }
    if points.iter().all(|point| point.0.is_nan()) { Vec::new() } else { points }
}

/// The heights of each orbit, turned so that they go on from those of the orbit before.
fn aligned(branch: &Branch, height: Height) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for orbit in &branch.orbits {
        let mut row = height.of(orbit);
        if let Some(before) = rows.last() {
            let apart = |turn: &usize| -> f64 {
                before.iter().enumerate().map(|(k, y)| (y - row[(k + turn) % row.len()]).powi(2)).sum()
            };
            let best = (0..row.len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(0);
            row.rotate_left(best);
        }
        rows.push(row);
    }
    rows
}
