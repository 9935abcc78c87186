//! The figure `statistics.svg`: mean, interval and quantiles of the main quantities over what is varied.

use videg_report::{Figure, HeatMap, Panel, ReportError, Scale as Colors, Series, Style, render_svg};

use super::document::Kept;
use super::summary::{Point, Summary};
use super::{Scale, system_description};
use crate::statistics::Statistics;

/// Most values of the second variable that are curves; more of them make a map.
const MOST_CURVES: usize = 5;
/// Most curves with bands, which hide each other.
const MOST_BANDS: usize = 3;

/// Most samples that have a mark each; more of them are a cloud.
const MOST_MARKERS: usize = 500;

type Limits = Vec<(f64, f64, f64)>;

/// Draws the figure.
pub(super) fn draw(summary: &Summary, kept: &Kept) -> Result<String, ReportError> {
    let units = Units::of(kept);
    if let Some(samples) = &summary.only {
        return alone(summary, samples, &units);
    }
    match Grid::new(summary, kept) {
        Some(grid) => maps(summary, &grid, &units),
        None => curves(summary, kept, &units),
    }
}

/// Units of quantities; those of an FMU of the user do not stand in the document.
struct Units(Vec<(String, String)>);

impl Units {
    fn of(kept: &Kept) -> Self {
        let description = if kept.fmu.is_none() { system_description().ok() } else { None };
        let known = description.iter().flat_map(|it| &it.variables);
        let known = known.filter_map(|variable| Some((variable.name.clone(), variable.unit()?.to_owned())));
        Self(known.chain([("average_voltage_gain".to_owned(), "V/s".to_owned())]).collect())
    }

    fn label(&self, name: &str) -> String {
        let unit = self.0.iter().find(|(known, unit)| known == name && unit != "1");
        unit.map_or_else(|| name.to_owned(), |(_, unit)| format!("{name} ({unit})"))
    }
}

fn percent(share: f64) -> String {
    format!("{} %", format!("{:.3}", 100.0 * share).trim_end_matches('0').trim_end_matches('.'))
}

fn interval_label(summary: &Summary) -> String {
    format!("mean, with its {} interval", percent(summary.confidence))
}

const BAND: &str = "5 % to 95 % of the samples";

fn letter(index: usize) -> String {
    ('a'..='z').nth(index).map(|letter| format!("({letter})")).unwrap_or_default()
}

/// The samples of the only point.
fn alone(summary: &Summary, samples: &[Vec<f64>], units: &Units) -> Result<String, ReportError> {
    let dots: Vec<Vec<(f64, f64)>> =
        samples.iter().map(|values| values.iter().enumerate().map(|(k, value)| (k as f64, *value)).collect()).collect();
    let statistics = summary.points.first().map_or(&[][..], |point| &point.statistics);
    let bands: Vec<Limits> = statistics.iter().zip(&dots).map(|(it, dots)| across(it, dots.len())).collect();
    let mut figure = Figure::new("Samples and their mean").caption("Each sample, the mean and its interval.");
    for (index, name) in summary.quantities.iter().enumerate() {
        let mut panel = Panel::new(letter(index), "sample that succeeded", units.label(name)).height(220.0);
        let style = if dots[index].len() > MOST_MARKERS { Style::Dots } else { Style::Markers };
        panel = panel.series(Series::points("samples", &dots[index]).style(style).color(0));
        let mean = statistics.get(index).map(|it| it.mean.value).filter(|mean| mean.is_finite());
        if let Some(mean) = mean {
            let label = format!("{} interval of the mean", percent(summary.confidence));
            panel = panel.band(label, &bands[index], 1).line("mean", mean);
        }
        figure = figure.panel(panel);
    }
    render_svg(&figure)
}

/// The interval of the mean over the whole width.
fn across(Statistics { mean, .. }: &Statistics, samples: usize) -> Limits {
    let [low, high] = mean.interval;
    if samples > 1 { vec![(0.0, low, high), ((samples - 1) as f64, low, high)] } else { Vec::new() }
}

/// A grid over two variables with evenly spread values.
struct Grid {
    xs: Vec<f64>,
    ys: Vec<f64>,
    log: [bool; 2],
    /// Places of the points, row by row.
    order: Vec<usize>,
}

