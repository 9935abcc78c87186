//! Isolated FMUs: the same numbers as in one process, and whatever they do to their own process is told and harms no other.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod instances;
mod verbs;

#[path = "../hostile/toy.rs"]
mod toy;
#[path = "../support/waiting.rs"]
mod waiting;
