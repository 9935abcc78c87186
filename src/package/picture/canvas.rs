//! A canvas for technical sketches: lines, shapes, arrows and labels in stroked letters, in pixels from the top left.

use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};

use super::letters;

/// A point, px.
pub(super) type Point = (f32, f32);

/// Line width of outlines, px.
pub(super) const THICK: f32 = 3.0;
/// Line width of dimensions and hatching, px.
pub(super) const THIN: f32 = 1.5;

/// A colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Ink(pub u8, pub u8, pub u8);

/// Outlines and letters.
pub(super) const BLACK: Ink = Ink(29, 33, 37);
/// Dimensions.
pub(super) const GREY: Ink = Ink(120, 130, 140);
/// Bodies.
pub(super) const STEEL: Ink = Ink(214, 221, 228);
/// Frames of the membranes.
pub(super) const DARK_STEEL: Ink = Ink(168, 178, 188);
/// The ball.
pub(super) const ORANGE: Ink = Ink(230, 159, 0);
/// Membranes.
pub(super) const BLUE: Ink = Ink(0, 114, 178);
/// Forces.
pub(super) const RED: Ink = Ink(213, 94, 0);

/// The picture while it is drawn.
pub(super) struct Canvas {
    pixels: Pixmap,
}

impl Canvas {
    /// A white canvas; none if a side has no length.
    pub(super) fn new(width: u32, height: u32) -> Option<Self> {
        let mut pixels = Pixmap::new(width, height)?;
        pixels.fill(Color::WHITE);
        Some(Self { pixels })
    }

    /// The picture as a PNG file.
    pub(super) fn png(&self) -> Option<Vec<u8>> {
        self.pixels.encode_png().ok()
    }

    fn stroke(&mut self, path: Option<Path>, width: f32, ink: Ink) {
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        if let Some(path) = path {
            self.pixels.stroke_path(&path, &paint(ink), &stroke, Transform::identity(), None);
        }
    }

    fn fill(&mut self, path: Option<Path>, ink: Ink) {
        if let Some(path) = path {
            self.pixels.fill_path(&path, &paint(ink), FillRule::Winding, Transform::identity(), None);
        }
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: &[Point], width: f32, ink: Ink) {
        self.stroke(through(points, false), width, ink);
    }

    /// A filled shape with these corners, without outline.
    pub(super) fn polygon(&mut self, points: &[Point], ink: Ink) {
        self.fill(through(points, true), ink);
    }

    /// A filled and outlined rectangle between two corners, the first at the top left.
    pub(super) fn rectangle(&mut self, from: Point, to: Point, filling: Ink) {
        let path = Rect::from_ltrb(from.0, from.1, to.0, to.1).map(PathBuilder::from_rect);
        self.fill(path.clone(), filling);
        self.stroke(path, THICK, BLACK);
    }

    /// A filled and outlined circle.
    pub(super) fn circle(&mut self, centre: Point, radius: f32, filling: Ink) {
        let path = PathBuilder::from_circle(centre.0, centre.1, radius);
        self.fill(path.clone(), filling);
        self.stroke(path, THICK, BLACK);
    }

    /// A straight line with a head at `to`.
    pub(super) fn arrow(&mut self, from: Point, to: Point, width: f32, ink: Ink) {
        let length = (to.0 - from.0).hypot(to.1 - from.1).max(1.0);
        let along = ((to.0 - from.0) / length, (to.1 - from.1) / length);
        let (head, half) = (4.0 * width + 4.0, 1.5 * width + 2.0);
        let neck = (to.0 - head * along.0, to.1 - head * along.1);
        self.line(&[from, neck], width, ink);
        let side = |sign: f32| (neck.0 - sign * half * along.1, neck.1 + sign * half * along.0);
        self.polygon(&[to, side(1.0), side(-1.0)], ink);
    }

    /// A label, centred at `centre`, with letters of this height. What follows an underscore is set low.
    pub(super) fn label(&mut self, centre: Point, height: f32, text: &str, ink: Ink) {
        let (lines, width) = letters::set(text, height);
        let origin = (centre.0 - width / 2.0, centre.1 + height / 2.0);
        for line in lines {
            let points: Vec<_> = line.iter().map(|point| (origin.0 + point.0, origin.1 - point.1)).collect();
            self.line(&points, height / 7.5, ink);
        }
    }
}

fn through(points: &[Point], closed: bool) -> Option<Path> {
    let (first, rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(first.0, first.1);
    for point in rest {
        path.line_to(point.0, point.1);
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn paint(ink: Ink) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(ink.0, ink.1, ink.2, 255);
    paint
}
