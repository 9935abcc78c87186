//! ngspice's shared library in its worker process, and what happens when the worker or the library fails. `videg crosscheck`
//! compares its energies with those of the embedded solver.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use videg::cosim::{CircuitSample, CircuitSlave, NgspiceCircuit};
use videg::ngspice::live::{Circuit, Job, LiveError, Ramp, Reply, State, WORKER_VERB, Wanted, Worker};
use videg::ngspice::{Elements, Run};
use videg_circuit::Settings;
use videg_system::messages::{frame, take};

const PROGRAM: &str = env!("CARGO_BIN_EXE_videg");
const STEP: f64 = 1e-3;
const STEPS: u32 = 2000;
/// Largest capacitance relative to that at rest.
const GROWTH: f64 = 20.0 / 15.0;

/// Capacitances of two membranes that are pressed in by turns, 30 ms every 250 ms, F.
fn capacitance(time: f64) -> [f64; 2] {
    let pulse = |time: f64| {
        let phase = time.rem_euclid(0.5) / 0.03;
        15e-12 + if phase < 1.0 { 5e-12 * (std::f64::consts::PI * phase).sin() } else { 0.0 }
    };
    [pulse(time), pulse(time + 0.25)]
}

/// Steps a circuit through the pulses.
fn run(circuit: &mut dyn CircuitSlave) -> CircuitSample {
    for k in 0..STEPS {
        let time = f64::from(k) * STEP;
        circuit.step(time, STEP, capacitance(time), capacitance(time + STEP)).unwrap();
    }
    circuit.sample().unwrap()
}

fn ngspice(settings: &Settings) -> NgspiceCircuit {
    let elements = Elements::new(&settings.parameters(), GROWTH).unwrap();
    NgspiceCircuit::new(
        "test",
        Path::new(PROGRAM),
        &elements,
        capacitance(0.0),
        &Run::new(f64::from(STEPS) * STEP, GROWTH),
    )
    .unwrap()
}

/// Breakpoints at the communication points would make the error grow with their number.
#[test]
fn more_communication_points_on_the_same_ramps_do_not_cost_accuracy() {
    let settings = Settings { exponential: true, ..Settings::default() };
    let whole = run(&mut ngspice(&settings)).ledger;
    let mut circuit = ngspice(&settings);
    for k in 0..STEPS {
        let time = f64::from(k) * STEP;
        let [start, end] = [capacitance(time), capacitance(time + STEP)];
        let middle = [0, 1].map(|j| 0.5 * (start[j] + end[j]));
        circuit.step(time, 0.5 * STEP, start, middle).unwrap();
        circuit.step(time + 0.5 * STEP, 0.5 * STEP, middle, end).unwrap();
    }
    let halved = circuit.sample().unwrap().ledger;
    // With breakpoints, steps of 1 ms cost 6e-3 of the load energy.
    assert!((halved.supply / whole.supply - 1.0).abs() < 1e-4, "{} {}", halved.supply, whole.supply);
    assert!((halved.load / whole.load - 1.0).abs() < 1e-4, "{} {}", halved.load, whole.load);
}

fn job() -> Job {
    let netlist = [
        "* test",
        "Vc c 0 external",
        "Rc c 0 1",
        ".subckt deg_left p n",
        "Cvidegleft p n 1p",
        "Cvidegleft_change p n Q='0*V(p,n)'",
        ".ends",
        "Xl c 0 deg_left",
        ".ic v(c)=1",
        ".options method=gear",
        ".end",
    ];
    Job {
        netlist: netlist.map(str::to_owned).to_vec(),
        sources: vec!["vc".to_owned()],
        commands: Vec::new(),
        longest_step: 1e-6,
        stop: 10.0,
        from_initial_conditions: true,
        is_trapezoidal: false,
        memory: None,
    }
}

fn ramp() -> Ramp {
    Ramp { from: 0.0, to: 1e-3, start: vec![1.0], end: vec![2.0] }
}

#[test]
fn a_worker_follows_its_ramps_exactly() {
    let mut worker = Worker::start(Path::new(PROGRAM), &job(), Duration::from_secs(60)).unwrap();
    let circuit = worker.circuit().unwrap();
    let resistor = circuit.elements.iter().position(|element| element.name == "rc").unwrap();
    let wanted = Wanted { groups: vec![vec![resistor]], probes: vec!["c".to_owned()], start: vec![1.0] };
    let begin = worker.begin(wanted).unwrap();
    assert_eq!((begin.probes.as_slice(), begin.membranes.voltage), (&[1.0][..], [1.0, 0.0]));
    let held = Ramp { from: 1e-3, to: 2e-3, start: vec![2.0], end: vec![2.0] };
    // The integral of V^2 over the ramp, then 4 V^2 for 1 ms, on 1 Ohm; within the error of steps of 1 us.
    for (ramp, voltage, energy) in [(ramp(), 2.0, 7e-3 / 3.0), (held, 2.0, 7e-3 / 3.0 + 4e-3)] {
        let state = worker.step(ramp).unwrap();
        assert_eq!(state.probes, [voltage]);
        assert!((state.groups[0].energy / energy - 1.0).abs() < 1e-3, "{} {energy}", state.groups[0].energy);
    }
    assert_eq!(worker.energies().unwrap().len(), circuit.elements.len());
}

