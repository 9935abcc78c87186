//! Where everything goes: axes, the parts of each series that show, legend rows, margins.

use super::axis::Axis;
use super::error::ReportError;
use super::figure::{Figure, Panel, ReferenceLine, Style};
use super::reduce::extent;
use super::trace::{Key, Trace, finish, finite, trace};

type Point = (f64, f64);

/// Font sizes and distances in px.
pub(super) const TITLE_SIZE: f64 = 13.0;
pub(super) const TEXT_SIZE: f64 = 11.0;
pub(super) const ROW: f64 = 16.0;
pub(super) const TITLE_ROW: f64 = 18.0;
pub(super) const LABEL_ROW: f64 = 13.0;
pub(super) const LEGEND_KEY: f64 = 18.0;
pub(super) const LEGEND_GAP: f64 = 5.0;
const EDGE: f64 = 6.0;
const TICK_ROOM: f64 = 10.0;
/// Width of a digit and mean width of a letter, in font sizes; the reader's font is not known.
const DIGIT: f64 = 0.6;
const LETTER: f64 = 0.53;
const BOLD: f64 = 0.58;
/// Distances below a frame, to the middle of the tick labels and of the x label.
const TICK_LABEL_DROP: f64 = 13.0;
pub(super) const X_LABEL_DROP: f64 = 28.0;

/// A figure with all numbers settled, in px from the upper left corner.
pub(super) struct Plan<'f> {
    pub width: f64,
    pub height: f64,
    pub left: f64,
    pub right: f64,
    pub title: Vec<String>,
    /// Lines that the longest y label takes.
    pub label_rows: usize,
    pub panels: Vec<PanelPlan<'f>>,
}

/// One panel: header (title and legend), frame, room for x labels.
pub(super) struct PanelPlan<'f> {
    pub panel: &'f Panel<'f>,
    pub x: Axis,
    pub y: Axis,
    pub x_ticks: usize,
    pub y_ticks: usize,
    pub y_label: Vec<String>,
    pub traces: Vec<Trace>,
    pub legend: Vec<Entry<'f>>,
    pub top: f64,
    pub header: f64,
    pub bottom: f64,
}

/// A legend entry at its place.
pub(super) struct Entry<'f> {
    pub label: &'f str,
    pub key: Key,
    pub x: f64,
    pub y: f64,
}

/// Lays a checked figure out.
pub(super) fn plan<'f>(figure: &'f Figure<'f>) -> Result<Plan<'f>, ReportError> {
    let x_axes = x_axes(figure)?;
    let mut panels = Vec::new();
    for (panel, x) in figure.panels.iter().zip(x_axes) {
        panels.push(plan_panel(panel, x, figure.width)?);
    }
    let label_rows = panels.iter().map(|panel| panel.y_label.len()).max().unwrap_or(0);
    let ticks = panels.iter().map(tick_width).fold(0.0, f64::max);
    let left = EDGE + label_rows as f64 * LABEL_ROW + ticks + TICK_ROOM;
    // However long the labels are, half of the width is left for the data.
    let left = left.min(figure.width / 2.0);
    let right = EDGE + TEXT_SIZE;
    let title = wrap(&figure.title, whole((figure.width - left - right) / (BOLD * TITLE_SIZE)));
    let mut top = EDGE + title.len() as f64 * TITLE_ROW;
    for plan in &mut panels {
        plan.top = top;
        place_legend(plan, left, figure.width - right);
        top += plan.header + plan.panel.height + plan.bottom + EDGE;
    }
    let (width, height) = (figure.width, top);
    Ok(Plan { width, height, left, right, title, label_rows, panels })
}

fn plan_panel<'f>(panel: &'f Panel<'f>, x: Axis, width: f64) -> Result<PanelPlan<'f>, ReportError> {
    let y_ticks = whole(panel.height / 26.0).max(2);
    let mut traces = Vec::new();
    for series in &panel.series {
        traces.push(trace(series, &x, width));
    }
    let y = y_axis(panel, &traces, y_ticks)?;
    for (series, trace) in panel.series.iter().zip(&mut traces) {
        finish(trace, series, (&x, &y), (width, panel.height));
    }
    let y_label = wrap(&panel.y_label, whole(panel.height / (LETTER * TEXT_SIZE)));
    let bottom = match (panel.share_x_with_next, panel.x_label.is_empty()) {
        (true, _) => 0.0,
        (false, true) => TICK_LABEL_DROP + EDGE,
        (false, false) => X_LABEL_DROP + EDGE,
    };
    let (x_ticks, legend) = (x_ticks(width), Vec::new());
    let (top, header) = (0.0, 0.0);
    Ok(PanelPlan { panel, x, y, x_ticks, y_ticks, y_label, traces, legend, top, header, bottom })
}

/// One axis for each panel; panels that share take the same.
fn x_axes(figure: &Figure) -> Result<Vec<Axis>, ReportError> {
    let mut axes = Vec::new();
    for group in figure.panels.split_inclusive(|panel| !panel.share_x_with_next) {
        let axis = x_axis(group, x_ticks(figure.width))?;
        axes.extend(std::iter::repeat_n(axis, group.len()));
    }
    Ok(axes)
}

