//! A recorded excitation through the functions of FMI: as with the model alone to the last bit; states; what is no recording.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

mod common;

use std::fmt::Write as _;
use std::path::Path;

use VibroImpactHarvester::Harvester;
use common::host::{Host, reference};
use fmu_export::abi::{fmi2CoSimulation, fmi2ModelExchange, fmi2OK};
use fmu_export::{Logger, Slave};
use fmu_host::slave::{bytes, get, restored, set, set_text, step};
use proptest::prelude::*;
use videg_model::{ExcitationKind, Harvester as Model, Parameters, Recording};

fn set_file(slave: &mut Harvester, path: &Path) {
    set_text(slave, "excitation.file", path.to_str().expect("UTF-8"));
}

/// Writes samples so that they read back to the same bits.
fn write(path: &Path, kind: ExcitationKind, times: &[f64], values: &[f64]) {
    let name = if kind == ExcitationKind::Force { "force" } else { "acceleration" };
    let mut text = format!("time,{name}\n");
    for (time, value) in times.iter().zip(values) {
        writeln!(text, "{time:?},{value:?}").expect("memory");
    }
    std::fs::write(path, text).expect("a file");
}

/// A slave under the recording at `path`, not yet initialised.
fn under(path: &Path) -> Harvester {
    let mut slave = Harvester::new();
    set_file(&mut slave, path);
    slave.update();
    slave
}

fn complaint(mut slave: Harvester) -> String {
    slave.initialize(&Logger::silent()).expect_err("no recording").to_string()
}

/// What shows every motion of cylinder and ball.
const SHOWN: [&str; 6] =
    ["cylinder.position", "cylinder.velocity", "ball.position", "ball.velocity", "gain.voltage", "energy.excitation"];

fn shown(slave: &Harvester) -> [u64; 6] {
    SHOWN.map(|name| get(slave, name).to_bits())
}

/// A saw of 0.1 s and 1 N that does not end before 1 s.
fn saw(folder: &Path, name: &str, height: f64) -> std::path::PathBuf {
    let times: Vec<f64> = (0..=20).map(|k| 0.05 * f64::from(k)).collect();
    let values: Vec<f64> = (0..=20).map(|k| if k % 2 == 0 { height } else { -height }).collect();
    let path = folder.join(name);
    write(&path, ExcitationKind::Force, &times, &values);
    path
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn a_run_is_that_of_the_model_to_the_last_bit(
        is_motion in any::<bool>(),
        first in -0.5_f64..0.5,
        samples in proptest::collection::vec((1e-3_f64..0.2, -3.0_f64..3.0), 2..40),
        scale in -2.0_f64..2.0,
        offset in -1.0_f64..1.0,
        repeat in any::<bool>(),
        steps in proptest::collection::vec(1e-4_f64..0.3, 1..30),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("recording.csv");
        let kind = if is_motion { ExcitationKind::Motion } else { ExcitationKind::Force };
        let mut time = first;
        let times: Vec<f64> = samples.iter().map(|(spacing, _)| { time += spacing; time }).collect();
        let values: Vec<f64> = samples.iter().map(|(_, value)| *value).collect();
        write(&path, kind, &times, &values);

        let host = Host::initializing(
            fmi2CoSimulation,
            0.0,
            &[("excitation.fileScale", scale), ("excitation.fileOffset", offset), ("excitation.acceleration", 1.0)],
        );
        host.choose("excitation.kind", if is_motion { 2 } else { 1 });
        prop_assert_eq!(host.set_boolean(reference("excitation.fileRepeat"), repeat.into()), fmi2OK);
        prop_assert_eq!(host.set_string(reference("excitation.file"), path.to_str().unwrap()), fmi2OK);
        prop_assert_eq!(host.exit_initialization(), fmi2OK);

        let recording = Recording::new(kind, times, values).unwrap();
        let parameters = Parameters {
            excitation_kind: kind,
            acceleration: 1.0,
            file_scale: scale,
            file_offset: offset,
            file_repeat: repeat,
            ..Parameters::default()
        };
        let mut model = Model::new(parameters.with_recording(Some(&recording)), 0.0).unwrap();
        let mut time = 0.0;
        for h in steps {
            host.step(time, h);
            time += h;
            model.advance(time).unwrap();
            let expected = [
                model.cylinder_position(),
                model.cylinder_velocity(),
                model.ball_position(),
                model.ball_velocity(),
                model.totals().voltage_gain,
            ];
            let found = host.get_all(&SHOWN[..5]);
            prop_assert_eq!(
                found.iter().map(|value| value.to_bits()).collect::<Vec<_>>(),
                expected.iter().map(|value| value.to_bits()).collect::<Vec<_>>(),
                "at {} s: {:?} for {:?}", time, found, expected
            );
        }
    }
}

