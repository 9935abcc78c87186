//! `videg sweep` through the binary: the same bytes however a sweep is interrupted, divided or computed, and what it
//! says to bad input.

mod cases;
mod checksums;
mod coupled;
mod precision;
mod request;
mod resume;
mod runs;
mod shards;
mod statistics;
