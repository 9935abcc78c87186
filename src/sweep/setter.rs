//! How a variable of the harvester sets a parameter of the model.

use fmu_import::{Kind, Value, Variable};
use videg_model::Parameters;

/// How a parameter of the model is set.
#[derive(Clone, Copy)]
pub(super) enum Setter {
    Quantity(fn(&mut Parameters, f64)),
    Choice(fn(&mut Parameters, i32)),
}

impl Setter {
    /// That of `variable`, if it is a parameter whose values are of the parameter's type.
    pub(super) fn of(variable: &Variable) -> Option<Self> {
        let named = |name: &str| name == variable.name;
        match variable.kind {
            Kind::Real { .. } => Parameters::TABLE.iter().find(|it| named(it.name)).map(|it| Self::Quantity(it.set)),
            Kind::Integer { .. } | Kind::Boolean { .. } | Kind::Enumeration { .. } => {
                Parameters::CHOICES.iter().find(|it| named(it.name)).map(|it| Self::Choice(it.set))
            }
            Kind::String { .. } | Kind::Other => None,
        }
    }

    /// Sets a value of the variable's type.
    pub(super) fn set(self, parameters: &mut Parameters, value: &Value) {
        match (self, value) {
            (Self::Quantity(set), Value::Real(number)) => set(parameters, *number),
            (Self::Choice(set), Value::Integer(number) | Value::Enumeration { value: number, .. }) => {
                set(parameters, *number);
            }
            (Self::Choice(set), Value::Boolean(on)) => set(parameters, i32::from(*on)),
            // No value of a variable is of another type than the variable.
            _ => debug_assert!(false, "{value} is of type {}", value.type_name()),
        }
    }
}
