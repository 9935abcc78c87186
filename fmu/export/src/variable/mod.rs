//! The variable table: each fact about a variable stands here, once.
//!
//! A table is a `static` array of [`Variable`]s. The **value reference of a variable is its index in the
//! table**; the 1-based position that `ModelStructure` wants is that index plus one. The exporter reads and
//! writes the model through the accessors of the table, checks each Set against it, applies its start values
//! to a fresh model, derives the GUID from it and writes `modelDescription.xml` from it.
//!
//! Write `type V = Variable<MyModel>;` and start the rows with `V::`, so that the compiler knows the model in
//! every closure.

mod assign;
mod builder;
mod kind;

pub(crate) use assign::{
    AsBoolean, AsFloat32, AsFloat64, AsInt8, AsInt16, AsInt32, AsInt64, AsInteger, AsReal, AsString, AsUInt8, AsUInt16,
    AsUInt32, AsUInt64, Transfer,
};
pub use builder::{Declaration, ReadOnly, Settable};
pub use kind::{
    BooleanSpec, Choice, ClockInterval, ClockSpec, EnumerationSpec, EnumerationType, GetDerivative, Getter,
    IntegerSpec, IntegerWidth, Kind, PartialDerivative, RealSpec, SetDerivative, Setter, StringSpec,
};

use crate::standard::Standard;

/// What a variable is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Chosen by the user before the simulation.
    Parameter,
    /// Follows from parameters during initialisation.
    CalculatedParameter,
    /// Given by the environment at each communication point.
    Input,
    /// Given to the environment at each communication point.
    Output,
    /// For display only.
    Local,
    /// The independent variable, time.
    Independent,
}

impl Causality {
    /// The word of `modelDescription.xml`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Parameter => "parameter",
            Self::CalculatedParameter => "calculatedParameter",
            Self::Input => "input",
            Self::Output => "output",
            Self::Local => "local",
            Self::Independent => "independent",
        }
    }
}

/// When a variable may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variability {
    /// Not after initialisation.
    Fixed,
    /// Between steps.
    Tunable,
    /// At events.
    Discrete,
    /// At any time (Real only).
    Continuous,
}

impl Variability {
    /// The word of `modelDescription.xml`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Tunable => "tunable",
            Self::Discrete => "discrete",
            Self::Continuous => "continuous",
        }
    }
}

/// Where the initial value of a variable comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// The start value is the initial value.
    Exact,
    /// The model calculates it.
    Calculated,
}

impl Initial {
    /// The word of `modelDescription.xml`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Calculated => "calculated",
        }
    }
}

/// One row of the variable table of the model `M`. Made by the constructors in this module, such as
/// [`Variable::parameter`].
pub struct Variable<M: 'static> {
    pub(crate) name: &'static str,
    pub(crate) description: &'static str,
    pub(crate) causality: Causality,
    pub(crate) variability: Variability,
    pub(crate) kind: Kind<M>,
    pub(crate) dependencies: Option<&'static [&'static str]>,
    pub(crate) initial_dependencies: Option<&'static [&'static [&'static str]]>,
    pub(crate) derivative_of: Option<&'static str>,
    pub(crate) alias_of: Option<&'static str>,
    pub(crate) clocks: &'static [&'static str],
    pub(crate) reinit: bool,
}

// Derived impls would ask for `M: Clone`, which fn pointers do not need.
impl<M> Clone for Variable<M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<M> Copy for Variable<M> {}

/// One table from several groups of rows. `N` must be the number of all rows; anything else does not compile where the
/// table is a `static`. Such a table takes no memory that an unloaded library would leave behind.
///
/// # Panics
/// At compile time, if `N` is not the number of rows or there is none.
pub const fn concat<M, const N: usize>(groups: &[&[Variable<M>]]) -> [Variable<M>; N] {
    let mut table = [groups[0][0]; N];
    let (mut filled, mut group) = (0, 0);
    while group < groups.len() {
        let mut row = 0;
        while row < groups[group].len() {
            table[filled] = groups[group][row];
            filled += 1;
            row += 1;
        }
        group += 1;
    }
    assert!(filled == N, "N is not the number of rows");
    table
}

impl<M> Variable<M> {
    /// Name, unique in the table.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// One line that tells the user what it is.
    pub const fn description(&self) -> &'static str {
        self.description
    }

    /// What it is for.
    pub const fn causality(&self) -> Causality {
        self.causality
    }

    /// When it may change.
    pub const fn variability(&self) -> Variability {
        self.variability
    }

    /// Where its initial value comes from; `None` for inputs and the independent variable, where FMI 2.0
    /// forbids the attribute.
    pub const fn initial(&self) -> Option<Initial> {
        match self.causality {
            Causality::Parameter => Some(Initial::Exact),
            Causality::CalculatedParameter | Causality::Output | Causality::Local => Some(Initial::Calculated),
            Causality::Input | Causality::Independent => None,
        }
    }

    /// Type, with its attributes and accessors.
    pub const fn kind(&self) -> &Kind<M> {
        &self.kind
    }

    /// Names of the variables that an output depends on at a communication point; `None` if nothing is promised,
    /// which importers read as "on every input".
    pub const fn dependencies(&self) -> Option<&'static [&'static str]> {
        self.dependencies
    }

    /// Names of the inputs and parameters that an initial value depends on, in groups; `None` if nothing is promised.
    pub const fn initial_dependencies(&self) -> Option<&'static [&'static [&'static str]]> {
        self.initial_dependencies
    }

    /// Name of the continuous state whose time derivative this is.
    pub const fn derivative_of(&self) -> Option<&'static str> {
        self.derivative_of
    }

    /// Name of the variable that FMI 3.0 has in its place.
    pub const fn alias_of(&self) -> Option<&'static str> {
        self.alias_of
    }

    /// Names of the clocks at whose ticks FMI 3.0 has it; none for one that is there always.
    pub const fn clocks(&self) -> &'static [&'static str] {
        self.clocks
    }

    /// Whether this is a clock.
    pub const fn is_clock(&self) -> bool {
        matches!(self.kind, Kind::Clock(_))
    }

    /// Whether a version of FMI has such a variable: FMI 2.0 sees no clocks and none of the variables that belong to some.
    pub const fn is_of(&self, standard: Standard) -> bool {
        matches!(standard, Standard::Fmi3) || !self.is_clock() && self.clocks.is_empty()
    }

    /// Whether this is a continuous state that jumps at events of model exchange.
    pub const fn reinit(&self) -> bool {
        self.reinit
    }
}

/// Value reference of the variable `name` in a table, `None` if there is no such variable.
pub fn value_reference<M>(table: &[Variable<M>], name: &str) -> Option<u32> {
    let index = table.iter().position(|v| v.name == name)?;
    u32::try_from(index).ok()
}
