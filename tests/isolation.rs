//! Isolated FMUs: the same numbers as in one process, and whatever they do to their own process is told and harms no other.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use tempfile::TempDir;
use videg::fmi::{Bounds, FmiError, Fmu, Instance, Isolation, Logging, Status};
use videg::package::{Options, build_all};

#[path = "hostile/toy.rs"]
mod toy;
#[path = "support/waiting.rs"]
mod waiting;

use waiting::wait_for;

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
    let mut instance = fmu.instantiate("toy", Logging::default()).unwrap();
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance
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
fn an_exit_is_told_with_its_code() {
    let text = end_in_step(&["STEP=exit(0);"]);
    assert!(text.contains("ended its process (exit status: 0"), "{text}");
}

#[test]
fn a_lower_bound_of_the_user_on_memory_stands() {
    let step = "STEP=struct { unsigned long current, most; } bound; getrlimit(9, &bound); \
                LOG(3, \"%s\", bound.most == 900000UL * 1024 ? \"as the user said\" : \"raised\"); abort();";
    let (_folder, path) = archive(&[step]);
    let check = format!(
        "ulimit -v 900000; exec {} fmu check {} --memory-limit 2048",
        env!("CARGO_BIN_EXE_videg"),
        path.display()
    );
    let output = Command::new("sh").args(["-c", &check]).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.contains("the FMU had logged: as the user said"), "{stderr}");
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
fn memory_is_bounded() {
    let text = end_in_step(&["STEP=for (;;) memset(malloc(1 << 20), 1, 1 << 20);"]);
    assert!(text.contains("(signal: 11 (SIGSEGV); memory limit 1024 MiB)"), "{text}");
}

#[test]
fn a_library_that_falls_while_it_is_loaded_takes_down_its_process_only() {
    let (_folder, path) = archive(&["LOADING=abort();"]);
    let error = Fmu::open_isolated(&path, &isolation()).unwrap_err().to_string();
    assert!(error.contains("toy.fmu: loading the library ended its process (signal: 6 (SIGABRT)"), "{error}");
}

#[test]
fn falls_while_it_is_instantiated_freed_and_unloaded_are_told() {
    let (_folder, fmu) = toy(&["INSTANTIATE=raise(SIGILL);"]);
    let error = fmu.instantiate("toy", Logging::default()).unwrap_err().to_string();
    assert!(error.contains("fmi2Instantiate of 'toy' ended its process (signal: 4 (SIGILL)"), "{error}");
    let (_folder, fmu) = toy(&["FREE=raise(SIGFPE);"]);
    let error = initialised(&fmu).free().unwrap_err().to_string();
    assert!(error.contains("fmi2FreeInstance of 'toy' ended its process (signal: 8 (SIGFPE)"), "{error}");
    drop(initialised(&fmu)); // tells nobody, and harms nobody
    let (_folder, fmu) = toy(&["UNLOADING=abort();"]);
    let error = initialised(&fmu).free().unwrap_err().to_string();
    assert!(error.contains("unloading the library of 'toy' ended its process (signal: 6"), "{error}");
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
fn closing_every_pipe_is_told() {
    let text = end_in_step(&["STEP=for (int i = 0; i < 64; ++i) close(i); pause();"]);
    assert!(text.contains("closed the pipes of its process, which was ended"), "{text}");
}

#[test]
fn messages_on_the_pipe_that_are_none_are_told() {
    let write = "STEP=for (int i = 3; i < 64; ++i) write(i, \"\\xff\\xff\\xff\\xff garbage\", 12); pause();";
    let text = end_in_step(&[write]);
    assert!(text.contains("(what it sent: a message of 4294967295 bytes is announced, allowed are"), "{text}");
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
        let wanted = "the FMU asks for 4611686018427387904 bytes, allowed are 268435456";
        assert!(error.contains(wanted), "{error}");
    }
}

