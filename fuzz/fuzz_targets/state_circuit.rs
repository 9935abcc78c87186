#![no_main]

#[path = "../../tests/fuzz-targets/fmu/circuit.rs"]
mod targets;

videg_fuzz::program!(targets::TARGETS);
