//! An instance of one of the FMUs, to step, save, restore and differentiate.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, TryLockError};

use fmu_import::{FmiError, Fmu, Logging};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::error::error;
use crate::fmus;
use crate::scenario::{Run, to_python};

/// Longest step in one piece, s: signals are looked for in between. Results do not depend on it.
const PIECE: f64 = 100.0;

/// An instance of one of our own FMUs, whole: nothing else holds a part of it.
struct Own(fmu_import::Instance);

// SAFETY: FMI 2.0 promises nothing of an instance that moves to another thread, but these FMUs are our own: an instance of theirs
// is a value on the heap that knows no thread. The importer's part is reference counts that only this value holds.
#[allow(unsafe_code)]
unsafe impl Send for Own {}

/// What an instance is and was told.
struct State {
    own: Own,
    /// s.
    time: f64,
    /// Rates of inputs for the next step: references and values.
    rates: (Vec<u32>, Vec<f64>),
}

/// An instance. Calls from several threads wait for nobody: the second one is refused.
#[pyclass]
pub struct Instance {
    /// None once it is closed.
    state: Mutex<Option<State>>,
}

/// Name, kind, causality, variability, unit and description of a variable.
type Described = (String, &'static str, &'static str, &'static str, Option<String>, Option<String>);

#[pymethods]
impl Instance {
    /// A harvester in a run.
    #[staticmethod]
    fn harvester(py: Python<'_>, fmu: PathBuf, run: Run) -> PyResult<Self> {
        let scenario = run.resolve().map_err(error)?;
        let fmu = py.detach(|| fmus::open(&fmu)).map_err(error)?;
        Ok(Self::of(videg::simulate::instance(&fmu, &scenario).map_err(error)?))
    }

    /// A circuit with these values: names, and values as text.
    #[staticmethod]
    fn circuit(py: Python<'_>, fmu: PathBuf, values: Vec<(String, String)>) -> PyResult<Self> {
        let fmu = py.detach(|| fmus::open(&fmu)).map_err(error)?;
        Ok(Self::of(initialised(&fmu, &values).map_err(error)?))
    }

    /// The time reached, s.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        self.with(|state| Ok(state.time))
    }

    /// Steps by `step`, s.
    fn step(&self, py: Python<'_>, step: f64) -> PyResult<()> {
        self.with(|state| {
            let (start, end) = (state.time, state.time + step);
            if !(step > 0.0 && end > start && end.is_finite()) {
                return Err(error(format!("step = {step} s at {start} s: must be a time above 0 that leads further")));
            }
            while state.time < end {
                let next = if state.time + 1.5 * PIECE < end { state.time + PIECE } else { end };
                py.detach(|| state.step(next)).map_err(error)?;
                py.check_signals()?;
            }
            state.rates = Default::default();
            Ok(())
        })
    }

    /// The value of a variable.
    fn get(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        self.with(|state| to_python(py, &state.own.0.get_by_name(name).map_err(error)?))
    }

    /// The values of Real variables as an array.
    fn reals<'py>(&self, py: Python<'py>, names: Vec<String>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(|state| {
            let references = state.references(&names)?;
            let mut values = vec![0.0; references.len()];
            state.own.0.get_real(&references, &mut values).map_err(error)?;
            Ok(PyArray1::from_vec(py, values))
        })
    }

    /// Sets a variable from text.
    fn set(&self, name: &str, text: &str) -> PyResult<()> {
        self.with(|state| state.own.0.set_by_name(name, text).map_err(error))
    }

    /// Change of `unknowns` for the change `seed` of `knowns`.
    fn derivative<'py>(
        &self,
        py: Python<'py>,
        unknowns: Vec<String>,
        knowns: Vec<String>,
        seed: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(|state| {
            let (unknowns, knowns) = (state.references(&unknowns)?, state.references(&knowns)?);
            let mut result = vec![0.0; unknowns.len()];
            state.own.0.directional_derivative(&unknowns, &knowns, &seed, &mut result).map_err(error)?;
            Ok(PyArray1::from_vec(py, result))
        })
    }

    /// Time derivatives of outputs.
    fn rates<'py>(&self, py: Python<'py>, names: Vec<String>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.with(|state| {
            let references = state.references(&names)?;
            let mut values = vec![0.0; references.len()];
            let orders = vec![1; references.len()];
            state.own.0.get_real_output_derivatives(&references, &orders, &mut values).map_err(error)?;
            Ok(PyArray1::from_vec(py, values))
        })
    }

    /// Sets rates of inputs for the next step.
    fn set_rates(&self, names: Vec<String>, rates: Vec<f64>) -> PyResult<()> {
        self.with(|state| {
            let references = state.references(&names)?;
            let orders = vec![1; references.len()];
            state.own.0.set_real_input_derivatives(&references, &orders, &rates).map_err(error)?;
            state.rates.0.extend(references);
            state.rates.1.extend(rates);
            Ok(())
        })
    }

    /// The state, and the time.
    fn save(&self) -> PyResult<(f64, Vec<u8>)> {
        self.with(|state| {
            let instance = &state.own.0;
            let saved = instance.save_state().map_err(error)?;
            Ok((state.time, instance.serialize_state(&saved).map_err(error)?))
        })
    }

    /// Goes back, or on, to a state saved.
    fn restore(&self, time: f64, saved: &[u8]) -> PyResult<()> {
        self.with(|state| {
            let instance = &mut state.own.0;
            let saved = instance.deserialize_state(saved).map_err(error)?;
            instance.restore_state(&saved).map_err(error)?;
            (state.time, state.rates) = (time, Default::default());
            Ok(())
        })
    }

    /// The variables.
    fn variables(&self) -> PyResult<Vec<Described>> {
        self.with(|state| {
            let variables = state.own.0.description().variables.iter();
            let described = variables.map(|it| {
                let (causality, variability) = (it.causality.as_str(), it.variability.as_str());
                let unit = it.unit().map(str::to_owned);
                (it.name.clone(), it.kind.name(), causality, variability, unit, it.description.clone())
            });
            Ok(described.collect())
        })
    }

    /// Warnings and errors that it has logged.
    fn messages(&self) -> PyResult<Vec<String>> {
        self.with(|state| Ok(state.own.0.messages().into_iter().map(|record| record.message).collect()))
    }

    /// Frees it.
    fn close(&self) -> PyResult<()> {
        let state = self.lock()?.take();
        state.map_or(Ok(()), |state| state.own.0.free().map_err(error))
    }
}

