//! Words around the frames, on the canvas of the plotting library.

use plotters::drawing::DrawingAreaErrorKind;
use plotters::element::{Circle, Cross, DashedPathElement, PathElement, Rectangle};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, FontStyle, FontTransform, RGBColor};

use super::canvas::{Canvas, INK, failed, ink, stroke, text, units, write};
use super::error::ReportError;
use super::layout::PanelPlan;
use super::legend::Entry;
use super::marks::{CROSS, DASH, MARKER, OPACITY, PIN};
use super::metrics::{BAR_GAP, BAR_WIDTH, EDGE, LABEL_ROW, LEGEND_GAP, LEGEND_KEY, ROW, TEXT_SIZE, X_LABEL_DROP};
use super::trace::Shape;

type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Title and legend.
pub(super) fn draw_header(canvas: &Canvas, panel: &PanelPlan) -> Result<(), ReportError> {
    let style = text(TEXT_SIZE, FontStyle::Bold, HPos::Left);
    write(canvas, &panel.panel.title, &style, (panel.frame.0, panel.top + ROW / 2.0))?;
    for entry in &panel.legend {
        draw_key(canvas, entry, panel.top + entry.y)?;
        let style = text(TEXT_SIZE, FontStyle::Normal, HPos::Left);
        write(canvas, entry.label, &style, (entry.x + LEGEND_KEY + LEGEND_GAP, panel.top + entry.y))?;
    }
    Ok(())
}

fn draw_key(canvas: &Canvas, entry: &Entry, middle: f64) -> Result<(), ReportError> {
    let y = units(middle);
    let (start, end) = (units(entry.x), units(entry.x + LEGEND_KEY));
    let (center, color) = ((i32::midpoint(start, end), y), ink(entry.key));
    let line = [(start, y), (end, y)];
    let area = [(start, y - units(4.0)), (end, y + units(4.0))];
    let cell = [(end - units(9.0), y - units(4.5)), (end, y + units(4.5))];
    let width = if entry.key.color.is_some() { 1.5 } else { 0.9 };
    match entry.key.shape {
        Shape::Line => canvas.draw(&PathElement::new(line, stroke(color, 2.0))),
        Shape::Dashes => canvas.draw(&DashedPathElement::new(line, units(DASH.0), units(DASH.1), stroke(color, width))),
        Shape::Marker => canvas.draw(&Circle::new(center, units(MARKER + 0.6), color.filled())),
        Shape::Dot => canvas.draw(&Circle::new(center, units(1.3), color.filled())),
        Shape::Cross => canvas.draw(&Cross::new(center, units(CROSS + 0.4), stroke(color, 1.2))),
        Shape::Pin => draw_pin(canvas, center, color),
        Shape::Hatch => draw_hatch(canvas, area),
        Shape::Area => canvas.draw(&Rectangle::new(area, color.mix(OPACITY).filled())),
        Shape::Cell => canvas.draw(&Rectangle::new(cell, color.filled())),
    }
    .map_err(failed)
}

fn draw_pin(canvas: &Canvas, center: (i32, i32), color: RGBColor) -> Drawn {
    canvas.draw(&Circle::new(center, units(PIN), color.filled()))?;
    canvas.draw(&Circle::new(center, units(PIN), stroke(INK, 0.6)))
}

/// A box with slanting lines.
fn draw_hatch(canvas: &Canvas, corners: [(i32, i32); 2]) -> Drawn {
    let [(left, top), (right, bottom)] = corners;
    let tall = bottom - top;
    for x in (left..=right - tall).step_by(units(5.0).unsigned_abs() as usize) {
        canvas.draw(&PathElement::new([(x, bottom), (x + tall, top)], stroke(INK, 0.8)))?;
    }
    canvas.draw(&Rectangle::new(corners, stroke(INK, 0.9)))
}

pub(super) fn draw_axis_labels(canvas: &Canvas, panel: &PanelPlan) -> Result<(), ReportError> {
    let across = text(TEXT_SIZE, FontStyle::Normal, HPos::Center);
    let top = panel.top + panel.header;
    if panel.bottom > 0.0 {
        let middle = f64::midpoint(panel.frame.0, panel.frame.1);
        write(canvas, &panel.panel.x_label, &across, (middle, top + panel.height + X_LABEL_DROP))?;
    }
    let upward = across.transform(FontTransform::Rotate270);
    let first = panel.label_rows - panel.y_label.len();
    for (row, line) in panel.y_label.iter().enumerate() {
        let x = panel.cell.0 + TEXT_SIZE + (first + row) as f64 * LABEL_ROW;
        write(canvas, line, &upward, (x, top + panel.height / 2.0))?;
    }
    Ok(())
}

/// Outline, ticks and label of the colour bar.
pub(super) fn draw_bar_labels(canvas: &Canvas, panel: &PanelPlan) -> Result<(), ReportError> {
    let Some(bar) = &panel.bar else { return Ok(()) };
    let (top, left) = (panel.top + panel.header, panel.frame.1 + BAR_GAP);
    let (bottom, right) = (top + panel.height, left + BAR_WIDTH);
    let outline = [(units(left), units(top)), (units(right), units(bottom))];
    canvas.draw(&Rectangle::new(outline, stroke(INK, 0.8))).map_err(failed)?;
    let range = bar.axis.scaled_range();
    let style = text(TEXT_SIZE, FontStyle::Normal, HPos::Left);
    for &tick in bar.axis.ticks() {
        let y = bottom - panel.height * (tick - range.start) / (range.end - range.start);
        let mark = [(units(right), units(y)), (units(right + 3.0), units(y))];
        canvas.draw(&PathElement::new(mark, stroke(INK, 0.8))).map_err(failed)?;
        write(canvas, &bar.axis.label(tick), &style, (right + EDGE, y))?;
    }
    let upward = text(TEXT_SIZE, FontStyle::Normal, HPos::Center).transform(FontTransform::Rotate270);
    write(canvas, bar.label, &upward, (panel.cell.1 - TEXT_SIZE, f64::midpoint(top, bottom)))
}
