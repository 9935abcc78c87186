//! ngspice and the embedded solver on the same C(t): two programs that share nothing but the problem.
//!
//! Without ngspice these tests are skipped, but not by `./test.sh`, which sets `VIDEG_ALL_TOOLS`.

#![allow(clippy::unwrap_used)]

use std::fmt::Debug;

use fmu_import::Fmu;
use videg::cosim::HarvesterFmu;
use videg::ngspice::{Branch, CapacitanceSource, CapacitanceTable, Check, Elements, Ngspice, Run, Waveforms};
use videg::package::{Options, build_all};
use videg::scenario::{CaseFile, Request, Scenario};
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
    let folder = tempfile::tempdir().unwrap();
    let paths = build_all(&Options { output: Some(folder.path().to_owned()), ..Options::default() }).unwrap();
    Fmu::open(&paths[0]).unwrap()
}

fn scenario(case: &str, until: f64) -> Scenario {
    Request { case: Some(case.to_owned()), until: Some(until), ..Request::default() }.resolve().unwrap()
}

fn harvester(fmu: &Fmu, scenario: &Scenario) -> HarvesterFmu {
    HarvesterFmu::new(fmu, scenario, &scenario.settings).unwrap()
}

fn table(fmu: &Fmu, case: &str, until: f64) -> CapacitanceTable {
    CapacitanceTable::from_harvester(&mut harvester(fmu, &scenario(case, until)), until, 1e-4).unwrap()
}

fn variants() -> impl Iterator<Item = Parameters> {
    TOPOLOGIES.into_iter().flat_map(|topology| {
        [Release::Zener, Release::Switch].map(|release| Parameters { topology, release, ..Parameters::default() })
    })
}

/// Holds the books of `found` against those of `expected`.
fn assert_books(found: &Waveforms, expected: &Waveforms, tolerance: f64, what: &dyn Debug) {
    let (a, b) = (found.ledger(), expected.ledger());
    println!(
        "{what:?}: supply {:+.1e}, load {:+.1e}, zener {:+.1e}, load charge {:+.1e}, RMS of the voltage {:.4?} V, {} points",
        a.supply / b.supply - 1.0,
        a.load / b.load - 1.0,
        a.zener / b.zener - 1.0,
        a.load_charge / b.load_charge - 1.0,
        found.voltage_difference(expected).unwrap(),
        found.points.unwrap_or_default(),
    );
    for (name, a, b) in [
        ("supply energy", a.supply, b.supply),
        ("load energy", a.load, b.load),
        ("zener energy", a.zener, b.zener),
        ("supply charge", a.supply_charge, b.supply_charge),
        ("load charge", a.load_charge, b.load_charge),
    ] {
        assert!((a - b).abs() <= tolerance * b.abs(), "{what:?}: {name} {a:e} against {b:e}");
    }
    // The two ways to book the mechanical energy, from the voltage and from the elements, are two quadratures.
    assert!(a.residual().abs() < 2.0 * tolerance * (a.supply + a.mechanical.abs()), "{what:?}: {a:?}");
}

/// Runs the circuit in ngspice and holds it against the embedded solver with the diodes that ngspice has, and with
/// ideal ones. Both integrate with errors of their own; the embedded solver's books are good to some 1e-5.
fn compare(ngspice: &Ngspice, table: &CapacitanceTable, ideal: &Parameters, what: &dyn Debug) -> [f64; 2] {
    let (until, growth) = (table.until(), table.growth());
    let elements = Elements::new(ideal, growth).unwrap();
    let found = ngspice.simulate(&elements, table, &Run::new(until, growth)).unwrap();
    let same = Parameters { diodes: Diodes::Exponential(elements.diode), ..*ideal };
    let expected = Waveforms::embedded(&same, table).unwrap();
    assert_books(&found, &expected, SAME_DIODES, &(what, "same diodes"));
    assert_books(&found, &Waveforms::embedded(ideal, table).unwrap(), NEAR_IDEAL, &(what, "ideal diodes"));
    found.voltage_difference(&expected).unwrap()
}

