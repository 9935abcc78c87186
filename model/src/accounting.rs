//! Sums over a run: gains of the impacts, works and losses, and the number of events.

pub mod batch;
pub mod budget;
pub mod ledger;
