//! The extension module `videg._videg`: what the package `videg` for Python calls. Names, values and texts come as a user would type
//! them on the command line; results go out as arrays and as JSON. The package in `python/videg` makes that pleasant.

#![allow(clippy::needless_pass_by_value, reason = "what comes from Python is owned")]
#![allow(clippy::missing_errors_doc, reason = "the package says which exceptions there are")]

mod background;
mod cosim;
mod error;
mod export;
mod fmus;
mod instance;
mod scenario;
mod simulate;
mod sweep;

/// What the package calls.
#[pyo3::pymodule]
mod _videg {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::{
        cosim::cosim,
        error::Error,
        export::export,
        fmus::close,
        instance::Instance,
        scenario::{cases, start_values},
        simulate::simulate,
        sweep::{evaluate, sweep},
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
