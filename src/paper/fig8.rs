//! Figure 8(b): one harvesting cycle in the plane of voltage and charge, as drawn in the paper and as circuits go through it.

use videg_circuit::{Ledger, Release, Settings, Topology, formulas};

use super::coupled::{Coupled, circuit};
use super::peak::{self, Peak};
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study, artefact};
use crate::cosim::{CosimError, Observer, Row, TracePoint};
use crate::scenario::Request;
use videg_report::{Figure, Panel, Series, Style, Table};

/// Largest error of C(t) within a communication step, relative to its value.
const TOLERANCE: f64 = 1e-4;
/// How long before and after the largest deflection to look for the ends of the cycle, s: two periods.
const AROUND: f64 = 1.0;

/// The circuits: a slow discharge into the load of the largest net gain of `videg reproduce tuning`, a storage at the voltage
/// that is best for all impacts of the case (docs/theory/circuit.md), and the paper's, which gives no load.
const KINDS: [Kind; 3] = [
    Kind { topology: Topology::Isolated, release: Release::Switch, voltage: 2000.0, load: 3.2e10 },
    Kind { topology: Topology::Isolated, release: Release::Storage, voltage: 2911.0, load: f64::INFINITY },
    Kind { topology: Topology::SharedNode, release: Release::Zener, voltage: 2000.0, load: 1e9 },
];
/// Panels of the picture.
const PANELS: [(Topology, &str); 2] =
    [(Topology::Isolated, "(a) isolated membranes"), (Topology::SharedNode, "(b) the paper's circuit: shared node")];

/// A circuit that goes through the cycle.
struct Kind {
    topology: Topology,
    release: Release,
    /// Of release, V.
    voltage: f64,
    /// ohm
    load: f64,
}

impl Kind {
    fn name(&self) -> String {
        let (voltage, load) = (self.voltage, 1e-9 * self.load);
        match self.release {
            Release::Zener => format!("Zener at {voltage} V, {load} Gohm"),
            Release::Switch => format!("switch at {voltage} V, {load} Gohm"),
            Release::Storage => format!("storage at {voltage} V"),
        }
    }

    fn membranes(&self) -> &'static str {
        match self.topology {
            Topology::Isolated => "isolated membranes",
            Topology::SharedNode => "shared node",
        }
    }

    fn settings(&self) -> Settings {
        let mut settings = circuit(self.topology, self.release, self.voltage, self.load);
        settings.circuit.storage_voltage = self.voltage;
        settings
    }
}

/// U, kV, and Q, nC, of a capacitance, F, at a voltage, V.
fn place(capacitance: f64, voltage: f64) -> (f64, f64) {
    (1e-3 * voltage, 1e9 * capacitance * voltage)
}

/// From the beginning of an impact to that of the next one on the same membrane.
struct Cycle {
    points: Vec<TracePoint>,
    bias_voltage: f64,
    rest_capacitance: f64,
    peak: Peak,
}

/// Makes the picture.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let cycle = Cycle::run(study)?;
    Ok(Artefact {
        findings: findings(&cycle),
        text: text(&cycle),
        tables: vec![table(&cycle)],
        pictures: vec![picture(&cycle)?],
        sheets: vec![sheet(&cycle)],
    })
}

impl Cycle {
    /// That of the impact which makes stage 3 of Table 1.
    fn run(study: &Study<'_>) -> Result<Self, PaperError> {
        let peak = peak::stage_3(study)?;
        let request =
            Request { case: Some(peak::CASE.to_owned()), until: Some(peak.time + AROUND), ..Request::default() };
        let Coupled { master, rest_capacitance, bias_voltage } =
            Coupled::new(study, request, &KINDS.map(|kind| kind.settings()), TOLERANCE)?;
        let mut recorder = CycleRecorder { from: peak.time - AROUND, points: Vec::new() };
        master.run(&mut [&mut recorder])?;
        let points = recorder.points;
        let none = || PaperError::NoCycle { case: peak::CASE, time: peak.time, within: AROUND };
        let deflection = |point: &TracePoint| point.harvester.deflection()[peak.side];
        let is_before = |point: &TracePoint| point.time < peak.time && deflection(point) <= 0.0;
        let begin = points.iter().rposition(is_before).ok_or_else(none)?;
        // Pressed in, let go, and pressed in again.
        let is_after = |point: &TracePoint| point.time > peak.time && deflection(point) <= 0.0;
        let away = points.iter().position(is_after).ok_or_else(none)?;
        let again = points.iter().skip(away).position(|point| deflection(point) > 0.0).ok_or_else(none)?;
        let points = points.into_iter().take(away + again).skip(begin).collect();
        Ok(Self { points, bias_voltage, rest_capacitance: rest_capacitance[peak.side], peak })
    }

