//! Isolated FMUs: the same numbers as in one process, and whatever they do to their own process is told and harms no other.

mod instances;
mod verbs;