impl Grid {
    /// The grid of a sweep that is drawn as a map.
    fn new(summary: &Summary, kept: &Kept) -> Option<Self> {
        let [one, other] = &kept.vary[..] else { return None };
        let (columns, rows) = (usize::try_from(one.count?).ok()?, usize::try_from(other.count?).ok()?);
        let is_map = rows > MOST_CURVES && columns > 1 && columns.checked_mul(rows) == Some(summary.points.len());
        let value = |place: usize, axis: usize| summary.points[place].given[axis].parse::<f64>().ok();
        if !is_map {
            return None;
        }
        let xs = (0..columns).map(|i| value(i * rows, 0)).collect::<Option<Vec<_>>>()?;
        let ys = (0..rows).map(|j| value(j, 1)).collect::<Option<Vec<_>>>()?;
        let log = [one.scale, other.scale].map(|scale| scale == Scale::Log);
        let (x_order, y_order) = (ascending(&xs, log[0])?, ascending(&ys, log[1])?);
        let order = y_order.iter().flat_map(|j| x_order.iter().map(move |i| i * rows + j)).collect();
        let sorted = |values: &[f64], order: &[usize]| order.iter().map(|&k| values[k]).collect();
        Some(Self { xs: sorted(&xs, &x_order), ys: sorted(&ys, &y_order), log, order })
    }

    fn values(&self, summary: &Summary, value: impl Fn(&Point) -> f64) -> Vec<f64> {
        self.order.iter().map(|&place| value(&summary.points[place])).collect()
    }
}

/// The places of evenly spread `values` in ascending order; none if they are not evenly spread, as whole numbers may be.
fn ascending(values: &[f64], is_log: bool) -> Option<Vec<usize>> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let places: Vec<f64> = order.iter().map(|&k| if is_log { values[k].ln() } else { values[k] }).collect();
    let [first, last] = [places.first()?, places.last()?];
    let step = (last - first) / (places.len() - 1) as f64;
    let is_even = places.windows(2).all(|pair| ((pair[1] - pair[0]) / step - 1.0).abs() < 1e-6);
    is_even.then_some(order)
}

/// The mean over two variables, and how well it is known.
fn maps(summary: &Summary, grid: &Grid, units: &Units) -> Result<String, ReportError> {
    let [x, y] = [0, 1].map(|axis| units.label(&summary.varied[axis]));
    let mean = |index: usize| grid.values(summary, |point| point.statistics[index].mean.value);
    let precision = |index: usize| grid.values(summary, |point| 100.0 * point.statistics[index].mean.precision());
    let values: Vec<[Vec<f64>; 2]> = (0..summary.quantities.len()).map(|k| [mean(k), precision(k)]).collect();
    let caption = "Mean, and half the width of its interval over the mean.";
    let mut figure = Figure::new("Mean of the samples").caption(caption).columns(2).width(860.0);
    for (index, (name, values)) in summary.quantities.iter().zip(&values).enumerate() {
        let half = format!("half {} interval / mean (%)", percent(summary.confidence));
        for (which, (label, values)) in [units.label(name), half].into_iter().zip(values).enumerate() {
            let map = HeatMap { xs: &grid.xs, ys: &grid.ys, values, scale: Colors::Quantity(label) };
            let mut panel = Panel::new(letter(2 * index + which), x.as_str(), y.as_str()).height(260.0).map(map);
            if grid.log[0] {
                panel = panel.log_x();
            }
            if grid.log[1] {
                panel = panel.log_y();
            }
            figure = figure.panel(panel);
        }
    }
    render_svg(&figure)
}

/// Points that are joined: those of one value of the second variable.
struct Curve<'a> {
    label: String,
    /// By ascending x.
    points: Vec<(f64, &'a Point)>,
}

