//! What a harvester takes from files: a recorded excitation, a measured membrane. A fault is named with its line. The FMU links this
//! package.

mod error;
pub mod membrane;
pub mod recording;

pub use error::DataError;
