//! The figure of a run: the last cycles in detail, energies since its start.

use crate::cosim::{HarvesterSample, Trace, TracePoint};
use crate::scenario::Scenario;
use fmu_import::Fmu;
use videg_circuit::Ledger;
use videg_report::{Drawing, Figure, Panel, ReportError, Series, Style, render_svg};

/// Points of one curve: time and value.
pub type Points = Vec<(f64, f64)>;

/// One curve of a trace.
pub fn points(trace: &[TracePoint], value: impl Fn(&TracePoint) -> f64) -> Points {
    trace.iter().map(|point| (point.time, value(point))).collect()
}

fn column(name: &str) -> impl Fn(&TracePoint) -> f64 + use<> {
    let index = HarvesterSample::names().iter().position(|column| *column == name);
    move |point| index.map_or(f64::NAN, |index| point.harvester.columns()[index])
}

/// Communication points further apart than this, s, are joined by a curve, not by a line.
const COARSE: f64 = 2e-3;

/// The relative displacement, mm. An adaptive master steps over flights: there the curve also has the velocities at both
/// ends. If an impact ends the flight, the velocity before it is not known, and the curve is a parabola.
fn displacement(trace: &[TracePoint]) -> Points {
    let [cylinder, ball, impact] = ["cylinder.velocity", "ball.velocity", "impact.lastVelocity"].map(column);
    let state = |point: &TracePoint| {
        (point.time, 1e3 * point.harvester.relative_displacement(), 1e3 * (cylinder(point) - ball(point)))
    };
    let mut points: Points = Vec::new();
    for pair in trace.windows(2) {
        let [(from, start, speed), (to, end, last)] = [state(&pair[0]), state(&pair[1])];
        let span = to - from;
        let last = if impact(&pair[0]).to_bits() == impact(&pair[1]).to_bits() {
            last
        } else {
            2.0 * (end - start) / span - speed
        };
        points.push((from, start));
        let pieces = if span > COARSE { 30_u32 } else { 1 };
        points.extend((1..pieces).map(|k| {
            let share = f64::from(k) / f64::from(pieces);
            (from + share * span, hermite(share, [start, end], [speed * span, last * span]))
        }));
    }
    points.extend(trace.last().map(|point| (state(point).0, state(point).1)));
    points
}

/// The cubic over 0 to 1 with these values and slopes at its ends.
fn hermite(x: f64, [start, end]: [f64; 2], [first, last]: [f64; 2]) -> f64 {
    let rest = 1.0 - x;
    rest * rest * ((1.0 + 2.0 * x) * start + x * first) + x * x * ((1.0 + 2.0 * rest) * end - rest * last)
}

/// The curves of the mechanics.
struct Mechanics {
    dz: Points,
    left: Points,
    right: Points,
}

impl Mechanics {
    fn new(trace: &Trace) -> Self {
        Self {
            dz: displacement(&trace.detail),
            left: points(&trace.detail, |point| 1e12 * point.harvester.capacitance()[0]),
            right: points(&trace.detail, |point| 1e12 * point.harvester.capacitance()[1]),
        }
    }

    fn panels<'a>(&'a self, figure: Figure<'a>, [from, to]: [f64; 2]) -> Figure<'a> {
        figure
            .panel(
                Panel::new("(a)", "", "z_M - z_m (mm)")
                    .x_range(from, to)
                    .height(120.0)
                    .series(Series::points("relative displacement", &self.dz).color(6))
                    .share_x_with_next(),
            )
            .panel(
                Panel::new("(b)", "", "capacitance (pF)")
                    .height(120.0)
                    .series(Series::points("left membrane", &self.left))
                    .series(Series::points("right membrane", &self.right))
                    .share_x_with_next(),
            )
    }
}

/// Ends of the detail, s.
pub fn detail_range(trace: &Trace, scenario: &Scenario) -> [f64; 2] {
    [trace.detail.first().map_or(0.0, |point| point.time), scenario.until]
}

/// Title of the figure.
pub fn title(scenario: &Scenario) -> String {
    format!("{}: {}", scenario.name, scenario.description)
}