#[test]
fn initial_values_know_the_recording_before_the_end_of_initialization() {
    let folder = tempfile::tempdir().unwrap();
    let path = saw(folder.path(), "saw.csv", 0.4);
    for kind in [fmi2CoSimulation, fmi2ModelExchange] {
        let host = Host::initializing(kind, 0.0, &[("excitation.amplitude", 0.0)]);
        assert_eq!(host.get("der(cylinder.velocity)"), 0.0);
        assert_eq!(host.set_string(reference("excitation.file"), path.to_str().unwrap()), fmi2OK);
        let acceleration = host.get("der(cylinder.velocity)");
        assert!((acceleration - 0.4 / 0.1245).abs() < 1e-12, "{acceleration}");
        assert_eq!(host.exit_initialization(), fmi2OK);
    }
}

/// An integrator of the importer's gets the recorded force in the derivatives and the samples as time events.
#[test]
fn model_exchange_has_the_recorded_force_and_stops_at_each_sample() {
    let folder = tempfile::tempdir().unwrap();
    let path = saw(folder.path(), "saw.csv", 0.4);
    let host = Host::initializing(fmi2ModelExchange, 0.0, &[("excitation.amplitude", 0.0)]);
    assert_eq!(host.set_string(reference("excitation.file"), path.to_str().unwrap()), fmi2OK);
    assert_eq!(host.exit_initialization(), fmi2OK);
    let (_, info) = host.new_discrete_states();
    assert!(info.nextEventTimeDefined != 0 && (info.nextEventTime - 0.05).abs() < 1e-15, "{}", info.nextEventTime);
    assert_eq!(host.enter_continuous_time_mode(), fmi2OK);
    for (time, force) in [(0.0, 0.4), (0.0125, 0.2), (0.025, 0.0), (0.05, -0.4)] {
        assert_eq!(host.place(time, &[0.0; 5]), fmi2OK);
        let acceleration = host.get("der(cylinder.velocity)");
        assert!((acceleration - force / 0.1245).abs() < 1e-12, "{acceleration} at {time} s");
    }
    assert!(host.try_derivatives(&["der(ball.position)"], "ball.velocity").is_ok());
}

#[test]
fn the_folder_of_resources_comes_first_for_names_without_a_way_up() {
    let (resources, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    saw(resources.path(), "saw.csv", 0.5);
    let elsewhere = saw(folder.path(), "saw.csv", 0.25);
    let with_resources = |file: &Path| {
        let mut slave = Harvester::new();
        slave.set_resources(resources.path());
        set(&mut slave, "excitation.amplitude", 0.0);
        set_file(&mut slave, file);
        slave.update();
        slave
    };
    let force = |slave: &Harvester| get(slave, "der(cylinder.velocity)") * 0.1245;
    assert!((force(&with_resources(Path::new("saw.csv"))) - 0.5).abs() < 1e-12);
    assert!((force(&with_resources(&elsewhere)) - 0.25).abs() < 1e-12);
    let said = complaint(with_resources(Path::new("missing.csv")));
    let here = std::env::current_dir().unwrap().join("missing.csv");
    let places = format!("(looked for as {} and {})", resources.path().join("missing.csv").display(), here.display());
    assert!(said.starts_with("excitation.file = \"missing.csv\": No such file") && said.ends_with(&places), "{said}");
    let said = complaint(with_resources(Path::new("../saw.csv")));
    assert!(!said.contains("looked for as"), "nothing outside of the folder is looked for: {said}");
}

#[test]
fn what_is_no_recording_is_an_error_after_which_a_reset_helps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.csv");
    for (text, said) in [
        ("time,force\n0,1\n1,NaN\n", "line 3: force = \"NaN\": it must be a finite number in N"),
        ("time [ms],acc\n0,1\n", "line 1: the heading is \"time [ms],acc\"; allowed is time,acceleration"),
        ("time,force\n0,1\n1,1e13\n", "line 3: force = 1e13 N"),
        ("time,acceleration\n0,1\n1,1\n", "allowed with it: excitation.kind = motion"),
    ] {
        std::fs::write(&path, text).unwrap();
        let host = Host::initializing(fmi2CoSimulation, 0.0, &[]);
        assert_eq!(host.set_string(reference("excitation.file"), path.to_str().unwrap()), fmi2OK);
        assert!(host.exit_initialization() != fmi2OK, "{text}");
        let lines = host.lines();
        let last = &lines.last().expect("a message").message;
        assert!(last.contains(said), "{last}");
        assert_eq!(host.reset(), fmi2OK);
        assert_eq!(host.initialize(), fmi2OK, "after a reset it is a new instance");
    }
    for (path, said) in [(folder.path(), "is a directory"), (Path::new("/dev/zero"), "not a regular file")] {
        let found = complaint(under(path));
        assert!(found.contains(said), "{found}");
    }
    let host = Host::stepping(&[]);
    assert!(host.set_string(reference("excitation.file"), "later.csv") != fmi2OK, "it is fixed");
    let host = Host::initializing(fmi2CoSimulation, 0.0, &[]);
    assert!(host.set_string(reference("excitation.file"), &"x".repeat(4097)) != fmi2OK, "no system has such names");
}