    /// Capacitance, F, and voltage, V, in the circuit of this kind, of the membrane that is pressed in.
    fn state(&self, point: &TracePoint, kind: usize) -> (f64, f64) {
        let side = self.peak.side;
        (point.harvester.capacitance()[side], point.circuits[kind].voltage[side])
    }

    /// Energy that a circuit has converted through this membrane, J: - integral of 1/2 `U^2` dC, exact where the
    /// charge or the voltage is kept from point to point.
    fn converted(&self, kind: usize) -> f64 {
        let steps = self.points.windows(2).map(|pair| {
            let [(before, u), (after, v)] = [0, 1].map(|k| self.state(&pair[k], kind));
            0.5 * u * v * (before - after)
        });
        steps.sum()
    }

    /// U, kV, and Q, nC.
    fn place(&self, point: &TracePoint, kind: usize) -> (f64, f64) {
        let (capacitance, voltage) = self.state(point, kind);
        place(capacitance, voltage)
    }

    /// The corners 2, 3 and 4 of the cycle in the paper: U, kV, and Q, nC.
    fn corners(&self) -> [(f64, f64); 3] {
        let (u, c2, c3) = (self.bias_voltage, self.rest_capacitance, self.peak.capacitance);
        [place(c2, u), place(c3, u), place(c2, formulas::peak_voltage(u, c2, c3))]
    }

    /// Energy in the triangle that they make, J, and the most that a cycle can convert; with `idle` capacitances `C_2` beside
    /// the membrane the most is less.
    fn triangle(&self, idle: f64) -> f64 {
        let (c2, c3) = (self.rest_capacitance, self.peak.capacitance);
        formulas::largest_net_gain(self.bias_voltage, c2 + idle * c2, c3 + idle * c2)
    }

    /// W of this impact, J, Eq. (13).
    fn eq13(&self) -> f64 {
        formulas::eq13_energy(self.bias_voltage, self.rest_capacitance, self.peak.capacitance)
    }
}

/// Where the energy went, uJ.
fn table(cycle: &Cycle) -> Table {
    let columns: [Account; 6] = [
        ("by both membranes", Ledger::converted),
        ("from the supply", |ledger| ledger.supply),
        ("into the load", |ledger| ledger.load),
        ("into Zener diodes", |ledger| ledger.zener),
        ("stored more", |ledger| ledger.stored),
        ("net gain", Ledger::surplus),
    ];
    let accounts = columns.iter().map(|(name, _)| format!("{name} (uJ)"));
    let numbers = std::iter::once("converted by this membrane (uJ)".to_owned()).chain(accounts);
    KINDS.iter().enumerate().fold(artefact::table("circuit", numbers), |table, (index, kind)| {
        let over_the_cycle = |account: fn(&Ledger) -> f64| match &cycle.points[..] {
            [first, .., last] => account(&last.circuits[index].ledger) - account(&first.circuits[index].ledger),
            _ => f64::NAN,
        };
        let values = columns.iter().map(|(_, account)| over_the_cycle(*account));
        let cells = std::iter::once(cycle.converted(index)).chain(values).map(|value| format!("{:.2}", 1e6 * value));
        table.row(std::iter::once(format!("{}, {}", kind.membranes(), kind.name())).chain(cells))
    })
}

/// A heading, and what is under it, J.
type Account = (&'static str, fn(&Ledger) -> f64);

/// Notes what happens around the largest deflection.
struct CycleRecorder {
    from: f64,
    points: Vec<TracePoint>,
}

impl Observer for CycleRecorder {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        if row.time >= self.from {
            self.points.push(TracePoint::of(row));
        }
        Ok(())
    }
}

