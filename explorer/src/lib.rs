//! The harvester with its circuit for a browser: what the page asks for, as numbers in flat arrays.
//!
//! [`Machine`] is a generator with all its parameters. It says what a run gives ([`Machine::run`]), moves ([`Machine::motion`]), and is computed
//! over ranges of its parameters ([`Machine::diagram`], [`Map`]). All numbers are those of the library that it is compiled from; units
//! are SI. Errors are the texts of the library.
#![forbid(unsafe_code)]

mod export;
mod film;
mod impacts;
mod machine;
mod map;
mod motion;
mod run;
mod setter;

pub use export::Reader;
pub use impacts::Shown;
pub use machine::Machine;
pub use map::Map;
pub use run::Outcome;
