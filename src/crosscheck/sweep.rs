//! Net gain over load and voltage of release, by the embedded solver, with ngspice as a witness at a few points.

use serde::Serialize;
use videg_circuit::{Release, Settings, Topology, formulas};

use super::{Agreement, Bench, Case, Check, Repeat, Solver, Stop, Task, Values};
use crate::ngspice::NgspiceError;
use crate::{progress, threads};

/// What a circuit comes to at one point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// Load resistance, ohm, or voltage of release, V.
    pub x: f64,
    /// What the mechanics gave, J.
    pub converted: f64,
    /// What a user gains, J.
    pub surplus: f64,
    /// What the supply gave, J.
    pub supply: f64,
}

/// A circuit over one of its parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// What the circuit is, e.g. `isolated, storage`.
    pub circuit: String,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// By the embedded solver with ideal diodes.
    pub points: Vec<Point>,
    /// By ngspice.
    pub witnesses: Vec<Point>,
}

impl Curve {
    /// The point where the mechanics give most, and where a parabola through it and its neighbours has its top.
    pub fn best(&self) -> Option<(&Point, f64)> {
        let (index, best) =
            self.points.iter().enumerate().max_by(|(_, a), (_, b)| a.converted.total_cmp(&b.converted))?;
        let neighbours =
            index.checked_sub(1).and_then(|before| Some((self.points.get(before)?, self.points.get(index + 1)?)));
        let top = neighbours.map_or(best.x, |(before, after)| {
            let (p, q) = (best.x - before.x, best.x - after.x);
            let (fall_p, fall_q) = (best.converted - before.converted, best.converted - after.converted);
            let curvature = p * fall_q - q * fall_p;
            if curvature > 0.0 { best.x - 0.5 * (p * p * fall_q - q * q * fall_p) / curvature } else { best.x }
        });
        Some((best, top))
    }

    /// ngspice against the embedded solver at the points that both have. Its diodes drop some mV where ideal ones do not.
    fn checks(&self) -> impl Iterator<Item = Check> + '_ {
        const TOLERANCE: f64 = 1e-3;
        let pairs = self.witnesses.iter().filter_map(|b| Some((self.points.iter().find(|a| a.x == b.x)?, b)));
        pairs.map(|(a, b)| {
            let between = format!("{} and {}", Solver::Ideal.name(), Solver::Batch.name());
            let deviation = (a.converted - b.converted).abs() / b.supply.abs().max(a.supply.abs());
            Check {
                name: format!("{}, {} = {:.6}: converted", self.circuit, self.parameter, b.x),
                unit: "J",
                analytic: None,
                values: Values {
                    embedded_ideal: Some(a.converted),
                    ngspice_batch: Some(b.converted),
                    ..Values::default()
                },
                agreement: Some(Agreement::new(between, deviation, TOLERANCE)),
                claim: None,
            }
        })
    }
}

/// The sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// Over the voltage of release, of six circuits: shared node and isolated, Zener, switch and storage.
    pub voltage: Vec<Curve>,
    /// Over the load resistance, of the four that have one.
    pub load: Vec<Curve>,
    /// `(U_in / 2) (C_3 / C_2 + 1)` on the shared node and with isolated membranes, V, for the `C_3` / `C_2` that
    /// [`formulas::best_release_ratio`] takes from the impacts.
    pub predicted: [f64; 2],
    /// Points at which ngspice stopped: they have no witness.
    #[serde(skip)]
    pub stops: Vec<Stop>,
    /// Points that it got to with changes.
    #[serde(skip)]
    pub repeats: Vec<Repeat>,
}

/// What a run at a point comes to.
struct Visit {
    point: Point,
    stop: Option<Stop>,
    repeats: Vec<Repeat>,
}

const TOPOLOGIES: [(Topology, &str); 2] = [(Topology::SharedNode, "shared node"), (Topology::Isolated, "isolated")];
const RELEASES: [(Release, &str); 3] =
    [(Release::Zener, "Zener"), (Release::Switch, "switch"), (Release::Storage, "storage")];

/// Points of a curve over the voltage, and of one over the load.
const VOLTAGES: u32 = 25;
const LOADS: u32 = 21;
/// Load resistances, powers of ten of an ohm.
const LOAD_DECADES: [f64; 2] = [7.0, 12.0];

/// A curve to come: the circuit, its parameter, how to set that, and where.
struct Plan {
    circuit: String,
    parameter: &'static str,
    settings: Settings,
    set: fn(&mut Settings, f64),
    xs: Vec<f64>,
    witnesses: Vec<f64>,
}