fn findings(cycle: &Cycle) -> Vec<Finding> {
    let finding = |quantity: String, unit: &str, videg: f64| Finding::new("Figure 8(b)", quantity, unit, videg);
    let (eq13, triangle) = (cycle.eq13(), cycle.triangle(0.0));
    let enclosed = finding("the cycle 2-3-4 over W, Eq. (13)".to_owned(), "1", triangle / eq13).reason(format!(
        "{:.2} uJ over {:.2} uJ: it is C3/C2 - 1; W is half of what the supply gives in a cycle, not what the cycle encloses",
        1e6 * triangle,
        1e6 * eq13
    ));
    let of_kind = |(index, kind): (usize, &Kind)| {
        let converted = cycle.converted(index);
        let share = |most: f64| format!("{:.0} %", 1e2 * converted / most);
        let shared = match kind.topology {
            Topology::Isolated => String::new(),
            Topology::SharedNode => {
                format!(", {} of what a shared node can convert at most", share(cycle.triangle(1.0)))
            }
        };
        let reason = format!("{} of the cycle 2-3-4{shared}", share(triangle));
        finding(format!("converted in a cycle, {}", kind.name()), "uJ", 1e6 * converted).reason(reason)
    };
    std::iter::once(enclosed).chain(KINDS.iter().enumerate().map(of_kind)).collect()
}

fn text(cycle: &Cycle) -> Vec<String> {
    let [_, _, (voltage, _)] = cycle.corners();
    vec![
        format!(
            "The membrane that takes the largest impact of {} between {} and {} s, stage 3 of Table 1, from the beginning of \
             that impact to its next. The corners 2, 3 and 4 are those of Table 1: pressed in at U_in it is charged from \
             C2 U_in to C3 U_in, recovering with its charge kept it reaches U_DE4 = {:.0} V, and into the load it goes back \
             along Q = C2 U.",
            peak::CASE,
            peak::WHEN[0],
            peak::WHEN[1],
            1e3 * voltage
        ),
        "What a closed path encloses is converted from the motion. A load that takes the charge slowly, behind a switch at U_in, \
         makes the path nearly the paper's, which ends where the next impact finds it. A storage takes the charge at its own \
         voltage, which is half of the triangle at best. In the paper's circuit the idle membrane lies in parallel, so that half of \
         the triangle is the most, and the load takes the charge while the membrane recovers. What is converted reaches the load, \
         but the Zener burns U_z for each charge, as much as the supply gives: the table has both membranes, the other one's impacts \
         in that time included."
            .to_owned(),
    ]
}

fn picture(cycle: &Cycle) -> Result<Picture, PaperError> {
    let corners = cycle.corners();
    let [second, third, fourth] = corners;
    let ideal = [second, third, fourth, second];
    let paths: Vec<Vec<_>> =
        (0..KINDS.len()).map(|kind| cycle.points.iter().map(|point| cycle.place(point, kind)).collect()).collect();
    let mut figure = Figure::new("Figure 8(b): one harvesting cycle").columns(2).width(960.0);
    for (topology, title) in PANELS {
        let mut panel = Panel::new(title, "voltage of the membrane (kV)", "charge of the membrane (nC)")
            .height(340.0)
            .series(Series::points("2-3-4-2 of the paper", &ideal).style(Style::Dashed).color(6));
        for (color, (kind, path)) in KINDS.iter().zip(&paths).enumerate() {
            if kind.topology == topology {
                panel = panel.series(Series::points(kind.name(), path).color(color));
            }
        }
        figure =
            figure.panel(panel.series(Series::points("2, 3, 4: Table 1", &corners).style(Style::Markers).color(6)));
    }
    let caption = format!(
        "Charge over voltage of a membrane through one cycle, case {}, U_in = {:.0} V. At stage 2 it is at rest, at 3 pressed in \
         the farthest, at 4 recovered with its charge kept. What a path encloses is the energy converted.",
        peak::CASE,
        cycle.bias_voltage
    );
    Picture::new("fig8", &figure, caption)
}

fn sheet(cycle: &Cycle) -> Sheet {
    let of_kinds =
        KINDS.iter().flat_map(|kind| ["voltage (V)", "charge (nC)"].map(|what| format!("{}: {what}", kind.name())));
    let columns = ["time (s)", "capacitance (pF)"].map(str::to_owned).into_iter().chain(of_kinds);
    let row = |point: &TracePoint| {
        let capacitance = point.harvester.capacitance()[cycle.peak.side];
        let places = (0..KINDS.len()).flat_map(|kind| [cycle.state(point, kind).1, cycle.place(point, kind).1]);
        [point.time, 1e12 * capacitance].into_iter().chain(places).collect()
    };
    Sheet::new("fig8", columns, cycle.points.iter().map(row))
}
