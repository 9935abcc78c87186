//! The same for FMI 3.0: random calls on any FMU of this exporter, in any order, within steps, too.

// Instances and states are tokens, which nobody here dereferences; helpers fail a test by a panic; all functions are called.
#![allow(clippy::not_unsafe_ptr_arg_deref, clippy::missing_panics_doc, clippy::wildcard_imports)]
#![allow(clippy::expect_used, clippy::float_cmp, non_upper_case_globals)] // constants as in the standard

mod call;
mod functions;
mod host;
mod run;

pub use call::{call, wild};
pub use functions::Functions;
pub use host::{Environment, Host, Line, Look, Session, Stepped};
pub use run::{Census, run};

use fmu_export::{Causality, Slave, Standard, Variability};
use std::ffi::CString;

/// A variable, as the description has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Its value reference.
    pub reference: u32,
    /// Its type, as the XML element.
    pub type_name: String,
    /// What it is for.
    pub causality: String,
    /// When it changes.
    pub variability: String,
}

/// An FMU of FMI 3.0.
#[derive(Clone)]
pub struct Fmu {
    /// Its C functions.
    pub functions: Functions,
    /// Its instantiation token.
    pub token: CString,
    /// Its variables.
    pub rows: Vec<Row>,
    /// Texts that Strings are set to.
    pub words: Vec<CString>,
    /// Strings that are set more often than others.
    pub favourites: Vec<u32>,
    /// Whether it offers model exchange, and has event mode in co-simulation.
    pub exchange: bool,
    /// Whether it has event mode in co-simulation.
    pub events: bool,
}

impl Fmu {
    /// The functions, and the facts that `modelDescription.xml` gives.
    ///
    /// # Errors
    /// If the description has no token.
    pub fn new(functions: Functions, description: &str) -> Result<Self, String> {
        let token = attribute(description, "instantiationToken").ok_or("the model description has no token")?;
        let (_, variables) = description.split_once("<ModelVariables>").ok_or("it has no variables")?;
        let row = |element: &str| {
            let of = |name: &str| attribute(element, name).unwrap_or_default().to_owned();
            let type_name = element.split_whitespace().next()?.to_owned();
            let reference = attribute(element, "valueReference")?.parse().ok()?;
            Some(Row { reference, type_name, causality: of("causality"), variability: of("variability") })
        };
        let rows = variables.split('<').filter(|element| element.contains(" name=\"")).filter_map(row).collect();
        let token = CString::new(token).map_err(|e| e.to_string())?;
        let exchange = description.contains("<ModelExchange ");
        let events = attribute(description, "hasEventMode") == Some("true");
        let words = [c"", c"other", c"\xff", c"/no/such/file.csv"].map(CString::from).to_vec();
        Ok(Self { functions, token, rows, words, favourites: Vec::new(), exchange, events })
    }

    /// The same from the table of a model.
    pub fn of<S: Slave>(functions: Functions) -> Self {
        let row = |(row, reference): (&fmu_export::Variable<S>, u32)| Row {
            reference,
            type_name: row.kind().type_name_3().to_owned(),
            causality: row.causality().as_str().to_owned(),
            variability: row.variability().as_str().to_owned(),
        };
        let token = fmu_export::Guid::of::<S>(Standard::Fmi3).to_string();
        Self {
            functions,
            token: CString::new(token).unwrap_or_default(),
            rows: S::variables().iter().zip(0..).map(row).collect(),
            words: vec![CString::default()],
            favourites: Vec::new(),
            exchange: S::INFO.model_exchange.is_some(),
            events: S::INFO.stops_at_events || S::variables().iter().any(fmu_export::Variable::is_clock),
        }
    }

    /// Value references of the variables that `test` picks.
    pub(crate) fn references(&self, test: impl Fn(&Row) -> bool) -> Vec<u32> {
        self.rows.iter().filter(|row| test(row)).map(|row| row.reference).collect()
    }

    /// Those that may be read within steps: continuous Float64 outputs.
    pub fn intermediate(&self) -> Vec<u32> {
        let (output, continuous) = (Causality::Output.as_str(), Variability::Continuous.as_str());
        // FMI 3.0 leaves out the variability of a Float64 that is continuous.
        let continuous = |row: &Row| row.variability.is_empty() || row.variability == continuous;
        self.references(|row| row.type_name == "Float64" && row.causality == output && continuous(row))
    }
}

/// The value of an attribute of the first element that has it.
fn attribute<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}