/// A program that sends `replies`, then behaves as `script` says.
fn fake(folder: &Path, replies: &[u8], script: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt as _;
    let path = folder.join("fake");
    let said = folder.join("said");
    std::fs::write(&said, replies).unwrap();
    std::fs::write(&path, format!("#!/bin/sh\ncat '{}'\n{script}\n", said.display())).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn a_worker_that_dies_hangs_or_talks_nonsense_is_an_error_and_not_more() {
    let circuit = || Reply::Circuit(Circuit { elements: vec![], nodes: vec![], unread: vec![] });
    let loaded = || vec![circuit(), Reply::Reached(State::default())];
    let vast = Reply::Reached(State { probes: vec![f64::INFINITY], ..State::default() });
    let folder = tempfile::tempdir().unwrap();
    for (replies, script, expected) in [
        (vec![], "echo oh no >&2; exit 7", "ended about the netlist (exit status: 7): oh no"),
        (vec![], "kill -SEGV $$", "ended about the netlist (signal: 11 (SIGSEGV)"),
        (vec![], "sleep 1000", "no answer of ngspice about the netlist within 1 s"),
        (
            vec![],
            "cat >/dev/null & printf '\\1\\0\\0\\0\\143'; wait",
            "ended about the netlist (what it sent: 1 bytes that are no message",
        ),
        (vec![], "echo what a program prints", "what it sent: a message of 1952540791 bytes, allowed are 4194304"),
        (vec![], "sleep 1000 & exit 4", "ended about the netlist (exit status: 4)"),
        (vec![Reply::Failure("no circuit".to_owned())], "sleep 1000", "no circuit"),
        (
            vec![circuit(), vast],
            "sleep 1000",
            "a voltage, current, charge or energy about the netlist is too large for a number",
        ),
        (loaded(), "exit 3", "ended between 0 s and 0.001 s (exit status: 3)"),
        (loaded(), "sleep 1000", "no answer of ngspice between 0 s and 0.001 s within 1 s"),
        (
            [loaded(), vec![circuit()]].concat(),
            "sleep 1000",
            "ended between 0 s and 0.001 s (what it sent: the answer to another",
        ),
    ] {
        let bytes: Vec<u8> = replies.iter().flat_map(|reply| frame(reply).unwrap()).collect();
        let program = fake(folder.path(), &bytes, script);
        let run = || -> Result<(), LiveError> {
            let mut worker = Worker::start(&program, &job(), Duration::from_secs(1))?;
            worker.circuit()?;
            worker.begin(Wanted::default())?;
            worker.step(ramp()).map(drop)
        };
        let error = run().unwrap_err();
        assert!(error.to_string().contains(expected), "{script}: {error}");
    }
    // More than a pipe holds.
    let mut long = job();
    long.netlist.extend(vec!["* a comment".to_owned(); 1 << 15]);
    let deaf = fake(folder.path(), &[], "sleep 1000");
    let error = Worker::start(&deaf, &long, Duration::from_secs(1)).err().unwrap();
    assert_eq!(error.to_string(), "no answer of ngspice about the netlist within 1 s");
    let missing = Worker::start(Path::new("/nowhere/videg"), &job(), Duration::from_secs(1)).err().unwrap();
    assert!(missing.to_string().starts_with(&format!("cannot start /nowhere/videg {WORKER_VERB}: ")), "{missing}");
}

#[test]
fn a_worker_of_another_build_says_so() {
    let mut command = Command::new(PROGRAM);
    command.arg(WORKER_VERB).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut worker = command.spawn().unwrap();
    worker.stdin.take().unwrap().write_all(&frame(&"0.0.0 with messages 0").unwrap()).unwrap();
    let mut said = worker.wait_with_output().unwrap().stdout;
    let Some(Reply::Failure(reason)) = take(&mut said, 1000).unwrap() else { panic!("another answer") };
    assert!(
        reason.starts_with("the worker is of videg ") && reason.ends_with("this is 0.0.0 with messages 0"),
        "{reason}"
    );
}

#[test]
fn a_circuit_that_ngspice_cannot_read_is_an_error_in_its_own_words() {
    for (line, expected) in
        [("Xa c 0 nothing", "unknown subckt: xa c 0 nothing"), ("Ra c 0 foo bar", "unknown parameter (foo)")]
    {
        let mut job = job();
        job.netlist.insert(2, line.to_owned());
        let mut worker = Worker::start(Path::new(PROGRAM), &job, Duration::from_secs(60)).unwrap();
        let error = worker.circuit().unwrap_err().to_string();
        assert!(error.starts_with("ngspice does not take the netlist; ngspice said: "), "{error}");
        assert!(error.contains(expected), "{error}");
    }
    let mut worker = Worker::start(Path::new(PROGRAM), &job(), Duration::from_secs(60)).unwrap();
    worker.circuit().unwrap();
    worker.begin(Wanted { probes: vec!["nowhere".to_owned()], start: vec![1.0], ..Wanted::default() }).unwrap();
    let error = worker.step(ramp()).unwrap_err().to_string();
    assert!(error.starts_with("the circuit has no vector nowhere"), "{error}");
}

fn cosim(folder: &Path, library: Option<&str>) -> std::process::Output {
    let mut command = Command::new(PROGRAM);
    command.args(["cosim", "--circuit", "ngspice", "--until", "0.5", "--json", "--output"]).arg(folder);
    if let Some(library) = library {
        command.env("VIDEG_NGSPICE_LIBRARY", library);
    }
    command.output().unwrap()
}

#[test]
fn cosim_couples_ngspice_and_writes_what_it_writes_for_any_circuit() {
    let folder = tempfile::tempdir().unwrap();
    let output = cosim(folder.path(), None);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["energy"]["supply"].as_f64().unwrap() > 0.0);
    for file in ["timeseries.csv", "report.html", "figure.svg", "result.json"] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
}

#[test]
fn without_the_library_cosim_says_how_to_get_it_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let output = cosim(folder.path(), Some("/nowhere/libngspice.so.0"));
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(error.contains("cannot load the shared library of ngspice (/nowhere/libngspice.so.0)"), "{error}");
    assert!(error.contains("apt install libngspice0"), "{error}");
}