/// A curve of the energies of the first circuit: name, value in J, and whether it is dashed, so that both show where two
/// coincide.
type EnergyCurve = (&'static str, fn(&Ledger) -> f64, Style);

const ENERGIES: [EnergyCurve; 4] = [
    ("supply", |ledger| ledger.supply, Style::Line),
    ("Zener", |ledger| ledger.zener, Style::Dashed),
    ("load", |ledger| ledger.load, Style::Line),
    ("converted", Ledger::converted, Style::Dashed),
];
/// Of a netlist of the user.
const NETLIST_ENERGIES: [EnergyCurve; 4] = [
    ("cost", |ledger| ledger.supply, Style::Line),
    ("other elements", |ledger| ledger.diode, Style::Dashed),
    ("gain", |ledger| ledger.load, Style::Line),
    ("net = gain - cost + stored", |ledger| ledger.surplus() + ledger.stored, Style::Dashed),
];

/// Of a circuit FMU of the user.
const FOREIGN_ENERGIES: [EnergyCurve; 4] = [
    ("supply", |ledger| ledger.supply, Style::Line),
    ("from the mechanics", |ledger| ledger.mechanical, Style::Dashed),
    ("load", |ledger| ledger.load, Style::Line),
    ("net = load - supply + stored", |ledger| ledger.surplus() + ledger.stored, Style::Dashed),
];

/// Whose circuit is drawn; of a user's, also the waveforms asked for.
pub enum Electrical {
    Paper,
    Netlist(Vec<Probe>),
    Foreign(Vec<Probe>),
}

/// Relative displacement, C(t), voltages (in detail) and cumulative energy (whole run) of the first circuit.
pub fn cosim(trace: &Trace, scenario: &Scenario, circuit: Electrical) -> Result<Drawing, ReportError> {
    let mechanics = Mechanics::new(trace);
    let voltage = |side: usize| {
        points(&trace.detail, move |point| point.circuits.first().map_or(f64::NAN, |c| 1e-3 * c.voltage[side]))
    };
    let [left, right] = [voltage(0), voltage(1)];
    let (curves, probes) = match circuit {
        Electrical::Paper => (ENERGIES, Vec::new()),
        Electrical::Netlist(probes) => (NETLIST_ENERGIES, probes),
        Electrical::Foreign(probes) => (FOREIGN_ENERGIES, probes),
    };
    let [steps, energies] = [&trace.detail, &trace.overview].map(|trace| EnergyLines::new(trace, &curves));
    let probes = Probes::new(trace, probes);
    // On a shared node the two voltages are one.
    let shared = left == right;
    let mut voltages = Panel::new("(c)", "", "voltage (kV)").height(120.0);
    voltages = if shared {
        voltages.series(Series::points("both membranes", &left))
    } else {
        voltages.series(Series::points("left membrane", &left)).series(Series::points("right membrane", &right))
    };
    let figure = mechanics.panels(Figure::new(title(scenario)), detail_range(trace, scenario));
    let (probed, voltages) = (probes.panels(), voltages.share_x_with_next());
    let (detail, whole) = (letter(3 + probed.len()), letter(4 + probed.len()));
    let steps = steps.panel(Panel::new(detail, "time (s)", "energy (mJ)").height(120.0), &curves);
    let whole = energies.panel(Panel::new(whole, "time (s)", "energy (mJ)").height(120.0), &curves);
    let figure = probed.into_iter().map(Panel::share_x_with_next).fold(figure.panel(voltages), Figure::panel);
    let figure = figure.panel(steps).panel(whole).caption(
        "Relative displacement of the ball, capacitances and voltages of the membranes and energies of the circuit in the last seconds of \
         the run, and the energies since its start. Lines join capacitances and voltages at communication points.",
    );
    Drawing::new(&figure)
}

/// Energies of the first circuit, mJ, since the first point of a trace.
struct EnergyLines {
    curves: [Points; 4],
    eq13: Points,
}

impl EnergyLines {
    fn new(trace: &[TracePoint], curves: &[EnergyCurve; 4]) -> Self {
        let since_first = |value: &dyn Fn(&TracePoint) -> f64| {
            let first = trace.first().map_or(0.0, value);
            thinned(&points(trace, |point| 1e3 * (value(point) - first)))
        };
        let curve = |(_, value, _): &EnergyCurve| {
            since_first(&|point| point.circuits.first().map_or(f64::NAN, |circuit| value(&circuit.ledger)))
        };
        Self { curves: curves.each_ref().map(curve), eq13: since_first(&|point| point.harvester.energy_eq13()) }
    }

    /// `panel` with those that are known.
    fn panel<'a>(&'a self, mut panel: Panel<'a>, curves: &[EnergyCurve; 4]) -> Panel<'a> {
        for (color, ((name, _, style), energy)) in curves.iter().zip(&self.curves).enumerate() {
            if energy.iter().any(|(_, value)| !value.is_nan()) {
                panel = panel.series(Series::points(*name, energy).style(*style).color(color));
            }
        }
        panel.series(Series::points("W, Eq. (13)", &self.eq13).color(6))
    }
}

/// Without points that lie on the line between those that stay, within a pixel's fraction: energies hold and step, and a report shall be small.
fn thinned(points: &[(f64, f64)]) -> Points {
    /// Largest distance from the line, over the range of all values.
    const TOLERANCE: f64 = 5e-4;
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), (_, y)| (low.min(*y), high.max(*y)));
    let tolerance = TOLERANCE * (high - low);
    let mut kept: Points = points.first().copied().into_iter().collect();
    // Slopes of the lines from the last point kept that pass all points since.
    let (mut least, mut most) = (f64::MIN, f64::MAX);
    for pair in points.windows(2) {
        let [before, here] = [pair[0], pair[1]];
        let from = kept.last().copied().unwrap_or(before);
        let slopes = |(x, y): (f64, f64), (x0, y0): (f64, f64)| {
            [(y - tolerance - y0) / (x - x0), (y + tolerance - y0) / (x - x0)]
        };
        let [low, high] = slopes(here, from);
        (least, most) = (least.max(low), most.min(high));
        let slope = (here.1 - from.1) / (here.0 - from.0);
        if !(least <= slope && slope <= most) && before.0 > from.0 {
            kept.push(before);
            [least, most] = slopes(here, before);
        }
    }
    // Times, not values: a circuit of the user may not tell one.
    let is_left = |last: &&(f64, f64)| kept.last().is_some_and(|kept| kept.0 < last.0);
    let last = points.last().filter(is_left).copied();
    kept.extend(last);
    kept
}

