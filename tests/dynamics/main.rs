//! The dynamics against closed forms and against simulations that share no code with the search for orbits.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

#[path = "../../model/tests/common/capsule.rs"]
mod capsule;
mod closed_form;
mod command;
mod files;
mod orbits;

use videg::dynamics::{Files, Problem, Varied};
use videg_model::{Parameters, Quantity};

/// The real parameter called `name`.
fn quantity(name: &str) -> &'static Quantity {
    Parameters::TABLE.iter().find(|quantity| quantity.name == name).unwrap()
}

/// A problem over one parameter.
fn over(parameters: Parameters, name: &str, from: f64, to: f64) -> Problem {
    Problem {
        parameters,
        files: Files::default(),
        varied: Some(Varied { quantity: quantity(name), values: vec![from, to] }),
    }
}

/// A problem at its own parameters.
fn at(parameters: Parameters) -> Problem {
    Problem { parameters, files: Files::default(), varied: None }
}
