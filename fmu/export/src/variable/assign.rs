//! Checks of a value ahead of a Set, and the accessors by type. Nothing is written here that was not checked.

use super::kind::{EnumerationSpec, IntegerSpec, IntegerWidth, Kind, RealSpec, StringSpec};
use super::{BooleanSpec, Variable};
use crate::error::CallError;
use fmu_abi::fmi2Boolean;

/// A type of the C interface. Enumerations travel as Integers, in FMI 3.0 as Int64.
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
/// Marker of `fmi3Float64`.
#[derive(Clone, Copy)]
pub(crate) struct AsFloat64;
/// Marker of `fmi3Float32`.
#[derive(Clone, Copy)]
pub(crate) struct AsFloat32;
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
            Kind::Real(spec) => Some(spec.get.get(model)),
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
            set.set(model, value);
        }
    }
}

impl<M: 'static> Transfer<M> for AsFloat64 {
    type Given<'a> = f64;
    type Taken = f64;
    const NAME: &'static str = "Float64";

    fn get(variable: &Variable<M>, model: &M) -> Option<f64> {
        if variable.kind.is_single() { None } else { AsReal::get(variable, model) }
    }

    fn check(variable: &Variable<M>, value: f64) -> Option<Result<(), CallError>> {
        if variable.kind.is_single() { None } else { AsReal::check(variable, value) }
    }

    fn set(variable: &Variable<M>, model: &mut M, value: f64) {
        AsReal::set(variable, model, value);
    }
}

impl<M: 'static> Transfer<M> for AsFloat32 {
    type Given<'a> = f32;
    type Taken = f32;
    const NAME: &'static str = "Float32";

    #[allow(clippy::cast_possible_truncation)] // what single precision is
    fn get(variable: &Variable<M>, model: &M) -> Option<f32> {
        variable.kind.is_single().then(|| AsReal::get(variable, model)).flatten().map(|value| value as f32)
    }

    fn check(variable: &Variable<M>, value: f32) -> Option<Result<(), CallError>> {
        variable.kind.is_single().then(|| AsReal::check(variable, value.into())).flatten()
    }

    fn set(variable: &Variable<M>, model: &mut M, value: f32) {
        AsReal::set(variable, model, value.into());
    }
}

/// How an integer of the C interface and one of a model become the other; what does not fit, the nearest.
trait Whole: Copy + ToString {
    fn of(value: i64) -> Self;
    fn widened(self) -> Option<i64>;
}

impl<M> Kind<M> {
    fn whole(&self, model: &M) -> Option<i64> {
        match self {
            Self::Integer(spec) => Some(spec.get.get(model)),
            Self::Enumeration(spec) => Some(spec.get.get(model).into()),
            _ => None,
        }
    }

    /// What is wrong with a value, too large for 64 bits if none; none if it is of another type.
    fn check_whole(&self, value: Option<i64>) -> Option<Result<(), String>> {
        let complaint = match self {
            Self::Integer(spec) => {
                value.map_or_else(|| Some(format!("above its max {}", spec.max)), |value| spec.complaint(value))
            }
            Self::Enumeration(spec) => {
                let number = value.and_then(|value| i32::try_from(value).ok());
                spec.complaint(number.unwrap_or(i32::MIN))
            }
            _ => return None,
        };
        Some(complaint.map_or(Ok(()), Err))
    }

    fn set_whole(&self, model: &mut M, value: i64) {
        match self {
            Self::Integer(IntegerSpec { set: Some(set), .. }) => set.set(model, value),
            Self::Enumeration(EnumerationSpec { set: Some(set), .. }) => set.set(model, i32::of(value)),
            _ => {}
        }
    }
}

macro_rules! integers {
    ($($marker:ident $integer:ident $name:literal |$kind:ident| $fits:expr;)*) => {$(
        #[doc = concat!("Marker of ", $name, ".")]
        #[derive(Clone, Copy)]
        pub(crate) struct $marker;

        impl<M: 'static> Transfer<M> for $marker {
            type Given<'a> = $integer;
            type Taken = $integer;
            const NAME: &'static str = $name;

            fn get(variable: &Variable<M>, model: &M) -> Option<$integer> {
                let $kind = &variable.kind;
                if $fits { $kind.whole(model).map(Whole::of) } else { None }
            }

            fn check(variable: &Variable<M>, value: $integer) -> Option<Result<(), CallError>> {
                let $kind = &variable.kind;
                let checked = if $fits { $kind.check_whole(value.widened()) } else { None };
                checked.map(|checked| refuse(variable, &value, checked.err()))
            }

            fn set(variable: &Variable<M>, model: &mut M, value: $integer) {
                if let Some(value) = value.widened() {
                    variable.kind.set_whole(model, value);
                }
            }
        }
    )*};
}
integers! {
    AsInteger i32 "Integer" |_kind| true;
    AsInt8 i8 "Int8" |kind| kind.is_of(IntegerWidth::Int8);
    AsUInt8 u8 "UInt8" |kind| kind.is_of(IntegerWidth::UInt8);
    AsInt16 i16 "Int16" |kind| kind.is_of(IntegerWidth::Int16);
    AsUInt16 u16 "UInt16" |kind| kind.is_of(IntegerWidth::UInt16);
    AsInt32 i32 "Int32" |kind| kind.is_of(IntegerWidth::Int32);
    AsUInt32 u32 "UInt32" |kind| kind.is_of(IntegerWidth::UInt32);
    AsInt64 i64 "Int64" |kind| kind.is_of(IntegerWidth::Int64) || matches!(kind, Kind::Enumeration(_));
    AsUInt64 u64 "UInt64" |kind| kind.is_of(IntegerWidth::UInt64);
}

impl<M> Kind<M> {
    /// Whether FMI 3.0 has it as a Float32.
    pub(crate) const fn is_single(&self) -> bool {
        matches!(self, Self::Real(spec) if spec.single)
    }

    fn is_of(&self, width: IntegerWidth) -> bool {
        matches!(self, Self::Integer(spec) if spec.width == width)
    }
}

macro_rules! whole {
    ($($integer:ty)*) => {$(
        impl Whole for $integer {
            fn of(value: i64) -> Self {
                Self::try_from(value).unwrap_or(if value < 0 { Self::MIN } else { Self::MAX })
            }

            fn widened(self) -> Option<i64> {
                i64::try_from(self).ok()
            }
        }
    )*};
}
whole!(i8 u8 i16 u16 i32 u32 i64 u64);

impl<M: 'static> Transfer<M> for AsBoolean {
    type Given<'a> = bool;
    type Taken = fmi2Boolean;
    const NAME: &'static str = "Boolean";

    fn get(variable: &Variable<M>, model: &M) -> Option<fmi2Boolean> {
        match &variable.kind {
            Kind::Boolean(spec) => Some(fmi2Boolean::from(spec.get.get(model))),
            _ => None,
        }
    }

    fn check(variable: &Variable<M>, _: bool) -> Option<Result<(), CallError>> {
        matches!(variable.kind, Kind::Boolean(_)).then_some(Ok(()))
    }

    fn set(variable: &Variable<M>, model: &mut M, value: bool) {
        if let Kind::Boolean(BooleanSpec { set: Some(set), .. }) = variable.kind {
            set.set(model, value);
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
            Kind::String(spec) => Some(spec.get.get(model)),
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
            set.set(model, value.to_owned());
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
        } else if self.single && value.is_finite() && value.abs() > f64::from(f32::MAX) {
            Some(format!("beyond {:e}, the largest number in single precision", f32::MAX))
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
    pub(crate) fn complaint(&self, value: i64) -> Option<String> {
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
