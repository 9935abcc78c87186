//! A figure as data of an interactive chart, for the script of the page.
//!
//! Traces are those of Plotly; places of panels are left to the script, which knows the width of the screen.

use serde_json::{Value, json};

use super::axes::group;
use super::cells::kind;
use super::colors::{Ramp, hex, palette};
use super::figure::{Band, Bars, Figure, HeatMap, Scale, Series, Style};
use super::layout::{PanelPlan, Plan};
use super::reduce::{extent, is_finite, reduce, reduce_markers};
use super::trace::Space;

type Point = (f64, f64);

/// Points of a series at most.
const POINTS: usize = 20_000;
/// Digits after the first, of x and of y: a time of 100 s needs more than the eye sees of a voltage.
const DIGITS: (usize, usize) = (8, 5);

/// The chart of a checked figure with its layout: traces, and for each panel its axes and what stands around it.
pub(super) fn chart(figure: &Figure, plan: &Plan) -> String {
    let mut traces = Vec::new();
    let mut panels = Vec::new();
    for (index, panel) in plan.panels.iter().enumerate() {
        traces.extend(panel_traces(panel).into_iter().map(|trace| at(trace, index)));
        panels.push(panel_json(figure, plan, index));
    }
    json!({ "title": words(&figure.title), "columns": figure.columns, "panels": panels, "traces": traces }).to_string()
}

fn panel_json(figure: &Figure, plan: &Plan, index: usize) -> Value {
    let planned = &plan.panels[index];
    let panel = planned.panel;
    let kind = |log| if log { "log" } else { "linear" };
    let linked = index.checked_sub(figure.columns).filter(|&above| group(figure, above).len() > 1);
    let lines: Vec<Value> = panel
        .lines
        .iter()
        .filter(|line| planned.space.y(line.value).is_finite())
        .map(|line| json!({ "label": words(&line.label), "y": line.value }))
        .collect();
    json!({
        "title": words(&panel.title),
        "height": planned.height.round(),
        "x": {
            "type": kind(panel.log_x), "range": [planned.x.low, planned.x.high], "title": words(&panel.x_label),
            "names": panel.x_names.iter().map(|(x, name)| (*x, words(name))).collect::<Vec<_>>(),
        },
        "y": { "type": kind(panel.log_y), "range": [planned.y.low, planned.y.high], "title": words(&panel.y_label) },
        "linked": linked,
        "open": !panel.share_x_with_next,
        "toScale": panel.equal_aspect,
        "lines": lines,
    })
}

fn panel_traces(planned: &PanelPlan) -> Vec<Value> {
    let (panel, space) = (planned.panel, planned.space);
    let map = panel.map.iter().flat_map(map_traces);
    let lines = panel.map.iter().flat_map(|map| line_traces(planned, map));
    let bands = panel.bands.iter().map(|band| band_trace(band, space));
    let series = panel.series.iter().map(|series| series_trace(series, space));
    let bars = panel.bars.iter().map(bars_trace);
    map.chain(lines).chain(bands).chain(series).chain(bars).collect()
}

/// The trace on the axes of a panel.
fn at(mut trace: Value, index: usize) -> Value {
    let number = if index == 0 { String::new() } else { (index + 1).to_string() };
    trace["panel"] = index.into();
    trace["xaxis"] = format!("x{number}").into();
    trace["yaxis"] = format!("y{number}").into();
    trace
}

fn scatter(label: &str, points: &[Point]) -> Value {
    let (xs, ys): (Vec<Value>, Vec<Value>) =
        points.iter().map(|&(x, y)| (short(x, DIGITS.0), short(y, DIGITS.1))).unzip();
    json!({ "type": "scatter", "name": words(label), "showlegend": !label.is_empty(), "x": xs, "y": ys })
}

fn series_trace(series: &Series, space: Space) -> Value {
    let color = hex(palette(series.color.unwrap_or(0)));
    let mut trace = scatter(&series.label, &thinned(series, space));
    let mark = |symbol, size: f64| json!({ "color": color, "symbol": symbol, "size": size });
    let (mode, field, look) = match series.style {
        Style::Line => ("lines", "line", json!({ "color": color, "width": 1.5 })),
        Style::Steps => ("lines", "line", json!({ "color": color, "width": 1.5, "shape": "hv" })),
        Style::Dashed => ("lines", "line", json!({ "color": color, "width": 1.5, "dash": "dash" })),
        Style::Markers => ("markers", "marker", mark("circle", 5.0)),
        Style::Dots => ("markers", "marker", mark("circle", 2.0)),
        Style::Pins => {
            let edge = json!({ "color": "#fff", "width": 1.5 });
            ("markers", "marker", json!({ "color": color, "symbol": "circle", "size": 10, "line": edge }))
        }
        Style::Crosses => ("markers", "marker", mark("x", 6.0)),
    };
    trace["mode"] = mode.into();
    trace[field] = look;
    trace
}

