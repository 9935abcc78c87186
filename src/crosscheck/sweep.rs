//! Net gain over load and voltage of release, by the embedded solver, and by ngspice at a few points.

use serde::Serialize;
use videg_circuit::{Release, Settings, Topology, formulas};

use super::check::{Agreement, IDEAL_DIODES, QuantityCheck, Values};
use super::mechanics::MechanicalRun;
use super::solver::Solver;
use super::solvers::{Job, JobResult, Solvers};
use super::stop::{Repeat, Stop};
use crate::ngspice::NgspiceError;
use crate::progress::Progress;

/// Energies of a circuit at one point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SweepPoint {
    /// Load resistance, ohm, or voltage of release, V.
    pub x: f64,
    /// Energy from the mechanics, J.
    pub converted: f64,
    /// What a user gains, J.
    pub surplus: f64,
    /// Energy from the supply, J.
    pub supply: f64,
}

/// A circuit over one of its parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepCurve {
    /// Name of the circuit, e.g. `isolated, storage`.
    pub circuit: String,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// By the embedded solver with ideal diodes.
    pub points: Vec<SweepPoint>,
    /// By ngspice.
    pub witnesses: Vec<SweepPoint>,
}

impl SweepCurve {
    /// The point of the largest converted energy, and the top of the parabola through it and its neighbours.
    pub fn best(&self) -> Option<(&SweepPoint, f64)> {
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

    /// ngspice against the embedded solver at the points that both have.
    fn checks(&self) -> impl Iterator<Item = QuantityCheck> + '_ {
        let pairs = self.witnesses.iter().filter_map(|b| Some((self.points.iter().find(|a| a.x == b.x)?, b)));
        pairs.map(|(a, b)| {
            let deviation = (a.converted - b.converted).abs() / b.supply.abs().max(a.supply.abs());
            let name = format!("{}, {} = {:.6}: converted", self.circuit, self.parameter, b.x);
            let values = Values::by([(Solver::Ideal, a.converted), (Solver::Batch, b.converted)]);
            QuantityCheck {
                agreement: Some(Agreement::between(Solver::Ideal, Solver::Batch, deviation, IDEAL_DIODES)),
                ..QuantityCheck::new(name, "J", values)
            }
        })
    }
}

/// The sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReleaseSweep {
    /// Over the voltage of release, of six circuits: shared node and isolated, Zener, switch and storage.
    pub voltage: Vec<SweepCurve>,
    /// Over the load resistance, of the four that have one.
    pub load: Vec<SweepCurve>,
    /// `(U_in / 2) (C_3 / C_2 + 1)` on the shared node and with isolated membranes, V, for the `C_3` / `C_2` that
    /// [`formulas::best_release_ratio`] takes from the impacts.
    pub predicted: [f64; 2],
    /// Points at which ngspice stopped, which are left out.
    #[serde(skip)]
    pub stops: Vec<Stop>,
    /// Points at which ngspice was repeated with changes.
    #[serde(skip)]
    pub repeats: Vec<Repeat>,
}

const TOPOLOGIES: [(Topology, &str); 2] = [(Topology::SharedNode, "shared node"), (Topology::Isolated, "isolated")];
const RELEASES: [(Release, &str); 3] =
    [(Release::Zener, "Zener"), (Release::Switch, "switch"), (Release::Storage, "storage")];

/// Points of a curve over the voltage, and of one over the load.
const VOLTAGES: u32 = 25;
const LOADS: u32 = 21;
/// Load resistances, powers of ten of an ohm.
const LOAD_DECADES: [f64; 2] = [7.0, 12.0];

/// A curve to be computed: the circuit, its parameter, and the values of that, one of them by ngspice, too.
struct Plan {
    circuit: String,
    parameter: &'static str,
    settings: Settings,
    set: fn(&mut Settings, f64),
    xs: Vec<f64>,
    witness: f64,
}

