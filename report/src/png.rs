//! A figure as a PNG picture, the same on every machine.
//!
//! The SVG reader and the rasteriser share their paths, but not the renderer that comes with the reader: that one
//! turns SIMD on, and fonts of the machine would change the text. The letters are Noto Sans (SIL Open Font License).

use std::sync::{Arc, LazyLock};

use tiny_skia::{Color, FillRule, Paint, Pixmap, Transform};
use usvg::fontdb::Database;
use usvg::{Group, Node, Options, Path, Tree};

use super::error::ReportError;

/// Pixels of a picture at most: 64 million.
const LARGEST: f64 = 64e6;
const SCALES: (f64, f64) = (0.1, 8.0);

static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    fonts.load_font_data(notosans::BOLD_TTF.to_vec());
    fonts.set_sans_serif_family("Noto Sans");
    Arc::new(fonts)
});

/// Turns the output of [`render_svg`](super::render_svg) into a PNG file of `scale` pixels for each px.
///
/// # Errors
/// A document that is no SVG, that shows more than plain shapes and text, or a scale that makes it too large.
pub fn render_png(svg: &str, scale: f64) -> Result<Vec<u8>, ReportError> {
    if !(SCALES.0..=SCALES.1).contains(&scale) {
        let (what, (min, max)) = ("pixels for each px".to_owned(), SCALES);
        return Err(ReportError::Size { what, value: scale.to_string(), min, max });
    }
    let options = Options { fontdb: Arc::clone(&FONTS), font_family: "Noto Sans".to_owned(), ..Options::default() };
    // Noto Sans has no superscript minus; a macron looks the same.
    let svg = svg.replace('\u{207b}', "\u{af}");
    let tree = Tree::from_str(&svg, &options).map_err(|error| failed(&error.to_string()))?;
    let (width, height) = (f64::from(tree.size().width()) * scale, f64::from(tree.size().height()) * scale);
    if width * height > LARGEST {
        let (what, value) = ("number of pixels".to_owned(), (width * height).to_string());
        return Err(ReportError::Size { what, value, min: 1.0, max: LARGEST });
    }
    let mut pixels = Pixmap::new(rounded(width), rounded(height)).ok_or_else(|| failed("it has no size"))?;
    pixels.fill(Color::WHITE);
    #[expect(clippy::cast_possible_truncation, reason = "a small number")]
    let scale = Transform::from_scale(scale as f32, scale as f32);
    draw_group(tree.root(), 1.0, scale, &mut pixels)?;
    pixels.encode_png().map_err(|error| failed(&error.to_string()))
}

fn draw_group(group: &Group, opacity: f32, scale: Transform, pixels: &mut Pixmap) -> Result<(), ReportError> {
    if group.clip_path().is_some() || group.mask().is_some() || !group.filters().is_empty() {
        return Err(failed("it cuts or filters what it shows"));
    }
    let opacity = opacity * group.opacity().get();
    for node in group.children() {
        match node {
            Node::Group(group) => draw_group(group, opacity, scale, pixels)?,
            Node::Path(path) => draw_path(path, opacity, scale, pixels)?,
            Node::Text(text) => draw_group(text.flattened(), opacity, scale, pixels)?,
            Node::Image(_) => return Err(failed("it holds a picture")),
        }
    }
    Ok(())
}

fn draw_path(path: &Path, opacity: f32, scale: Transform, pixels: &mut Pixmap) -> Result<(), ReportError> {
    let transform = scale.pre_concat(path.abs_transform());
    let smooth = path.rendering_mode().use_shape_antialiasing();
    if let Some(fill) = path.fill() {
        let paint = paint(fill.paint(), fill.opacity().get() * opacity, smooth)?;
        let rule = match fill.rule() {
            usvg::FillRule::NonZero => FillRule::Winding,
            usvg::FillRule::EvenOdd => FillRule::EvenOdd,
        };
        pixels.fill_path(path.data(), &paint, rule, transform, None);
    }
    if let Some(stroke) = path.stroke() {
        let paint = paint(stroke.paint(), stroke.opacity().get() * opacity, smooth)?;
        pixels.stroke_path(path.data(), &paint, &stroke.to_tiny_skia(), transform, None);
    }
    Ok(())
}