/// What is left of a series, at most [`POINTS`] points.
fn thinned(series: &Series, space: Space) -> Vec<Point> {
    if series.data.lengths().0 <= POINTS {
        return series.data.iter().collect();
    }
    let points: Vec<Point> = space.points(&series.data).collect();
    let finite = || points.iter().copied().filter(is_finite);
    let ranges = (extent(finite().map(|p| p.0)), extent(finite().map(|p| p.1)));
    let kept = |fineness: usize| {
        if series.style.is_marks() {
            reduce_markers(finite(), ranges, (fineness, fineness))
        } else {
            reduce(&points, fineness)
        }
    };
    // Lines that run back and forth in x keep more than four points a column.
    let mut fineness = if series.style.is_marks() { 2048 } else { POINTS / 4 };
    let mut points = kept(fineness);
    while points.len() > POINTS && fineness > 1 {
        fineness /= 2;
        points = kept(fineness);
    }
    points.truncate(POINTS);
    points.into_iter().map(|(x, y)| space.data(x, y)).collect()
}

/// Closed outlines, one for each stretch without a gap.
fn band_trace(band: &Band, space: Space) -> Value {
    let mut outline = Vec::new();
    let is_complete = |limit: &(f64, f64, f64)| {
        let (x, low, high) = (space.x(limit.0), space.y(limit.1), space.y(limit.2));
        is_finite(&(x, low)) && high.is_finite()
    };
    for run in band.limits.split(|limit| !is_complete(limit)).filter(|run| !run.is_empty()) {
        let stride = run.len().div_ceil(POINTS / 2);
        let run: Vec<_> = run.iter().step_by(stride).collect();
        outline.extend(run.iter().map(|limit| (limit.0, limit.1)));
        outline.extend(run.iter().rev().map(|limit| (limit.0, limit.2)));
        outline.push((f64::NAN, f64::NAN));
    }
    let mut trace = scatter(&band.label, &outline);
    let (red, green, blue) = palette(band.color);
    trace["mode"] = "lines".into();
    trace["line"] = json!({ "width": 0 });
    trace["fill"] = "toself".into();
    trace["fillcolor"] = format!("rgba({red},{green},{blue},0.25)").into();
    trace["hoverinfo"] = "skip".into();
    trace
}

fn bars_trace(bars: &Bars) -> Value {
    let limits = &bars.limits[..bars.limits.len().min(POINTS)];
    let middles: Vec<Point> = limits.iter().map(|&(x, low, high)| (x, f64::midpoint(low, high))).collect();
    let halves: Vec<Value> = limits.iter().map(|&(_, low, high)| short(high / 2.0 - low / 2.0, DIGITS.1)).collect();
    let color = hex(palette(bars.color));
    let mut trace = scatter("", &middles);
    trace["mode"] = "markers".into();
    trace["marker"] = json!({ "color": color, "size": 1 });
    trace["error_y"] = json!({ "type": "data", "array": halves, "color": color, "thickness": 1.2, "width": 3 });
    trace
}

/// The map; of kinds, an entry of the legend for each.
fn map_traces(map: &HeatMap) -> Vec<Value> {
    let rows: Vec<Vec<Value>> = map.values.chunks(map.xs.len().max(1)).map(|row| round(row, DIGITS.1)).collect();
    let mut trace = json!({
        "type": "heatmap", "x": round(map.xs, DIGITS.0), "y": round(map.ys, DIGITS.0), "z": rows, "hoverongaps": false,
    });
    let mut traces = Vec::new();
    match &map.scale {
        Scale::Quantity(label) => {
            let ramp = Ramp::over(map.values);
            let steps = ramp.anchors().len() as f64 - 1.0;
            let stops = ramp.anchors().iter().zip(0_u32..);
            trace["colorscale"] = stops.map(|(&color, k)| json!([f64::from(k) / steps, hex(color)])).collect();
            (trace["zmin"], trace["zmax"]) = (ramp.low.into(), ramp.high.into());
            trace["label"] = words(label).into();
        }
        Scale::Kinds(names) => {
            let count = names.len().max(1) as f64;
            let stops = (0..names.len()).flat_map(|k| {
                let color = hex(palette(kind(k as f64)));
                [json!([k as f64 / count, color]), json!([(k as f64 + 1.0) / count, color])]
            });
            trace["colorscale"] = stops.collect();
            (trace["zmin"], trace["zmax"]) = ((-0.5).into(), (count - 0.5).into());
            trace["showscale"] = false.into();
            trace["kinds"] = names.iter().map(|name| words(name)).collect();
            traces.extend(names.iter().enumerate().map(|(k, name)| {
                let mut key = scatter(name, &[(f64::NAN, f64::NAN)]);
                key["mode"] = "markers".into();
                key["marker"] = json!({ "symbol": "square", "size": 10, "color": hex(palette(k)) });
                key
            }));
        }
    }
    traces.insert(0, trace);
    traces
}

