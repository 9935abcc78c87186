//! ngspice and the embedded solver on the same C(t): two programs that share nothing but the problem.
//!
//! Without ngspice these tests are skipped, but not by `./test.sh`, which sets `VIDEG_ALL_TOOLS`.

#![allow(clippy::unwrap_used)]

#[path = "../support/extent.rs"]
mod extent;
#[cfg(unix)]
mod live;

use std::fmt::Debug;

use extent::extent;
use fmu_import::Fmu;
use videg::cosim::HarvesterFmu;
use videg::ngspice::{CapacitanceTable, CapacitorTest, Elements, Ngspice, Run, SolverRun, Waveforms};
use videg::package::{Options, build_all};
use videg::scenario::{Request, Scenario};
use videg_circuit::{Diodes, Parameters, Release, Topology};

const TOPOLOGIES: [Topology; 2] = [Topology::SharedNode, Topology::Isolated];

/// What two integrators of the same equations may differ by.
const SAME_DIODES: f64 = 1e-4;

/// What ngspice's diodes cost against ideal ones: they drop N Vt ln(I / IS), 4 mV at 1 uA, of the 30 V and more that a
/// load of 100 Mohm and more sees, in energies twice that.
const NEAR_IDEAL: f64 = 3e-4;

fn ngspice() -> Option<Ngspice> {
    let found = Ngspice::find(None);
    assert!(found.is_ok() || std::env::var_os("VIDEG_ALL_TOOLS").is_none(), "{}", found.unwrap_err());
    found.inspect_err(|error| eprintln!("skipped: {error}")).ok()
}

fn harvester_fmu() -> Fmu {
    Fmu::open(&build_all(&Options::default()).unwrap()[0]).unwrap()
}

fn scenario(case: &str, until: f64) -> Scenario {
    Request { case: Some(case.to_owned()), until: Some(until), ..Request::default() }.resolve().unwrap()
}

fn harvester(fmu: &Fmu, scenario: &Scenario) -> HarvesterFmu {
    HarvesterFmu::new(fmu, scenario, &scenario.settings).unwrap()
}

fn table(fmu: &Fmu, case: &str, until: f64) -> CapacitanceTable {
    CapacitanceTable::from_harvester(&mut harvester(fmu, &scenario(case, until)), until, 1e-4, &()).unwrap()
}

fn variants() -> impl Iterator<Item = Parameters> {
    TOPOLOGIES.into_iter().flat_map(|topology| {
        [Release::Zener, Release::Switch].map(|release| Parameters { topology, release, ..Parameters::default() })
    })
}

/// Compares the ledger of `found` with that of `expected`.
fn assert_ledger(found: &Waveforms, expected: &Waveforms, tolerance: f64, what: &dyn Debug) {
    let (a, b) = (found.ledger(), expected.ledger());
    for (name, a, b) in [
        ("supply energy", a.supply, b.supply),
        ("load energy", a.load, b.load),
        ("zener energy", a.zener, b.zener),
        ("leakage energy", a.leakage, b.leakage),
        ("supply charge", a.supply_charge, b.supply_charge),
        ("load charge", a.load_charge, b.load_charge),
    ] {
        assert!((a - b).abs() <= tolerance * b.abs(), "{what:?}: {name} {a:e} against {b:e}");
    }
    // The converted energy and the work on the membranes are two quadratures.
    assert!(a.residual().abs() < 2.0 * tolerance * (a.supply + a.mechanical.abs()), "{what:?}: {a:?}");
}

fn simulate(ngspice: &Ngspice, parameters: &Parameters, table: &CapacitanceTable) -> Waveforms {
    let (until, growth) = (table.until(), table.growth());
    ngspice.simulate(&Elements::new(parameters, growth).unwrap(), table, &Run::new(until, growth)).unwrap()
}

/// Compares the circuit in ngspice with the embedded solver, with the diodes of ngspice and with ideal ones. Both integrate
/// with errors; the ledger of the embedded solver is good to some 1e-5.
fn compare(ngspice: &Ngspice, table: &CapacitanceTable, ideal: &Parameters, what: &dyn Debug) -> [f64; 2] {
    let found = simulate(ngspice, ideal, table);
    let elements = Elements::new(ideal, table.growth()).unwrap();
    let same = Parameters { diodes: Diodes::Exponential(elements.diode), ..*ideal };
    let expected = Waveforms::embedded(&same, table).unwrap();
    assert_ledger(&found, &expected, SAME_DIODES, &(what, "same diodes"));
    assert_ledger(&found, &Waveforms::embedded(ideal, table).unwrap(), NEAR_IDEAL, &(what, "ideal diodes"));
    found.voltage_difference(&expected).unwrap()
}

