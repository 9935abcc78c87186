//! Verbs that run FMUs: nothing of a worker is left, results are the same in one process or two, and limits bind or are refused.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use videg::package::{Options, build_all};

use crate::command::{self, stderr as said};
use crate::waiting::wait_for;
use crate::{has_ended, toy};

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
    let output = command::videg(&["fmu", "check"])
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
    let mut host = command::videg(&["fmu", "check"]).arg(&path).spawn().unwrap();
    let pid = wait_for(|| std::fs::read_to_string(&mark).ok().filter(|text| !text.is_empty()));
    host.kill().unwrap();
    host.wait().unwrap();
    wait_for(|| has_ended(&pid).then_some(()));
}

#[test]
fn a_lower_limit_of_the_user_on_memory_stands_and_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let step = "STEP=struct { unsigned long current, most; } bound; getrlimit(9, &bound); \
                LOG(3, \"%s\", bound.most == 3145728UL * 1024 ? \"as the user said\" : \"raised\"); abort();";
    toy::fmu(folder.path(), "toy.fmu", &[step]);
    let line = format!("ulimit -v 3145728 && exec {} fmu check toy.fmu", env!("CARGO_BIN_EXE_videg"));
    let output = Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap();
    let stderr = said(&output);
    assert!(stderr.contains("(signal: 6 (SIGABRT); memory limit 3072 MiB)"), "{stderr}");
    assert!(stderr.contains("the FMU had logged: as the user said"), "{stderr}");
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
    let mut host = command::videg(&["cosim", "--isolate", "--until", "300", "--output", "out"]);
    let host = host.current_dir(folder.path()).stderr(std::process::Stdio::piped()).spawn().unwrap();
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
    command::videg(arguments).current_dir(folder).output().unwrap()
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
    let ours = harvester(folder.path());
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
        (&["--time-limit", "8", "--memory-limit", "0"][..], "time_limit_s 7.5, is"),
        (&[][..], "was any memory_limit_bytes"),
        (&["--no-isolate"][..], "is not given"),
    ] {
        let output = sweep(other);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(said.contains("it belongs to another sweep: the isolation was") && said.contains(differs), "{said}");
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