fn paint(paint: &usvg::Paint, opacity: f32, smooth: bool) -> Result<Paint<'static>, ReportError> {
    let usvg::Paint::Color(color) = paint else { return Err(failed("it shades its colours")) };
    let mut paint = Paint { anti_alias: smooth, ..Paint::default() };
    paint.set_color(Color::from_rgba8(color.red, color.green, color.blue, 255));
    paint.shader.apply_opacity(opacity);
    Ok(paint)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be at most 64 million")]
fn rounded(size: f64) -> u32 {
    size.round() as u32
}

fn failed(reason: &str) -> ReportError {
    ReportError::Png(reason.to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::figure::{Figure, HeatMap, Panel, Scale, Series};
    use super::super::svg::render_svg;
    use super::*;

    fn pixels(svg: &str, scale: f64) -> Pixmap {
        Pixmap::decode_png(&render_png(svg, scale).unwrap()).unwrap()
    }

    fn count(pixels: &Pixmap, color: (u8, u8, u8)) -> usize {
        pixels.pixels().iter().filter(|p| (p.red(), p.green(), p.blue()) == color).count()
    }

    #[test]
    fn a_figure_becomes_pixels_with_text_lines_and_cells() {
        let map = HeatMap { xs: &[0.0, 1.0], ys: &[0.0], values: &[-1.0, 1.0], scale: Scale::Quantity(String::new()) };
        let bare = render_svg(&Figure::new("").panel(Panel::new("", "", "").map(map.clone()))).unwrap();
        let line = [(0.0, -0.4), (1.0, 0.4)];
        let panel = Panel::new("", "time (s)", "").series(Series::points("wave", &line)).map(map);
        let svg = render_svg(&Figure::new("").panel(panel)).unwrap();
        let (bare, full) = (pixels(&bare, 1.0), pixels(&svg, 1.0));
        assert_eq!(full.width(), 720);
        assert!(count(&full, (8, 48, 107)) > 10_000, "blue cells");
        assert!(count(&full, (0, 114, 178)) > 100, "the line");
        let dark = |p: &Pixmap| p.pixels().iter().filter(|p| p.red() < 100 && p.red() == p.blue()).count();
        assert!(dark(&full) > dark(&bare) + 50, "the words");
        assert_eq!(pixels(&svg, 2.0).width(), 1440);
    }

    #[test]
    fn every_letter_of_the_labels_has_a_shape() {
        let face = |letter: char| {
            let svg = format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40\" height=\"40\" font-family=\"sans-serif\">\
                 <text x=\"4\" y=\"30\" font-size=\"30\">{letter}</text></svg>"
            );
            render_png(&svg, 1.0).unwrap()
        };
        let missing = face('\u{e000}');
        for letter in
            "Az09\u{2212}\u{d7}\u{b9}\u{b2}\u{b3}\u{2070}\u{2074}\u{2079}\u{207b}<>()".replace('<', "").chars()
        {
            assert_ne!(face(letter), missing, "{letter}");
        }
    }

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        let svg = render_svg(&Figure::new("F").panel(Panel::new("(a)", "x", "y").line("l", 1.0))).unwrap();
        assert_eq!(render_png(&svg, 1.5).unwrap(), render_png(&svg, 1.5).unwrap());
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        assert!(render_png("<p>", 1.0).is_err());
        let svg = |inside: &str| {
            format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9000\" height=\"9000\">{inside}</svg>")
        };
        assert!(render_png(&svg(""), 1.0).unwrap_err().to_string().contains("number of pixels is 81000000"));
        assert!(render_png(&svg(""), f64::NAN).unwrap_err().to_string().contains("pixels for each px is NaN"));
        let clipped =
            "<clipPath id=\"c\"><path d=\"M0 0h9v9z\"/></clipPath><g clip-path=\"url(#c)\"><path d=\"M0 0h9v9z\"/></g>";
        assert!(render_png(&svg(clipped), 0.1).is_err());
    }
}
