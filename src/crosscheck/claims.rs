//! The circuit asked for, quantity by quantity: by closed form and by every solver.

use videg_circuit::{Ledger, Release, Settings, Topology, formulas};

use super::peaks::{Pulses, charges, largest_deviation, node_capacitances};
use super::{Agreement, Case, Check, Claim, Impact, Solver, Values};
use crate::ngspice::Waveforms;

/// A claim holds up to this, relative: the paper gives its powers in two or three digits.
const CLAIM: f64 = 0.02;
/// What of the energy moved the two ways of booking may disagree on.
const BOOKS: f64 = 1e-4;

/// What was found out about the circuit asked for.
pub struct Findings<'a> {
    /// The mechanics.
    pub case: &'a Case,
    /// The circuit.
    pub settings: &'a Settings,
    /// The circuit by solver.
    pub runs: &'a [(Solver, Waveforms)],
    /// The single pulses, if there are any.
    pub pulses: Option<&'a Pulses>,
    /// By solver, the peak voltage after each of them when nothing lets the charge out, V.
    pub open: &'a [(Solver, Vec<f64>)],
}

/// What is checked of the single pulses on an open circuit.
pub fn pulse_checks(findings: &Findings<'_>) -> Vec<Check> {
    findings.voltages()
}

/// Everything that is checked of the circuit asked for.
pub fn checks(findings: &Findings<'_>) -> Vec<Check> {
    let mut checks = findings.charges();
    checks.extend(findings.energies());
    checks.extend(findings.conversion());
    checks.push(findings.waveforms());
    checks.push(findings.books());
    checks
}

