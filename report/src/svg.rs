//! A figure as an SVG document: checks, drawing, document head.

use askama::Template;

use super::canvas::UNITS;
use super::check::{check, check_height};
use super::draw::draw;
use super::error::ReportError;
use super::figure::{Figure, Scale};
use super::layout::{Plan, plan};

/// Text that XML cannot carry, even escaped, becomes a space.
fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || c == '\u{fffe}' || c == '\u{ffff}' { ' ' } else { c }).collect()
}

/// The opening tag and the accessible name.
#[derive(Template)]
#[template(
    ext = "svg",
    escape = "html",
    source = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {{ view.0 }} {{ view.1 }}" width="{{ size.0 }}" height="{{ size.1 }}" role="img" font-family="sans-serif" stroke-linejoin="round">
<title>{{ title }}</title>
{%- if !description.is_empty() %}
<desc>{{ description }}</desc>
{%- endif %}"#
)]
struct Head<'a> {
    view: (f64, f64),
    size: (f64, f64),
    title: &'a str,
    description: &'a str,
}

/// Renders a figure as an SVG document.
///
/// The text stays text, in the reader's sans-serif font; the background is white, so that the
/// figure reads the same on a dark page and in print.
///
/// # Errors
/// A figure without panels, a series whose columns differ in length, a range or a reference line that is not finite,
/// a size beyond bounds, a map that does not fit its axes, limits out of order, a logarithmic axis without values.
pub fn render_svg(figure: &Figure) -> Result<String, ReportError> {
    let figure = prepared(figure)?;
    document(&figure, &plan(&figure)?)
}

/// The figure, checked, with texts that any document can carry.
pub(super) fn prepared<'a>(figure: &Figure<'a>) -> Result<Figure<'a>, ReportError> {
    check(figure)?;
    Ok(cleaned(figure))
}

/// The SVG element of a figure laid out.
pub(super) fn document(figure: &Figure, plan: &Plan) -> Result<String, ReportError> {
    plan.panels.iter().try_for_each(|panel| check_height(panel.panel, panel.height))?;
    Ok(head(figure, plan)? + "\n" + &draw(plan)? + "</svg>\n")
}

fn head(figure: &Figure, plan: &Plan) -> Result<String, ReportError> {
    let names = [figure.title.as_str(), figure.caption.as_str(), "Figure"];
    let title = names.into_iter().find(|name| !name.is_empty()).unwrap_or_default();
    let size = (plan.width.round(), plan.height.round());
    let view = ((plan.width * UNITS).round(), (plan.height * UNITS).round());
    Ok(Head { view, size, title, description: &figure.caption }.render()?)
}

fn cleaned<'a>(figure: &Figure<'a>) -> Figure<'a> {
    let mut figure = figure.clone();
    figure.title = clean(&figure.title);
    figure.caption = clean(&figure.caption);
    for panel in &mut figure.panels {
        panel.title = clean(&panel.title);
        panel.x_label = clean(&panel.x_label);
        panel.x_names.iter_mut().for_each(|(_, name)| *name = clean(name));
        panel.y_label = clean(&panel.y_label);
        panel.series.iter_mut().for_each(|series| series.label = clean(&series.label));
        panel.lines.iter_mut().for_each(|line| line.label = clean(&line.label));
        panel.hatches.iter_mut().for_each(|hatch| hatch.label = clean(&hatch.label));
        panel.bands.iter_mut().for_each(|band| band.label = clean(&band.label));
        match panel.map.as_mut().map(|map| &mut map.scale) {
            Some(Scale::Quantity(label)) => *label = clean(label),
            Some(Scale::Kinds(names)) => names.iter_mut().for_each(|name| *name = clean(name)),
            None => {}
        }
    }
    figure
}

#[cfg(test)]
mod tests {
    use super::super::figure::{HeatMap, Panel, Scale, Series, Style};
    use super::*;
    use quick_xml::events::Event;

