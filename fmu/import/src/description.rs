//! The content of `modelDescription.xml`, as typed values.

use std::collections::HashMap;
use std::str::FromStr;
use std::sync::Arc;

use super::error::{FmiError, Result};
use super::suggest;

/// The model description of a co-simulation FMU, of FMI 2.0 or 3.0. One of 3.0 can be read, not run; what has another name there
/// stands under that of 2.0.
#[derive(Debug, Clone)]
pub struct ModelDescription {
    /// Version of FMI: "2.0", or "3.0" with what may follow.
    pub fmi_version: String,
    /// Name of the model.
    pub model_name: String,
    /// Identifier that ties the description to its library; in FMI 3.0 the instantiation token.
    pub guid: String,
    /// One sentence about the model.
    pub description: Option<String>,
    /// The tool that wrote the FMU.
    pub generation_tool: Option<String>,
    /// Co-simulation interface and its capabilities.
    pub co_simulation: CoSimulation,
    /// Units that the variables use.
    pub units: Vec<Unit>,
    /// Enumeration types that the variables use.
    pub enumerations: Vec<EnumerationType>,
    /// Log categories that the FMU knows.
    pub log_categories: Vec<String>,
    /// Experiment that the author proposes.
    pub default_experiment: DefaultExperiment,
    /// All variables, in file order.
    pub variables: Vec<Variable>,
    /// Positions in `variables` of the outputs, as `ModelStructure` lists them.
    pub outputs: Vec<usize>,
    pub(super) positions: HashMap<String, usize>,
    pub(super) enumeration_positions: HashMap<String, usize>,
}

/// The `CoSimulation` element.
#[derive(Debug, Clone, Default, PartialEq)]
#[allow(clippy::struct_excessive_bools)]
pub struct CoSimulation {
    /// Stem of the library's file name; a C identifier.
    pub model_identifier: String,
    /// The FMU is only a wrapper for a tool that must be installed.
    pub needs_execution_tool: bool,
    /// `fmi2DoStep` takes steps of different sizes.
    pub can_handle_variable_communication_step_size: bool,
    /// Inputs may be given with derivatives.
    pub can_interpolate_inputs: bool,
    /// Highest order of output derivatives.
    pub max_output_derivative_order: u32,
    /// `fmi2DoStep` may return before it is done.
    pub can_run_asynchronously: bool,
    /// One instance a process.
    pub can_be_instantiated_only_once_per_process: bool,
    /// The memory callbacks are not used.
    pub can_not_use_memory_management_functions: bool,
    /// States can be saved and restored.
    pub can_get_and_set_fmu_state: bool,
    /// Saved states can be turned into bytes.
    pub can_serialize_fmu_state: bool,
    /// `fmi2GetDirectionalDerivative` works.
    pub provides_directional_derivative: bool,
}

/// A unit and its meaning in SI base units.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Name, as the variables refer to it.
    pub name: String,
    /// Meaning in base units, if given.
    pub base: Option<BaseUnit>,
}

/// Exponents of the SI base units and the conversion `base = factor * unit + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseUnit {
    /// Exponents of kg, m, s, A, K, mol, cd, rad.
    pub exponents: [i32; 8],
    /// Factor.
    pub factor: f64,
    /// Offset.
    pub offset: f64,
}

/// An enumeration type.
#[derive(Debug, Clone, PartialEq)]
pub struct EnumerationType {
    /// Name, as the variables refer to it.
    pub name: String,
    /// Its items, in file order.
    pub items: Vec<EnumerationItem>,
}

/// One item of an enumeration.
#[derive(Debug, Clone, PartialEq)]
pub struct EnumerationItem {
    /// Name.
    pub name: String,
    /// The integer that travels.
    pub value: i32,
    /// What it means.
    pub description: Option<String>,
}

/// The `DefaultExperiment` element.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DefaultExperiment {
    /// Start time, s.
    pub start_time: Option<f64>,
    /// Stop time, s.
    pub stop_time: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Communication step size, s.
    pub step_size: Option<f64>,
}

/// One scalar variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name.
    pub name: String,
    /// Handle for the C functions, unique for the base type.
    pub value_reference: u32,
    /// One sentence about it.
    pub description: Option<String>,
    /// Role.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// How its initial value comes about; none for inputs and the independent variable.
    pub initial: Option<Initial>,
    /// Name of its type definition.
    pub declared_type: Option<String>,
    /// Base type with its attributes, those of the type definition included.
    pub kind: Kind,
    /// Its XML element: the name of its type in its version of FMI.
    pub type_name: &'static str,
}

/// Base type of a variable.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // the fields are the attributes of the same name
pub enum Kind {
    /// 64-bit floating-point number.
    Real { unit: Option<Arc<str>>, start: Option<f64>, min: Option<f64>, max: Option<f64> },
    /// Integer: of 32 bits in FMI 2.0.
    Integer { start: Option<i64>, min: Option<i64>, max: Option<i64> },
    /// Truth value.
    Boolean { start: Option<bool> },
    /// Text.
    String { start: Option<String> },
    /// Item of the enumeration type named in [`Variable::declared_type`].
    Enumeration { start: Option<i32> },
    /// A type that FMI 2.0 does not have: clock or bytes.
    Other,
}

