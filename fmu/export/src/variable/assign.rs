//! Checks of a value ahead of a Set, and the accessors by type. Nothing is written here that was not checked.

use super::kind::{EnumerationSpec, IntegerSpec, Kind, RealSpec, StringSpec};
use super::{BooleanSpec, Variable};
use crate::error::CallError;
use fmu_abi::fmi2Boolean;

/// A type of the C interface. Enumerations travel as Integers.
pub(crate) trait Transfer<M: 'static>: Copy {
    /// What is handed in by a Set.
    type Given<'a>: Copy;
    /// What is handed out by a Get.
    type Taken;
    /// Name for messages.
    const NAME: &'static str;

    /// Reads the variable; `None` if it is of another type.
    fn get(variable: &Variable<M>, model: &M) -> Option<Self::Taken>;

    /// Checks a value against the variable; `None` if it is of another type.
    fn check(variable: &Variable<M>, value: Self::Given<'_>) -> Option<Result<(), CallError>>;

    /// Writes the variable.
    fn set(variable: &Variable<M>, model: &mut M, value: Self::Given<'_>);
}

/// Marker of `fmi2Real`.
#[derive(Clone, Copy)]
pub(crate) struct AsReal;
/// Marker of `fmi2Integer`.
#[derive(Clone, Copy)]
pub(crate) struct AsInteger;
/// Marker of `fmi2Boolean`.
#[derive(Clone, Copy)]
pub(crate) struct AsBoolean;
/// Marker of `fmi2String`.
#[derive(Clone, Copy)]
pub(crate) struct AsString;

impl<M: 'static> Transfer<M> for AsReal {
    type Given<'a> = f64;
    type Taken = f64;
    const NAME: &'static str = "Real";

    fn get(variable: &Variable<M>, model: &M) -> Option<f64> {
        match &variable.kind {
            Kind::Real(spec) => Some((spec.get)(model)),
            _ => None,
        }
    }

    fn check(variable: &Variable<M>, value: f64) -> Option<Result<(), CallError>> {
        match &variable.kind {
            Kind::Real(spec) => Some(refuse(variable, &value, spec.complaint(value))),
            _ => None,
        }
    }

    fn set(variable: &Variable<M>, model: &mut M, value: f64) {
        if let Kind::Real(RealSpec { set: Some(set), .. }) = variable.kind {
            set(model, value);
        }
    }
}

impl<M: 'static> Transfer<M> for AsInteger {
    type Given<'a> = i32;
    type Taken = i32;
    const NAME: &'static str = "Integer";

    fn get(variable: &Variable<M>, model: &M) -> Option<i32> {
        match &variable.kind {
            Kind::Integer(spec) => Some((spec.get)(model)),
            Kind::Enumeration(spec) => Some((spec.get)(model)),
            _ => None,
        }
    }

    fn check(variable: &Variable<M>, value: i32) -> Option<Result<(), CallError>> {
        match &variable.kind {
            Kind::Integer(spec) => Some(refuse(variable, &value, spec.complaint(value))),
            Kind::Enumeration(spec) => Some(refuse(variable, &value, spec.complaint(value))),
            _ => None,
        }
    }

    fn set(variable: &Variable<M>, model: &mut M, value: i32) {
        if let Kind::Integer(IntegerSpec { set: Some(set), .. })
        | Kind::Enumeration(EnumerationSpec { set: Some(set), .. }) = variable.kind
        {
            set(model, value);
        }
    }
}

impl<M: 'static> Transfer<M> for AsBoolean {
    type Given<'a> = bool;
    type Taken = fmi2Boolean;
    const NAME: &'static str = "Boolean";

    fn get(variable: &Variable<M>, model: &M) -> Option<fmi2Boolean> {
        match &variable.kind {
            Kind::Boolean(spec) => Some(fmi2Boolean::from((spec.get)(model))),
            _ => None,
        }
    }

    fn check(variable: &Variable<M>, _: bool) -> Option<Result<(), CallError>> {
        matches!(variable.kind, Kind::Boolean(_)).then_some(Ok(()))
    }

    fn set(variable: &Variable<M>, model: &mut M, value: bool) {
        if let Kind::Boolean(BooleanSpec { set: Some(set), .. }) = variable.kind {
            set(model, value);
        }
    }
}

impl<M: 'static> Transfer<M> for AsString {
    /// The text, or why the C string is none.
    type Given<'a> = Result<&'a str, &'static str>;
    type Taken = String;
    const NAME: &'static str = "String";

    fn get(variable: &Variable<M>, model: &M) -> Option<String> {
        match &variable.kind {
            Kind::String(spec) => Some((spec.get)(model)),
            _ => None,
        }
    }

    fn check(variable: &Variable<M>, value: Self::Given<'_>) -> Option<Result<(), CallError>> {
        match &variable.kind {
            Kind::String(spec) => {
                let complaint = value.map_or_else(|reason| Some(reason.to_owned()), |text| spec.complaint(text));
                Some(refuse(variable, &value.map_or_else(|_| "?".to_owned(), beginning), complaint))
            }
            _ => None,
        }
    }

    fn set(variable: &Variable<M>, model: &mut M, value: Self::Given<'_>) {
        if let Kind::String(StringSpec { set: Some(set), .. }) = variable.kind
            && let Ok(value) = value
        {
            set(model, value);
        }
    }
}

fn refuse<M>(variable: &Variable<M>, value: &impl ToString, complaint: Option<String>) -> Result<(), CallError> {
    complaint.map_or(Ok(()), |bound| Err(CallError::BadValue { name: variable.name, value: value.to_string(), bound }))
}

/// What a message shows of a text.
fn beginning(text: &str) -> String {
    text.char_indices().nth(40).map_or_else(|| format!("{text:?}"), |(end, _)| format!("{:?}...", &text[..end]))
}

impl<M> StringSpec<M> {
    /// Why a value is refused, if it is.
    pub(crate) fn complaint(&self, value: &str) -> Option<String> {
        let bytes = value.len();
        (bytes > self.longest).then(|| format!("{bytes} bytes are too long; at most {}", self.longest))
    }
}

impl<M> RealSpec<M> {
    /// Why a value is refused, if it is.
    pub(crate) fn complaint(&self, value: f64) -> Option<String> {
        let unit = if self.unit == "1" { "" } else { self.unit };
        if value.is_nan() || (value.is_infinite() && !self.infinity_allowed) {
            Some("it must be finite".to_owned())
        } else if value < self.min {
            Some(format!("below its min {} {unit}", self.min).trim_end().to_owned())
        } else if value > self.max {
            Some(format!("above its max {} {unit}", self.max).trim_end().to_owned())
        } else {
            None
        }
    }
}

impl<M> IntegerSpec<M> {
    /// Why a value is refused, if it is.
    pub(crate) fn complaint(&self, value: i32) -> Option<String> {
        if value < self.min {
            Some(format!("below its min {}", self.min))
        } else if value > self.max {
            Some(format!("above its max {}", self.max))
        } else {
            None
        }
    }
}

impl<M> EnumerationSpec<M> {
    /// Why a value is refused, if it is.
    pub(crate) fn complaint(&self, value: i32) -> Option<String> {
        if self.of.item(value).is_some() {
            return None;
        }
        let items = self.of.items.iter().zip(1..);
        let choices: Vec<_> = items.map(|((name, _), n)| format!("{n} ({name})")).collect();
        Some(format!("no item of {}; allowed: {}", self.of.name, choices.join(", ")))
    }
}