    /// Names of all elements and the text of all text elements; panics if not well formed.
    fn parse(svg: &str) -> (Vec<String>, Vec<String>) {
        let mut reader = quick_xml::Reader::from_str(svg);
        reader.config_mut().check_end_names = true;
        let (mut names, mut texts) = (Vec::new(), Vec::new());
        loop {
            match reader.read_event().unwrap() {
                Event::Start(e) | Event::Empty(e) => {
                    assert!(e.attributes().all(|a| a.is_ok()));
                    names.push(e.name().as_ref().to_owned());
                }
                Event::Text(e) => texts.push(e.as_ref().trim().to_owned()),
                Event::Eof => return (names, texts),
                _ => {}
            }
        }
    }

    fn one(series: Series) -> String {
        render_svg(&Figure::new("One").panel(Panel::new("(a)", "t (s)", "y (V)").series(series))).unwrap()
    }

    #[test]
    fn the_document_is_well_formed_scales_and_has_a_name() {
        let svg = one(Series::points("wave", &[(0.0, 0.0), (1.0, 1.0)]));
        let (names, texts) = parse(&svg);
        assert_eq!(&names[..2], ["svg", "title"]);
        assert!(texts.contains(&"t (s)".to_owned()) && texts.contains(&"wave".to_owned()));
        let head = svg.split_once('>').unwrap().0;
        assert!(head.contains("viewBox=\"0 0 7200 ") && head.contains("width=\"720\""), "{head}");
        assert!(head.contains("role=\"img\"") && head.contains("sans-serif"));
    }

    #[test]
    fn labels_are_escaped_and_control_characters_dropped() {
        let evil = "</text><script>alert(1)</script>\u{1}";
        let figure = Figure::new(evil)
            .caption("a \"caption\" & more")
            .panel(Panel::new(evil, evil, evil).series(Series::points(evil, &[])).line(evil, 1.0));
        let svg = render_svg(&figure).unwrap();
        let (names, _) = parse(&svg);
        assert!(!names.iter().any(|name| name == "script"));
        assert!(!svg.contains('\u{1}') && svg.contains("<desc>"));
    }

    #[test]
    fn empty_constant_and_broken_series_are_drawn() {
        let broken = [(0.0, 1.0), (1.0, f64::NAN), (2.0, f64::INFINITY), (f64::NAN, 0.0), (3.0, 2.0)];
        for style in [Style::Line, Style::Steps, Style::Markers, Style::Dots, Style::Crosses, Style::Dashed] {
            for points in [&[][..], &[(1.0, 5.0)], &[(0.0, 5.0), (9.0, 5.0)], &broken] {
                let svg = one(Series::points("s", points).style(style));
                parse(&svg);
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{style:?} {points:?}");
            }
        }
    }

