//! Instances through the library: what is told of an FMU that falls, hangs, takes too much or answers nonsense. The table of
//! `docs/hostile-inputs.md`, which `tests/hostile` checks, has each way to end a process with its message.

use std::path::PathBuf;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use fmu_import::{Bounds, FmiError, Fmu, Instance, Isolation, Logging, Status};
use tempfile::TempDir;

use crate::{instance, toy};

fn isolation() -> Isolation {
    let bounds = Bounds { time: Some(Duration::from_secs(20)), memory: Some(1 << 30) };
    Isolation { program: env!("CARGO_BIN_EXE_videg").into(), bounds }
}

fn within(seconds: f64) -> Isolation {
    Isolation { bounds: Bounds { time: Some(Duration::from_secs_f64(seconds)), memory: None }, ..isolation() }
}

/// The toy with these macros, in a folder of its own.
fn archive(macros: &[&str]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = toy::fmu(folder.path(), "toy.fmu", macros);
    (folder, path)
}

/// The same, isolated.
fn toy(macros: &[&str]) -> (TempDir, Fmu) {
    let (folder, path) = archive(macros);
    let fmu = Fmu::open_isolated(&path, &isolation()).unwrap();
    (folder, fmu)
}

fn initialised(fmu: &Fmu) -> Instance {
    instance::initialised(fmu, "toy", Logging::default(), &[])
}

/// What a step says of an FMU that ends in it.
fn end_in_step(macros: &[&str]) -> String {
    let (_folder, fmu) = toy(macros);
    let mut instance = initialised(&fmu);
    let error = instance.do_step(1.25, 0.25).unwrap_err();
    assert!(matches!(error, FmiError::Isolated(_)), "{error}");
    let again = instance.get_by_name("y").unwrap_err();
    assert_eq!(again.to_string(), error.to_string(), "later calls tell the same");
    error.to_string()
}

#[test]
fn a_crash_names_fmu_call_time_signal_and_what_was_logged() {
    let text =
        end_in_step(&["STEP=LOG(3, \"%s\", \"about to fall\"); puts(\"and printed\"); fflush(stdout); abort();"]);
    assert!(
        text.contains("toy.fmu: fmi2DoStep of 'toy' at t = 1.25 s ended its process (signal: 6 (SIGABRT)"),
        "{text}"
    );
    assert!(text.contains("memory limit 1024 MiB"), "{text}");
    assert!(text.ends_with("the FMU had logged: about to fall; it had printed: and printed"), "{text}");
}

#[test]
fn a_copy_that_the_fmu_makes_of_its_process_neither_answers_nor_listens() {
    let (_folder, fmu) = toy(&["STEP=if (!fork()) time = 1000;"]);
    let mut instance = initialised(&fmu);
    for step in 1..=20 {
        instance.do_step(f64::from(step - 1), 1.0).unwrap();
        assert_eq!(instance.get_by_name("y").unwrap().to_string(), step.to_string());
    }
    instance.free().unwrap();
}

#[test]
fn a_call_without_end_is_ended_at_the_time_limit() {
    let (_folder, path) = archive(&["STEP=for (;;) LOG(1, \"%s\", \"again\");"]);
    // It holds for loading as well, which takes its time on a busy machine.
    let fmu = Fmu::open_isolated(&path, &within(3.0)).unwrap();
    let error = initialised(&fmu).do_step(0.0, 1.0).unwrap_err().to_string();
    assert!(error.contains("fmi2DoStep of 'toy' at t = 0 s took longer than the time limit of 3 s"), "{error}");
    assert!(error.contains("the FMU had logged: again"), "{error}");
}

#[test]
fn what_the_fmu_prints_closes_and_returns_disturbs_no_message() {
    let (_folder, fmu) = toy(&["STEP=puts(\"noise\"); fflush(stdout); close(0); close(1); close(2); return 77;"]);
    let mut instance = initialised(&fmu);
    assert_eq!(instance.do_step(0.0, 1.0).unwrap_err().status(), Some(Status::Unknown(77)));
    assert_eq!(instance.do_step(0.0, 1.0).unwrap_err().status(), Some(Status::Unknown(77)));
    instance.free().unwrap();
}

#[test]
fn a_child_that_holds_the_pipes_open_delays_nothing() {
    let (_folder, fmu) = toy(&["STEP=if (!fork()) { setsid(); sleep(100); _exit(0); } _exit(3);"]);
    let mut instance = initialised(&fmu);
    let begun = Instant::now();
    let text = instance.do_step(0.0, 1.0).unwrap_err().to_string();
    assert!(text.contains("(exit status: 3"), "{text}");
    assert!(begun.elapsed() < Duration::from_secs(50), "waited for the child");
}

