//! The types of variables with their attributes and the accessors into the model. FMI 2.0 has one Real and one Integer
//! where FMI 3.0 has one of each size; it has no clocks, whose rows it does not see.

use super::Variable;

/// Type of a variable with the attributes of that type.
pub enum Kind<M: 'static> {
    /// `fmi2Real`; `fmi3Float64`, or `fmi3Float32` if it is [`single`](RealSpec::single)
    Real(RealSpec<M>),
    /// `fmi2Integer`; in FMI 3.0 of its [`width`](IntegerSpec::width)
    Integer(IntegerSpec<M>),
    /// `fmi2Boolean`, `fmi3Boolean`
    Boolean(BooleanSpec<M>),
    /// `fmi2String`, `fmi3String`
    String(StringSpec<M>),
    /// An `fmi2Integer` or `fmi3Int64` that counts the items of an enumeration from 1.
    Enumeration(EnumerationSpec<M>),
    /// `fmi3Clock`
    Clock(ClockSpec<M>),
}

/// How a variable is read.
pub enum Getter<M: 'static, T: 'static> {
    /// By a function of its own.
    Field(fn(&M) -> T),
    /// By its number: a function for all rows of a table that is known at run time only.
    Element(fn(&M, usize) -> T, usize),
}

impl<M, T> Getter<M, T> {
    /// Reads the model.
    #[inline]
    pub fn get(self, model: &M) -> T {
        match self {
            Self::Field(get) => get(model),
            Self::Element(get, number) => get(model, number),
        }
    }
}

/// How a variable is written.
pub enum Setter<M: 'static, T: 'static> {
    /// By a function of its own.
    Field(fn(&mut M, T)),
    /// By its number, as [`Getter::Element`].
    Element(fn(&mut M, usize, T), usize),
}

impl<M, T> Setter<M, T> {
    /// Writes the model.
    #[inline]
    pub fn set(self, model: &mut M, value: T) {
        match self {
            Self::Field(set) => set(model, value),
            Self::Element(set, number) => set(model, number, value),
        }
    }
}

/// Sets a time derivative of an input: model, order from 1, value.
pub type SetDerivative<M> = fn(&mut M, u32, f64);

/// Gives a time derivative of an output: model, order from 1.
pub type GetDerivative<M> = fn(&M, u32) -> f64;

/// Gives the partial derivative of a Real with respect to `known`; see [`RealSpec::partial_derivative`].
pub type PartialDerivative<M> = fn(&M, known: &Variable<M>) -> f64;

/// Attributes and accessors of a Real.
pub struct RealSpec<M: 'static> {
    /// Unit, `"1"` if it has none.
    pub unit: &'static str,
    /// Whether FMI 3.0 has it in single precision.
    pub single: bool,
    /// Start value in that unit; none if the model calculates it.
    pub start: Option<f64>,
    /// Lower bound; minus infinity if there is none.
    pub min: f64,
    /// Upper bound; infinity if there is none.
    pub max: f64,
    /// Typical magnitude.
    pub nominal: Option<f64>,
    /// Whether a Set may give an infinite value. NaN is refused always.
    pub infinity_allowed: bool,
    /// Reads the model.
    pub get: Getter<M, f64>,
    /// Writes the model.
    pub set: Option<Setter<M, f64>>,
    /// Highest order and setter of the time derivatives of an input.
    pub input_derivatives: Option<(u32, SetDerivative<M>)>,
    /// Highest order and getter of the time derivatives of an output.
    pub output_derivatives: Option<(u32, GetDerivative<M>)>,
    /// Partial derivative with respect to another Real, everything else that may be set being constant; zero if none is
    /// given. Asked for only if [`ModelInfo::directional_derivatives`](crate::ModelInfo::directional_derivatives) is set.
    /// This Real is an output or the derivative of a continuous state, before the end of initialisation also a calculated
    /// parameter; the other is an input or, before the end of initialisation, a parameter, afterwards a continuous state.
    ///
    /// Of an input in co-simulation it is the derivative at the end of the last step with respect to the input held during
    /// that step, of a state that at the communication point. In model exchange, after initialisation, it is asked for
    /// only where this Real depends on the other, as its row says; else it is zero.
    ///
    /// NaN where the model knows none: the call is an error then.
    pub partial_derivative: Option<PartialDerivative<M>>,
}