impl Kind {
    /// Name of the XML element.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Real { .. } => "Real",
            Self::Integer { .. } => "Integer",
            Self::Boolean { .. } => "Boolean",
            Self::String { .. } => "String",
            Self::Enumeration { .. } => "Enumeration",
            Self::Other => "Other",
        }
    }
}

impl Kind {
    /// Least and largest number allowed, of an integer as the nearest double.
    #[allow(clippy::cast_precision_loss)] // a bound beyond 2^53 is one to look at
    pub fn bounds(&self) -> [Option<f64>; 2] {
        match *self {
            Self::Real { min, max, .. } => [min, max],
            Self::Integer { min, max, .. } => [min, max].map(|bound| bound.map(|bound| bound as f64)),
            _ => [None; 2],
        }
    }
}

macro_rules! keywords {
    ($(#[$doc:meta])* $name:ident { $($(#[$item_doc:meta])* $item:ident = $text:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $name { $($(#[$item_doc])* $item),* }

        impl $name {
            /// All values, as the XML spells them.
            pub const ALLOWED: &'static [&'static str] = &[$($text),*];

            /// The value, as the XML spells it.
            pub fn as_str(self) -> &'static str {
                match self { $(Self::$item => $text),* }
            }
        }

        impl FromStr for $name {
            type Err = ();
            fn from_str(text: &str) -> std::result::Result<Self, ()> {
                match text { $($text => Ok(Self::$item),)* _ => Err(()) }
            }
        }
    };
}

keywords! {
    /// Role of a variable.
    Causality {
        /// Set before the simulation.
        Parameter = "parameter",
        /// Follows from parameters.
        CalculatedParameter = "calculatedParameter",
        /// Set by the environment.
        Input = "input",
        /// Read by the environment.
        Output = "output",
        /// Internal.
        Local = "local",
        /// Time.
        Independent = "independent",
    }
}

keywords! {
    /// When a variable may change.
    Variability {
        /// Never.
        Constant = "constant",
        /// Not after initialization.
        Fixed = "fixed",
        /// Between steps, by the environment.
        Tunable = "tunable",
        /// At events.
        Discrete = "discrete",
        /// All the time.
        Continuous = "continuous",
    }
}

keywords! {
    /// How an initial value comes about.
    Initial {
        /// The start value holds.
        Exact = "exact",
        /// The start value is a guess.
        Approx = "approx",
        /// It is computed.
        Calculated = "calculated",
    }
}

impl Variable {
    /// Whether the environment may set it (before initialization at least).
    pub fn is_settable(&self) -> bool {
        self.variability != Variability::Constant
            && (matches!(self.causality, Causality::Parameter | Causality::Input)
                || matches!(self.initial, Some(Initial::Exact | Initial::Approx)))
    }

    /// Whether it is an input.
    pub fn is_input(&self) -> bool {
        self.causality == Causality::Input
    }

    /// The unit of a Real that has one.
    pub fn unit(&self) -> Option<&str> {
        match &self.kind {
            Kind::Real { unit, .. } => unit.as_deref(),
            _ => None,
        }
    }
}

impl ModelDescription {
    /// Whether it is of FMI 3.0.
    pub fn is_fmi_3(&self) -> bool {
        self.fmi_version.starts_with("3.")
    }

    /// Whether there is an input of this name.
    pub fn is_input(&self, name: &str) -> bool {
        self.variable(name).is_ok_and(Variable::is_input)
    }

    /// The variable of this name.
    ///
    /// # Errors
    /// When there is none; the error names the nearest one.
    pub fn variable(&self, name: &str) -> Result<&Variable> {
        let found = self.positions.get(name).and_then(|&position| self.variables.get(position));
        found.ok_or_else(|| FmiError::UnknownVariable {
            model: self.model_name.clone(),
            name: name.to_owned(),
            suggestion: suggest::nearest(name, self.variables.iter().map(|variable| variable.name.as_str())),
        })
    }

    /// The same with further variables and enumeration types; those of names that are there already are left out.
    #[must_use]
    pub fn with(
        mut self,
        variables: impl IntoIterator<Item = Variable>,
        enumerations: impl IntoIterator<Item = EnumerationType>,
    ) -> Self {
        for variable in variables {
            if !self.positions.contains_key(&variable.name) {
                self.positions.insert(variable.name.clone(), self.variables.len());
                self.variables.push(variable);
            }
        }
        for enumeration in enumerations {
            if !self.enumeration_positions.contains_key(&enumeration.name) {
                self.enumeration_positions.insert(enumeration.name.clone(), self.enumerations.len());
                self.enumerations.push(enumeration);
            }
        }
        self
    }

    /// The enumeration type of this variable, if it is an enumeration.
    pub fn enumeration(&self, variable: &Variable) -> Option<&EnumerationType> {
        let name = variable.declared_type.as_deref()?;
        matches!(variable.kind, Kind::Enumeration { .. })
            .then(|| self.enumeration_positions.get(name).and_then(|&position| self.enumerations.get(position)))
            .flatten()
    }

    /// The outputs, as `ModelStructure` lists them.
    pub fn output_variables(&self) -> impl Iterator<Item = &Variable> {
        self.outputs.iter().filter_map(|&position| self.variables.get(position))
    }
}

#[cfg(test)]
mod tests;
