//! Kept inputs of files and arguments.

use videg_fuzz_targets::{TARGETS, kept};

#[test]
fn kept_files_and_arguments_hold_what_their_targets_check() {
    kept::replay(&TARGETS);
}

#[test]
fn every_target_of_the_table_is_fuzzed() {
    kept::programs(&TARGETS, |name| !name.ends_with("_harvester") && !name.ends_with("_circuit"));
}
