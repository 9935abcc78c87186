//! The paper's equations: one pure function each, tagged with its number. The rest of the model calls these.

pub mod excitation;
pub mod force;
pub mod gap;
pub mod impact;
pub mod membrane;
