//! The canvas of the plotting library: units, pens, letters.

use std::fmt::Display;

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::prelude::{DrawingArea, RGBColor, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, ShapeStyle, TextStyle};

use super::axis::Axis;
use super::colors::{REFERENCE, palette};
use super::error::ReportError;
use super::trace::Key;

/// The library draws on whole pixels: ten of them are one px of the figure.
pub(super) const UNITS: f64 = 10.0;
/// The SVG backend divides font sizes by this.
const FONT_FACTOR: f64 = 1.24;

pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
pub(super) const GRID: RGBColor = RGBColor(228, 228, 228);
pub(super) const FINE_GRID: RGBColor = RGBColor(241, 241, 241);

pub(super) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

pub(super) fn text(size: f64, weight: FontStyle, side: HPos) -> TextStyle<'static> {
    let font = ("sans-serif", size * UNITS * FONT_FACTOR).into_font().style(weight);
    TextStyle::from(font).color(&INK).pos(Pos::new(side, VPos::Center))
}

/// Writes a label; nothing if it is empty.
pub(super) fn write(canvas: &Canvas, label: &str, style: &TextStyle, at: (f64, f64)) -> Result<(), ReportError> {
    if label.is_empty() {
        return Ok(());
    }
    canvas.draw_text(label, style, (units(at.0), units(at.1))).map_err(failed)
}

pub(super) fn stroke(color: RGBColor, width: f64) -> ShapeStyle {
    color.stroke_width(units(width).unsigned_abs())
}

pub(super) fn ink(key: Key) -> RGBColor {
    let (red, green, blue) = key.color.map_or(REFERENCE, palette);
    RGBColor(red, green, blue)
}

#[expect(clippy::cast_possible_truncation, reason = "sizes are checked to be some thousand px")]
pub(super) fn units(px: f64) -> i32 {
    (px * UNITS).round() as i32
}

pub(super) fn failed(error: impl Display) -> ReportError {
    ReportError::Draw(error.to_string())
}
