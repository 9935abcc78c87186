//! Disks that fill up or fail, and programs that are killed, at every call that changes a file: what stands under a final
//! name is always whole, and what is gone on with ends in the bytes of an undisturbed run.
//!
//! `VIDEG_SOAK=full` takes as many points and faults as `docs/soak.md` tells of; without it a minute's worth is run.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod disk;
#[path = "../support/extent.rs"]
mod extent;
mod outputs;
mod sweep;

use extent::extent;
