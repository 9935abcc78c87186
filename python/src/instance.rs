//! An instance of one of the FMUs, to step, save, restore and differentiate.

use std::path::PathBuf;

use fmu_import::{FmiError, Fmu, Logging};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::error::error;
use crate::fmus;
use crate::scenario::{Run, to_python};

/// Longest step in one piece, s: signals are looked for in between. Results do not depend on it.
const PIECE: f64 = 1.0;

/// An instance, which stays on its thread. The package checks that before each call.
#[pyclass(unsendable)]
pub struct Instance {
    /// None once it is closed.
    instance: Option<fmu_import::Instance>,
    /// s.
    time: f64,
}

/// Name, kind, causality, variability, unit and description of a variable.
type Described = (String, &'static str, &'static str, &'static str, Option<String>, Option<String>);

#[pymethods]
impl Instance {
    /// A harvester in a run.
    #[staticmethod]
    fn harvester(fmu: PathBuf, run: Run) -> PyResult<Self> {
        let (fmu, scenario) = (fmus::open(&fmu).map_err(error)?, run.resolve().map_err(error)?);
        let instance = videg::simulate::instance(&fmu, &scenario).map_err(error)?;
        Ok(Self { instance: Some(instance), time: 0.0 })
    }

    /// A circuit with these values: names, and values as text.
    #[staticmethod]
    fn circuit(fmu: PathBuf, values: Vec<(String, String)>) -> PyResult<Self> {
        let fmu = fmus::open(&fmu).map_err(error)?;
        let instance = initialised(&fmu, &values).map_err(error)?;
        Ok(Self { instance: Some(instance), time: 0.0 })
    }

    /// The time reached, s.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// Steps by `step`, s.
    fn step(&mut self, py: Python<'_>, step: f64) -> PyResult<()> {
        let start = self.time;
        self.open()?;
        if !(step > 0.0 && (start + step).is_finite()) {
            return Err(error(format!("step = {step} s: must be a finite time above 0")));
        }
        let end = start + step;
        while self.time < end {
            let now = self.time;
            let next = if now + 1.5 * PIECE < end { now + PIECE } else { end };
            self.open_mut()?.do_step(now, next - now).map_err(error)?;
            self.time = next;
            py.check_signals()?;
            // Other threads have their turn.
            py.detach(|| ());
        }
        Ok(())
    }

    /// The value of a variable.
    fn get(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        to_python(py, &self.open()?.get_by_name(name).map_err(error)?)
    }

    /// The values of Real variables as an array.
    fn reals<'py>(&self, py: Python<'py>, names: Vec<String>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let references = self.references(&names)?;
        let mut values = vec![0.0; references.len()];
        self.open()?.get_real(&references, &mut values).map_err(error)?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// Sets a variable from text.
    fn set(&mut self, name: &str, text: &str) -> PyResult<()> {
        self.open_mut()?.set_by_name(name, text).map_err(error)
    }

    /// Change of `unknowns` for the change `seed` of `knowns`.
    fn derivative<'py>(
        &self,
        py: Python<'py>,
        unknowns: Vec<String>,
        knowns: Vec<String>,
        seed: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (unknowns, knowns) = (self.references(&unknowns)?, self.references(&knowns)?);
        let mut result = vec![0.0; unknowns.len()];
        self.open()?.directional_derivative(&unknowns, &knowns, &seed, &mut result).map_err(error)?;
        Ok(PyArray1::from_vec(py, result))
    }

    /// Time derivatives of outputs.
    fn rates<'py>(&self, py: Python<'py>, names: Vec<String>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let references = self.references(&names)?;
        let mut values = vec![0.0; references.len()];
        let orders = vec![1; references.len()];
        self.open()?.get_real_output_derivatives(&references, &orders, &mut values).map_err(error)?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// Sets rates of inputs for the next step.
    fn set_rates(&mut self, names: Vec<String>, rates: Vec<f64>) -> PyResult<()> {
        let references = self.references(&names)?;
        let orders = vec![1; references.len()];
        self.open_mut()?.set_real_input_derivatives(&references, &orders, &rates).map_err(error)
    }

    /// The state, and the time.
    fn save(&self) -> PyResult<(f64, Vec<u8>)> {
        let instance = self.open()?;
        let state = instance.save_state().map_err(error)?;
        Ok((self.time, instance.serialize_state(&state).map_err(error)?))
    }

    /// Goes back, or on, to a state saved.
    fn restore(&mut self, time: f64, state: &[u8]) -> PyResult<()> {
        let instance = self.open_mut()?;
        let state = instance.deserialize_state(state).map_err(error)?;
        instance.restore_state(&state).map_err(error)?;
        self.time = time;
        Ok(())
    }

    /// The variables.
    fn variables(&self) -> PyResult<Vec<Described>> {
        let variables = self.open()?.description().variables.iter();
        let described = variables.map(|it| {
            let (causality, variability) = (it.causality.as_str(), it.variability.as_str());
            let unit = it.unit().map(str::to_owned);
            (it.name.clone(), it.kind.name(), causality, variability, unit, it.description.clone())
        });
        Ok(described.collect())
    }

    /// Warnings and errors that it has logged.
    fn messages(&self) -> PyResult<Vec<String>> {
        Ok(self.open()?.messages().into_iter().map(|record| record.message).collect())
    }

    /// Frees it.
    fn close(&mut self) -> PyResult<()> {
        self.instance.take().map_or(Ok(()), |instance| instance.free().map_err(error))
    }
}

impl Instance {
    fn open(&self) -> PyResult<&fmu_import::Instance> {
        self.instance.as_ref().ok_or_else(closed)
    }

    fn open_mut(&mut self) -> PyResult<&mut fmu_import::Instance> {
        self.instance.as_mut().ok_or_else(closed)
    }

    fn references(&self, names: &[String]) -> PyResult<Vec<u32>> {
        let description = self.open()?.description();
        names
            .iter()
            .map(|name| {
                let variable = description.variable(name).map_err(error)?;
                let is_real = matches!(variable.kind, fmu_import::Kind::Real { .. });
                is_real.then_some(variable.value_reference).ok_or_else(|| error(format!("{name}: is no Real variable")))
            })
            .collect()
    }
}

fn closed() -> PyErr {
    error("the instance is closed")
}

fn initialised(fmu: &Fmu, values: &[(String, String)]) -> Result<fmu_import::Instance, FmiError> {
    let mut instance = fmu.instantiate("circuit", Logging::default())?;
    instance.begin_initialization(
        0.0,
        None,
        values,
        |(name, _)| fmu.description().is_input(name),
        |instance, (name, text)| instance.set_by_name(name, text),
    )?;
    instance.exit_initialization_mode()?;
    Ok(instance)
}
