//! Layout: axes, the visible parts of each series, legend rows, margins.

use super::axes::{x_axes, y_axis};
use super::axis::Axis;
use super::band::{Whisker, areas, whiskers};
use super::cells::Cells;
use super::error::ReportError;
use super::figure::{Figure, Panel, Scale};
use super::legend::{Entry, legend, wrap};
use super::metrics::{
    BAR_GAP, BAR_WIDTH, BOLD, DIGIT, EDGE, LABEL_ROW, LETTER, TEXT_SIZE, TICK_LABEL_DROP, TICK_ROOM, TITLE_ROW,
    TITLE_SIZE, X_LABEL_DROP, floored,
};
use super::trace::{Space, Trace, finish, trace};

type Point = (f64, f64);

/// A figure with all numbers settled, in px from the upper left corner.
pub(super) struct Plan<'f> {
    pub width: f64,
    pub height: f64,
    pub title: Vec<String>,
    pub title_left: f64,
    pub panels: Vec<PanelPlan<'f>>,
}

/// One panel: header (title and legend), frame, room for x labels.
pub(super) struct PanelPlan<'f> {
    pub panel: &'f Panel<'f>,
    pub space: Space,
    pub x: Axis,
    pub y: Axis,
    pub y_label: Vec<String>,
    /// Lines that the longest y label of the column takes.
    pub label_rows: usize,
    pub traces: Vec<Trace>,
    /// Polygons of each band.
    pub areas: Vec<Vec<Vec<Point>>>,
    /// Of each set of bars.
    pub whiskers: Vec<Vec<Whisker>>,
    pub cells: Option<Cells<'f>>,
    pub bar: Option<ColorBar<'f>>,
    pub legend: Vec<Entry<'f>>,
    /// Ends of the cell that the panel takes of the figure's width.
    pub cell: Point,
    /// Ends of the frame.
    pub frame: Point,
    pub top: f64,
    pub header: f64,
    pub height: f64,
    pub bottom: f64,
}

/// What the colours of a map mean, to the right of the frame.
pub(super) struct ColorBar<'f> {
    pub axis: Axis,
    pub label: &'f str,
}

/// Lays a checked figure out.
pub(super) fn plan<'f>(figure: &'f Figure<'f>) -> Result<Plan<'f>, ReportError> {
    let cell = figure.width / figure.columns as f64;
    let x_axes = x_axes(figure, x_ticks(cell))?;
    let mut panels = Vec::new();
    for (panel, x) in figure.panels.iter().zip(x_axes) {
        panels.push(plan_panel(panel, x, cell)?);
    }
    for column in 0..figure.columns.min(panels.len()) {
        place_column(&mut panels, (column, figure.columns), cell);
    }
    let title_left = panels.first().map_or(EDGE, |plan| plan.frame.0);
    let title = wrap(&figure.title, floored((figure.width - title_left - EDGE) / (BOLD * TITLE_SIZE)));
    let mut top = EDGE + title.len() as f64 * TITLE_ROW;
    for row in panels.chunks_mut(figure.columns) {
        top = place_row(row, top) + EDGE;
    }
    Ok(Plan { width: figure.width, height: top, title, title_left, panels })
}

fn plan_panel<'f>(panel: &'f Panel<'f>, x: Axis, width: f64) -> Result<PanelPlan<'f>, ReportError> {
    let space = Space::of(panel);
    let mut traces: Vec<Trace> = panel.series.iter().map(|series| trace(series, space, &x, width)).collect();
    let cells = panel.map.as_ref().map(|map| Cells::new(map, space));
    let mut y = y_axis(panel, (&x, &traces, cells.as_ref()), y_ticks(panel.height))?;
    let mut height = panel.height;
    if panel.equal_aspect {
        height = drawn_to_scale(&x, &y, width);
        y = y.with_ticks(y_ticks(height));
    }
    for (series, trace) in panel.series.iter().zip(&mut traces) {
        finish(trace, series, (&x, &y), (width, height));
    }
    let bottom = match (panel.share_x_with_next, panel.x_label.is_empty()) {
        (true, _) => 0.0,
        (false, true) => TICK_LABEL_DROP + EDGE,
        (false, false) => X_LABEL_DROP + EDGE,
    };
    Ok(PanelPlan {
        panel,
        space,
        areas: panel.bands.iter().map(|band| areas(band, space, (&x, &y), width)).collect(),
        whiskers: panel.bars.iter().map(|bars| whiskers(bars, space, (&x, &y))).collect(),
        x,
        y,
        y_label: wrap(&panel.y_label, floored(height / (LETTER * TEXT_SIZE))),
        label_rows: 0,
        traces,
        bar: color_bar(panel, cells.as_ref(), height),
        cells,
        legend: Vec::new(),
        cell: (0.0, width),
        frame: (0.0, width),
        top: 0.0,
        header: 0.0,
        height,
        bottom,
    })
}

fn color_bar<'f>(panel: &'f Panel<'f>, cells: Option<&Cells>, height: f64) -> Option<ColorBar<'f>> {
    let ramp = cells?.ramp?;
    let Some(Scale::Quantity(label)) = panel.map.as_ref().map(|map| &map.scale) else { return None };
    Some(ColorBar { axis: Axis::exact(ramp.low, ramp.high, y_ticks(height))?, label })
}

