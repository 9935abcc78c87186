//! Reading and writing the variables of an instance, by value reference (fast) and by name (comfortable).

use std::ffi::{CStr, CString, c_char};
use std::ptr;

use fmu_abi::{fmi2Boolean, fmi2False};

use super::description::{Kind, Variable};
use super::error::{FmiError, Result, ValueError};
use super::instance::Instance;
use super::value::Value;

/// One getter or setter of numbers: the lengths must agree, nothing is allocated.
macro_rules! numbers {
    ($($(#[$doc:meta])* $method:ident($value:ty) = $symbol:literal $field:ident $($mutability:ident)?;)*) => {
        $(numbers!(@one $(#[$doc])* $method, $value, $symbol, $field, $($mutability)?);)*
    };
    (@one $(#[$doc:meta])* $method:ident, $value:ty, $symbol:literal, $field:ident, ) => {
        $(#[$doc])*
        ///
        /// # Errors
        /// When the slices differ in length, or the call fails.
        #[inline]
        pub fn $method(&self, references: &[u32], values: &mut [$value]) -> Result<()> {
            self.core().same_length($symbol, references.len(), values.len(), "values")?;
            // SAFETY: both slices hold as many items as is said.
            self.core().call($symbol, |functions, component| unsafe {
                (functions.$field)(component, references.as_ptr(), references.len(), values.as_mut_ptr())
            })
        }
    };
    (@one $(#[$doc:meta])* $method:ident, $value:ty, $symbol:literal, $field:ident, set) => {
        $(#[$doc])*
        ///
        /// # Errors
        /// When the slices differ in length, or the call fails.
        #[inline]
        pub fn $method(&mut self, references: &[u32], values: &[$value]) -> Result<()> {
            self.core().same_length($symbol, references.len(), values.len(), "values")?;
            // SAFETY: both slices hold as many items as is said.
            self.core().call($symbol, |functions, component| unsafe {
                (functions.$field)(component, references.as_ptr(), references.len(), values.as_ptr())
            })
        }
    };
}

/// One getter or setter of derivatives of an order.
macro_rules! derivatives {
    ($(#[$doc:meta])* $method:ident($($self:tt)+) $values:ty, $as_ptr:ident, $symbol:literal, $field:ident) => {
        $(#[$doc])*
        ///
        /// # Errors
        /// When the slices differ in length, or the call fails.
        pub fn $method(self: $($self)+, references: &[u32], orders: &[i32], values: $values) -> Result<()> {
            self.core().same_length($symbol, references.len(), orders.len(), "orders")?;
            self.core().same_length($symbol, references.len(), values.len(), "values")?;
            // SAFETY: all slices hold as many items as is said.
            self.core().call($symbol, |functions, component| unsafe {
                (functions.$field)(component, references.as_ptr(), references.len(), orders.as_ptr(), values.$as_ptr())
            })
        }
    };
}

impl Instance {
    numbers! {
        /// Reads Reals. Does not allocate.
        get_real(f64) = "fmi2GetReal" get_real;
        /// Writes Reals. Does not allocate.
        set_real(f64) = "fmi2SetReal" set_real set;
        /// Reads Integers and Enumerations.
        get_integer(i32) = "fmi2GetInteger" get_integer;
        /// Writes Integers and Enumerations.
        set_integer(i32) = "fmi2SetInteger" set_integer set;
    }

    derivatives! {
        /// Gives inputs derivatives of the orders (1, 2, ...), for the FMU to extrapolate.
        set_real_input_derivatives(&mut Self) &[f64], as_ptr, "fmi2SetRealInputDerivatives", set_real_input_derivatives
    }

    derivatives! {
        /// Reads derivatives of the orders (1, 2, ...) of outputs.
        get_real_output_derivatives(&Self) &mut [f64], as_mut_ptr, "fmi2GetRealOutputDerivatives", get_real_output_derivatives
    }

    /// Reads Booleans.
    ///
    /// # Errors
    /// When the slices differ in length, or the call fails.
    pub fn get_boolean(&self, references: &[u32], values: &mut [bool]) -> Result<()> {
        let name = "fmi2GetBoolean";
        self.core().same_length(name, references.len(), values.len(), "values")?;
        let mut numbers = vec![fmi2False; values.len()];
        // SAFETY: both slices hold as many items as is said.
        self.core().call(name, |functions, component| unsafe {
            (functions.get_boolean)(component, references.as_ptr(), references.len(), numbers.as_mut_ptr())
        })?;
        for (value, number) in values.iter_mut().zip(numbers) {
            *value = number != fmi2False;
        }
        Ok(())
    }

    /// Writes Booleans.
    ///
    /// # Errors
    /// When the slices differ in length, or the call fails.
    pub fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<()> {
        let name = "fmi2SetBoolean";
        self.core().same_length(name, references.len(), values.len(), "values")?;
        let numbers: Vec<_> = values.iter().map(|&value| fmi2Boolean::from(value)).collect();
        // SAFETY: both slices hold as many items as is said.
        self.core().call(name, |functions, component| unsafe {
            (functions.set_boolean)(component, references.as_ptr(), references.len(), numbers.as_ptr())
        })
    }

    /// Reads Strings.
    ///
    /// # Errors
    /// When the call fails.
    pub fn get_string(&self, references: &[u32]) -> Result<Vec<String>> {
        let mut pointers = vec![ptr::null(); references.len()];
        // SAFETY: both slices hold as many items as is said.
        self.core().call("fmi2GetString", |functions, component| unsafe {
            (functions.get_string)(component, references.as_ptr(), references.len(), pointers.as_mut_ptr())
        })?;
        // The strings live until the next call only, so they are copied.
        Ok(pointers.into_iter().map(copied).collect())
    }

    /// Writes Strings.
    ///
    /// # Errors
    /// When the slices differ in length, a text holds a zero byte, or the call fails.
    pub fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<()> {
        let name = "fmi2SetString";
        self.core().same_length(name, references.len(), values.len(), "values")?;
        let owned =
            |text: &&str| CString::new(*text).map_err(|_| FmiError::Text { what: "value", text: (*text).to_owned() });
        let texts = values.iter().map(owned).collect::<Result<Vec<_>>>()?;
        let pointers: Vec<_> = texts.iter().map(|text| text.as_ptr()).collect();
        // SAFETY: both slices hold as many items as is said, and the texts live until the call is over.
        self.core().call(name, |functions, component| unsafe {
            (functions.set_string)(component, references.as_ptr(), references.len(), pointers.as_ptr())
        })
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
        // SAFETY: all slices hold as many items as is said.
        self.core().call(name, |functions, component| unsafe {
            let (unknown_count, known_count) = (unknowns.len(), knowns.len());
            let (unknowns, knowns) = (unknowns.as_ptr(), knowns.as_ptr());
            let derivative = functions.get_directional_derivative;
            derivative(component, unknowns, unknown_count, knowns, known_count, seed.as_ptr(), result.as_mut_ptr())
        })
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
        })
    }

    /// Sets the variable with this reference, which must be of the value's type. Bounds are not checked.
    ///
    /// # Errors
    /// When the call fails.
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

/// Copies a string of the FMU; NULL counts as empty.
fn copied(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: the FMU returns zero-terminated strings that live until the next call.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}
