//! A measured membrane through the functions of FMI: as with the model alone to the last bit; states; what is no membrane.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

mod common;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use VibroImpactHarvester::Harvester;
use common::host::{Host, reference};
use fmu_export::abi::{fmi2CoSimulation, fmi2OK};
use fmu_export::{Logger, Slave};
use fmu_host::slave::{bytes, get, restored, set, set_text, step};
use videg_model::{ForceTable, Harvester as Model, MembraneLaw, Parameters};

/// A membrane that is `factor` times as stiff as another, with a capacitance of its own.
fn points(factor: f64) -> [Vec<f64>; 3] {
    let x: Vec<f64> = (0..=30).map(|k| 1e-4 * f64::from(k)).collect();
    let force = x.iter().map(|x| factor * (60.0 * x + 3e4 * x * x)).collect();
    let capacitance = x.iter().map(|x| 2e-11 * (1.0 + (x / 0.006).powi(2))).collect();
    [x, force, capacitance]
}

fn write(folder: &Path, name: &str, factor: f64) -> PathBuf {
    let [x, force, capacitance] = points(factor);
    let mut text = "deflection,force,capacitance\n".to_owned();
    for ((x, force), capacitance) in x.iter().zip(&force).zip(&capacitance) {
        writeln!(text, "{x:?},{force:?},{capacitance:?}").expect("memory");
    }
    let path = folder.join(name);
    std::fs::write(&path, text).expect("a file");
    path
}

/// A slave with the membrane at `path` and a ball that flies, not yet initialised.
fn with(path: &Path) -> Harvester {
    let mut slave = Harvester::new();
    set_text(&mut slave, "membrane.file", path.to_str().expect("UTF-8"));
    set(&mut slave, "membrane.law", 2.0);
    set(&mut slave, "initial.ballVelocity", 0.2);
    slave.update();
    slave
}

fn complaint(mut slave: Harvester) -> String {
    slave.initialize(&Logger::silent()).expect_err("no membrane").to_string()
}

const SHOWN: [&str; 6] = [
    "ball.velocity",
    "left.deflection",
    "right.capacitance",
    "gain.voltage",
    "membrane.restCapacitance",
    "pulse.nextKnot",
];

fn shown(slave: &Harvester) -> [u64; 6] {
    SHOWN.map(|name| get(slave, name).to_bits())
}

#[test]
fn a_run_is_that_of_the_model_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let mut slave = with(&write(folder.path(), "film.csv", 1.0));
    slave.initialize(&Logger::silent()).unwrap();
    let [x, force, capacitance] = points(1.0);
    let table = ForceTable::new(x, force, Some(capacitance)).unwrap();
    let p = Parameters { membrane_law: MembraneLaw::Table, ball_velocity: 0.2, ..Parameters::default() };
    let mut model = Model::new(p.with_table(Some(&table)), 0.0).unwrap();
    assert!((get(&slave, "membrane.restCapacitance") - 2e-11).abs() < 1e-25, "as measured");
    for k in 0..3000 {
        step(&mut slave, 1e-3 * f64::from(k), 1e-3);
        model.advance(1e-3 * f64::from(k) + 1e-3).unwrap();
        assert_eq!(get(&slave, "left.capacitance").to_bits(), model.capacitance(videg_model::Side::Left).to_bits());
    }
    assert_eq!(get(&slave, "gain.voltage").to_bits(), model.totals().voltage_gain.to_bits());
    assert!(model.totals().impacts > 10);
}

#[test]
fn states_go_back_to_their_own_membrane() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "film.csv", 1.0);
    let mut slave = with(&path);
    slave.initialize(&Logger::silent()).unwrap();
    step(&mut slave, 0.0, 0.21);
    let state = bytes(&slave);
    let go_on = |mut slave: Harvester| {
        step(&mut slave, 0.21, 0.5);
        shown(&slave)
    };
    let expected = go_on(slave.clone());
    write(folder.path(), "film.csv", 1.5);
    assert_eq!(go_on(restored(&state, &slave).expect("its points are in memory")), expected);
    let said = restored(&state, &Harvester::new()).err().expect("another table").to_string();
    assert!(said.starts_with("membrane.file = ") && said.contains("another table"), "{said}");
    write(folder.path(), "film.csv", 1.0);
    assert_eq!(go_on(restored(&state, &Harvester::new()).expect("the same points again")), expected);
}

#[test]
fn what_is_no_membrane_is_an_error_that_names_file_and_value() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.csv");
    for (text, said) in [
        ("deflection,force\n0,0\n1e-3,NaN\n", "line 3: force = \"NaN\": it must be a finite number in N"),
        ("deflection_mm,force\n0,0\n", "line 1: the heading is \"deflection_mm,force\"; allowed is deflection,force"),
        ("deflection,force\n0,0\n1e-3,1\n2e-3,1e10\n", "line 4: force = 1e10 N is outside [0, 1e9] N"),
    ] {
        std::fs::write(&path, text).unwrap();
        let host = Host::initializing(fmi2CoSimulation, 0.0, &[]);
        assert_eq!(host.set_string(reference("membrane.file"), path.to_str().unwrap()), fmi2OK);
        assert!(host.exit_initialization() != fmi2OK, "{text}");
        let lines = host.lines();
        let last = &lines.last().expect("a message").message;
        assert!(last.contains(said) && last.contains("membrane.file = "), "{last}");
    }
    let found = complaint(with(Path::new("/dev/zero")));
    assert!(found.contains("not a regular file"), "{found}");
    let mut unused = with(&write(folder.path(), "film.csv", 1.0));
    set(&mut unused, "membrane.law", 1.0);
    unused.update();
    assert!(complaint(unused).contains("needs membrane.law = table"));
    let mut missing = Harvester::new();
    set(&mut missing, "membrane.law", 2.0);
    missing.update();
    assert!(complaint(missing).contains("set membrane.file"));
}

#[test]
fn a_run_beyond_the_last_point_is_warned_of_once_for_each_membrane() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("short.csv");
    std::fs::write(&path, "deflection,force\n0,0\n1e-4,1e-3\n2e-4,3e-3\n").unwrap();
    let host = Host::initializing(fmi2CoSimulation, 0.0, &[("initial.ballVelocity", 0.2)]);
    assert_eq!(host.set_string(reference("membrane.file"), path.to_str().unwrap()), fmi2OK);
    host.choose("membrane.law", 2);
    assert_eq!(host.exit_initialization(), fmi2OK);
    for k in 0..20 {
        host.step_warns(0.25 * f64::from(k), 0.25);
    }
    let warned: Vec<_> =
        host.lines().into_iter().map(|line| line.message).filter(|line| line.contains("the last point of")).collect();
    assert_eq!(warned.len(), 2, "{warned:?}");
}
