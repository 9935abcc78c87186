//! What fuzzing checks of each thing that comes from outside, as functions of bytes: libFuzzer runs them in `fuzz/`, and
//! the tests of this package run the kept inputs through them with a stable compiler. docs/fuzzing.md says what each
//! checks.
//!
//! [`TARGETS`] is the table. Those of the FMUs stand in `fmu/`, a file for each: both FMUs have C functions of the same
//! names, so no program can have both.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a panic is how a target fails")]

mod archive;
mod arguments;
mod case_file;
mod description;
pub mod fmu;
pub mod kept;
mod membrane;
mod raw_file;
mod recording;
mod sweep_file;
mod sweep_merge;
mod sweep_record;
mod sweeps;

/// A thing that comes from outside.
pub struct Target {
    /// What it is called: as the program in `fuzz/` and the folders of its inputs.
    pub name: &'static str,
    /// Checks an input and panics if something is wrong; whether it was taken, not refused.
    pub check: fn(&[u8]) -> bool,
    /// Inputs to start from, each of which is taken.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All targets but those of the FMUs.
pub const TARGETS: [Target; 10] = [
    archive::TARGET,
    arguments::TARGET,
    case_file::TARGET,
    description::TARGET,
    membrane::TARGET,
    raw_file::TARGET,
    recording::TARGET,
    sweep_file::TARGET,
    sweep_merge::TARGET,
    sweep_record::TARGET,
];

/// The target called `name`.
///
/// # Panics
/// If there is none.
pub fn find<'a>(targets: &'a [Target], name: &str) -> &'a Target {
    targets.iter().find(|target| target.name == name).unwrap_or_else(|| panic!("no target is called {name}"))
}