/// On the paper's motion, on a slow transient, and with a ball that comes to rest. `videg crosscheck` has random circuits.
#[test]
#[ignore = "slow"]
fn both_solvers_agree() {
    let Some(ngspice) = ngspice() else { return };
    let fmu = harvester_fmu();
    for (case, until, volts) in
        [("fig14", 10.0, 0.1), ("fig15", 5.0, f64::INFINITY), ("table3-2hz", 5.0, f64::INFINITY)]
    {
        let table = table(&fmu, case, extent(0.5, 1.0) * until);
        for ideal in variants() {
            for difference in compare(&ngspice, &table, &ideal, &(case, ideal.topology, ideal.release)) {
                assert!(difference < volts, "{case}: {difference} V RMS");
            }
        }
    }
}

/// Films that leak while a membrane waits for the next impact, and such that lose all their charge until then.
#[test]
#[ignore = "slow"]
fn both_solvers_agree_on_films_that_leak() {
    let Some(ngspice) = ngspice() else { return };
    let table = table(&harvester_fmu(), "fig14", extent(2.5, 5.0));
    for leakage_time_constant in [0.05, 1.0, 30.0] {
        for release in [Release::Zener, Release::Switch, Release::Storage] {
            for topology in TOPOLOGIES {
                let ideal = Parameters {
                    topology,
                    release,
                    leakage_time_constant,
                    storage_voltage: 2200.0,
                    ..Parameters::default()
                };
                compare(&ngspice, &table, &ideal, &(topology, release, leakage_time_constant));
            }
        }
    }
}

/// ngspice keeps all its time points in memory, so long runs are divided, and each piece begins where the last one ended.
#[test]
fn a_divided_run_equals_an_undivided_one() {
    let Some(ngspice) = ngspice() else { return };
    let table = table(&harvester_fmu(), "fig14", 3.0);
    for ideal in variants() {
        let elements = Elements::new(&ideal, table.growth()).unwrap();
        let follow = |piece: f64| {
            let run = Run { piece, ..Run::new(table.until(), table.growth()) };
            let pieces = std::cell::Cell::new(0);
            let found = ngspice.follow(&elements, &table, &run, &|_| pieces.set(pieces.get() + 1)).unwrap();
            let SolverRun { waveforms, repeated, stop } = found;
            assert!(stop.is_none() && repeated.is_empty(), "{stop:?} {repeated:?}");
            (waveforms, pieces.get())
        };
        let ((undivided, one), (divided, many)) = (follow(1e3), follow(0.17));
        assert!(one == 1 && many > 10, "{one} {many}");
        assert_eq!(undivided.time, divided.time);
        let (a, b) = (undivided.ledger(), divided.ledger());
        for (a, b) in [(a.supply, b.supply), (a.load, b.load), (a.zener, b.zener), (a.stored, b.stored)] {
            assert!((a - b).abs() < 1e-6 * undivided.ledger().supply, "{ideal:?}: {a:e} {b:e}");
        }
        assert!(undivided.voltage_difference(&divided).unwrap().iter().all(|volts| *volts < 1e-2));
    }
}

#[test]
fn a_storage_takes_the_charge_that_a_zener_without_load_passes() {
    let Some(ngspice) = ngspice() else { return };
    let table = table(&harvester_fmu(), "fig14", 5.0);
    for topology in TOPOLOGIES {
        // A Zener diode into 0 ohm holds the membranes at U_z as a storage of U_z does, and burns what that stores.
        let (zener_voltage, storage_voltage) = (2200.0, 2200.0);
        let shorted =
            Parameters { topology, zener_voltage, storage_voltage, load_resistance: 0.0, ..Parameters::default() };
        let expected = Waveforms::embedded(&shorted, &table).unwrap().ledger();
        let found = simulate(&ngspice, &Parameters { release: Release::Storage, ..shorted }, &table).ledger();
        // The drop of 4 mV at 2.2 kV counts relative to the 200 V above the supply.
        assert!((found.load / expected.zener - 1.0).abs() < 1e-4, "{found:?} against {expected:?}");
        assert!((found.supply / expected.supply - 1.0).abs() < 1e-4, "{found:?} against {expected:?}");
        assert!(found.zener == 0.0 && found.diode > 0.0 && found.surplus() > 0.0);
        assert!(found.residual().abs() < 1e-4 * found.supply, "{found:?}");
    }
}

