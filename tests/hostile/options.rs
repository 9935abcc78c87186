//! Settings and options that are out of bounds, or commands to somebody else.

use super::sandbox::{Input, refused};

fn set(what: &'static str, setting: &str) -> Input {
    refused(what, &["sweep", "--check", "--set", setting], Vec::new())
}

fn circuit(what: &'static str, setting: &str) -> Input {
    refused(what, &["cosim", "--circuit", "ngspice", "--output", "out", "--until", "1", "--set", setting], Vec::new())
}

fn option(what: &'static str, line: &str) -> Input {
    refused(what, &line.split(' ').collect::<Vec<_>>(), Vec::new())
}

/// All of them.
pub fn inputs() -> Vec<Input> {
    vec![
        set("no number", "membrane.restitution=NaN"),
        set("infinity", "membrane.stiffness=inf"),
        set("out of range", "membrane.restitution=1.5"),
        set("an integer beyond 32 bits", "excitation.seed=99999999999"),
        set("an unknown variable", "membrane.restitutoin=0.5"),
        set("an output", "ball.position=1"),
        set("no value", "membrane.restitution"),
        set("a command to the shell", "membrane.restitution=$(touch CANARY)"),
        set("a name that commands the terminal", "\u{1b}[2J=1"),
        set("a name of 100,000 letters", &format!("{}=1", "x".repeat(100_000))),
        circuit("a command to ngspice in a number", "zener.voltage=2000\n.control\nshell touch CANARY\n.endc"),
        circuit("a command to ngspice in a choice", "release=zener\n.control\nshell touch CANARY\n.endc"),
        circuit("a command to ngspice in a name", "load.resistance\n.control\nshell touch CANARY\n.endc\n=1"),
        circuit("no number for the circuit", "load.resistance=NaN"),
        circuit("a resistance below zero", "load.resistance=-1"),
        circuit("a leakage below zero", "leakage.timeConstant=-1"),
        option("a run without end", "simulate --output out --until inf"),
        option("more steps than can be written", "simulate --output out --step 1e-300"),
        option("a window outside of the run", "simulate --output out --until 10 --window 50,100"),
        option("an unknown case", "simulate --output out --case ../../etc/passwd"),
        option(
            "more points than can be counted",
            "sweep --check --design random --points 18446744073709551615 --samples 2 --vary membrane.restitution=0.2:0.9",
        ),
        option(
            "a grid of 1e24 points",
            "sweep --check --vary membrane.restitution=0.2:0.9:1000000000000 --vary membrane.stiffness=1e5:2e5:1000000000000",
        ),
        option("a logarithmic range from zero", "sweep --check --vary membrane.restitution=log:0:0.9:5"),
        option("shard 9 of 8", "sweep --shard 9/8 --vary membrane.restitution=0.2:0.9:2"),
        option("a time limit that is none", "fmu check toy.fmu --time-limit -1"),
        option("isolated and not isolated", "fmu check toy.fmu --isolate --no-isolate"),
        option("a library that is none", "fmu build --add-binary linux64=out/kept.txt"),
    ]
}