/// The mean over the first variable, a curve for each value of the second one.
fn curves(summary: &Summary, kept: &Kept, units: &Units) -> Result<String, ReportError> {
    let Curves { all: curves, names, is_mixed } = Curves::new(summary);
    let is_joined = names.is_empty() && !is_mixed;
    let has_bands = is_joined && curves.len() <= MOST_BANDS;
    let label = summary.varied.first().map_or_else(|| "point".to_owned(), |name| units.label(name));
    let drawn: Vec<Vec<Drawn>> = (0..summary.quantities.len())
        .map(|index| curves.iter().map(|curve| Drawn::new(curve, index)).collect())
        .collect();
    let caption = "Mean of the samples with its interval, and the range of most samples, over what is varied.";
    let shaded = if has_bands { format!("; shaded: {BAND}") } else { String::new() };
    let mut figure =
        Figure::new(format!("Means and their {} intervals{shaded}", percent(summary.confidence))).caption(caption);
    for (index, (name, drawn)) in summary.quantities.iter().zip(&drawn).enumerate() {
        let x_label = if index + 1 == summary.quantities.len() { label.as_str() } else { "" };
        let mut panel = Panel::new(letter(index), x_label, units.label(name)).height(240.0);
        for (color, (curve, Drawn { means, bars, band })) in curves.iter().zip(drawn).enumerate() {
            let color = color % MOST_CURVES;
            let label = if curve.label.is_empty() { interval_label(summary) } else { curve.label.clone() };
            if has_bands {
                panel = panel.band(if curves.len() == 1 { BAND } else { "" }, band, color);
            }
            if is_joined {
                panel = panel.series(Series::points("", means).color(color));
            }
            panel = panel.series(Series::points(label, means).style(Style::Markers).color(color)).bars(bars, color);
        }
        panel = panel.x_names(names.iter().enumerate().map(|(k, name)| (k as f64, name.as_str())));
        if kept.vary.first().is_some_and(|varied| varied.scale == Scale::Log) && names.is_empty() {
            panel = panel.log_x();
        }
        figure = figure.panel(if index + 1 < summary.quantities.len() { panel.share_x_with_next() } else { panel });
    }
    render_svg(&figure)
}

/// What is drawn of a curve.
struct Drawn {
    means: Vec<(f64, f64)>,
    bars: Limits,
    band: Limits,
}

impl Drawn {
    fn new(curve: &Curve<'_>, index: usize) -> Self {
        let of = |point: &Point| point.statistics[index];
        let limits = |limits: &dyn Fn(Statistics) -> [f64; 2]| -> Limits {
            let all = curve.points.iter().map(|(x, point)| (*x, limits(of(point))));
            all.filter(|(_, ends)| ends.iter().all(|end| end.is_finite())).map(|(x, [a, b])| (x, a, b)).collect()
        };
        Self {
            means: curve.points.iter().map(|(x, point)| (*x, of(point).mean.value)).collect(),
            bars: limits(&|it| it.mean.interval),
            band: limits(&|it| [it.quantiles[0], it.quantiles[2]]),
        }
    }
}

/// The points by curve.
struct Curves<'a> {
    all: Vec<Curve<'a>>,
    /// Of the values of the first variable, if they are no numbers.
    names: Vec<String>,
    /// Whether points with other values of some variable are on one curve.
    is_mixed: bool,
}

impl<'a> Curves<'a> {
    fn new(summary: &'a Summary) -> Self {
        let (xs, names) = places(summary);
        let seconds: Vec<&str> =
            summary.points.iter().map(|point| point.given.get(1).map_or("", String::as_str)).collect();
        let mut kinds: Vec<&str> = Vec::new();
        for second in &seconds {
            if kinds.len() <= MOST_CURVES && !kinds.contains(second) {
                kinds.push(second);
            }
        }
        let is_mixed = summary.varied.len() > 2 || kinds.len() > MOST_CURVES;
        if is_mixed {
            kinds = vec![""];
        }
        let curve = |kind: &&str| {
            let own = xs.iter().zip(&summary.points).zip(&seconds).filter(|(_, second)| is_mixed || *second == kind);
            let mut points: Vec<_> = own.map(|((x, point), _)| (*x, point)).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let label = summary.varied.get(1).filter(|_| kinds.len() > 1).map(|name| format!("{name} = {kind}"));
            Curve { label: label.unwrap_or_default(), points }
        };
        Self { all: kinds.iter().map(curve).collect(), names, is_mixed }
    }
}

/// The places of the points on the x axis, and the names of those if the values of the first variable are no numbers.
fn places(summary: &Summary) -> (Vec<f64>, Vec<String>) {
    let first = |point: &Point| point.given.first().cloned().unwrap_or_default();
    let numbers: Option<Vec<f64>> = summary.points.iter().map(|point| first(point).parse().ok()).collect();
    if let Some(numbers) = numbers {
        return (numbers, Vec::new());
    }
    let mut names: Vec<String> = Vec::new();
    let mut place = |name: String| {
        names.iter().position(|known| *known == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        })
    };
    let xs = summary.points.iter().map(|point| place(first(point)) as f64).collect();
    (xs, names)
}
