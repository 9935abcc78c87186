//! The C functions, the table behind them and the model description, one subject a module: they share a toy model, which takes long to
//! compile.
#![allow(clippy::expect_used, clippy::panic)] // Helpers outside of #[test] functions fail a test, too.

mod call_order;
mod common;
mod derive;
mod directional;
mod fmi3_call_order;
mod fmi3_model_exchange;
mod fmi3_panics;
mod fmi3_random;
mod fmi3_stepping;
mod fmi3_values;
mod fmu_states;
mod lifecycle;
mod model_description;
mod model_exchange;
mod panics;
mod random_calls;
mod stepping;
mod table;
mod values;
