#![no_main]

#[path = "../../tests/fuzz-targets/fmu/harvester.rs"]
mod targets;

videg_fuzz::program!(targets::TARGETS);