/// Attributes and accessors of an Integer.
pub struct IntegerSpec<M: 'static> {
    /// Its type in FMI 3.0. In FMI 2.0 it is an Integer of 32 bits, and what is too large for that shows as the nearest one.
    pub width: IntegerWidth,
    /// Start value; none if the model calculates it.
    pub start: Option<i64>,
    /// Lower bound; that of its type if there is no other.
    pub min: i64,
    /// Upper bound; that of its type if there is no other.
    pub max: i64,
    /// Reads the model.
    pub get: Getter<M, i64>,
    /// Writes the model.
    pub set: Option<Setter<M, i64>>,
}

macro_rules! integer_widths {
    ($($width:ident $integer:ty;)*) => {
        /// Type of an Integer in FMI 3.0.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum IntegerWidth {
            $(#[doc = concat!("`fmi3", stringify!($width), "`")] $width,)*
        }

        impl IntegerWidth {
            /// The name of the type, as the XML element of FMI 3.0.
            pub const fn type_name(self) -> &'static str {
                match self { $(Self::$width => stringify!($width),)* }
            }

            /// Smallest and largest value. Those of the model are of 64 bits with a sign.
            #[allow(clippy::cast_possible_wrap, clippy::cast_lossless)] // no `From` in const; `u64::MAX` is looked at
            pub const fn bounds(self) -> (i64, i64) {
                match self {
                    Self::UInt64 => (0, i64::MAX),
                    $(#[allow(unreachable_patterns)] Self::$width => (<$integer>::MIN as i64, <$integer>::MAX as i64),)*
                }
            }
        }
    };
}
integer_widths! {
    Int8 i8;
    UInt8 u8;
    Int16 i16;
    UInt16 u16;
    Int32 i32;
    UInt32 u32;
    Int64 i64;
    UInt64 u64;
}

/// Attributes and accessors of a clock.
pub struct ClockSpec<M: 'static> {
    /// When it ticks.
    pub interval: ClockInterval,
    /// Whether it ticks at the present event.
    pub get: Getter<M, bool>,
    /// Makes it tick, or no longer. An input has one.
    pub set: Option<Setter<M, bool>>,
}

/// When a clock ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClockInterval {
    /// Whenever the model (an output) or the environment (an input) says.
    Triggered,
    /// At regular times: an input that the environment makes tick.
    Periodic {
        /// From one tick to the next, s.
        interval: f64,
        /// First tick after the start, s.
        shift: f64,
    },
}

/// Attributes and accessors of a Boolean.
pub struct BooleanSpec<M: 'static> {
    /// Start value; none if the model calculates it.
    pub start: Option<bool>,
    /// Reads the model.
    pub get: Getter<M, bool>,
    /// Writes the model.
    pub set: Option<Setter<M, bool>>,
}

/// Attributes and accessors of a String.
pub struct StringSpec<M: 'static> {
    /// Start value; none if the model calculates it.
    pub start: Option<&'static str>,
    /// Most bytes that a Set may give; `usize::MAX` if there is no bound.
    pub longest: usize,
    /// Reads the model.
    pub get: Getter<M, String>,
    /// Writes the model.
    pub set: Option<Setter<M, String>>,
}

/// Attributes and accessors of an enumeration. The accessors speak in item numbers, from 1.
pub struct EnumerationSpec<M: 'static> {
    /// The enumeration.
    pub of: &'static EnumerationType,
    /// Start value; none if the model calculates it.
    pub start: Option<i32>,
    /// Reads the model.
    pub get: Getter<M, i32>,
    /// Writes the model; never called with a number that is not an item.
    pub set: Option<Setter<M, i32>>,
}

