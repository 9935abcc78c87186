//! Every hostile input that videg is known to meet, through the public surface, and `docs/hostile-inputs.md`, which says
//! what becomes of each. `UPDATE_HOSTILE=1 cargo test --test hostile -- --ignored` writes it.
//!
//! Whatever comes in: the exit code is 2 and stderr one line (but where the table says otherwise), nothing is written
//! outside of the folder for results, nothing that was there is lost, no temporary file is left, and no command that hides
//! in an input is carried out.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod archives;
mod circuits;
mod descriptions;
mod files;
#[path = "../support/instance.rs"]
mod instance;
mod libraries;
mod memory;
mod netlists;
mod options;
mod page;
mod sandbox;
mod toy;

use std::panic::catch_unwind;

use sandbox::Input;

/// Inputs by kind, in the order of the page.
fn all() -> Vec<(&'static str, Vec<Input>)> {
    vec![
        ("Archives", archives::inputs()),
        ("Model descriptions", descriptions::inputs()),
        ("Libraries of FMUs", libraries::inputs()),
        ("Settings and options", options::inputs()),
        ("Case files, sweep files, results of sweeps", files::inputs()),
        ("Netlists", netlists::inputs()),
        ("Circuit FMUs and their mappings", circuits::inputs()),
        ("Serialised states and raw files of ngspice", memory::inputs()),
    ]
}

#[test]
#[ignore = "slow"]
fn every_hostile_input_comes_to_what_the_page_says() {
    sandbox::build();
    let mut failures = 0;
    let mut row = |input: &Input| {
        let told = catch_unwind(|| sandbox::run(input)); // so that the first failure hides no other
        failures += usize::from(told.is_err());
        told.map_or_else(|_| String::new(), |told| page::row(input, &told))
    };
    let sections =
        all().into_iter().map(|(kind, inputs)| page::section(kind, &inputs.iter().map(&mut row).collect::<Vec<_>>()));
    let sections: Vec<_> = sections.collect();
    assert_eq!(failures, 0, "inputs that come to something else");
    page::check(&sections);
}