impl Instance {
    fn of(instance: fmu_import::Instance) -> Self {
        Self { state: Mutex::new(Some(State { own: Own(instance), time: 0.0, rates: Default::default() })) }
    }

    /// Nobody waits: the thread that has the instance may need the interpreter's lock, which this one holds.
    fn lock(&self) -> PyResult<MutexGuard<'_, Option<State>>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                Err(error("another thread is using the instance; make one in each thread"))
            }
        }
    }

    fn with<T>(&self, work: impl FnOnce(&mut State) -> PyResult<T>) -> PyResult<T> {
        work(self.lock()?.as_mut().ok_or_else(|| error("the instance is closed"))?)
    }
}

impl State {
    /// Steps to `end`, s. Rates hold for one step of the FMU, and are set again for each.
    fn step(&mut self, end: f64) -> Result<(), FmiError> {
        let (references, rates) = &self.rates;
        if !references.is_empty() {
            self.own.0.set_real_input_derivatives(references, &vec![1; references.len()], rates)?;
        }
        self.own.0.do_step(self.time, end - self.time)?;
        self.time = end;
        Ok(())
    }

    fn references(&self, names: &[String]) -> PyResult<Vec<u32>> {
        let description = self.own.0.description();
        let reference = |name: &String| {
            let variable = description.variable(name).map_err(error)?;
            let is_real = matches!(variable.kind, fmu_import::Kind::Real { .. });
            is_real.then_some(variable.value_reference).ok_or_else(|| error(format!("{name}: is no Real variable")))
        };
        names.iter().map(reference).collect()
    }
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