#[test]
fn a_fatal_error_of_one_instance_concerns_no_other() {
    let (_folder, fmu) = toy(&["STEP=if (time > 0) return 4;"]);
    let (mut one, mut other) = (initialised(&fmu), initialised(&fmu));
    assert_eq!(one.do_step(1.0, 1.0).unwrap_err().status(), Some(Status::Fatal));
    assert!(matches!(one.do_step(1.0, 1.0).unwrap_err(), FmiError::Dead { .. }));
    other.do_step(0.0, 1.0).unwrap();
}

#[test]
fn nothing_is_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let temporary = folder.path().join("temporary");
    std::fs::create_dir(&temporary).unwrap();
    let path = toy::fmu(
        folder.path(),
        "toy.fmu",
        &["STEP=FILE *f = fopen(\"left.txt\", \"w\"); fclose(f); chmod(\".\", 0); abort();"],
    );
    let output = Command::new(env!("CARGO_BIN_EXE_videg"))
        .args(["fmu", "check"])
        .arg(&path)
        .env("TMPDIR", &temporary)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert_eq!(std::fs::read_dir(&temporary).unwrap().count(), 0, "the unpacked folder is gone");
    assert!(!folder.path().join("left.txt").exists(), "it works in its own folder");
}

#[test]
fn a_worker_whose_host_is_killed_ends() {
    let folder = tempfile::tempdir().unwrap();
    let mark = folder.path().join("pid");
    let step = format!(
        "STEP=FILE *f = fopen(\"{}\", \"w\"); fprintf(f, \"%d\", getpid()); fclose(f); for (;;);",
        mark.display()
    );
    let path = toy::fmu(folder.path(), "toy.fmu", &[&step]);
    let mut host = Command::new(env!("CARGO_BIN_EXE_videg")).args(["fmu", "check"]).arg(&path).spawn().unwrap();
    let pid = wait_for(|| std::fs::read_to_string(&mark).ok().filter(|text| !text.is_empty()));
    host.kill().unwrap();
    host.wait().unwrap();
    let process = PathBuf::from("/proc").join(&pid);
    let is_gone = || std::fs::read_to_string(process.join("stat")).map_or(true, |stat| stat.contains(") Z "));
    wait_for(|| is_gone().then_some(()));
}

/// The workers of a process.
fn workers(host: u32) -> Vec<String> {
    let children = std::fs::read_to_string(format!("/proc/{host}/task/{host}/children")).unwrap_or_default();
    let is_worker = |pid: &&str| {
        std::fs::read_to_string(format!("/proc/{pid}/cmdline")).is_ok_and(|line| line.contains("fmu-worker"))
    };
    children.split_whitespace().filter(is_worker).map(str::to_owned).collect()
}

#[test]
fn a_co_simulation_whose_worker_is_killed_keeps_the_series_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let host = Command::new(env!("CARGO_BIN_EXE_videg"))
        .args(["cosim", "--isolate", "--until", "300", "--output", "out"])
        .current_dir(folder.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let part = folder.path().join("out/timeseries.csv.part");
    wait_for(|| std::fs::metadata(&part).ok().filter(|file| file.len() > 10_000));
    for worker in workers(host.id()) {
        assert!(Command::new("kill").args(["-KILL", &worker]).status().unwrap().success());
    }
    let output = host.wait_with_output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("of 'harvester' at t = ") && stderr.contains("(signal: 9 (SIGKILL)"), "{stderr}");
    assert!(stderr.contains("the time series up to there is in out/timeseries.csv.part"), "{stderr}");
    assert!(std::fs::read_to_string(part).unwrap().lines().count() > 10);
}

