//! What tests of the FMU share, of which each file uses its part.
#![allow(dead_code, clippy::expect_used)] // helpers fail a test, too

pub mod differences;
pub mod host;