/// A waveform of a user's circuit that was asked for.
pub struct Probe {
    name: String,
    /// Label of its axis.
    axis: String,
    /// The value on the axis over that of the circuit.
    scale: f64,
}

impl Probe {
    /// A node of a netlist, or `i(source)`.
    pub fn of_node(name: &str) -> Self {
        let is_current = name.to_ascii_lowercase().starts_with("i(");
        let (axis, scale) = if is_current { ("current (uA)", 1e6) } else { ("voltage (V)", 1.0) };
        Self { name: name.to_owned(), axis: axis.to_owned(), scale }
    }

    /// A variable of a circuit FMU.
    pub fn of_variable(name: &str, fmu: &Fmu) -> Self {
        let unit = fmu.description().variable(name).ok().and_then(|variable| variable.unit());
        let axis = unit.map_or_else(|| "value".to_owned(), |unit| format!("value ({unit})"));
        Self { name: name.to_owned(), axis, scale: 1.0 }
    }
}

/// The waveforms in panels, one for each kind of axis.
struct Probes {
    curves: Vec<(Probe, Points)>,
}

impl Probes {
    fn new(trace: &Trace, probes: Vec<Probe>) -> Self {
        let curve = |(index, probe): (usize, Probe)| {
            let value = |point: &TracePoint| probe.scale * point.probes.get(index).copied().unwrap_or(f64::NAN);
            let points = points(&trace.detail, value);
            (probe, points)
        };
        Self { curves: probes.into_iter().enumerate().map(curve).collect() }
    }

