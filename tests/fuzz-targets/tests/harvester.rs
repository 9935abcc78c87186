//! Kept inputs of the harvester FMU.
#![allow(clippy::panic, reason = "a panic is how a target fails")]

#[path = "../fmu/harvester.rs"]
mod targets;

use targets::TARGETS;
use videg_fuzz_targets::kept;

#[test]
fn kept_states_and_calls_hold_what_their_targets_check() {
    kept::replay(&TARGETS);
}

#[test]
fn every_target_of_the_table_is_fuzzed() {
    kept::programs(&TARGETS, |name| name.ends_with("_harvester"));
}