fn x_axis(group: &[Panel], ticks: usize) -> Result<Axis, ReportError> {
    let mut given = group.iter().filter_map(|panel| panel.x_range).peekable();
    let title = group.first().map_or("", |panel| &panel.title);
    if given.peek().is_some() {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for range in given {
            // Each range must be one by itself: a union would hide a reversed one.
            Axis::exact(range.0, range.1, ticks).ok_or_else(|| bad_range(title, "x", range))?;
            (low, high) = (low.min(range.0), high.max(range.1));
        }
        return Axis::exact(low, high, ticks).ok_or_else(|| bad_range(title, "x", (low, high)));
    }
    let points = group.iter().flat_map(|panel| &panel.series).flat_map(|s| finite(&s.data));
    let range = extent(points.map(|p| p.0));
    let has_dots = group.iter().flat_map(|p| &p.series).any(|s| s.style == Style::Markers);
    let margin = if has_dots { 0.02 } else { 0.0 };
    Axis::around(range.0, range.1, margin, ticks).ok_or_else(|| bad_range(title, "x", range))
}

fn y_axis(panel: &Panel, traces: &[Trace], ticks: usize) -> Result<Axis, ReportError> {
    if let Some(range) = panel.y_range {
        return Axis::exact(range.0, range.1, ticks).ok_or_else(|| bad_range(&panel.title, "y", range));
    }
    let shown = traces.iter().flat_map(|t| t.parts.iter().flatten()).map(|p| p.1);
    let range = extent(shown.chain(panel.lines.iter().map(|line| line.value)));
    Axis::around(range.0, range.1, 0.06, ticks).ok_or_else(|| bad_range(&panel.title, "y", range))
}

/// Legend entries flow from the title to the right, and on to further rows.
fn place_legend<'f>(plan: &mut PanelPlan<'f>, left: f64, right: f64) {
    let panel = plan.panel;
    let series = panel.series.iter().zip(&plan.traces).map(|(s, t)| (s.label.as_str(), t.key));
    let lines = panel.lines.iter().map(|l: &ReferenceLine| (l.label.as_str(), Key::Dashes));
    let entries: Vec<(&'f str, Key)> = series.chain(lines).filter(|e| !e.0.is_empty()).collect();
    if entries.is_empty() && panel.title.is_empty() {
        plan.header = TEXT_SIZE;
        return;
    }
    let indent = if panel.title.is_empty() { 0.0 } else { text_width(&panel.title) * BOLD / LETTER + ROW };
    let (mut x, mut y) = (left + indent, plan.top + ROW / 2.0);
    for (label, key) in entries {
        let width = LEGEND_KEY + LEGEND_GAP + text_width(label);
        if x + width > right && x > left + indent {
            (x, y) = (left + indent, y + ROW);
        }
        plan.legend.push(Entry { label, key, x, y });
        x += width + ROW;
    }
    plan.header = y - plan.top + ROW / 2.0 + 3.0;
}

fn tick_width(plan: &PanelPlan) -> f64 {
    plan.y.label_length(plan.y_ticks) as f64 * DIGIT * TEXT_SIZE
}

/// Words of a label in as few lines of at most `length` characters as possible.
fn wrap(label: &str, length: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in label.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= length => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn text_width(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER * TEXT_SIZE
}

fn x_ticks(width: f64) -> usize {
    whole(width / 75.0).max(2)
}

fn bad_range(panel: &str, axis: &'static str, (low, high): Point) -> ReportError {
    ReportError::InvalidRange { panel: panel.to_owned(), axis, low, high }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sizes are checked to be positive and at most some thousand px"
)]
pub(super) fn whole(value: f64) -> usize {
    value as usize
}

#[cfg(test)]
mod tests {
    use super::super::figure::Series;
    use super::*;

    #[test]
    fn panels_that_share_take_the_union_of_their_ranges() {
        let (early, late) = ([(0.0, 1.0), (1.0, 2.0)], [(3.0, 1.0), (4.0, 2.0)]);
        let figure = Figure::new("")
            .panel(Panel::new("", "", "").series(Series::points("", &early)).share_x_with_next())
            .panel(Panel::new("", "t", "").series(Series::points("", &late)))
            .panel(Panel::new("", "t", "").series(Series::points("", &late)));
        let plan = plan(&figure).unwrap();
        let ends: Vec<_> = plan.panels.iter().map(|p| (p.x.low, p.x.high)).collect();
        assert_eq!(ends, [(0.0, 4.0), (0.0, 4.0), (3.0, 4.0)]);
        assert_eq!(plan.panels[0].bottom, 0.0);
    }

    #[test]
    fn the_y_range_is_that_of_the_window() {
        let line = [(0.0, 0.0), (1.0, 1.0), (2.0, 50.0)];
        let panel = Panel::new("", "", "").series(Series::points("", &line)).x_range(0.0, 1.0);
        let figure = Figure::new("").panel(panel);
        let plan = plan(&figure).unwrap();
        assert!((1.0..1.1).contains(&plan.panels[0].y.high));
    }

    #[test]
    fn a_long_legend_takes_more_rows_and_stays_within_the_frame() {
        let mut panel = Panel::new("(a)", "", "");
        for _ in 0..12 {
            panel = panel.series(Series::points("a rather long label", &[]));
        }
        let figure = Figure::new("").panel(panel);
        let plan = plan(&figure).unwrap();
        let rows: Vec<f64> = plan.panels[0].legend.iter().map(|e| e.y).collect();
        assert!(rows.last() > rows.first());
        assert!(plan.panels[0].legend.iter().all(|e| e.x < plan.width - plan.right));
    }

    #[test]
    fn long_labels_wrap() {
        assert_eq!(wrap("relative displacement (mm)", 16), ["relative", "displacement", "(mm)"]);
        assert_eq!(wrap("relative displacement (mm)", 21), ["relative displacement", "(mm)"]);
    }
}
