//! The figures of a crosscheck.

use super::run::Crosscheck;
use super::solver::Solver;
use super::sweep::{ReleaseSweep, SweepCurve, SweepPoint};
use crate::cosim::CircuitSample;
use crate::ngspice::Waveforms;
use videg_report::{Figure, Panel, ReportError, Series, Style, render_svg};

type Points = Vec<(f64, f64)>;

/// An energy: its name, and how to read it in mJ.
type Energy = (&'static str, fn(&CircuitSample) -> f64);

/// Length of the detail, s: some periods of the paper's 2 Hz.
const DETAIL: f64 = 2.0;
/// Markers of ngspice over the width of a figure.
const MARKERS: usize = 100;

fn points(run: &Waveforms, from: f64, value: impl Fn(&CircuitSample) -> f64) -> Points {
    let rows = run.time.iter().zip(&run.samples).filter(|(time, _)| **time >= from);
    rows.map(|(&time, sample)| (time, value(sample))).collect()
}

/// About [`MARKERS`] of the points, evenly spaced in time.
fn thinned(points: &[(f64, f64)]) -> Points {
    let [Some(first), Some(last)] = [points.first(), points.last()] else { return Vec::new() };
    let spacing = (last.0 - first.0) / MARKERS as f64;
    let mut due = first.0;
    let kept = points.iter().filter(|point| {
        let keep = point.0 >= due;
        if keep {
            due = point.0 + spacing;
        }
        keep
    });
    kept.copied().collect()
}

/// Voltages of embedded solver and ngspice in the last seconds, their difference, and the energies of the whole run.
pub fn overlay(found: &Crosscheck) -> Result<String, ReportError> {
    let empty = Waveforms::default();
    let run = |solver| found.run(solver).unwrap_or(&empty);
    let (embedded, ngspice) = (run(Solver::Exponential), run(Solver::Batch));
    let until = found.scenario.until;
    let from = (until - DETAIL).max(0.0);
    let voltage = |run: &Waveforms, side: usize| points(run, from, move |at| 1e-3 * at.voltage[side]);
    let sides = [0, 1].map(|side| (voltage(embedded, side), thinned(&voltage(ngspice, side))));
    let differences = [Solver::Exponential, Solver::Ideal, Solver::Live].map(|solver| {
        let pairs =
            points(run(solver), from, |at| at.voltage[0]).into_iter().zip(points(ngspice, from, |at| at.voltage[0]));
        pairs.map(|((time, a), (_, b))| (time, 1e3 * (a - b))).collect::<Points>()
    });
    let energies: [Energy; 4] = [
        ("supply", |at| 1e3 * at.ledger.supply),
        ("Zener", |at| 1e3 * at.ledger.zener),
        ("load", |at| 1e3 * at.ledger.load),
        ("converted", |at| 1e3 * at.ledger.converted()),
    ];
    let energies =
        energies.map(|(name, value)| (name, points(embedded, 0.0, value), thinned(&points(ngspice, 0.0, value))));
    let mut voltages = Panel::new("(a)", "", "voltage (kV)").x_range(from, until).height(150.0).share_x_with_next();
    let shared = sides[0].0 == sides[1].0;
    let names: &[&str] = if shared { &["both membranes"] } else { &["left membrane", "right membrane"] };
    for (k, (name, (line, markers))) in names.iter().zip(&sides).enumerate() {
        voltages = voltages.series(Series::points(format!("{name}, embedded"), line).color(k));
        voltages =
            voltages.series(Series::points(format!("{name}, ngspice"), markers).style(Style::Markers).color(k + 3));
    }
    let mut below = Panel::new("(b)", "time (s)", "difference (mV)").x_range(from, until).height(110.0);
    for (name, line) in ["exponential diodes", "ideal diodes", "ngspice live"].iter().zip(&differences) {
        below = below.series(Series::points(*name, line));
    }
    let mut ledger = Panel::new("(c)", "time (s)", "energy (mJ)").height(150.0);
    for (k, (name, line, markers)) in energies.iter().enumerate() {
        ledger = ledger.series(Series::points(*name, line).color(k));
        ledger = ledger.series(Series::points("", markers).style(Style::Markers).color(k));
    }
    let title = format!("{}: {}", found.scenario.name, found.label);
    let figure = Figure::new(title).panel(voltages).panel(below).panel(ledger).caption(OVERLAY_CAPTION);
    render_svg(&figure)
}

/// Caption of the overlay.
pub const OVERLAY_CAPTION: &str = "(a) Voltages of the membranes by the embedded solver with exponential diodes (lines) and by ngspice \
    in batch (dots) in the last seconds of the run; (b) what the left membrane's voltage differs by from that of ngspice in batch; (c) \
    energies since the start, embedded solver (lines) and ngspice (dots).";

/// Caption of the figure of the sweep.
pub const SWEEP_CAPTION: &str = "Energies of the whole run, embedded solver with ideal diodes (lines) and ngspice (dots): (a) what the \
    mechanics give, converted, and (b) what a user gains, the surplus, over the voltage of release; (c) and (d) the same over the load resistance.";

/// Net gain over voltage of release and load.
pub fn sweep(sweep: &ReleaseSweep) -> Result<String, ReportError> {
    let values: [fn(&SweepPoint) -> f64; 2] = [|point| 1e3 * point.converted, |point| 1e3 * point.surplus];
    let lines =
        |curves: &[SweepCurve], x: fn(f64) -> f64, value: fn(&SweepPoint) -> f64| -> Vec<(String, Points, Points)> {
            let of = |points: &[SweepPoint]| points.iter().map(|point| (x(point.x), value(point))).collect();
            curves.iter().map(|curve| (curve.circuit.clone(), of(&curve.points), of(&curve.witnesses))).collect()
        };
    let voltage = values.map(|value| lines(&sweep.voltage, |x| 1e-3 * x, value));
    let load = values.map(|value| lines(&sweep.load, |x| x, value));
    let names = ["converted energy (mJ)", "surplus (mJ)"];
    let over_voltage = ["(a)", "(b)"].into_iter().zip(names).zip(&voltage);
    let over_load = ["(c)", "(d)"].into_iter().zip(names).zip(&load);
    let mut figure =
        Figure::new("Converted energy and surplus over voltage of release and load").caption(SWEEP_CAPTION);
    for ((title, name), lines) in over_voltage {
        figure = figure.panel(curves(title, "voltage of release (kV)", name, lines));
    }
    for ((title, name), lines) in over_load {
        figure = figure.panel(curves(title, "load resistance (ohm)", name, lines).log_x());
    }
    render_svg(&figure)
}

fn curves<'a>(title: &str, x: &str, y: &str, lines: &'a [(String, Points, Points)]) -> Panel<'a> {
    // The same circuit has the same colour in all panels.
    let colors: &[usize] = if lines.len() == 4 { &[0, 1, 3, 4] } else { &[0, 1, 2, 3, 4, 5] };
    let all = lines.iter().zip(colors).enumerate();
    all.fold(Panel::new(title, x, y).height(150.0), |panel, (index, ((name, line, markers), &color))| {
        let witness = if index == 0 { "dots: ngspice" } else { "" };
        panel
            .series(Series::points(name.clone(), line).color(color))
            .series(Series::points(witness, markers).style(Style::Markers).color(color))
    })
}
