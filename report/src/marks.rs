//! Content of a frame, on the canvas of the plotting library.

use plotters::element::{Circle, Cross, DashedPathElement, EmptyElement, PathElement, Polygon};
use plotters::style::{Color, ShapeStyle, WHITE};

use super::canvas::{Chart, UNITS, failed, ink, stroke, units};
use super::cells::dots_markup;
use super::colors::palette;
use super::error::ReportError;
use super::layout::PanelPlan;
use super::trace::{Key, Shape, Trace};

type Point = (f64, f64);

/// Radii and lengths in px.
pub(super) const MARKER: f64 = 1.8;
pub(super) const CROSS: f64 = 2.2;
pub(super) const PIN: f64 = 3.6;
const DOT: f64 = 0.8;
const CAP: f64 = 3.0;
pub(super) const DASH: (f64, f64) = (5.0, 3.0);
/// Opacity of bands, which overlap.
pub(super) const OPACITY: f64 = 0.25;
/// Lines longer than this, in px, are so dense that dashes would not be seen.
const LONGEST_DASHED: f64 = 2e4;

/// Clouds of small dots.
pub(super) fn clouds(chart: &Chart, panel: &PanelPlan) -> String {
    let clouds = panel.traces.iter().filter(|trace| trace.key.shape == Shape::Dot);
    let place = |&(x, y): &Point| chart.backend_coord(&(panel.x.scaled(x), panel.y.scaled(y)));
    let markup = |trace: &Trace| {
        let color = palette(trace.key.color.unwrap_or(0));
        dots_markup(trace.parts.iter().flatten().map(place), color, units(2.0 * DOT))
    };
    clouds.map(markup).collect()
}

pub(super) fn draw_areas(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    for (band, areas) in panel.panel.bands.iter().zip(&panel.areas) {
        let style = ink(Key::new(Shape::Area, band.color)).mix(OPACITY).filled();
        for area in areas {
            let corners: Vec<Point> = area.iter().map(|at| scaled(panel, at)).collect();
            chart.draw_series([Polygon::new(corners, style)]).map_err(failed)?;
        }
    }
    Ok(())
}

pub(super) fn draw_traces(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    for trace in &panel.traces {
        for part in &trace.parts {
            let points: Vec<Point> = part.iter().map(|at| scaled(panel, at)).collect();
            draw_part(chart, points, trace.key)?;
        }
    }
    Ok(())
}

fn draw_part(chart: &mut Chart, points: Vec<Point>, key: Key) -> Result<(), ReportError> {
    let style = stroke(ink(key), 1.2);
    match (key.shape, &points[..]) {
        (Shape::Dot | Shape::Area | Shape::Hatch | Shape::Cell, _) => Ok(()),
        (Shape::Marker, _) => {
            let dots = points.into_iter().map(|at| Circle::new(at, units(MARKER), style.filled()));
            chart.draw_series(dots).map(drop)
        }
        (Shape::Cross, _) => {
            chart.draw_series(points.into_iter().map(|at| Cross::new(at, units(CROSS), style))).map(drop)
        }
        (Shape::Pin, _) => {
            let rings = [(PIN + 1.6, WHITE), (PIN, ink(key))];
            rings.into_iter().try_for_each(|(radius, color)| {
                let pins = points.iter().map(|at| Circle::new(*at, units(radius), color.filled()));
                chart.draw_series(pins).map(drop)
            })
        }
        // A value between two gaps is a dot, not an invisible line.
        (_, &[only]) => chart.draw_series([Circle::new(only, units(1.0), style.filled())]).map(drop),
        (Shape::Dashes, _) if length(chart, &points) < LONGEST_DASHED => {
            chart.draw_series([dashed(points, style)]).map(drop)
        }
        _ => chart.draw_series([PathElement::new(points, style)]).map(drop),
    }
    .map_err(failed)
}

pub(super) fn draw_whiskers(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    for (bars, whiskers) in panel.panel.bars.iter().zip(&panel.whiskers) {
        let style = stroke(ink(Key::new(Shape::Line, bars.color)), 1.0);
        for whisker in whiskers {
            let [low, high] = whisker.ends.map(|(y, _)| scaled(panel, &(whisker.x, y)));
            chart.draw_series([PathElement::new([low, high], style)]).map_err(failed)?;
            let caps = [low, high].into_iter().zip(whisker.ends).filter(|(_, end)| end.1);
            let cap = |(at, _)| EmptyElement::at(at) + PathElement::new([(-units(CAP), 0), (units(CAP), 0)], style);
            chart.draw_series(caps.map(cap)).map_err(failed)?;
        }
    }
    Ok(())
}

pub(super) fn draw_lines(chart: &mut Chart, panel: &PanelPlan) -> Result<(), ReportError> {
    let inside = panel.y.low..=panel.y.high;
    let values = panel.panel.lines.iter().map(|line| panel.space.y(line.value));
    for value in values.filter(|value| inside.contains(value)) {
        let (ends, y) = (panel.x.scaled_range(), panel.y.scaled(value));
        let line = dashed(vec![(ends.start, y), (ends.end, y)], stroke(ink(Key::REFERENCE), 0.9));
        chart.draw_series([line]).map_err(failed)?;
    }
    Ok(())
}

fn dashed(points: Vec<Point>, style: ShapeStyle) -> DashedPathElement<std::vec::IntoIter<Point>, i32> {
    DashedPathElement::new(points, units(DASH.0), units(DASH.1), style)
}

/// Length of a line in px.
fn length(chart: &Chart, points: &[Point]) -> f64 {
    let places: Vec<(i32, i32)> = points.iter().map(|at| chart.backend_coord(at)).collect();
    let steps = places.windows(2).map(|pair| {
        let (across, down) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        f64::from(across).hypot(f64::from(down))
    });
    steps.sum::<f64>() / UNITS
}

fn scaled(panel: &PanelPlan, &(x, y): &Point) -> Point {
    (panel.x.scaled(x), panel.y.scaled(y))
}