/// A claim about a value of ngspice, relative to the claim or, where that is nothing, to `scale`.
fn hold(says: &str, analytic: f64, values: &Values, scale: f64) -> Option<Claim> {
    let found = values.ngspice_batch?;
    let (says, scale) = if analytic.abs() > 1e-3 * scale {
        (says.to_owned(), analytic.abs())
    } else {
        (format!("{says}, relative to the supply"), scale)
    };
    Some(Claim::new(says, (found - analytic) / scale, CLAIM))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl Findings<'_> {
    /// The waveforms by a solver.
    pub fn run(&self, solver: Solver) -> Option<&Waveforms> {
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

    /// A check of solvers relative to `moved`, and of a claim that comes to nothing relative to `supplied`.
    fn scaled(
        &self,
        name: &str,
        unit: &'static str,
        values: Values,
        [moved, supplied]: [f64; 2],
        claim: Option<(&str, f64)>,
    ) -> Check {
        let leaked = self.in_unit(self.case.leaked_charge(self.settings), unit);
        Check {
            name: name.to_owned(),
            unit,
            analytic: claim.map(|(_, analytic)| analytic),
            values,
            agreement: Agreement::of(&values, Some(moved), leaked),
            claim: claim.and_then(|(says, analytic)| hold(says, analytic, &values, supplied)),
        }
    }

    /// A charge, C, as it is or as the energy, J, that the supply gives with it.
    fn in_unit(&self, charge: f64, unit: &str) -> f64 {
        if unit == "C" { charge } else { charge * self.supply_voltage() }
    }

    /// Smallest scale of deviations of an energy, J, or a charge, C.
    fn least(&self, unit: &str) -> f64 {
        self.in_unit(self.case.least_charge(self.settings), unit)
    }

    /// What differences of energies are relative to, J, by ngspice: the larger of what the supply gives and the load gets,
    /// for solvers; what the supply gives, for claims.
    fn scales(&self) -> [f64; 2] {
        let [supply, load] = self.run(Solver::Batch).map_or([0.0; 2], |waveforms| {
            let ledger = waveforms.ledger();
            [ledger.supply, ledger.load]
        });
        [load, 0.0].map(|load| self.case.energy_scale(self.settings, supply, load))
    }

    /// Sum over the impacts of a closed form of the node's `C_2` and `C_3`.
    fn sum(&self, value: impl Fn(f64, f64) -> f64) -> f64 {
        let form = |impact: &Impact| {
            let [c2, c3] = node_capacitances(self.case, self.topology(), impact);
            value(c2, c3)
        };
        self.case.impacts.iter().map(form).sum()
    }

    /// `U_DE4` of each single pulse.
    fn voltages(&self) -> Vec<Check> {
        let Some(pulses) = self.pulses else { return Vec::new() };
        let open = |solver| self.open.iter().find(|(other, _)| *other == solver).map(|(_, found)| found.as_slice());
        let values = Values::of(|solver| open(solver).map(mean));
        let row = |name: &str, says: &str, topology, agreement| {
            let analytic = pulses.expected(self.case, topology, self.supply_voltage());
            let deviation = open(Solver::Batch).map_or(f64::NAN, |found| largest_deviation(found, &analytic));
            let claim = Some(Claim::new(says, deviation, self.open_circuit_tolerance(pulses)));
            Check { name: name.to_owned(), unit: "V", analytic: Some(mean(&analytic)), values, agreement, claim }
        };
        let pair = |solver: Solver, tolerance| {
            let deviation = largest_deviation(open(solver)?, open(Solver::Batch)?).abs();
            Some(Agreement::new(format!("{} and {}", solver.name(), Solver::Batch.name()), deviation, tolerance))
        };
        let pairs = [pair(Solver::Exponential, 3e-4), pair(Solver::Ideal, 1e-3)];
        let agreement = Agreement::worst(pairs.into_iter().flatten());
        let own = format!("U_DE4, mean of {} pulses", pulses.order.len());
        if self.topology() == Topology::Isolated {
            return vec![row(&own, "U_DE4 by Eq. (12), isolated: U_in C3/C2", Topology::Isolated, agreement)];
        }
        vec![
            row(&own, "U_DE4 on the shared node: U_in (C3+C2)/(2 C2)", Topology::SharedNode, agreement),
            row(
                "the same by Eq. (12) as printed",
                "U_DE4 by Eq. (12) on the shared node: U_in C3/C2",
                Topology::Isolated,
                None,
            ),
        ]
    }

    /// The error of the table, and what the reverse currents of charging and release diode take from the voltage by the
    /// end of the run, relative.
    fn open_circuit_tolerance(&self, pulses: &Pulses) -> f64 {
        let [left, right] = self.case.rest;
        let capacitance = if self.topology() == Topology::Isolated { left.min(right) } else { left + right };
        let leaked = 2.0 * self.settings.diode.saturation_current * pulses.table.until();
        Case::TABLE_ERROR + leaked / (capacitance * self.supply_voltage())
    }

    fn charges(&self) -> Vec<Check> {
        let formula = |c2, c3| formulas::cycle_charge(self.supply_voltage(), c2, c3);
        let each: Vec<f64> = (self.case.impacts.iter())
            .map(|impact| node_capacitances(self.case, self.topology(), impact))
            .map(|[c2, c3]| formula(c2, c3))
            .collect();
        let found = |solver| self.run(solver).map(|waveforms| charges(waveforms, &self.case.impacts));
        let mut rows = Vec::new();
        if each.len() > 1 {
            let expected = &each[..each.len() - 1];
            let values = Values::of(|solver| found(solver).as_deref().map(mean));
            let deviation = found(Solver::Batch).map_or(f64::NAN, |found| largest_deviation(&found, expected));
            rows.push(Check {
                name: "dQ, mean of the impacts".to_owned(),
                unit: "C",
                analytic: Some(mean(expected)),
                values,
                agreement: Agreement::of(&values, None, 0.0),
                claim: Some(Claim::new("every single impact moves dQ = U_in dC", deviation, CLAIM)),
            });
        }
        rows.push(self.row(
            "supply charge",
            "C",
            |ledger| ledger.supply_charge,
            Some(("all impacts together move U_in dC", self.sum(formula))),
        ));
        rows.push(self.row("load charge", "C", |ledger| ledger.load_charge, None));
        rows
    }

    /// A quantity of the books, relative to itself.
    fn row(&self, name: &str, unit: &'static str, value: fn(&Ledger) -> f64, claim: Option<(&str, f64)>) -> Check {
        let values = self.ledgers(value);
        let own = values.ngspice_batch.map_or(0.0, f64::abs).max(self.least(unit));
        self.scaled(name, unit, values, [own; 2], claim)
    }

    /// A difference of energies, relative to the energy moved.
    fn difference(&self, name: &str, value: fn(&Ledger) -> f64, claim: Option<(&str, f64)>) -> Check {
        self.scaled(name, "J", self.ledgers(value), self.scales(), claim)
    }

    fn energies(&self) -> Vec<Check> {
        let supply = self.supply_voltage();
        let eq13 = self.sum(|c2, c3| formulas::eq13_energy(supply, c2, c3));
        let zener = self.settings.circuit.zener_voltage * self.sum(|c2, c3| formulas::cycle_charge(supply, c2, c3));
        let zener = (self.settings.circuit.release == Release::Zener).then_some(("the Zener burns U_z U_in dC", zener));
        vec![
            self.row(
                "supply energy",
                "J",
                |ledger| ledger.supply,
                Some(("the supply gives U_in^2 dC = 2 W", 2.0 * eq13)),
            ),
            self.row("load energy", "J", |ledger| ledger.load, Some(("the load gets W of Eq. (13)", eq13))),
            self.row("Zener energy", "J", |ledger| ledger.zener, zener),
            self.difference("diode energy", |ledger| ledger.diode, None),
            self.difference("change of the stored energy", |ledger| ledger.stored, None),
            self.difference(
                "surplus = load - supply",
                Ledger::surplus,
                Some(("W of Eq. (13) is what a user gains", eq13)),
            ),
        ]
    }

    /// What the mechanics gave, against the closed forms.
    fn conversion(&self) -> Vec<Check> {
        let supply = self.supply_voltage();
        let release = self.settings.circuit.release_voltage();
        let eq13 = self.sum(|c2, c3| formulas::eq13_energy(supply, c2, c3));
        let quick = self.sum(|c2, c3| formulas::release_net_gain(supply, release, c2, c3));
        let slow = self.sum(|c2, c3| formulas::largest_net_gain(supply, c2, c3));
        let converted =
            self.difference("converted", Ledger::converted, Some(("W of Eq. (13) is what the mechanics give", eq13)));
        let mut quickly = self.difference(
            "converted, quick release",
            Ledger::converted,
            Some(("quick release: (C3 U_in - C2 U_r)(U_r - U_in)", quick)),
        );
        let mut slowly =
            self.difference("converted, largest", Ledger::converted, Some(("at most U_in^2 dC^2 / (2 C2)", slow)));
        if let Some(claim) = &mut slowly.claim {
            claim.holds = claim.deviation <= claim.tolerance;
        }
        // The same quantity three times: the solvers need to agree on it but once.
        quickly.agreement = None;
        slowly.agreement = None;
        vec![converted, quickly, slowly]
    }

    /// Voltages of the membranes over the whole run.
    fn waveforms(&self) -> Check {
        let batch = self.run(Solver::Batch);
        let difference = |solver| {
            let [left, right] = self.run(solver)?.voltage_difference(batch?)?;
            Some(if left.is_nan() { left } else { left.max(right) })
        };
        let values = Values::of(|solver| if solver == Solver::Batch { None } else { difference(solver) });
        Check {
            name: "V(de), RMS from ngspice batch".to_owned(),
            unit: "V",
            analytic: None,
            values,
            agreement: Agreement::of_voltages(&values, batch.map_or(0.0, Waveforms::highest_voltage)),
            claim: None,
        }
    }

    /// Each solver's own books: the work on the membranes, summed on a path of its own, is what was converted.
    fn books(&self) -> Check {
        let values = self.ledgers(Ledger::residual);
        let [scale, _] = self.scales();
        let own = |solver: Solver| {
            let residual = values.get(solver)?.abs();
            Some(Agreement::new(format!("two ways to book in {}", solver.name()), residual / scale, BOOKS))
        };
        Check {
            name: "converted - work, two books".to_owned(),
            unit: "J",
            analytic: Some(0.0),
            values,
            agreement: Agreement::worst(Solver::ALL.into_iter().filter_map(own)),
            claim: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cosim::MechanicsSummary;
    use crate::ngspice::CapacitanceTable;
    use videg_circuit::Circuit;

    /// One pulse of the left membrane by 40 %, and the beginning of another.
    fn case() -> Case {
        let time: Vec<f64> = (0..=450).map(|k| f64::from(k) * 1e-3).collect();
        let bump = |t: f64| 1.0 + 0.4 * (std::f64::consts::PI * (t / 0.06).clamp(0.0, 1.0)).sin();
        let left: Vec<f64> = time.iter().map(|&t| 15e-12 * bump(t).max(bump(t - 0.4))).collect();
        let right = vec![15e-12; time.len()];
        let impact = |time| Impact { time, side: 0, ratio: 1.4 };
        let mechanics = MechanicsSummary {
            impacts: 2,
            events: 2,
            average_voltage_gain: 0.0,
            average_power_eq13: 0.0,
            voltage_gain: 0.0,
            energy_eq13: 0.0,
        };
        Case {
            table: CapacitanceTable::new(&time, &left, &right).unwrap(),
            mechanics,
            impacts: vec![impact(0.0), impact(0.4)],
            rest: [15e-12; 2],
            bias_voltage: 2000.0,
            warnings: Vec::new(),
        }
    }

    /// What comes of a capacitor with I = C dV/dt: it keeps its voltage when C changes, as if each change were a start.
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
        let (case, settings) = (case(), Settings::default());
        let runs = Solver::ALL.map(|solver| {
            let right = Waveforms::embedded(&settings.parameters(), &case.table).unwrap();
            (solver, if wrong == Some(solver) { without_v_dc_dt(&settings, &case.table) } else { right })
        });
        let findings = Findings { case: &case, settings: &settings, runs: &runs, pulses: None, open: &[] };
        checks(&findings).into_iter().filter(Check::failed).map(|check| check.name).collect()
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
        let case = case();
        for (topology, expected) in [(Topology::Isolated, 2800.0), (Topology::SharedNode, 2400.0)] {
            let pulses = Pulses::new(&case, topology).unwrap().unwrap();
            assert_eq!(pulses.order, [0]);
            let mut open = Settings::default();
            open.circuit.topology = topology;
            open.circuit.zener_voltage = 1e4;
            let found = Waveforms::embedded(&open.parameters(), &pulses.table).unwrap();
            let [peak] = pulses.peaks(&found)[..] else { panic!("one pulse has one peak") };
            assert!((peak - expected).abs() < 1e-6 * expected, "{topology:?}: {peak}");
            assert!((pulses.expected(&case, topology, 2000.0)[0] - expected).abs() < 1e-9, "{topology:?}");
        }
    }
}
