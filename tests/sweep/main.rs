//! `videg sweep` through the binary: the same bytes however a sweep is interrupted, divided or computed, and what it
//! says to bad input.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod checksums;
mod command;
mod request;
mod resume;
mod runs;
mod shards;
#[path = "../support/signals.rs"]
mod signals;