#[test]
fn saved_states_go_back_to_their_own_recording() {
    let folder = tempfile::tempdir().unwrap();
    let [first, other] = [("a.csv", 0.4), ("b.csv", 0.7)].map(|(name, height)| saw(folder.path(), name, height));
    let host = Host::initializing(fmi2CoSimulation, 0.0, &[]);
    assert_eq!(host.set_string(reference("excitation.file"), first.to_str().unwrap()), fmi2OK);
    assert_eq!(host.exit_initialization(), fmi2OK);
    host.step(0.0, 0.33);
    let (saved, serialized) = (host.save(), host.serialize(host.save()));
    host.step(0.33, 0.4);
    let expected = host.get_all(&SHOWN);

    assert_eq!(host.reset(), fmi2OK);
    assert_eq!(host.set_string(reference("excitation.file"), other.to_str().unwrap()), fmi2OK);
    assert_eq!(host.initialize(), fmi2OK);
    host.step(0.0, 0.33);
    host.step(0.33, 0.4);
    assert_ne!(host.get_all(&SHOWN), expected);
    host.restore(saved);
    assert_eq!(host.string(reference("excitation.file")), first.to_str().unwrap());
    host.step(0.33, 0.4);
    assert_eq!(host.get_all(&SHOWN), expected);

    let foreign = Host::stepping(&[]);
    let mut state = core::ptr::null_mut();
    assert_eq!(foreign.deserialize(&serialized, &mut state), fmi2OK);
    foreign.restore(state);
    foreign.step(0.33, 0.4);
    assert_eq!(foreign.get_all(&SHOWN), expected);
}

#[test]
fn the_bytes_of_a_state_need_the_same_samples() {
    let folder = tempfile::tempdir().unwrap();
    let path = saw(folder.path(), "saw.csv", 0.4);
    let mut slave = under(&path);
    slave.initialize(&Logger::silent()).unwrap();
    step(&mut slave, 0.0, 0.21);
    let state = bytes(&slave);
    let go_on = |mut slave: Harvester| {
        step(&mut slave, 0.21, 0.5);
        shown(&slave)
    };
    let expected = go_on(slave.clone());

    saw(folder.path(), "saw.csv", 0.5);
    assert_eq!(go_on(restored(&state, &slave).expect("its samples are in memory")), expected);
    let said = restored(&state, &Harvester::new()).err().expect("another recording").to_string();
    assert!(said.starts_with("excitation.file = ") && said.contains("another recording"), "{said}");
    let present = under(&path);
    assert!(restored(&state, &present).is_err());
    std::fs::remove_file(&path).unwrap();
    let said = restored(&state, &Harvester::new()).err().expect("no recording").to_string();
    assert!(said.contains("No such file"), "{said}");
    saw(folder.path(), "saw.csv", 0.4);
    assert_eq!(go_on(restored(&state, &Harvester::new()).expect("the same samples again")), expected);
    assert_eq!(go_on(restored(&state, &present).expect("read again")), expected);
    // Before initialisation there is nothing but parameters.
    let before = bytes(&under(&path));
    assert_eq!(shown(&restored(&before, &Harvester::new()).expect("a state")), shown(&under(&path)));
}

#[test]
fn a_step_over_more_samples_than_anybody_waits_for_is_discarded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fast.csv");
    write(&path, ExcitationKind::Force, &[0.0, 1e-6, 3e-6], &[0.0, 1.0, 0.0]);
    let mut slave = under(&path);
    set(&mut slave, "excitation.fileRepeat", 1.0);
    slave.update();
    slave.initialize(&Logger::silent()).unwrap();
    let error = slave.do_step(0.0, 200.0, &Logger::silent()).unwrap_err().to_string();
    assert_eq!(error, "communicationStepSize = 200 s: it must be at most 150 s, 100000000 samples of the recording");
    step(&mut slave, 0.0, 1e-4);
}

#[test]
fn a_recording_of_the_other_kind_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = saw(folder.path(), "saw.csv", 0.4);
    let mut slave = under(&path);
    set(&mut slave, "excitation.kind", 2.0);
    slave.update();
    assert!(complaint(slave).contains("allowed with it: excitation.kind = force"));
}