#[test]
fn the_capacitor_of_the_netlists_obeys_its_closed_forms() {
    let Some(ngspice) = ngspice() else { return };
    let time: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 1e-3).collect();
    let wave = |t: &f64| 15e-12 * (1.5 - 0.5 * (std::f64::consts::PI * 3.0 * t).cos());
    let left: Vec<f64> = time.iter().map(wave).collect();
    let wave = CapacitanceTable::new(&time, &left, &left).unwrap();
    let ramp = CapacitanceTable::new(&[0.0, 1.0], &[15e-12, 30e-12], &[15e-12; 2]).unwrap();
    // The charge is a sum of currents by the trapezoidal rule. A current that jumps, as at each row of the wave, may cost it
    // half a step times the jump, 1.4e-3 of the charge if all were of one sign.
    for (test, table, tolerance) in [
        (CapacitorTest::Isolated, &wave, 1e-6),
        (CapacitorTest::ConstantVoltage, &wave, 1e-4),
        (CapacitorTest::ConstantVoltage, &ramp, 1e-6),
        (CapacitorTest::Discharge { resistance: 1e10 }, &ramp, 1e-6),
        (CapacitorTest::Discharge { resistance: 1e11 }, &ramp, 1e-6),
    ] {
        let deviation = test.run(&ngspice, 2000.0, table, &Run::new(table.until(), table.growth())).unwrap();
        assert!(deviation.largest < tolerance, "{test:?}: {deviation:?}");
        assert!(deviation.found != 0.0 && (deviation.found / deviation.expected - 1.0).abs() < tolerance);
    }
}

#[test]
fn a_table_is_as_close_to_the_fmu_as_it_was_asked_to_be_and_meets_every_peak() {
    let fmu = harvester_fmu();
    let mut rows = Vec::new();
    for error in [1e-2, 1e-3, 1e-4] {
        let scenario = scenario("fig14", 3.0);
        let table = CapacitanceTable::from_harvester(&mut harvester(&fmu, &scenario), 3.0, error, &()).unwrap();
        let (mut witness, mut largest, mut peak) = (harvester(&fmu, &scenario), 0.0_f64, 0.0_f64);
        let step = 1.0 / 65_536.0;
        for k in 0..3 * 65_536 {
            witness.step(f64::from(k) * step, step).unwrap();
            let exact = witness.sample().unwrap().capacitance()[0];
            largest = largest.max((table.left_at(f64::from(k + 1) * step) - exact).abs());
            peak = peak.max(exact);
        }
        let height = peak - table.initial()[0];
        assert!(largest < error * height, "{} of {error}", largest / height);
        let top = table.left().iter().copied().fold(0.0, f64::max);
        assert!(top >= peak && top - peak < 1e-6 * height, "{top:e} against {peak:e}");
        rows.push(table.len());
    }
    // The error falls with the square of the spacing.
    assert!(rows[2] < 12 * rows[0], "{rows:?}");
}

#[test]
fn tables_of_long_runs_stay_small_even_where_the_ball_chatters() {
    let fmu = harvester_fmu();
    for (case, until, most) in [("fig14", 100.0, 150_000), ("table3-2hz", 20.0, 50_000)] {
        let rows = table(&fmu, case, until).len();
        assert!(rows < most, "{case}: {rows} rows");
    }
}

#[test]
fn tables_and_errors_that_make_no_sense_are_named() {
    let table = |time: &[f64], left: &[f64]| CapacitanceTable::new(time, left, &vec![1e-12; time.len()]);
    for (time, left, expected) in [
        (&[0.0, 1.0][..], &[1e-12][..], "2 times, 1 left, 2 right"),
        (&[0.0], &[1e-12], "two rows at least"),
        (&[0.5, 1.0], &[1e-12; 2], "row 0: time = 0.5 s: must start at 0 s"),
        (&[0.0, 0.0], &[1e-12; 2], "row 1: time = 0 s"),
        (&[0.0, f64::NAN], &[1e-12; 2], "row 1: time = NaN s"),
        (&[0.0, f64::INFINITY], &[1e-12; 2], "row 1: time = inf s"),
        (&[0.0, 1.0], &[1e-12, 0.0], "row 1: left capacitance = 0 F"),
        (&[0.0, 1.0], &[f64::NAN, 1e-12], "row 0: left capacitance = NaN F"),
    ] {
        let error = table(time, left).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let mut harvester = harvester(&harvester_fmu(), &scenario("fig14", 1.0));
    for error in [0.0, -1.0, f64::NAN, 1.0] {
        let message = CapacitanceTable::from_harvester(&mut harvester, 1.0, error, &()).unwrap_err().to_string();
        assert!(message.contains("must lie from 1e-9 to 0.1"), "{message}");
    }
}
