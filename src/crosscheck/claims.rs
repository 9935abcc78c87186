//! The circuit asked for, quantity by quantity: by closed form and by every solver.

use videg_circuit::{Ledger, Release, Settings, Topology, formulas};

use super::check::{Agreement, Claim, IDEAL_DIODES, QuantityCheck, SAME_DIODES, Values};
use super::mechanics::MechanicalRun;
use super::pulses::{Pulses, charges, largest_deviation};
use super::solver::Solver;
use crate::ngspice::Waveforms;

/// Results of the circuit asked for.
pub struct Findings<'a> {
    /// The mechanics.
    pub mechanics: &'a MechanicalRun,
    /// The circuit.
    pub settings: &'a Settings,
    /// The circuit by solver.
    pub runs: &'a [(Solver, Waveforms)],
    /// The single pulses, if there are any.
    pub pulses: Option<&'a Pulses>,
    /// By solver, the peak voltage after each of them on an open circuit, V.
    pub open: &'a [(Solver, Vec<f64>)],
}

/// The scales of deviations: for solvers, and for claims whose closed form is 0.
type Scales = [f64; 2];

/// A claim about a value of ngspice, relative to the closed form or, where that is nothing, to `scale`.
fn claim(says: &str, analytic: f64, values: &Values, scale: f64) -> Option<Claim> {
    let found = values.get(Solver::Batch)?;
    let (says, scale) = if analytic.abs() > 1e-3 * scale {
        (says.to_owned(), analytic.abs())
    } else {
        (format!("{says}, relative to the supply"), scale)
    };
    Some(Claim::new(says, (found - analytic) / scale, Claim::TOLERANCE))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl Findings<'_> {
    /// All checks but those of the single pulses.
    pub fn checks(&self) -> Vec<QuantityCheck> {
        let mut checks = self.charges();
        checks.extend(self.energies());
        checks.extend(self.conversion());
        checks.extend([self.waveforms(), self.work()]);
        checks
    }

    fn run(&self, solver: Solver) -> Option<&Waveforms> {
        self.runs.iter().find(|(other, _)| *other == solver).map(|(_, waveforms)| waveforms)
    }

    fn ledgers(&self, value: impl Fn(&Ledger) -> f64) -> Values {
        Values::of(|solver| self.run(solver).map(|waveforms| value(&waveforms.ledger())))
    }

    fn supply_voltage(&self) -> f64 {
        self.settings.circuit.supply_voltage
    }

    fn topology(&self) -> Topology {
        self.settings.circuit.topology
    }

    /// Sum over the impacts of a closed form of the node's `C_2` and `C_3`.
    fn sum(&self, closed_form: impl Fn(f64, f64) -> f64) -> f64 {
        self.mechanics.sum(self.topology(), closed_form)
    }

    fn scaled(
        &self,
        name: &str,
        unit: &'static str,
        values: Values,
        [moved, supplied]: Scales,
        closed_form: Option<(&str, f64)>,
    ) -> QuantityCheck {
        let leaked = self.in_unit(self.mechanics.leaked_charge(self.settings), unit);
        QuantityCheck {
            analytic: closed_form.map(|(_, analytic)| analytic),
            agreement: Agreement::of(&values, Some(moved), leaked),
            claim: closed_form.and_then(|(says, analytic)| claim(says, analytic, &values, supplied)),
            ..QuantityCheck::new(name, unit, values)
        }
    }

    /// A charge, C, as it is or as the energy, J, that the supply gives with it.
    fn in_unit(&self, charge: f64, unit: &str) -> f64 {
        if unit == "C" { charge } else { charge * self.supply_voltage() }
    }

    /// Scales of differences of energies, J, by ngspice: the larger of the energies from the supply and to the load, and the
    /// energy from the supply.
    fn scales(&self) -> Scales {
        let ledger = self.run(Solver::Batch).map_or_else(Ledger::default, Waveforms::ledger);
        [ledger.load, 0.0].map(|load| self.mechanics.energy_scale(self.settings, ledger.supply, load))
    }

    /// `U_DE4` of each single pulse on an open circuit.
    pub fn pulse_checks(&self) -> Vec<QuantityCheck> {
        let Some(pulses) = self.pulses else { return Vec::new() };
        let open = |solver| self.open.iter().find(|(other, _)| *other == solver).map(|(_, found)| found.as_slice());
        let values = Values::of(|solver| open(solver).map(mean));
        let check = |name: &str, says: &str, topology, agreement| {
            let analytic = pulses.expected(self.mechanics, topology, self.supply_voltage());
            let deviation = open(Solver::Batch).map_or(f64::NAN, |found| largest_deviation(found, &analytic));
            let claim = Some(Claim::new(says, deviation, self.open_circuit_tolerance(pulses)));
            QuantityCheck { analytic: Some(mean(&analytic)), agreement, claim, ..QuantityCheck::new(name, "V", values) }
        };
        let pair = |(solver, tolerance)| {
            let deviation = largest_deviation(open(solver)?, open(Solver::Batch)?).abs();
            Some(Agreement::between(solver, Solver::Batch, deviation, tolerance))
        };
        let pairs = [(Solver::Exponential, SAME_DIODES), (Solver::Ideal, IDEAL_DIODES)];
        let agreement = Agreement::worst(pairs.into_iter().filter_map(pair));
        let name = format!("U_DE4, mean of {} pulses", pulses.order.len());
        if self.topology() == Topology::Isolated {
            return vec![check(&name, "U_DE4 by Eq. (12), isolated: U_in C3/C2", Topology::Isolated, agreement)];
        }
        let printed = "U_DE4 by Eq. (12) on the shared node: U_in C3/C2";
        vec![
            check(&name, "U_DE4 on the shared node: U_in (C3+C2)/(2 C2)", Topology::SharedNode, agreement),
            check("the same by Eq. (12) as printed", printed, Topology::Isolated, None),
        ]
    }

    /// The error of the table, and what the reverse currents of charging and release diode take from the voltage by the
    /// end of the run, relative.
    fn open_circuit_tolerance(&self, pulses: &Pulses) -> f64 {
        let [left, right] = self.mechanics.rest;
        let capacitance = if self.topology() == Topology::Isolated { left.min(right) } else { left + right };
        let leaked = 2.0 * self.settings.diode.saturation_current * pulses.table.until();
        MechanicalRun::TABLE_ERROR + leaked / (capacitance * self.supply_voltage())
    }

    fn charges(&self) -> Vec<QuantityCheck> {
        let (impacts, topology) = (&self.mechanics.impacts, self.topology());
        let formula = |c2, c3| formulas::cycle_charge(self.supply_voltage(), c2, c3);
        let mut checks = Vec::new();
        // Not of the last impact, whose charge the run may not hold.
        if let Some((_, complete @ [_, ..])) = impacts.split_last() {
            let capacitances = complete.iter().map(|impact| self.mechanics.node_capacitances(topology, impact));
            let expected: Vec<_> = capacitances.map(|[c2, c3]| formula(c2, c3)).collect();
            let found = |solver| self.run(solver).map(|waveforms| charges(waveforms, impacts));
            let values = Values::of(|solver| found(solver).as_deref().map(mean));
            let deviation = found(Solver::Batch).map_or(f64::NAN, |found| largest_deviation(&found, &expected));
            let says = "every single impact moves dQ = U_in dC";
            checks.push(QuantityCheck {
                analytic: Some(mean(&expected)),
                agreement: Agreement::of(&values, None, 0.0),
                claim: Some(Claim::new(says, deviation, Claim::TOLERANCE)),
                ..QuantityCheck::new("dQ, mean of the impacts", "C", values)
            });
        }
        let all = ("all impacts together move U_in dC", self.sum(formula));
        checks.push(self.total("supply charge", "C", |ledger| ledger.supply_charge, Some(all)));
        checks.push(self.total("load charge", "C", |ledger| ledger.load_charge, None));
        checks
    }

    /// A total of the run, relative to itself.
    fn total(
        &self,
        name: &str,
        unit: &'static str,
        value: fn(&Ledger) -> f64,
        closed_form: Option<(&str, f64)>,
    ) -> QuantityCheck {
        let values = self.ledgers(value);
        let least = self.in_unit(self.mechanics.least_charge(self.settings), unit);
        let scale = values.get(Solver::Batch).map_or(0.0, f64::abs).max(least);
        self.scaled(name, unit, values, [scale; 2], closed_form)
    }

    /// A difference of energies, relative to the energy moved.
    fn difference(&self, name: &str, value: fn(&Ledger) -> f64, closed_form: Option<(&str, f64)>) -> QuantityCheck {
        self.scaled(name, "J", self.ledgers(value), self.scales(), closed_form)
    }

    fn energies(&self) -> Vec<QuantityCheck> {
        let supply = self.supply_voltage();
        let eq13 = self.sum(|c2, c3| formulas::eq13_energy(supply, c2, c3));
        let zener = self.settings.circuit.zener_voltage * self.sum(|c2, c3| formulas::cycle_charge(supply, c2, c3));
        let zener = (self.settings.circuit.release == Release::Zener).then_some(("the Zener burns U_z U_in dC", zener));
        let supplied = ("the supply gives U_in^2 dC = 2 W", 2.0 * eq13);
        let gain = ("W of Eq. (13) is what a user gains", eq13);
        let mut checks = vec![
            self.total("supply energy", "J", |ledger| ledger.supply, Some(supplied)),
            self.total("load energy", "J", |ledger| ledger.load, Some(("the load gets W of Eq. (13)", eq13))),
            self.total("Zener energy", "J", |ledger| ledger.zener, zener),
            self.difference("diode energy", |ledger| ledger.diode, None),
            self.difference("change of the stored energy", |ledger| ledger.stored, None),
            self.difference("surplus = load - supply", Ledger::surplus, Some(gain)),
        ];
        if self.settings.circuit.leaks() {
            checks.push(self.total("leakage energy", "J", |ledger| ledger.leakage, None));
        }
        checks
    }

    /// The energy from the mechanics, against the closed forms.
    fn conversion(&self) -> [QuantityCheck; 3] {
        let (supply, release) = (self.supply_voltage(), self.settings.circuit.release_voltage());
        let converted =
            |name: &str, says: &str, analytic| self.difference(name, Ledger::converted, Some((says, analytic)));
        let eq13 = self.sum(|c2, c3| formulas::eq13_energy(supply, c2, c3));
        let quick = self.sum(|c2, c3| formulas::release_net_gain(supply, release, c2, c3));
        let slow = self.sum(|c2, c3| formulas::largest_net_gain(supply, c2, c3));
        let mut checks = [
            converted("converted", "W of Eq. (13) is what the mechanics give", eq13),
            converted("converted, quick release", "quick release: (C3 U_in - C2 U_r)(U_r - U_in)", quick),
            converted("converted, largest", "at most U_in^2 dC^2 / (2 C2)", slow),
        ];
        if let Some(claim) = &mut checks[2].claim {
            claim.holds = claim.deviation <= claim.tolerance;
        }
        // The same quantity three times: one comparison of the solvers is enough.
        checks[1].agreement = None;
        checks[2].agreement = None;
        checks
    }

    /// Voltages of the membranes over the whole run.
    fn waveforms(&self) -> QuantityCheck {
        let batch = self.run(Solver::Batch);
        let difference = |solver| {
            let [left, right] = self.run(solver)?.voltage_difference(batch?)?;
            Some(if left.is_nan() { left } else { left.max(right) })
        };
        let values = Values::of(|solver| if solver == Solver::Batch { None } else { difference(solver) });
        let highest = batch.map_or(0.0, Waveforms::highest_voltage);
        let agreement = Agreement::of_voltages(&values, highest);
        QuantityCheck { agreement, ..QuantityCheck::new("V(de), RMS from ngspice batch", "V", values) }
    }

    /// The energy balance of each solver: the work on the membranes, summed independently, equals the converted energy.
    fn work(&self) -> QuantityCheck {
        /// Relative to the energy moved.
        const TOLERANCE: f64 = 1e-4;
        let values = self.ledgers(Ledger::residual);
        let [scale, _] = self.scales();
        let balance = |solver: Solver| {
            let residual = values.get(solver)?.abs();
            Some(Agreement::new(format!("two ways to book in {}", solver.name()), residual / scale, TOLERANCE))
        };
        QuantityCheck {
            analytic: Some(0.0),
            agreement: Agreement::worst(Solver::ALL.into_iter().filter_map(balance)),
            ..QuantityCheck::new("converted - work, two books", "J", values)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cosim::{MechanicsSummary, MembraneImpact};
    use crate::ngspice::CapacitanceTable;
    use videg_circuit::Circuit;

    /// One pulse of the left membrane by 40 %, and the beginning of another.
    fn mechanics() -> MechanicalRun {
        let time: Vec<f64> = (0..=450).map(|k| f64::from(k) * 1e-3).collect();
        let bump = |t: f64| 1.0 + 0.4 * (std::f64::consts::PI * (t / 0.06).clamp(0.0, 1.0)).sin();
        let left: Vec<f64> = time.iter().map(|&t| 15e-12 * bump(t).max(bump(t - 0.4))).collect();
        let right = vec![15e-12; time.len()];
        let impact = |time| MembraneImpact { time, side: 0, ratio: 1.4 };
        let summary = MechanicsSummary { impacts: 2, events: 2, ..MechanicsSummary::default() };
        MechanicalRun {
            table: CapacitanceTable::new(&time, &left, &right).unwrap(),
            summary,
            impacts: vec![impact(0.0), impact(0.4)],
            rest: [15e-12; 2],
            bias_voltage: 2000.0,
            warnings: Vec::new(),
        }
    }

    /// A capacitor with I = C dV/dt: it keeps its voltage when C changes, as if each change were a start.
    fn without_v_dc_dt(settings: &Settings, table: &CapacitanceTable) -> Waveforms {
        let mut found = Waveforms::embedded(&settings.parameters(), table).unwrap();
        let idle = Circuit::new(settings.parameters(), table.initial()).unwrap();
        for sample in &mut found.samples {
            sample.voltage = idle.voltage();
            sample.ledger = idle.ledger();
        }
        found
    }

    fn failures(wrong: Option<Solver>) -> Vec<String> {
        let (mechanics, settings) = (mechanics(), Settings::default());
        let runs = Solver::ALL.map(|solver| {
            let right = Waveforms::embedded(&settings.parameters(), &mechanics.table).unwrap();
            (solver, if wrong == Some(solver) { without_v_dc_dt(&settings, &mechanics.table) } else { right })
        });
        let findings = Findings { mechanics: &mechanics, settings: &settings, runs: &runs, pulses: None, open: &[] };
        findings.checks().into_iter().filter(QuantityCheck::failed).map(|check| check.name).collect()
    }

    #[test]
    fn a_capacitor_that_loses_v_dc_dt_fails_whichever_solver_has_it() {
        assert_eq!(failures(None), Vec::<String>::new());
        for solver in Solver::ALL {
            let failed = failures(Some(solver));
            for name in ["supply energy", "load energy", "V(de), RMS from ngspice batch"] {
                assert!(failed.iter().any(|other| other == name), "{solver:?}: {name} is not among {failed:?}");
            }
        }
    }

    #[test]
    fn a_pulse_on_an_open_circuit_reaches_its_own_peak_voltage() {
        let mechanics = mechanics();
        for (topology, expected) in [(Topology::Isolated, 2800.0), (Topology::SharedNode, 2400.0)] {
            let pulses = Pulses::new(&mechanics, topology).unwrap().unwrap();
            assert_eq!(pulses.order, [0]);
            let mut open = Settings::default();
            open.circuit.topology = topology;
            open.circuit.zener_voltage = 1e4;
            let found = Waveforms::embedded(&open.parameters(), &pulses.table).unwrap();
            let [peak] = pulses.peaks(&found)[..] else { panic!("one pulse has one peak") };
            assert!((peak - expected).abs() < 1e-6 * expected, "{topology:?}: {peak}");
            assert!((pulses.expected(&mechanics, topology, 2000.0)[0] - expected).abs() < 1e-9, "{topology:?}");
        }
    }
}