/// An enumeration type. Its items are numbered from 1 in the order given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EnumerationType {
    /// Name, unique among the types and different from every variable name.
    pub name: &'static str,
    /// What the choice is about.
    pub description: &'static str,
    /// Name and meaning of each item.
    pub items: &'static [(&'static str, &'static str)],
}

impl EnumerationType {
    /// The number of the item with this name, counted from 1.
    ///
    /// # Panics
    /// If there is none; in a table, that is at compile time.
    #[allow(clippy::panic)]
    pub const fn number_of(&self, name: &str) -> i32 {
        let (mut index, mut number) = (0, 1);
        while index < self.items.len() {
            if same(self.items[index].0.as_bytes(), name.as_bytes()) {
                return number;
            }
            (index, number) = (index + 1, number + 1);
        }
        panic!("the enumeration has no such item");
    }

    /// Name of the item with this number, counted from 1.
    pub fn item(&self, number: i32) -> Option<&'static str> {
        let index = usize::try_from(number).ok()?.checked_sub(1)?;
        self.items.get(index).map(|item| item.0)
    }
}

const fn same(a: &[u8], b: &[u8]) -> bool {
    let mut k = 0;
    while k < a.len() && k < b.len() && a[k] == b[k] {
        k += 1;
    }
    k == a.len() && k == b.len()
}

/// A type of a model whose values are the items of an enumeration. With the feature `derive`, `#[derive(Choice)]` makes an `enum`
/// one: name and documentation of each item are those of the enumeration.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no type of a variable",
    label = "none of f64, f32, i8 to u64, bool and String, each under this very name, and no enum with #[derive(Choice)]"
)]
pub trait Choice: Sized {
    /// The enumeration.
    const TYPE: &'static EnumerationType;

    /// The number of an item, from 1.
    fn number(&self) -> i32;

    /// The item with this number, if there is one.
    fn of(number: i32) -> Option<Self>;
}

// Derived impls would ask for `M: Clone`, which fn pointers do not need.
macro_rules! copy {
    ($($name:ident<M $(, $value:ident)?>)*) => {$(
        impl<M $(, $value)?> Clone for $name<M $(, $value)?> {
            fn clone(&self) -> Self {
                *self
            }
        }
        impl<M $(, $value)?> Copy for $name<M $(, $value)?> {}
    )*};
}
copy!(Kind<M> RealSpec<M> IntegerSpec<M> BooleanSpec<M> StringSpec<M> EnumerationSpec<M> ClockSpec<M> Getter<M, T> Setter<M, T>);

impl<M> Kind<M> {
    /// The name of the type, as the XML element of the `modelDescription.xml` of FMI 2.0.
    pub const fn type_name(&self) -> &'static str {
        match self {
            Self::Real(_) => "Real",
            Self::Integer(_) => "Integer",
            Self::Boolean(_) => "Boolean",
            Self::String(_) => "String",
            Self::Enumeration(_) => "Enumeration",
            Self::Clock(_) => "Clock",
        }
    }

    /// The same for FMI 3.0.
    pub const fn type_name_3(&self) -> &'static str {
        match self {
            Self::Real(spec) if spec.single => "Float32",
            Self::Real(_) => "Float64",
            Self::Integer(spec) => spec.width.type_name(),
            _ => self.type_name(),
        }
    }

    /// Writes the start value into a model, if there is one.
    pub(crate) fn apply_start(&self, model: &mut M) {
        match self {
            Self::Real(s) => apply(s.start, s.set, model),
            Self::Integer(s) => apply(s.start, s.set, model),
            Self::Boolean(s) => apply(s.start, s.set, model),
            Self::Enumeration(s) => apply(s.start, s.set, model),
            Self::String(s) => apply(s.start.map(str::to_owned), s.set, model),
            Self::Clock(_) => {}
        }
    }
}

fn apply<M, T>(start: Option<T>, setter: Option<Setter<M, T>>, model: &mut M) {
    if let (Some(start), Some(setter)) = (start, setter) {
        setter.set(model, start);
    }
}