#[test]
fn ill_formed_messages_are_kept_bounded_and_in_order() {
    let step = "STEP=LOG(1, NULL); LOG(1, \"%s\", NULL); LOG(77, \"\\xff\\xfe\"); \
                char *long_text = malloc(1 << 20); memset(long_text, 'x', 1 << 20); long_text[(1 << 20) - 1] = 0; LOG(1, long_text);";
    let (_folder, fmu) = toy(&[step]);
    let (sender, receiver) = mpsc::channel();
    let mut instance = fmu.instantiate("toy", Logging::to(move |record| sender.send(record.clone()).unwrap())).unwrap();
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.do_step(0.0, 1.0).unwrap();
    let found: Vec<_> = receiver.try_iter().map(|record| record.message).collect();
    assert_eq!(found, [String::new(), String::new(), "\u{fffd}\u{fffd}".to_owned(), "x".repeat(4096)]);
    assert_eq!(instance.messages().iter().map(|record| record.message.clone()).collect::<Vec<_>>(), found);
}

#[test]
fn states_go_by_number_and_back() {
    let (_folder, fmu) = toy(&[]);
    let mut instance = initialised(&fmu);
    let y = |instance: &Instance| instance.get_by_name("y").unwrap().to_string();
    instance.do_step(0.0, 1.0).unwrap();
    let mut state = instance.save_state().unwrap();
    instance.do_step(1.0, 1.0).unwrap();
    assert_eq!(y(&instance), "2");
    instance.restore_state(&state).unwrap();
    assert_eq!(y(&instance), "1");
    instance.do_step(2.0, 1.0).unwrap();
    instance.save_state_into(&mut state).unwrap();
    let bytes = instance.serialize_state(&state).unwrap();
    instance.do_step(0.0, 0.5).unwrap();
    let other = instance.deserialize_state(&bytes).unwrap();
    instance.restore_state(&other).unwrap();
    assert_eq!(y(&instance), "3");
    drop(instance); // before its states
}

#[test]
fn a_state_of_absurd_size_is_refused() {
    for isolated in [true, false] {
        let (_folder, path) = archive(&["SIZE=(size_t)1 << 62"]);
        let fmu = if isolated { Fmu::open_isolated(&path, &isolation()) } else { Fmu::open(&path) }.unwrap();
        let instance = initialised(&fmu);
        let state = instance.save_state().unwrap();
        let error = instance.serialize_state(&state).unwrap_err().to_string();
        let wanted = "a state of 4611686018427387904 bytes, allowed are 268435456";
        assert!(error.contains(wanted), "{error}");
    }
}

#[test]
fn bytes_that_are_too_many_for_a_state_are_refused_and_the_instance_lives() {
    let (_folder, fmu) = toy(&[]);
    let mut instance = initialised(&fmu);
    let error = instance.deserialize_state(&vec![0; (256 << 20) + 1]).unwrap_err().to_string();
    assert_eq!(error, "fmi2DeSerializeFMUstate of 'toy': a state of 268435457 bytes, allowed are 268435456");
    instance.do_step(0.0, 1.0).unwrap();
}

#[test]
fn the_time_told_is_that_of_the_state_restored_or_of_the_new_experiment() {
    let (_folder, fmu) = toy(&["FREE=abort();"]);
    let stepped = || {
        let mut instance = initialised(&fmu);
        instance.do_step(0.0, 1.0).unwrap();
        let state = instance.save_state().unwrap();
        instance.do_step(1.0, 1.0).unwrap();
        (instance, state)
    };
    let end = |instance: Instance| instance.free().unwrap_err().to_string();
    let (instance, _state) = stepped();
    assert!(end(instance).contains("fmi2FreeInstance of 'toy' at t = 2 s"));
    let (mut instance, state) = stepped();
    instance.restore_state(&state).unwrap();
    assert!(end(instance).contains("fmi2FreeInstance of 'toy' at t = 1 s"));
    let (mut instance, _state) = stepped();
    instance.reset().unwrap();
    assert!(end(instance).contains("fmi2FreeInstance of 'toy' ended"));
    let (mut instance, _state) = stepped();
    instance.reset().unwrap();
    instance.setup_experiment(0.5, None, None).unwrap();
    assert!(end(instance).contains("fmi2FreeInstance of 'toy' at t = 0.5 s"));
}

#[test]
fn an_error_tells_nothing_of_earlier_calls() {
    let (_folder, fmu) = toy(&["STEP=if (time > 0) return 3; LOG(1, \"%s\", \"an old story\");"]);
    let mut instance = initialised(&fmu);
    instance.do_step(0.0, 1.0).unwrap();
    assert_eq!(instance.do_step(1.0, 1.0).unwrap_err().to_string(), "fmi2DoStep of 'toy' returned Error");
}

#[test]
fn a_fatal_error_of_one_instance_concerns_no_other() {
    let (_folder, fmu) = toy(&["STEP=if (time > 0) return 4;"]);
    let (mut one, mut other) = (initialised(&fmu), initialised(&fmu));
    assert_eq!(one.do_step(1.0, 1.0).unwrap_err().status(), Some(Status::Fatal));
    assert!(matches!(one.do_step(1.0, 1.0).unwrap_err(), FmiError::Dead { .. }));
    other.do_step(0.0, 1.0).unwrap();
}