    fn panels(&self) -> Vec<Panel<'_>> {
        let mut axes: Vec<&str> = Vec::new();
        for (probe, _) in &self.curves {
            if !axes.contains(&probe.axis.as_str()) {
                axes.push(&probe.axis);
            }
        }
        let panel = |(index, axis): (usize, &&str)| {
            let curves = self.curves.iter().filter(|(probe, _)| probe.axis == **axis);
            curves.fold(Panel::new(letter(3 + index), "", *axis).height(120.0), |panel, (probe, points)| {
                panel.series(Series::points(probe.name.as_str(), points))
            })
        };
        axes.iter().enumerate().map(panel).collect()
    }
}

/// Label of the panel with this index: (a), (b), ...
fn letter(index: usize) -> String {
    let letters = ('a'..='z').map(|letter| format!("({letter})"));
    letters.cycle().nth(index).unwrap_or_default()
}

/// Relative displacement, C(t) and velocities (in detail) and the gains (whole run).
pub fn simulate(trace: &Trace, scenario: &Scenario) -> Result<String, ReportError> {
    let mechanics = Mechanics::new(trace);
    let cylinder = points(&trace.detail, column("cylinder.velocity"));
    let ball = points(&trace.detail, column("ball.velocity"));
    let gain = points(&trace.overview, |point| 1e-3 * point.harvester.voltage_gain());
    let velocities = Panel::new("(c)", "time (s)", "velocity (m/s)")
        .height(120.0)
        .series(Series::points("cylinder", &cylinder))
        .series(Series::points("ball", &ball));
    let gains = Panel::new("(d)", "time (s)", "sum of gains (kV)")
        .height(150.0)
        .series(Series::points("sum of U_DE4 - U_in", &gain).color(2));
    let figure = mechanics.panels(Figure::new(title(scenario)), detail_range(trace, scenario));
    let figure = figure.panel(velocities).panel(gains).caption(
        "Relative displacement of the ball, capacitances of the membranes and velocities in the last seconds of the \
         run, and the sum of the voltage gains since its start.",
    );
    render_svg(&figure)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_points_stay_close_to_all_that_are_left_out() {
        let mut random = fastrand::Rng::with_seed(7);
        for kind in 0..40 {
            let mut y = 0.0;
            let all: Points = (0..2000)
                .map(|k| {
                    let step = if random.f64() < 0.02 { 10.0 * random.f64() } else { 0.0 };
                    y += if kind % 2 == 0 { step } else { 0.01 * (f64::from(k) * 0.03).sin() + 1e-3 * step };
                    (f64::from(k) * 1e-3, y)
                })
                .collect();
            let kept = thinned(&all);
            assert!(kept.len() < all.len() / 3 && kept[0] == all[0] && kept.last() == all.last());
            let range = all.iter().map(|point| point.1).fold(f64::MIN, f64::max)
                - all.iter().map(|point| point.1).fold(f64::MAX, f64::min);
            for (x, y) in all {
                let after = kept.partition_point(|point| point.0 < x).clamp(1, kept.len() - 1);
                let [(x0, y0), (x1, y1)] = [kept[after - 1], kept[after]];
                let line = y0 + (y1 - y0) * (x - x0) / (x1 - x0);
                assert!((line - y).abs() <= 1.001e-3 * range, "{x}: {line} for {y} of {range}");
            }
        }
        assert_eq!(thinned(&[]), []);
        assert_eq!(thinned(&[(0.0, f64::NAN), (1.0, f64::NAN)]).len(), 2);
    }

    #[test]
    fn a_cubic_is_its_own_curve() {
        let (cubic, slope) = (|x: f64| 2.0 - x + 3.0 * x * x * x, |x: f64| 9.0 * x * x - 1.0);
        for x in [0.0, 0.3, 0.8, 1.0] {
            assert!((hermite(x, [cubic(0.0), cubic(1.0)], [slope(0.0), slope(1.0)]) - cubic(x)).abs() < 1e-12, "{x}");
        }
    }
}