#[test]
fn both_solvers_agree_on_the_paper_circuit() {
    let Some(ngspice) = ngspice() else { return };
    let table = table(&harvester_fmu(), "fig14", 10.0);
    for ideal in variants() {
        for difference in compare(&ngspice, &table, &ideal, &(ideal.topology, ideal.release)) {
            assert!(difference < 0.1, "{difference} V RMS");
        }
    }
}

#[test]
fn both_solvers_agree_on_a_slow_transient_and_on_a_ball_that_comes_to_rest() {
    let Some(ngspice) = ngspice() else { return };
    let fmu = harvester_fmu();
    for case in ["fig15", "table3-2hz"] {
        let table = table(&fmu, case, 5.0);
        for ideal in variants() {
            compare(&ngspice, &table, &ideal, &(case, ideal.topology, ideal.release));
        }
    }
}

/// The same numbers in every run: `xorshift64*`, from 0 to 1.
fn random(state: &mut u64) -> f64 {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn both_solvers_agree_for_loads_and_voltages_drawn_at_random() {
    let Some(ngspice) = ngspice() else { return };
    let table = table(&harvester_fmu(), "fig14", 5.0);
    let mut state = 0x5eed;
    let variants: Vec<_> = variants().collect();
    for case in variants.iter().cycle().take(5) {
        let parameters = Parameters {
            load_resistance: 10.0_f64.powf(8.0 + 3.0 * random(&mut state)),
            // On a shared node Fig. 14 reaches 2412 V: charge must come through, or there is nothing to compare.
            zener_voltage: 2000.0 + 350.0 * random(&mut state),
            ..*case
        };
        compare(&ngspice, &table, &parameters, &parameters);
    }
}

/// ngspice keeps all its time points in memory, so long runs are divided, and each piece begins where the last one ended.
#[test]
fn a_divided_run_equals_an_undivided_one() {
    let Some(ngspice) = ngspice() else { return };
    let table = table(&harvester_fmu(), "fig14", 3.0);
    for ideal in variants() {
        let elements = Elements::new(&ideal, table.growth()).unwrap();
        let run = |piece| Run { piece, ..Run::new(table.until(), table.growth()) };
        let follow = |piece: f64| {
            let parts = std::cell::RefCell::new(Vec::new());
            let outcome =
                ngspice.follow(&elements, &table, &run(piece), &|part| parts.borrow_mut().push(part)).unwrap();
            assert!(outcome.stop.is_none() && outcome.repeated.is_empty(), "{outcome:?}");
            (outcome.waveforms, parts.into_inner().len())
        };
        let ((whole, one), (divided, many)) = (follow(1e3), follow(0.17));
        assert!(one == 1 && many > 10, "{one} {many}");
        assert_eq!(whole.time, divided.time);
        let (a, b) = (whole.ledger(), divided.ledger());
        let pairs = [(a.supply, b.supply), (a.load, b.load), (a.zener, b.zener), (a.stored, b.stored)];
        let difference = pairs.iter().map(|(a, b)| (a - b).abs() / whole.ledger().supply).fold(0.0, f64::max);
        println!(
            "{:?} {:?}: {difference:.1e}, {:?} V",
            ideal.topology,
            ideal.release,
            whole.voltage_difference(&divided)
        );
        assert!(difference < 1e-6, "{:?} {:?}: {a:?} {b:?}", ideal.topology, ideal.release);
        assert!(whole.voltage_difference(&divided).unwrap().iter().all(|volts| *volts < 1e-2));
    }
}

#[test]
fn a_storage_takes_the_charge_that_a_zener_without_load_passes() {
    let Some(ngspice) = ngspice() else { return };
    let table = table(&harvester_fmu(), "fig14", 5.0);
    for topology in TOPOLOGIES {
        // A Zener diode into 0 ohm holds the membranes at U_z as a storage of U_z does, and burns what that stores.
        let shorted = Parameters { topology, zener_voltage: 2200.0, load_resistance: 0.0, ..Parameters::default() };
        let expected = Waveforms::embedded(&shorted, &table).unwrap().ledger();
        let loaded = Elements::new(&Parameters { load_resistance: 1e9, ..shorted }, table.growth()).unwrap();
        let storage = Elements { branch: Branch::Storage { voltage: 2200.0 }, ..loaded }.checked().unwrap();
        let found = ngspice.simulate(&storage, &table, &Run::new(table.until(), table.growth())).unwrap().ledger();
        println!("{topology:?}: load {:+.1e}", found.load / expected.zener - 1.0);
        // The drop of 4 mV at 2.2 kV counts for what it is of the 200 V above the supply.
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
    for (check, table, tolerance) in [
        (Check::ChargedCapacitor, &wave, 1e-6),
        (Check::ConstantVoltage, &wave, 1e-4),
        (Check::ConstantVoltage, &ramp, 1e-6),
        (Check::RcDischarge { resistance: 1e10 }, &ramp, 1e-6),
        (Check::RcDischarge { resistance: 1e11 }, &ramp, 1e-6),
    ] {
        let deviation = check.run(&ngspice, 2000.0, table, &Run::new(table.until(), table.growth())).unwrap();
        println!("{check:?}: {deviation:?}");
        assert!(deviation.largest < tolerance, "{check:?}: {deviation:?}");
        assert!(deviation.found != 0.0 && (deviation.found / deviation.expected - 1.0).abs() < tolerance);
    }
}

/// Value of the left column of `table` at `time`, s.
fn interpolated(table: &CapacitanceTable, time: f64) -> f64 {
    let next = table.times().partition_point(|&row| row <= time).clamp(1, table.len() - 1);
    let (a, b) = (table.times()[next - 1], table.times()[next]);
    table.left()[next - 1] + (table.left()[next] - table.left()[next - 1]) * (time - a) / (b - a)
}

#[test]
fn a_table_is_as_close_to_the_fmu_as_it_was_asked_to_be_and_meets_every_peak() {
    let fmu = harvester_fmu();
    let mut rows = Vec::new();
    for error in [1e-2, 1e-3, 1e-4] {
        let scenario = scenario("fig14", 3.0);
        let table = CapacitanceTable::from_harvester(&mut harvester(&fmu, &scenario), 3.0, error).unwrap();
        let (mut witness, mut largest, mut peak) = (harvester(&fmu, &scenario), 0.0_f64, 0.0_f64);
        let step = 1.0 / 65_536.0;
        for k in 0..3 * 65_536 {
            witness.step(f64::from(k) * step, step).unwrap();
            let exact = witness.sample().unwrap().capacitance()[0];
            largest = largest.max((interpolated(&table, f64::from(k + 1) * step) - exact).abs());
            peak = peak.max(exact);
        }
        let height = peak - table.initial()[0];
        println!("asked {error:e}, found {:.1e}, {} rows", largest / height, table.len());
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
        println!("{case}: {rows} rows for {until} s");
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
        let message = CapacitanceTable::from_harvester(&mut harvester, 1.0, error).unwrap_err().to_string();
        assert!(message.contains("must lie from 1e-9 to 0.1"), "{message}");
    }
}

#[test]
fn what_a_user_writes_never_gets_into_a_netlist() {
    let hostile = "x\n.control\nshell touch pwned\n.endc\n* $(touch pwned) `touch pwned`";
    let file = CaseFile { name: Some(hostile.into()), description: Some(hostile.into()), ..CaseFile::default() };
    let request = Request { file: Some(file), until: Some(0.5), ..Request::default() };
    let scenario = request.resolve().unwrap();
    assert_eq!(scenario.name, hostile);
    let fmu = harvester_fmu();
    let table = CapacitanceTable::from_harvester(&mut harvester(&fmu, &scenario), 0.5, 1e-3).unwrap();
    let elements = Elements::new(&Parameters::default(), table.growth()).unwrap();
    let netlist =
        elements.netlist(CapacitanceSource::Table, table.initial(), &Run::new(table.until(), table.growth())).unwrap();
    let mut written = Vec::new();
    table.write(&mut written).unwrap();
    let written = String::from_utf8(written).unwrap();
    assert!(!netlist.text().contains("pwned") && !netlist.text().contains("shell"));
    assert!(written.bytes().all(|byte| byte.is_ascii_digit() || b"e-. \n".contains(&byte)));
}
