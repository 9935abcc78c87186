//! A laid-out figure on the canvas of the plotting library.

use std::fmt::Display;

use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::types::RangedCoordf64;
use plotters::element::{Circle, DashedPathElement, PathElement};
use plotters::prelude::{DrawingArea, IntoDrawingArea, RGBColor, SVGBackend, WHITE};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoFont, ShapeStyle, TextStyle};

use super::error::ReportError;
use super::layout::{
    Entry, LABEL_ROW, LEGEND_GAP, LEGEND_KEY, PanelPlan, Plan, ROW, TEXT_SIZE, TITLE_ROW, TITLE_SIZE, X_LABEL_DROP,
};
use super::trace::Key;

/// The library draws on whole pixels: ten of them are one px of the figure.
pub(super) const UNITS: f64 = 10.0;
/// The SVG backend divides font sizes by this.
const FONT_FACTOR: f64 = 1.24;

/// Colours that readers with any colour vision tell apart (Okabe and Ito 2008), darkest first:
/// yellow comes last, since it is faint on white.
const PALETTE: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(240, 228, 66),
];
const INK: RGBColor = RGBColor(34, 34, 34);
const GRID: RGBColor = RGBColor(228, 228, 228);
const REFERENCE: RGBColor = RGBColor(90, 90, 90);

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws the figure; the document's own head is replaced later.
pub(super) fn draw(plan: &Plan) -> Result<String, ReportError> {
    let mut svg = String::new();
    let size = (units(plan.width).unsigned_abs(), units(plan.height).unsigned_abs());
    let canvas = SVGBackend::with_string(&mut svg, size).into_drawing_area();
    canvas.fill(&WHITE).map_err(failed)?;
    let style = text(TITLE_SIZE, FontStyle::Bold, HPos::Left);
    for (row, line) in plan.title.iter().enumerate() {
        put(&canvas, line, &style, (plan.left, TITLE_SIZE + row as f64 * TITLE_ROW))?;
    }
    for panel in &plan.panels {
        draw_panel(&canvas, plan, panel)?;
    }
    canvas.present().map_err(failed)?;
    drop(canvas);
    Ok(svg)
}

fn draw_panel(canvas: &Canvas, plan: &Plan, panel: &PanelPlan) -> Result<(), ReportError> {
    draw_header(canvas, plan, panel)?;
    draw_axis_labels(canvas, plan, panel)?;
    let top = panel.top + panel.header;
    let area = canvas.clone().shrink((0, units(top)), (units(plan.width), units(panel.panel.height + panel.bottom)));
    let mut chart = ChartBuilder::on(&area)
        .margin_right(units(plan.right))
        .set_label_area_size(LabelAreaPosition::Left, units(plan.left))
        .set_label_area_size(LabelAreaPosition::Bottom, units(panel.bottom))
        .build_cartesian_2d(panel.x.scaled_range(), panel.y.scaled_range())
        .map_err(failed)?;
    draw_mesh(&mut chart, panel)?;
    draw_traces(&mut chart, panel)?;
    draw_lines(&mut chart, panel)?;
    draw_frame(&mut chart)
}

fn draw_mesh(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    let ticks = text(TEXT_SIZE, FontStyle::Normal, HPos::Center);
    let mut mesh = chart.configure_mesh();
    mesh.x_labels(panel.x_ticks)
        .y_labels(panel.y_ticks)
        .max_light_lines(0)
        .bold_line_style(stroke(GRID, 0.7))
        .axis_style(stroke(INK, 0.8))
        .label_style(ticks)
        .set_all_tick_mark_size(units(3.5));
    let (x_label, y_label) = (|x: &f64| panel.x.label(*x), |y: &f64| panel.y.label(*y));
    mesh.x_label_formatter(&x_label).y_label_formatter(&y_label);
    mesh.draw().map_err(failed)
}

fn draw_lines(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    let inside = panel.y.low..=panel.y.high;
    for line in panel.panel.lines.iter().filter(|line| inside.contains(&line.value)) {
        let (ends, y) = (panel.x.scaled_range(), panel.y.scaled(line.value));
        let path = [(ends.start, y), (ends.end, y)];
        let dashes = DashedPathElement::new(path, units(5.0), units(3.0), stroke(REFERENCE, 0.9));
        chart.draw_series([dashes]).map_err(failed)?;
    }
    Ok(())
}