/// Frames below each other have the same ends.
fn place_column(panels: &mut [PanelPlan], (column, columns): (usize, usize), cell: f64) {
    let members = || panels.iter().skip(column).step_by(columns);
    let rows = members().map(|panel| panel.y_label.len()).max().unwrap_or(0);
    let ticks = members().map(|panel| tick_width(&panel.y)).fold(0.0, f64::max);
    let bar = members().filter_map(|panel| panel.bar.as_ref().map(bar_width)).fold(0.0, f64::max);
    // However long the labels are, half of the width is left for the data.
    let margin = (EDGE + rows as f64 * LABEL_ROW + ticks + TICK_ROOM).min(cell / 2.0);
    let right = (EDGE + TEXT_SIZE + bar).min(cell / 2.0 - EDGE);
    let start = column as f64 * cell;
    for plan in panels.iter_mut().skip(column).step_by(columns) {
        plan.label_rows = rows;
        plan.cell = (start, start + cell);
        plan.frame = (start + margin, start + cell - right);
        let width = plan.frame.1 - plan.frame.0;
        plan.x = with_room(&plan.x, width);
        if plan.panel.equal_aspect {
            plan.height = drawn_to_scale(&plan.x, &plan.y, width);
        }
        (plan.legend, plan.header) = legend(plan.panel, &plan.traces, plan.frame);
    }
}

/// Frames beside each other have the same top; returns where the row ends.
fn place_row(row: &mut [PanelPlan], top: f64) -> f64 {
    let header = row.iter().map(|plan| plan.header).fold(0.0, f64::max);
    for plan in row.iter_mut() {
        (plan.top, plan.header) = (top, header);
    }
    top + header + row.iter().map(|plan| plan.height + plan.bottom).fold(0.0, f64::max)
}

/// Height of a frame in which one unit of y is as long as one of x.
fn drawn_to_scale(x: &Axis, y: &Axis, width: f64) -> f64 {
    width * (y.high - y.low) / (x.high - x.low)
}

/// As many ticks as have room for their labels.
fn with_room(axis: &Axis, width: f64) -> Axis {
    let crowded = |axis: &Axis| (axis.ticks().len() as f64) * (tick_width(axis) + TEXT_SIZE) > width;
    let fewer = (2..x_ticks(width).max(3)).rev().map(|ticks| axis.with_ticks(ticks));
    std::iter::once(axis.clone()).chain(fewer).find(|axis| !crowded(axis)).unwrap_or_else(|| axis.with_ticks(2))
}

fn tick_width(axis: &Axis) -> f64 {
    axis.label_length() as f64 * DIGIT * TEXT_SIZE
}

fn bar_width(bar: &ColorBar) -> f64 {
    let label = if bar.label.is_empty() { 0.0 } else { LABEL_ROW };
    BAR_GAP + BAR_WIDTH + EDGE + tick_width(&bar.axis) + label
}

fn x_ticks(width: f64) -> usize {
    floored(width / 75.0).max(2)
}

fn y_ticks(height: f64) -> usize {
    floored(height / 26.0).max(2)
}

#[cfg(test)]
mod tests {
    use super::super::figure::{HeatMap, Series};
    use super::*;

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
        assert!(plan.panels[0].legend.iter().all(|e| e.x < plan.panels[0].frame.1));
    }

    #[test]
    fn panels_that_share_down_a_column_take_the_union_of_their_ranges() {
        let (early, late) = ([(0.0, 1.0), (1.0, 2.0)], [(3.0, 1.0), (4.0, 2.0)]);
        let panel = |points| Panel::new("", "", "").series(Series::points("", points));
        let figure = Figure::new("").panel(panel(&early).share_x_with_next()).panel(panel(&late)).panel(panel(&late));
        let ends = |plan: &Plan| plan.panels.iter().map(|p| (p.x.low, p.x.high)).collect::<Vec<_>>();
        let one = plan(&figure).unwrap();
        assert_eq!(ends(&one), [(0.0, 4.0), (0.0, 4.0), (3.0, 4.0)]);
        assert_eq!(one.panels[0].bottom, 0.0);
        let figure = Figure::new("").columns(2).panel(panel(&early).share_x_with_next()).panel(panel(&early));
        let figure = figure.panel(panel(&late)).panel(panel(&late));
        let two = plan(&figure).unwrap();
        assert_eq!(ends(&two), [(0.0, 4.0), (0.0, 1.0), (0.0, 4.0), (3.0, 4.0)]);
        let tops: Vec<f64> = two.panels.iter().map(|p| p.top).collect();
        assert!(tops[0] == tops[1] && tops[1] < tops[2] && tops[2] == tops[3]);
        assert!(two.panels[0].frame.1 < two.panels[1].frame.0);
    }

    #[test]
    fn a_drawing_to_scale_takes_its_height_from_the_ranges() {
        let panel = Panel::new("", "", "").x_range(0.0, 4.0).y_range(-1.0, 1.0).equal_aspect();
        let figure = Figure::new("").panel(panel);
        let plan = plan(&figure).unwrap();
        let plan = &plan.panels[0];
        assert!((plan.height - (plan.frame.1 - plan.frame.0) / 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_map_reaches_the_frame_and_leaves_room_for_its_bar() {
        let map = HeatMap { xs: &[1.0, 2.0], ys: &[1.0, 10.0], values: &[1.0; 4], scale: Scale::Quantity("P".into()) };
        let figure = Figure::new("").panel(Panel::new("", "", "").map(map).log_y());
        let plan = plan(&figure).unwrap();
        let panel = &plan.panels[0];
        assert_eq!((panel.x.low, panel.x.high, panel.y.low, panel.y.high), (0.5, 2.5, -0.5, 1.5));
        assert!(plan.width - panel.frame.1 > BAR_GAP + BAR_WIDTH);
    }
}
