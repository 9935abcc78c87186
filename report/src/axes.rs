//! Ranges of the axes of a figure.

use super::axis::Axis;
use super::band::heights;
use super::cells::{Cells, covered};
use super::error::ReportError;
use super::figure::{Figure, Panel};
use super::reduce::{extent, is_finite};
use super::trace::{Space, Trace};

type Point = (f64, f64);

/// One x axis for each panel; panels that share take the same.
pub(super) fn x_axes(figure: &Figure, ticks: usize) -> Result<Vec<Axis>, ReportError> {
    let mut axes: Vec<Axis> = Vec::new();
    for (index, panel) in figure.panels.iter().enumerate() {
        let above = index.checked_sub(figure.columns).filter(|&above| figure.panels[above].share_x_with_next);
        let shared = above.and_then(|above| axes.get(above).cloned());
        axes.push(match shared {
            Some(axis) if figure.panels[index - figure.columns].log_x == panel.log_x => axis,
            _ => x_axis(&group(figure, index), ticks)?.named(&panel.x_names),
        });
    }
    Ok(axes)
}

/// The panel and those below it that share its x axis.
pub(super) fn group<'p, 'f>(figure: &'p Figure<'f>, index: usize) -> Vec<&'p Panel<'f>> {
    let mut group: Vec<&Panel> = Vec::new();
    for panel in figure.panels.iter().skip(index).step_by(figure.columns) {
        if group.last().is_some_and(|above| !above.share_x_with_next || above.log_x != panel.log_x) {
            break;
        }
        group.push(panel);
    }
    group
}

fn x_axis(group: &[&Panel], ticks: usize) -> Result<Axis, ReportError> {
    let first = group.first();
    let (title, log) = (first.map_or("", |panel| &panel.title), first.is_some_and(|panel| panel.log_x));
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for range in group.iter().filter_map(|panel| panel.x_range) {
        // Each range must be one by itself: a union would hide a reversed one.
        exact(range, log, ticks).ok_or_else(|| bad_range(title, "x", range))?;
        (low, high) = (low.min(range.0), high.max(range.1));
    }
    if low < high {
        return exact((low, high), log, ticks).ok_or_else(|| bad_range(title, "x", (low, high)));
    }
    let range = extent(group.iter().flat_map(|panel| all_x(panel)));
    let has_marks = group.iter().flat_map(|panel| &panel.series).any(|series| series.style.is_marks());
    let has_bars = group.iter().any(|panel| !panel.bars.is_empty());
    let has_map = group.iter().any(|panel| panel.map.is_some());
    let to_scale = group.iter().any(|panel| panel.equal_aspect);
    let margin = if has_marks || has_bars || to_scale { 0.02 } else { 0.0 };
    let axis = match (has_map, log) {
        // A map ends where its outer cells end, not at a round number near by.
        (true, _) => fit(range, log, ticks),
        (false, true) => Axis::around_log(range.0, range.1, margin, ticks),
        (false, false) => Axis::around(range.0, range.1, margin, ticks),
    };
    axis.ok_or_else(|| bad_range(title, "x", range))
}

/// All x values of a panel, in axis units.
fn all_x(panel: &Panel) -> Vec<f64> {
    let space = Space::of(panel);
    let points = panel.series.iter().flat_map(|series| space.points(&series.data).filter(is_finite)).map(|p| p.0);
    let bands = panel.bands.iter().flat_map(|band| band.limits).chain(panel.bars.iter().flat_map(|bars| bars.limits));
    let limits = bands.map(|limit| space.x(limit.0));
    let cells = panel.map.iter().flat_map(|map| covered(map.xs.iter().map(|&x| space.x(x))));
    points.chain(limits).chain(cells).filter(|x| x.is_finite()).collect()
}

/// The y axis around what shows of a panel.
pub(super) fn y_axis(
    panel: &Panel,
    (x, traces, cells): (&Axis, &[Trace], Option<&Cells>),
    ticks: usize,
) -> Result<Axis, ReportError> {
    let bad = |range| bad_range(&panel.title, "y", range);
    if let Some(range) = panel.y_range {
        return exact(range, panel.log_y, ticks).ok_or_else(|| bad(range));
    }
    let space = Space::of(panel);
    let shown = traces.iter().flat_map(|t| t.parts.iter().flatten()).map(|p| p.1);
    let lines = panel.lines.iter().map(|line| space.y(line.value));
    let bands = panel.bands.iter().flat_map(|band| heights(band.limits, space, x));
    let bars = panel.bars.iter().flat_map(|bars| heights(bars.limits, space, x));
    let rows = cells.into_iter().flat_map(Cells::y_range);
    let all = shown.chain(lines).chain(bands).chain(bars).chain(rows);
    let range = extent(all.filter(|y| y.is_finite()));
    let axis = match (cells.is_some(), panel.log_y) {
        (true, log) => fit(range, log, ticks),
        (false, true) => Axis::around_log(range.0, range.1, 0.06, ticks),
        (false, false) => Axis::around(range.0, range.1, 0.06, ticks),
    };
    axis.ok_or_else(|| bad(range))
}

/// An axis with these ends, given in axis units.
fn fit((low, high): Point, log: bool, ticks: usize) -> Option<Axis> {
    if log { Axis::exact_log(low, high, ticks) } else { Axis::exact(low, high, ticks) }
}

/// An axis with these ends, given in data units.
fn exact((low, high): Point, log: bool, ticks: usize) -> Option<Axis> {
    if !log {
        return Axis::exact(low, high, ticks);
    }
    if low > 0.0 { Axis::exact_log(low.log10(), high.log10(), ticks) } else { None }
}

fn bad_range(panel: &str, axis: &'static str, (low, high): Point) -> ReportError {
    let reason = format!("{axis} range {low} to {high} is not a finite, ascending interval");
    ReportError::Panel { panel: panel.to_owned(), reason }
}