impl Sweep {
    /// Sweeps around `settings` on the C(t) of `case`.
    ///
    /// # Errors
    /// What a solver says.
    pub fn new(
        bench: &Bench<'_>,
        case: &Case,
        settings: &Settings,
        observer: &dyn progress::Progress,
    ) -> Result<Self, NgspiceError> {
        let supply = settings.circuit.supply_voltage;
        let predicted =
            [1.0, 0.0].map(|idle| formulas::best_release_voltage(supply, 1.0 + idle, case.best_ratio() + idle));
        let plans: Vec<Plan> = over_voltage(case, settings, predicted).chain(over_load(settings)).collect();
        let tasks: Vec<_> = plans.iter().flat_map(|plan| plan.tasks(bench)).collect();
        let results = threads::run(&tasks, observer)?;
        drop(tasks);
        let mut results = results.into_iter();
        let (mut stops, mut repeats) = (Vec::new(), Vec::new());
        let mut whole = |visit: Visit| {
            repeats.extend(visit.repeats);
            let is_whole = visit.stop.is_none();
            stops.extend(visit.stop);
            is_whole.then_some(visit.point)
        };
        let mut curves = plans.into_iter().map(|plan| {
            let points = results.by_ref().take(plan.xs.len()).filter_map(&mut whole).collect();
            let witnesses = results.by_ref().take(plan.witnesses.len()).filter_map(&mut whole).collect();
            Curve { circuit: plan.circuit, parameter: plan.parameter, points, witnesses }
        });
        let voltage = curves.by_ref().take(TOPOLOGIES.len() * RELEASES.len()).collect();
        let load = curves.collect();
        Ok(Self { voltage, load, predicted, stops, repeats })
    }
}

impl Sweep {
    /// ngspice against the embedded solver, point by point.
    pub fn checks(&self) -> Vec<Check> {
        self.voltage.iter().chain(&self.load).flat_map(Curve::checks).collect()
    }
}

/// `xs` and those that ngspice is asked for, in order.
fn with_witnesses(xs: impl Iterator<Item = f64>, witnesses: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = xs.chain(witnesses.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

impl Plan {
    fn tasks<'a>(&'a self, bench: &'a Bench<'a>) -> impl Iterator<Item = Task<'a, Visit>> {
        let embedded = self.xs.iter().map(|&x| (x, Solver::Ideal));
        let witnesses = self.witnesses.iter().map(|&x| (x, Solver::Batch));
        embedded.chain(witnesses).map(move |(x, solver)| {
            let mut settings = self.settings;
            (self.set)(&mut settings, x);
            let name = format!("{} in {}", self.circuit, solver.name());
            Task::new(name.clone(), move |progress| {
                let outcome = bench.run(solver, &settings, progress)?;
                let ledger = outcome.waveforms.ledger();
                let (converted, surplus) = (ledger.converted(), ledger.surplus());
                let open = vec![format!("the point {} = {x:.6} of the sweep", self.parameter)];
                Ok(Visit {
                    point: Point { x, converted, surplus, supply: ledger.supply },
                    stop: Stop::of(&name, &outcome, bench.table.until(), open),
                    repeats: Repeat::of(&name, &outcome).collect(),
                })
            })
        })
    }
}

/// From `U_in` to beyond the largest `U_DE4`; ngspice where the most is predicted.
fn over_voltage<'a>(case: &'a Case, settings: &'a Settings, predicted: [f64; 2]) -> impl Iterator<Item = Plan> + 'a {
    let supply = settings.circuit.supply_voltage;
    let largest = case.impacts.iter().map(|impact| impact.ratio).fold(1.0, f64::max);
    circuits(settings).map(move |(circuit, settings)| {
        let shared = settings.circuit.topology == Topology::SharedNode;
        let idle = if shared { 1.0 } else { 0.0 };
        let span = formulas::peak_voltage(supply, 1.0 + idle, largest + idle) - supply;
        let part = |k: u32| f64::from(k) / f64::from(VOLTAGES - 1);
        let witnesses = vec![predicted[usize::from(!shared)]];
        let xs = with_witnesses((0..VOLTAGES).map(|k| supply + 1.05 * span * part(k)), &witnesses);
        let set = |settings: &mut Settings, voltage| {
            settings.circuit.zener_voltage = voltage;
            settings.circuit.storage_voltage = voltage;
        };
        Plan { circuit, parameter: "release voltage", settings, set, xs, witnesses }
    })
}

/// From a quick to a slow release; ngspice at the load asked for.
fn over_load(settings: &Settings) -> impl Iterator<Item = Plan> {
    let asked = settings.circuit.load_resistance;
    circuits(settings).filter(|(_, settings)| settings.circuit.release != Release::Storage).map(
        move |(circuit, settings)| {
            let [from, to] = LOAD_DECADES;
            let exponent = |k: u32| from + (to - from) * f64::from(k) / f64::from(LOADS - 1);
            let witnesses = vec![asked];
            let xs = with_witnesses((0..LOADS).map(|k| 10.0_f64.powf(exponent(k))), &witnesses);
            let set = |settings: &mut Settings, resistance| settings.circuit.load_resistance = resistance;
            Plan { circuit, parameter: "load resistance", settings, set, xs, witnesses }
        },
    )
}

fn circuits(settings: &Settings) -> impl Iterator<Item = (String, Settings)> {
    let base = *settings;
    TOPOLOGIES.into_iter().flat_map(move |(topology, node)| {
        RELEASES.into_iter().map(move |(release, element)| {
            let mut settings = base;
            settings.circuit.topology = topology;
            settings.circuit.release = release;
            (format!("{node}, {element}"), settings)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_a_parabola_is_found_between_uneven_points() {
        let at = |x: f64| Point { x, converted: 5.0 - (x - 2.3) * (x - 2.3), surplus: 0.0, supply: 1.0 };
        let curve = Curve {
            circuit: String::new(),
            parameter: "x",
            points: [0.0, 1.0, 2.0, 3.5, 4.0].map(at).to_vec(),
            witnesses: Vec::new(),
        };
        let (best, top) = curve.best().unwrap();
        assert_eq!(best.x, 2.0);
        assert!((top - 2.3).abs() < 1e-12, "{top}");
    }
}