    #[test]
    fn gaps_split_the_line() {
        let (line, gap) = ([(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (3.0, 1.0)], f64::NAN);
        let torn = [(0.0, 0.0), (1.0, 1.0), (1.5, gap), (2.0, 0.0), (3.0, 1.0)];
        let lines = |points| one(Series::points("", points)).matches("#0072B2").count();
        assert_eq!((lines(&line), lines(&torn)), (1, 2));
    }

    #[test]
    fn a_long_series_makes_a_small_document() {
        let xs: Vec<f64> = (0..1_000_000).map(|k| f64::from(k) * 1e-4).collect();
        let ys: Vec<f64> = xs.iter().map(|x| (x * 1e3).sin()).collect();
        let svg = one(Series::columns("noise", &xs, &ys));
        assert!(svg.len() < 100_000, "{} bytes", svg.len());
    }

    #[test]
    fn a_map_of_many_cells_makes_a_small_document() {
        let axis: Vec<f64> = (0..200).map(f64::from).collect();
        let wave = |x: f64, y: f64| (0.03 * x).sin() * (0.05 * y).cos();
        let values: Vec<f64> = axis.iter().flat_map(|&y| axis.iter().map(move |&x| wave(x, y))).collect();
        let map = HeatMap { xs: &axis, ys: &axis, values: &values, scale: Scale::Quantity("z (V)".to_owned()) };
        let svg = render_svg(&Figure::new("").panel(Panel::new("", "", "").map(map))).unwrap();
        assert!(svg.len() < 400_000, "{} bytes", svg.len());
        let (_, texts) = parse(&svg);
        assert!(texts.contains(&"z (V)".to_owned()) && texts.contains(&"0.5".to_owned()), "{texts:?}");
    }

    #[test]
    fn bands_lie_below_lines_and_bars_have_caps() {
        let (line, limits) = ([(0.0, 1.0), (1.0, 2.0)], [(0.0, 0.5, 1.5), (1.0, 1.5, 2.5)]);
        let bare = Panel::new("", "", "").series(Series::points("", &line));
        let full = bare.clone().band("range", &limits, 1).bars(&limits, 2);
        let draw = |panel: &Panel| render_svg(&Figure::new("").panel(panel.clone())).unwrap();
        let (before, after) = (draw(&bare), draw(&full));
        assert!(after.find("<polygon").unwrap() < after.find("stroke=\"#0072B2\"").unwrap());
        assert!(!before.contains("#009E73"));
        assert_eq!(after.matches("stroke=\"#009E73\"").count(), 6, "two bars with two caps each");
        assert_eq!(after, draw(&full), "the same bytes every time");
    }

    #[test]
    fn a_logarithmic_axis_puts_decades_at_equal_distances() {
        let points = [(1.0, 1.0), (2.0, 10.0), (3.0, 100.0)];
        let panel = Panel::new("", "", "").log_y().series(Series::points("", &points));
        let svg = render_svg(&Figure::new("").panel(panel)).unwrap();
        let line = svg.split("<polyline").find(|part| part.contains("#0072B2")).unwrap();
        let line = line.split_once("points=\"").unwrap().1.split_once('"').unwrap().0;
        let ys: Vec<i32> = line.split_whitespace().map(|p| p.split_once(',').unwrap().1.parse().unwrap()).collect();
        assert!((ys[0] - ys[1] - (ys[1] - ys[2])).abs() <= 1, "{ys:?}");
        assert!(parse(&svg).1.contains(&"10".to_owned()));
    }

    #[test]
    fn steep_and_huge_data_stay_inside_the_frame() {
        let points = [(0.0, -1e308), (0.5, 1e308), (1.0, -1e12), (2.0, 4.0)];
        let panel = Panel::new("", "", "").series(Series::points("", &points)).y_range(0.0, 5.0);
        let svg = render_svg(&Figure::new("").panel(panel)).unwrap();
        let (_, size) = svg.split_once("viewBox=\"0 0 7200 ").unwrap();
        let height: i32 = size.split_once('"').unwrap().0.parse().unwrap();
        for points in svg.split("points=\"").skip(1).map(|s| s.split_once('"').unwrap().0) {
            for pair in points.split_whitespace() {
                let (x, y) = pair.split_once(',').unwrap();
                let (x, y): (i32, i32) = (x.parse().unwrap(), y.parse().unwrap());
                assert!((0..=7200).contains(&x) && (0..=height).contains(&y), "{pair}");
            }
        }
    }

    #[test]
    fn labels_too_long_for_a_small_figure_do_not_break_it() {
        let words = "many words ".repeat(40);
        let tiny = [(0.0, 1e-200), (1.0, 3e-200)];
        let panel = Panel::new(&words, &words, &words).height(30.0);
        let panel = panel.series(Series::points(&words, &tiny)).line(&words, -1e-200);
        let mut figure = Figure::new(&words).panel(panel);
        figure.width = 200.0;
        parse(&render_svg(&figure).unwrap());
    }
}
