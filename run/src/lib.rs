//! One run of a vibro-impact dielectric elastomer generator, described by a [`scenario`]: of the harvester's FMU alone
//! ([`simulate`]), coupled with a circuit ([`cosim`]), or of the circuit in [`ngspice`].
//!
//! A package of its own, since its loops are optimised even where the rest of `videg` is not.

#![allow(
    clippy::missing_errors_doc,
    reason = "the messages of the error types say it; a section says what is beyond them"
)]

pub mod cosim;
pub mod ngspice;
pub mod progress;
pub mod scenario;
pub mod simulate;
