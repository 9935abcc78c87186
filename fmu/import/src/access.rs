//! Reading and writing the variables of an instance, by value reference (fast) and by name (comfortable).

use std::ffi::CString;

use fmu_abi::{fmi2Boolean, fmi2False};

use super::description::{Kind, Variable};
use super::error::{FmiError, Result, ValueError};
use super::instance::Instance;
use super::request::{Request, Results};
use super::value::Value;

#[allow(clippy::missing_errors_doc, reason = "the documentation of the type says when a call fails")]
impl Instance {
    /// Reads Reals. Does not allocate.
    #[inline]
    pub fn get_real(&self, references: &[u32], values: &mut [f64]) -> Result<()> {
        self.core().same_length("fmi2GetReal", references.len(), values.len(), "values")?;
        self.core().call(&Request::GetReal { references: references.into() }, Results::Reals(values))
    }

    /// Writes Reals. Does not allocate.
    #[inline]
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<()> {
        self.core().same_length("fmi2SetReal", references.len(), values.len(), "values")?;
        self.core().done(&Request::SetReal { references: references.into(), values: values.into() })
    }

    /// Reads Integers. Does not allocate.
    #[inline]
    pub fn get_integer(&self, references: &[u32], values: &mut [i32]) -> Result<()> {
        self.core().same_length("fmi2GetInteger", references.len(), values.len(), "values")?;
        self.core().call(&Request::GetInteger { references: references.into() }, Results::Integers(values))
    }

    /// Writes Integers. Does not allocate.
    #[inline]
    pub fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<()> {
        self.core().same_length("fmi2SetInteger", references.len(), values.len(), "values")?;
        self.core().done(&Request::SetInteger { references: references.into(), values: values.into() })
    }

    /// Gives inputs derivatives of the orders (1, 2, ...), for the FMU to extrapolate.
    pub fn set_real_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Result<()> {
        let name = "fmi2SetRealInputDerivatives";
        self.core().same_length(name, references.len(), orders.len(), "orders")?;
        self.core().same_length(name, references.len(), values.len(), "values")?;
        let (references, orders, values) = (references.into(), orders.into(), values.into());
        self.core().done(&Request::SetInputDerivatives { references, orders, values })
    }

    /// Reads derivatives of the orders (1, 2, ...) of outputs.
    pub fn get_real_output_derivatives(&self, references: &[u32], orders: &[i32], values: &mut [f64]) -> Result<()> {
        let name = "fmi2GetRealOutputDerivatives";
        self.core().same_length(name, references.len(), orders.len(), "orders")?;
        self.core().same_length(name, references.len(), values.len(), "values")?;
        let request = Request::GetOutputDerivatives { references: references.into(), orders: orders.into() };
        self.core().call(&request, Results::Reals(values))
    }

    /// Reads Booleans.
    pub fn get_boolean(&self, references: &[u32], values: &mut [bool]) -> Result<()> {
        self.core().same_length("fmi2GetBoolean", references.len(), values.len(), "values")?;
        let mut numbers = vec![fmi2False; values.len()];
        self.core().call(&Request::GetBoolean { references: references.into() }, Results::Integers(&mut numbers))?;
        values.iter_mut().zip(numbers).for_each(|(value, number)| *value = number != fmi2False);
        Ok(())
    }

    /// Writes Booleans.
    pub fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<()> {
        self.core().same_length("fmi2SetBoolean", references.len(), values.len(), "values")?;
        let numbers: Vec<_> = values.iter().map(|&value| fmi2Boolean::from(value)).collect();
        self.core().done(&Request::SetBoolean { references: references.into(), values: numbers.into() })
    }

    /// Reads Strings.
    pub fn get_string(&self, references: &[u32]) -> Result<Vec<String>> {
        let mut texts = vec![CString::default(); references.len()];
        self.core().call(&Request::GetString { references: references.into() }, Results::Texts(&mut texts))?;
        Ok(texts.iter().map(|text| text.to_string_lossy().into_owned()).collect())
    }

    /// Writes Strings.
    ///
    /// # Errors
    /// When the slices differ in length, a text holds a zero byte, or the call fails.
    pub fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<()> {
        self.core().same_length("fmi2SetString", references.len(), values.len(), "values")?;
        let owned =
            |text: &&str| CString::new(*text).map_err(|_| FmiError::Text { what: "value", text: (*text).to_owned() });
        let texts = values.iter().map(owned).collect::<Result<Vec<_>>>()?;
        self.core().done(&Request::SetString { references: references.into(), values: texts.into() })
    }