fn videg(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_videg")).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn a_sweep_goes_on_after_a_run_that_took_its_process_down() {
    let folder = tempfile::tempdir().unwrap();
    let crash = "STEP=static int n; if (time > 0.35) { LOG(3, \"%s\", \"too late\"); raise(SIGFPE); }";
    toy::fmu(folder.path(), "toy.fmu", &[crash]);
    let sweep = ["sweep", "--fmu", "toy.fmu", "--vary", "gain=1,2,3", "--record", "y", "--output", "out"];
    let output = videg(folder.path(), &[&sweep[..], &["--until", "1"]].concat());
    assert_eq!(output.status.code(), Some(1), "all runs failed: {output:?}");
    let results = std::fs::read_to_string(folder.path().join("out/sweep.csv")).unwrap();
    let told = "toy.fmu: fmi2DoStep of 'sweep' at t = 0.4 s ended its process (signal: 8 (SIGFPE)";
    assert_eq!(results.matches(told).count(), 3, "{results}");
    let output = videg(folder.path(), &[&sweep[..], &["--until", "0.3", "--fresh"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

/// An FMU of this project.
fn harvester(folder: &Path) -> PathBuf {
    build_all(&Options { output: Some(folder.to_owned()), ..Options::default() }).unwrap().swap_remove(0)
}

/// Every file of two runs, but for what tells them apart.
fn same_files(one: &Path, other: &Path, names: &[&str]) {
    for name in names {
        let read = |folder: &Path| std::fs::read(folder.join(name)).unwrap();
        assert!(read(one) == read(other), "{name} differs");
    }
}

#[test]
fn our_fmus_give_the_same_bytes_isolated_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let cosim = ["cosim", "--circuit", "fmu", "--until", "3", "--adaptive", "1e-3", "--output"];
    for (output, option) in [("here", "--no-isolate"), ("isolated", "--isolate")] {
        let run = videg(folder.path(), &[&cosim[..], &[output, option]].concat());
        assert_eq!(run.status.code(), Some(0), "{run:?}");
    }
    same_files(&folder.path().join("here"), &folder.path().join("isolated"), &["timeseries.csv", "figure.svg"]);
    let fmu = harvester(folder.path());
    let check = |option| videg(folder.path(), &["fmu", "check", fmu.to_str().unwrap(), option]);
    let (here, isolated) = (check("--no-isolate"), check("--isolate"));
    assert_eq!((here.status.code(), isolated.status.code()), (Some(0), Some(0)));
    assert_eq!(here.stdout, isolated.stdout);
    let sweep = ["sweep", "--fmu", fmu.to_str().unwrap(), "--vary", "membrane.restitution=0.3:0.9:3", "--until", "2"];
    for (output, option) in [("sweep-here", "--no-isolate"), ("sweep-isolated", "--isolate")] {
        let run =
            videg(folder.path(), &[&sweep[..], &["--record", "ball.position", "--output", output, option]].concat());
        assert_eq!(run.status.code(), Some(0), "{run:?}");
    }
    let [here, isolated] = ["sweep-here", "sweep-isolated"].map(|name| folder.path().join(name));
    same_files(&here, &isolated, &["sweep.csv"]); // the others say how it was run
}

/// Whether a check of this FMU runs a worker.
fn is_isolated(path: &Path, arguments: &[&str]) -> bool {
    let mut arguments = [&["fmu", "check", path.to_str().unwrap()][..], arguments].concat();
    arguments.extend(["--memory-limit", "1"]); // with which no worker gets anywhere
    videg(path.parent().unwrap(), &arguments).status.code() == Some(2)
}

#[test]
fn only_fmus_of_this_project_run_in_this_process_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let ours = harvester(folder.path());
    let changed = folder.path().join("changed.fmu");
    change_library(&ours, &changed);
    let foreign = toy::fmu(folder.path(), "toy.fmu", &[]);
    for (path, isolated) in [(&ours, false), (&changed, true), (&foreign, true)] {
        assert_eq!(is_isolated(path, &[]), isolated, "{}", path.display());
        assert!(is_isolated(path, &["--isolate"]));
    }
    let falls = toy::fmu(folder.path(), "falls.fmu", &["STEP=raise(SIGKILL);"]);
    let check = |option| videg(folder.path(), &["fmu", "check", falls.to_str().unwrap(), option]).status.code();
    assert_eq!(
        (check("--no-isolate"), check("--isolate")),
        (None, Some(2)),
        "it takes down the process that it runs in"
    );
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_limit_that_binds_nothing_is_refused_or_where_the_fmu_is_named_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let one: &[&str] = &["sweep", "--until", "1"];
    for verb in [one, &["sweep", "--until", "1", "--check"], &["simulate", "--until", "1"], &["cosim", "--until", "1"]]
    {
        for limit in [["--time-limit", "5"], ["--memory-limit", "512"]] {
            let output = videg(folder.path(), &[verb, &limit].concat());
            let expected =
                format!("videg: {} needs --isolate here: the FMUs of videg run in its own process", limit[0]);
            assert!(output.status.code() == Some(2) && said(&output).starts_with(&expected), "{verb:?} {output:?}");
            let output = videg(folder.path(), &["fmu", "check", "any.fmu", "--no-isolate", limit[0], limit[1]]);
            let expected = format!("'--no-isolate' cannot be used with '{}", limit[0]);
            assert!(output.status.code() == Some(2) && said(&output).contains(&expected), "{output:?}");
        }
    }
    let ours =
        build_all(&Options { output: Some(folder.path().to_owned()), ..Options::default() }).unwrap().swap_remove(0);
    let check = |more: &[&str]| videg(folder.path(), &[&["fmu", "check", ours.to_str().unwrap()], more].concat());
    let output = check(&["--time-limit", "5"]);
    let expected = format!("videg: warning: --time-limit does not bind {}: it is one of videg's", ours.display());
    assert!(output.status.code() == Some(0) && said(&output).starts_with(&expected), "{output:?}");
    assert_eq!(said(&check(&["--time-limit", "5", "--isolate"])), "");
}

#[test]
fn a_sweep_isolates_our_fmu_where_it_is_asked_to_and_its_document_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = |output: &str, more: &[&str]| {
        let what = ["sweep", "--vary", "membrane.restitution=0.3:0.9:2", "--until", "2", "--output", output];
        videg(folder.path(), &[&what[..], more].concat())
    };
    let isolation = |output: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(folder.path().join(output).join("sweep.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["isolation"].clone()
    };
    assert!(sweep("here", &[]).status.success());
    assert_eq!(isolation("here"), serde_json::Value::Null);
    assert!(sweep("isolated", &["--isolate", "--time-limit", "50"]).status.success());
    assert_eq!(isolation("isolated"), serde_json::json!({"time_limit_s": 50.0, "memory_limit_bytes": 4096_u64 << 20}));
    same_files(&folder.path().join("here"), &folder.path().join("isolated"), &["sweep.csv"]);
    // With this little memory no worker gets anywhere: it is one that runs.
    let output = sweep("starved", &["--isolate", "--memory-limit", "1"]);
    assert!(!output.status.success(), "{output:?}");
}

#[test]
fn the_limits_of_an_isolated_fmu_decide_which_sweep_it_is() {
    let folder = tempfile::tempdir().unwrap();
    toy::fmu(folder.path(), "toy.fmu", &[]);
    let sweep = |more: &[&str]| {
        let what =
            ["sweep", "--fmu", "toy.fmu", "--vary", "gain=1,2", "--record", "y", "--until", "1", "--output", "out"];
        videg(folder.path(), &[&what[..], more].concat())
    };
    let limits = ["--time-limit", "7.5", "--memory-limit", "0"];
    assert!(sweep(&limits).status.success());
    let text = std::fs::read_to_string(folder.path().join("out/sweep.json")).unwrap();
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["isolation"], serde_json::json!({"time_limit_s": 7.5, "memory_limit_bytes": null}));
    assert!(sweep(&limits).status.success(), "the same sweep again");
    for (other, differs) in [
        (&["--time-limit", "8", "--memory-limit", "0"][..], "\"time_limit_s\":7.5"),
        (&[][..], "\"memory_limit_bytes\":null"),
        (&["--no-isolate"][..], "not nothing"),
    ] {
        let output = sweep(other);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(said.contains("it belongs to another sweep (isolation is") && said.contains(differs), "{said}");
    }
}

/// Copies an FMU with a byte more at the end of its library.
fn change_library(from: &Path, to: &Path) {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(from).unwrap()).unwrap();
    let mut entries = Vec::new();
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        let name = entry.name().unwrap().into_owned();
        let mut bytes = Vec::new();
        std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
        if name.starts_with("binaries/") {
            bytes.push(0);
        }
        entries.push((name, bytes));
    }
    let entries: Vec<_> = entries.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
    std::fs::write(to, toy::zipped(&entries)).unwrap();
}