impl ReleaseSweep {
    /// Sweeps around `settings` on the C(t) of `mechanics`.
    pub(super) fn new(
        solvers: &Solvers<'_>,
        mechanics: &MechanicalRun,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self, NgspiceError> {
        let (supply, ratio) = (settings.circuit.supply_voltage, mechanics.best_ratio());
        let predicted = [1.0, 0.0].map(|idle| formulas::best_release_voltage(supply, 1.0 + idle, ratio + idle));
        let plans: Vec<Plan> = over_voltage(mechanics, settings, predicted).chain(over_load(settings)).collect();
        let jobs = plans.iter().flat_map(|plan| plan.jobs(mechanics)).collect();
        let mut results = solvers.run_all(jobs, progress)?.into_iter();
        let (mut stops, mut repeats) = (Vec::new(), Vec::new());
        let mut points = |xs: &[f64]| {
            let point = |(&x, result): (&f64, JobResult)| {
                repeats.extend(result.repeats);
                let ledger = result.waveforms.ledger();
                let (converted, surplus) = (ledger.converted(), ledger.surplus());
                let is_complete = result.stop.is_none();
                stops.extend(result.stop);
                is_complete.then_some(SweepPoint { x, converted, surplus, supply: ledger.supply })
            };
            xs.iter().zip(results.by_ref()).filter_map(point).collect()
        };
        let curve = |plan: Plan| {
            let (points, witnesses) = (points(&plan.xs), points(&[plan.witness]));
            SweepCurve { circuit: plan.circuit, parameter: plan.parameter, points, witnesses }
        };
        let mut voltage: Vec<_> = plans.into_iter().map(curve).collect();
        let load = voltage.split_off(TOPOLOGIES.len() * RELEASES.len());
        Ok(Self { voltage, load, predicted, stops, repeats })
    }

    /// ngspice against the embedded solver, point by point.
    pub fn checks(&self) -> Vec<QuantityCheck> {
        self.voltage.iter().chain(&self.load).flat_map(SweepCurve::checks).collect()
    }
}

impl Plan {
    fn jobs<'a>(&self, mechanics: &'a MechanicalRun) -> impl Iterator<Item = Job<'a>> {
        let embedded = self.xs.iter().map(|&x| (x, Solver::Ideal));
        embedded.chain([(self.witness, Solver::Batch)]).map(|(x, solver)| {
            let mut settings = self.settings;
            (self.set)(&mut settings, x);
            let name = format!("{} in {}", self.circuit, solver.name());
            let open = vec![format!("the point {} = {x:.6} of the sweep", self.parameter)];
            Job { name, solver, settings, table: &mechanics.table, open, last_row: true }
        })
    }
}

/// `xs` and `witness`, in order.
fn with(xs: impl Iterator<Item = f64>, witness: f64) -> Vec<f64> {
    let mut all: Vec<f64> = xs.chain([witness]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// From `U_in` to beyond the largest `U_DE4`; ngspice at the predicted optimum.
fn over_voltage(
    mechanics: &MechanicalRun,
    settings: &Settings,
    [shared, isolated]: [f64; 2],
) -> impl Iterator<Item = Plan> {
    let (supply, largest) = (settings.circuit.supply_voltage, mechanics.largest_ratio());
    circuits(settings).map(move |(circuit, settings)| {
        let (idle, witness) =
            if settings.circuit.topology == Topology::SharedNode { (1.0, shared) } else { (0.0, isolated) };
        let span = formulas::peak_voltage(supply, 1.0 + idle, largest + idle) - supply;
        let part = |k: u32| f64::from(k) / f64::from(VOLTAGES - 1);
        let xs = with((0..VOLTAGES).map(|k| supply + 1.05 * span * part(k)), witness);
        let set = |settings: &mut Settings, voltage| {
            settings.circuit.zener_voltage = voltage;
            settings.circuit.storage_voltage = voltage;
        };
        Plan { circuit, parameter: "release voltage", settings, set, xs, witness }
    })
}

/// From a quick to a slow release; ngspice at the load asked for.
fn over_load(settings: &Settings) -> impl Iterator<Item = Plan> {
    let [from, to] = LOAD_DECADES;
    let exponent = move |k: u32| from + (to - from) * f64::from(k) / f64::from(LOADS - 1);
    let witness = settings.circuit.load_resistance;
    let loaded = circuits(settings).filter(|(_, settings)| settings.circuit.release != Release::Storage);
    loaded.map(move |(circuit, settings)| {
        let xs = with((0..LOADS).map(|k| 10.0_f64.powf(exponent(k))), witness);
        let set = |settings: &mut Settings, resistance| settings.circuit.load_resistance = resistance;
        Plan { circuit, parameter: "load resistance", settings, set, xs, witness }
    })
}

fn circuits(settings: &Settings) -> impl Iterator<Item = (String, Settings)> + use<> {
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
        let at = |x: f64| SweepPoint { x, converted: 5.0 - (x - 2.3) * (x - 2.3), surplus: 0.0, supply: 1.0 };
        let curve = SweepCurve {
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
