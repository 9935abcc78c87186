//! The tool as users and scripts meet it. One binary for all of these tests: each further one would link the whole tool.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod cases;
#[path = "../support/command.rs"]
mod command;
#[cfg(unix)]
mod completions;
#[cfg(target_os = "linux")]
#[path = "../support/instance.rs"]
mod instance;
#[cfg(target_os = "linux")]
mod interruption;
#[cfg(target_os = "linux")]
#[path = "../isolation/mod.rs"]
mod isolation;
#[cfg(target_os = "linux")]
mod paths;
#[cfg(target_os = "linux")]
mod read_only;
#[cfg(target_os = "linux")]
mod results;
#[path = "../support/signals.rs"]
mod signals;
mod ssp;
#[path = "../sweep/mod.rs"]
mod sweep;
#[cfg(unix)]
mod terminal;
#[cfg(target_os = "linux")]
#[path = "../hostile/toy.rs"]
mod toy;
#[cfg(target_os = "linux")]
#[path = "../support/waiting.rs"]
mod waiting;
#[cfg(target_os = "linux")]
mod widths;

/// Whether a process, by its number, is gone, or a zombie that waits for its parent.
#[cfg(target_os = "linux")]
fn has_ended(process: &str) -> bool {
    std::fs::read_to_string(format!("/proc/{process}/stat")).map_or(true, |stat| stat.contains(") Z "))
}
