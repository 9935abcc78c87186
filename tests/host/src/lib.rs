//! A host that errs: random calls of the C functions of an FMU, in any order and with any arguments that a C program can
//! make without breaking its own memory. Each answer is checked against the tables of FMI 2.0 and against what the host
//! knows of the state of the instance.

#![cfg_attr(miri, feature(c_variadic))] // for the logger
#![allow(non_upper_case_globals)] // the constants of the ABI, in patterns, are spelled as in the standard

/// The chapter of the book about the exporter: what it shows compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/howto/fmu.md")]
mod book {}

mod arguments;
mod call;
pub mod experiment;
pub mod fmi3;
mod functions;
mod host;
pub mod hostile;
pub mod initial;
mod instance;
mod log;
mod random;
mod session;
pub mod slave;

pub use fmu_export::{Function, Interface, abi};
pub use functions::{Exchange, Functions};
pub use host::{Host, UNTOUCHED, ok};
pub use instance::Instance;
pub use log::{Line, Log};
pub use random::Random;
pub use session::{Census, run, run_tape};

use std::ffi::CString;

/// What the host knows of an FMU.
#[derive(Clone)]
pub struct Fmu {
    /// Its C functions.
    pub functions: Functions,
    /// Its GUID.
    pub guid: CString,
    /// Number of its variables; their value references count from 0.
    pub variables: u32,
    /// A String that is set more often than others.
    pub favourite: Option<u32>,
    /// Number of continuous states.
    pub states: usize,
    /// Number of event indicators.
    pub indicators: usize,
}

impl Fmu {
    /// The functions, and the facts that `modelDescription.xml` gives.
    ///
    /// # Errors
    /// If the description has no GUID.
    pub fn new(functions: Functions, description: &str) -> Result<Self, String> {
        let attribute = |name: &str| {
            let (_, rest) = description.split_once(&format!(" {name}=\""))?;
            rest.split_once('"').map(|(value, _)| value)
        };
        let guid = attribute("guid").ok_or("the model description has no guid")?;
        let count = |element: &str| description.matches(element).count();
        Ok(Self {
            functions,
            guid: CString::new(guid).map_err(|e| e.to_string())?,
            variables: u32::try_from(count("<ScalarVariable ")).map_err(|e| e.to_string())?,
            favourite: None,
            states: count(" derivative=\""),
            indicators: attribute("numberOfEventIndicators").and_then(|n| n.parse().ok()).unwrap_or_default(),
        })
    }
}
