//! A laid-out figure on the canvas of the plotting library.
//!
//! What the library would write down mark by mark - the cells of a map, the dots of a cloud - lies as compact paths
//! between its layers.

use plotters::chart::{ChartBuilder, LabelAreaPosition};
use plotters::element::PathElement;
use plotters::prelude::{IntoDrawingArea, SVGBackend, WHITE};
use plotters::style::FontStyle;
use plotters::style::text_anchor::HPos;

use super::canvas::{Canvas, Chart, FINE_GRID, GRID, INK, failed, stroke, text, units, write};
use super::cells::ramp_markup;
use super::error::ReportError;
use super::isolines;
use super::labels::{draw_axis_labels, draw_bar_labels, draw_header};
use super::layout::{PanelPlan, Plan};
use super::marks::{clouds, draw_areas, draw_lines, draw_traces, draw_whiskers};
use super::metrics::{BAR_GAP, BAR_WIDTH, TEXT_SIZE, TITLE_ROW, TITLE_SIZE};

/// Draws the figure: all that goes into its SVG element.
pub(super) fn draw(plan: &Plan) -> Result<String, ReportError> {
    let (mut maps, mut dots) = (String::new(), String::new());
    let ground = layer(plan, |canvas| {
        canvas.fill(&WHITE).map_err(failed)?;
        plan.panels.iter().try_for_each(|panel| {
            maps += &draw_ground(canvas, panel)?;
            Ok(())
        })
    })?;
    let areas = layer(plan, |canvas| {
        plan.panels.iter().try_for_each(|panel| {
            let mut chart = chart(canvas, panel)?;
            draw_areas(&mut chart, panel)?;
            dots += &clouds(&chart, panel);
            Ok(())
        })
    })?;
    let marks = layer(plan, |canvas| {
        draw_title(canvas, plan)?;
        plan.panels.iter().try_for_each(|panel| draw_panel(canvas, panel))
    })?;
    Ok([ground, maps, areas, dots, marks].concat())
}

/// What `paint` puts on an empty canvas, without the SVG element around it.
fn layer(plan: &Plan, paint: impl FnOnce(&Canvas<'_>) -> Result<(), ReportError>) -> Result<String, ReportError> {
    let mut svg = String::new();
    let size = (units(plan.width).unsigned_abs(), units(plan.height).unsigned_abs());
    let canvas = SVGBackend::with_string(&mut svg, size).into_drawing_area();
    paint(&canvas)?;
    canvas.present().map_err(failed)?;
    drop(canvas);
    let inside = svg.split_once('>').and_then(|(_, inside)| inside.rsplit_once("</svg>"));
    Ok(inside.map_or_else(String::new, |(inside, _)| inside.trim_start().to_owned()))
}

fn draw_title(canvas: &Canvas, plan: &Plan) -> Result<(), ReportError> {
    let style = text(TITLE_SIZE, FontStyle::Bold, HPos::Left);
    for (row, line) in plan.title.iter().enumerate() {
        write(canvas, line, &style, (plan.title_left, TITLE_SIZE + row as f64 * TITLE_ROW))?;
    }
    Ok(())
}

/// Grid and tick labels; returns the cells of the map, which cover the grid, and its colour bar.
fn draw_ground(canvas: &Canvas, panel: &PanelPlan) -> Result<String, ReportError> {
    let mut chart = chart(canvas, panel)?;
    draw_mesh(&mut chart, panel)?;
    let place = |x, y| chart.backend_coord(&(panel.x.scaled(x), panel.y.scaled(y)));
    let Some(cells) = &panel.cells else { return Ok(String::new()) };
    let markup = cells.markup((&panel.x, &panel.y), place) + &isolines::markup(panel);
    let Some(ramp) = cells.ramp.filter(|_| panel.bar.is_some()) else { return Ok(markup) };
    let top = panel.top + panel.header;
    let (left, right) = (panel.frame.1 + BAR_GAP, panel.frame.1 + BAR_GAP + BAR_WIDTH);
    Ok(markup + &ramp_markup(&ramp, (units(left), units(top)), (units(right), units(top + panel.height))))
}

fn draw_panel(canvas: &Canvas, panel: &PanelPlan) -> Result<(), ReportError> {
    draw_header(canvas, panel)?;
    draw_axis_labels(canvas, panel)?;
    draw_bar_labels(canvas, panel)?;
    let mut chart = chart(canvas, panel)?;
    draw_traces(&mut chart, panel)?;
    draw_whiskers(&mut chart, panel)?;
    draw_lines(&mut chart, panel)?;
    draw_frame(&mut chart)
}

/// The axes of a panel at their place.
fn chart<'a, 'b>(canvas: &Canvas<'b>, panel: &PanelPlan) -> Result<Chart<'a, 'b>, ReportError> {
    let (cell, frame) = (panel.cell, panel.frame);
    let corner = (units(cell.0), units(panel.top + panel.header));
    let area = canvas.clone().shrink(corner, (units(cell.1 - cell.0), units(panel.height + panel.bottom)));
    ChartBuilder::on(&area)
        .margin_right(units(cell.1 - frame.1))
        .set_label_area_size(LabelAreaPosition::Left, units(frame.0 - cell.0))
        .set_label_area_size(LabelAreaPosition::Bottom, units(panel.bottom))
        .build_cartesian_2d(panel.x.clone(), panel.y.clone())
        .map_err(failed)
}

fn draw_mesh(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    let ticks = text(TEXT_SIZE, FontStyle::Normal, HPos::Center);
    let mut mesh = chart.configure_mesh();
    mesh.max_light_lines(1)
        .light_line_style(stroke(FINE_GRID, 0.7))
        .bold_line_style(stroke(GRID, 0.7))
        .axis_style(stroke(INK, 0.8))
        .label_style(ticks)
        .set_all_tick_mark_size(units(3.5));
    let (x_label, y_label) = (|x: &f64| panel.x.label(*x), |y: &f64| panel.y.label(*y));
    mesh.x_label_formatter(&x_label).y_label_formatter(&y_label);
    mesh.draw().map_err(failed)
}

fn draw_frame(chart: &mut Chart) -> Result<(), ReportError> {
    let (x, y) = (chart.x_range(), chart.y_range());
    let corners = [(x.start, y.start), (x.end, y.start), (x.end, y.end), (x.start, y.end), (x.start, y.start)];
    chart.draw_series([PathElement::new(corners, stroke(INK, 0.8))]).map_err(failed)?;
    Ok(())
}
