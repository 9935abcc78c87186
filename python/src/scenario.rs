//! A run as Python describes it.

use std::path::PathBuf;

use clap::ValueEnum;
use fmu_import::Value;
use pyo3::prelude::*;
use serde::Serialize;
use videg::scenario::{self, CaseFile, Request, Scenario, ScenarioError, Setting, StartValue};
use videg::simulate::Points;
use videg_model::Case;

use crate::error::error;

/// Case or case file, settings as `name=value`, and times.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Run {
    case: Option<String>,
    case_file: Option<PathBuf>,
    settings: Vec<String>,
    until: Option<f64>,
    step: Option<f64>,
    window: Option<[f64; 2]>,
}

/// The points of a table: by what, and its number. A default is a row each millisecond, or the end of a shorter run.
#[derive(FromPyObject)]
pub struct By(String, f64);

impl By {
    /// The points of a run up to `until`, s.
    pub fn points(&self, until: f64) -> Points {
        match self.0.as_str() {
            "knots" => Points::Knots(self.1),
            "sample" => Points::Sample(self.1),
            _ => Points::Sample(self.1.min(until)),
        }
    }
}

impl Run {
    /// The scenario.
    pub fn resolve(self) -> Result<Scenario, ScenarioError> {
        let Self { case, case_file, settings, until, step, window } = self;
        let file = case_file.as_deref().map(CaseFile::read).transpose()?;
        let settings = settings.iter().map(|text| Setting::parse(text)).collect::<Result<_, _>>()?;
        Request { case, file, settings, until, step, window, until_place: None }.resolve()
    }
}

#[derive(Serialize)]
struct Listed {
    name: &'static str,
    description: &'static str,
    source: &'static str,
    /// V/s.
    paper_voltage_gain: Option<f64>,
    /// W.
    paper_power: Option<f64>,
}

/// The published cases, as JSON.
#[pyfunction]
pub fn cases() -> PyResult<String> {
    let listed = Case::ALL.iter().map(|case| Listed {
        name: case.name,
        description: case.description,
        source: case.source,
        paper_voltage_gain: case.paper_voltage_gain,
        paper_power: case.paper_power,
    });
    serde_json::to_string(&listed.collect::<Vec<_>>()).map_err(error)
}

/// Name, value, the same with the number of an item, unit and description of a parameter.
type Described = (String, Py<PyAny>, Py<PyAny>, Option<String>, String);

/// All parameters of the harvester in a run.
#[pyfunction]
pub fn start_values(py: Python<'_>, run: Run) -> PyResult<Vec<Described>> {
    let values = scenario::start_values(&run.resolve().map_err(error)?).map_err(error)?;
    let described = |it: StartValue| {
        let number = if let Value::Enumeration { value, .. } = it.value { &Value::Integer(value) } else { &it.value };
        Ok((it.name, to_python(py, &it.value)?, to_python(py, number)?, it.unit, it.description))
    };
    values.into_iter().map(described).collect()
}

/// `value` as an object of Python: an item of an enumeration is its name.
pub fn to_python(py: Python<'_>, value: &Value) -> PyResult<Py<PyAny>> {
    Ok(match value {
        Value::Real(value) => value.into_pyobject(py)?.into_any().unbind(),
        Value::Integer(value) => value.into_pyobject(py)?.into_any().unbind(),
        Value::Boolean(value) => value.into_pyobject(py)?.to_owned().into_any().unbind(),
        Value::String(text) | Value::Enumeration { name: text, .. } => text.into_pyobject(py)?.into_any().unbind(),
    })
}

/// The item of a choice that is called `text`, the value of `name`.
pub fn item<T: ValueEnum>(name: &str, text: &str) -> PyResult<T> {
    T::from_str(text, false).map_err(|_| {
        let items = T::value_variants().iter().filter_map(|item| Some(item.to_possible_value()?.get_name().to_owned()));
        error(format!("{name} = {text:?}: allowed are {}", items.collect::<Vec<_>>().join(", ")))
    })
}