fn draw_traces(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    let scaled = |&(x, y): &(f64, f64)| (panel.x.scaled(x), panel.y.scaled(y));
    for trace in &panel.traces {
        let style = stroke(color(trace.key), 1.2);
        for part in &trace.parts {
            let points: Vec<_> = part.iter().map(scaled).collect();
            if matches!(trace.key, Key::Dot(_)) {
                let dots = points.into_iter().map(|at| Circle::new(at, units(1.8), style.filled()));
                chart.draw_series(dots).map_err(failed)?;
            } else if let [only] = points[..] {
                // A value between two gaps is a dot, not an invisible line.
                chart.draw_series([Circle::new(only, units(1.0), style.filled())]).map_err(failed)?;
            } else {
                chart.draw_series([PathElement::new(points, style)]).map_err(failed)?;
            }
        }
    }
    Ok(())
}

fn draw_frame(chart: &mut Chart) -> Result<(), ReportError> {
    let (x, y) = (chart.x_range(), chart.y_range());
    let corners = [(x.start, y.start), (x.end, y.start), (x.end, y.end), (x.start, y.end), (x.start, y.start)];
    chart.draw_series([PathElement::new(corners, stroke(INK, 0.8))]).map_err(failed)?;
    Ok(())
}

fn draw_header(canvas: &Canvas, plan: &Plan, panel: &PanelPlan) -> Result<(), ReportError> {
    if !panel.panel.title.is_empty() {
        let style = text(TEXT_SIZE, FontStyle::Bold, HPos::Left);
        put(canvas, &panel.panel.title, &style, (plan.left, panel.top + ROW / 2.0))?;
    }
    for entry in &panel.legend {
        draw_key(canvas, entry)?;
        let style = text(TEXT_SIZE, FontStyle::Normal, HPos::Left);
        put(canvas, entry.label, &style, (entry.x + LEGEND_KEY + LEGEND_GAP, entry.y))?;
    }
    Ok(())
}

fn draw_key(canvas: &Canvas, entry: &Entry) -> Result<(), ReportError> {
    let y = units(entry.y);
    let (start, end) = (units(entry.x), units(entry.x + LEGEND_KEY));
    let ink = color(entry.key);
    match entry.key {
        Key::Line(_) => canvas.draw(&PathElement::new([(start, y), (end, y)], stroke(ink, 2.0))),
        Key::Dot(_) => canvas.draw(&Circle::new((i32::midpoint(start, end), y), units(2.4), ink.filled())),
        Key::Dashes => {
            canvas.draw(&DashedPathElement::new([(start, y), (end, y)], units(5.0), units(3.0), stroke(ink, 0.9)))
        }
    }
    .map_err(failed)
}

fn draw_axis_labels(canvas: &Canvas, plan: &Plan, panel: &PanelPlan) -> Result<(), ReportError> {
    let across = text(TEXT_SIZE, FontStyle::Normal, HPos::Center);
    let top = panel.top + panel.header;
    if panel.bottom > 0.0 {
        let middle = f64::midpoint(plan.left, plan.width - plan.right);
        let below = top + panel.panel.height + X_LABEL_DROP;
        put(canvas, &panel.panel.x_label, &across, (middle, below))?;
    }
    let upward = across.transform(FontTransform::Rotate270);
    let middle = top + panel.panel.height / 2.0;
    let first = plan.label_rows - panel.y_label.len();
    for (row, line) in panel.y_label.iter().enumerate() {
        let x = TEXT_SIZE + (first + row) as f64 * LABEL_ROW;
        put(canvas, line, &upward, (x, middle))?;
    }
    Ok(())
}

fn put(canvas: &Canvas, label: &str, style: &TextStyle, at: (f64, f64)) -> Result<(), ReportError> {
    if label.is_empty() {
        return Ok(());
    }
    canvas.draw_text(label, style, (units(at.0), units(at.1))).map_err(failed)
}

fn text(size: f64, weight: FontStyle, side: HPos) -> TextStyle<'static> {
    let font = ("sans-serif", size * UNITS * FONT_FACTOR).into_font().style(weight);
    TextStyle::from(font).color(&INK).pos(Pos::new(side, VPos::Center))
}

fn stroke(color: RGBColor, width: f64) -> ShapeStyle {
    color.stroke_width(units(width).unsigned_abs())
}

fn color(key: Key) -> RGBColor {
    match key {
        Key::Line(index) | Key::Dot(index) => PALETTE.get(index % PALETTE.len()).copied().unwrap_or(INK),
        Key::Dashes => REFERENCE,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "sizes are checked to be some thousand px")]
fn units(px: f64) -> i32 {
    (px * UNITS).round() as i32
}

fn failed(error: impl Display) -> ReportError {
    ReportError::Draw(error.to_string())
}