    /// Computes the change of `unknowns` for the change `seed` of `knowns`: `result = d unknowns / d knowns * seed`.
    ///
    /// # Errors
    /// When the FMU does not declare `providesDirectionalDerivative`, slices differ in length, or the call fails.
    pub fn directional_derivative(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        result: &mut [f64],
    ) -> Result<()> {
        let name = "fmi2GetDirectionalDerivative";
        let supported = self.description().co_simulation.provides_directional_derivative;
        self.core().require(name, supported, "providesDirectionalDerivative")?;
        self.core().same_length(name, knowns.len(), seed.len(), "seeds")?;
        self.core().same_length(name, unknowns.len(), result.len(), "results")?;
        let (unknowns, knowns, seed) = (unknowns.into(), knowns.into(), seed.into());
        self.core().call(&Request::DirectionalDerivative { unknowns, knowns, seed }, Results::Reals(result))
    }

    /// Sets the variable of this name from text, as a user types it: numbers, `true` or `false`, text, or the name of
    /// an enumeration's item. Bounds are checked before the FMU is asked.
    ///
    /// # Errors
    /// When there is no such variable (the error proposes one), it cannot be set, the text does not read as its type
    /// or lies out of its range, or the call fails.
    pub fn set_by_name(&mut self, name: &str, text: &str) -> Result<()> {
        let variable = self.description().variable(name)?;
        if !variable.is_settable() {
            return Err(not_settable(variable).into());
        }
        let value = Value::parse(self.description(), variable, text)?;
        let reference = variable.value_reference;
        self.set_value(reference, &value)
    }

    /// Sets what was chosen for an experiment from `start` to `stop`, s, and leaves the instance in initialization mode: inputs
    /// are set there, where FMI 2.0 wants them, all else before.
    ///
    /// # Errors
    /// The first of `set`, or of a call in between.
    pub fn begin_initialization<T, E: From<FmiError>>(
        &mut self,
        start: f64,
        stop: Option<f64>,
        choices: &[T],
        is_input: impl Fn(&T) -> bool,
        mut set: impl FnMut(&mut Self, &T) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        let (inputs, others): (Vec<_>, Vec<_>) = choices.iter().partition(|choice| is_input(choice));
        others.into_iter().try_for_each(|choice| set(self, choice))?;
        self.setup_experiment(start, stop, None)?;
        self.enter_initialization_mode()?;
        inputs.into_iter().try_for_each(|choice| set(self, choice))
    }

    /// Reads the variable of this name.
    ///
    /// # Errors
    /// When there is no such variable (the error proposes one), or the call fails.
    pub fn get_by_name(&self, name: &str) -> Result<Value> {
        let variable = self.description().variable(name)?;
        let reference = [variable.value_reference];
        Ok(match variable.kind {
            Kind::Real { .. } => {
                let mut value = [0.0];
                self.get_real(&reference, &mut value)?;
                Value::Real(value[0])
            }
            Kind::Integer { .. } | Kind::Enumeration { .. } => {
                let mut value = [0];
                self.get_integer(&reference, &mut value)?;
                if matches!(variable.kind, Kind::Integer { .. }) {
                    return Ok(Value::Integer(value[0]));
                }
                Value::of_enumeration(self.description(), variable, value[0])
            }
            Kind::Boolean { .. } => {
                let mut value = [false];
                self.get_boolean(&reference, &mut value)?;
                Value::Boolean(value[0])
            }
            Kind::String { .. } => Value::String(self.get_string(&reference)?.pop().unwrap_or_default()),
            Kind::Other => return Err(FmiError::Version { found: self.description().fmi_version.clone() }),
        })
    }

    /// Sets the variable with this reference, which must be of the value's type. Bounds are not checked.
    pub fn set_value(&mut self, reference: u32, value: &Value) -> Result<()> {
        let reference = [reference];
        match value {
            Value::Real(value) => self.set_real(&reference, &[*value]),
            Value::Integer(value) | Value::Enumeration { value, .. } => self.set_integer(&reference, &[*value]),
            Value::Boolean(value) => self.set_boolean(&reference, &[*value]),
            Value::String(value) => self.set_string(&reference, &[value]),
        }
    }
}

fn not_settable(variable: &Variable) -> ValueError {
    ValueError::NotSettable {
        variable: variable.name.clone(),
        variability: variable.variability.as_str(),
        causality: variable.causality.as_str(),
    }
}