/// Contours at the ticks of the colour bar, and hatched parts of the map, which are shaded in a chart.
fn line_traces(planned: &PanelPlan, map: &HeatMap) -> Vec<Value> {
    let contour = |values: &[f64], contours: Value| {
        let rows: Vec<Vec<Value>> = values.chunks(map.xs.len().max(1)).map(|row| round(row, DIGITS.1)).collect();
        json!({
            "type": "contour", "x": round(map.xs, DIGITS.0), "y": round(map.ys, DIGITS.0), "z": rows, "hoverinfo": "skip",
            "contours": contours, "showscale": false, "showlegend": false, "line": { "color": "#222", "width": 1 },
        })
    };
    let hatches = planned.panel.hatches.iter().map(|hatch| {
        let mut trace = contour(hatch.values, json!({ "type": "constraint", "operation": ">", "value": hatch.above }));
        (trace["name"], trace["showlegend"]) = (words(&hatch.label).into(), (!hatch.label.is_empty()).into());
        trace["fillcolor"] = "rgba(34,34,34,0.3)".into();
        trace
    });
    let bar = planned.bar.as_ref().filter(|_| planned.panel.contours);
    let contours = bar.and_then(|bar| Some((bar.axis.tick_values().first().copied()?, bar.axis.tick_values())));
    let contours = contours.map(|(first, ticks)| {
        let step = ticks.get(1).map_or(1.0, |next| next - first);
        let last = ticks.last().copied().unwrap_or(first);
        let levels = json!({ "coloring": "none", "showlabels": true, "start": first, "end": last, "size": step });
        contour(map.values, levels)
    });
    hatches.chain(contours).collect()
}

fn round(values: &[f64], digits: usize) -> Vec<Value> {
    values.iter().map(|&value| short(value, digits)).collect()
}

/// A number with that many digits after the first; a gap becomes null.
fn short(value: f64, digits: usize) -> Value {
    format!("{value:.digits$e}").parse::<f64>().unwrap_or(f64::NAN).into()
}

/// Text that the chart shows as it is: it would take `<b>` for a command.
fn words(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Drawing;
    use super::super::figure::Panel;
    use super::*;

    fn parsed(figure: &Figure) -> Value {
        serde_json::from_str(&Drawing::new(figure).unwrap().chart).unwrap()
    }

    #[test]
    fn panels_have_axes_of_their_own_and_shared_ones_are_linked() {
        let line = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.25)];
        let panel = || Panel::new("(a)", "x", "y").series(Series::points("s", &line));
        let chart = parsed(&Figure::new("F").panel(panel().share_x_with_next()).panel(panel()).panel(panel().log_y()));
        assert_eq!(chart["panels"].as_array().unwrap().len(), 3);
        assert_eq!((&chart["panels"][1]["linked"], &chart["panels"][2]["linked"]), (&json!(0), &Value::Null));
        assert_eq!(chart["panels"][2]["y"]["type"], "log");
        assert_eq!(chart["traces"][0]["y"], json!([1.0, null, 3.25]));
        assert_eq!((&chart["traces"][0]["xaxis"], &chart["traces"][1]["xaxis"]), (&json!("x"), &json!("x2")));
    }

    #[test]
    fn every_mark_becomes_a_trace() {
        let limits = [(0.0, 1.0, 3.0), (1.0, 2.0, 3.0)];
        let kinds = Scale::Kinds(vec!["none".into(), "one".into()]);
        let map = HeatMap { xs: &[0.0, 1.0], ys: &[0.0], values: &[0.0, 1.0], scale: kinds };
        let panel = Panel::new("", "", "").band("range", &limits, 1).bars(&limits, 2).map(map);
        let chart = parsed(&Figure::new("").panel(panel.line("bias", 2.0)));
        let types: Vec<&str> =
            chart["traces"].as_array().unwrap().iter().map(|t| t["type"].as_str().unwrap()).collect();
        assert_eq!(types, ["heatmap", "scatter", "scatter", "scatter", "scatter"]);
        assert_eq!(chart["traces"][4]["error_y"]["array"], json!([1.0, 0.5]));
        assert_eq!(chart["panels"][0]["lines"][0]["y"], json!(2.0));
    }

    #[test]
    fn long_series_are_thinned_out_with_their_peaks() {
        let mut points: Vec<Point> = (0..200_000).map(|k| (f64::from(k), f64::from(k % 7))).collect();
        points[123_456].1 = 99.0;
        for style in [Style::Line, Style::Dots] {
            let series = Series::points("", &points).style(style);
            let chart = parsed(&Figure::new("").panel(Panel::new("", "", "").series(series)));
            let ys = chart["traces"][0]["y"].as_array().unwrap();
            assert!(ys.len() <= POINTS && ys.contains(&json!(99.0)), "{style:?}: {}", ys.len());
        }
    }

    #[test]
    fn labels_are_words_not_commands() {
        let chart = parsed(&Figure::new("<U> & <b>").panel(Panel::new("", "", "")));
        assert_eq!(chart["title"], "&lt;U&gt; &amp; &lt;b&gt;");
    }
}
