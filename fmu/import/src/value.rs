//! Values of variables, and reading them from the text that a user types.

use std::fmt;

use super::description::{EnumerationType, Kind, ModelDescription, Variable};
use super::error::ValueError;
use super::{suggest, unit};

/// A value of any base type.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// 64-bit floating-point number.
    Real(f64),
    /// 32-bit integer.
    Integer(i32),
    /// Truth value.
    Boolean(bool),
    /// Text.
    String(String),
    /// Item of an enumeration.
    Enumeration {
        /// The integer that travels.
        value: i32,
        /// Name of the item; empty if the enumeration has no such item.
        name: String,
    },
}

impl fmt::Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(value) => write!(out, "{value}"),
            Self::Integer(value) => write!(out, "{value}"),
            Self::Boolean(value) => write!(out, "{value}"),
            Self::String(value) => out.write_str(value),
            Self::Enumeration { value, name } if name.is_empty() => write!(out, "{value}"),
            Self::Enumeration { name, .. } => out.write_str(name),
        }
    }
}

impl Value {
    /// Name of the base type.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Real(_) => "Real",
            Self::Integer(_) => "Integer",
            Self::Boolean(_) => "Boolean",
            Self::String(_) => "String",
            Self::Enumeration { .. } => "Enumeration",
        }
    }

    /// Reads `text` as a value of `variable`, within its bounds. Items of enumerations go by name or number.
    ///
    /// # Errors
    /// When the text does not read as the variable's type, or lies out of its range.
    pub fn parse(description: &ModelDescription, variable: &Variable, text: &str) -> Result<Self, ValueError> {
        let value = Self::read(description, variable, text)?;
        value.check(variable)?;
        Ok(value)
    }

    /// As [`Value::parse`], whatever the bounds.
    ///
    /// # Errors
    /// When the text does not read as the variable's type.
    pub fn read(description: &ModelDescription, variable: &Variable, text: &str) -> Result<Self, ValueError> {
        let trimmed = text.trim();
        match &variable.kind {
            Kind::Real { .. } => {
                // Infinity is a value to some models, such as a load that is not there; bounds say so if it is not.
                let value = trimmed.parse().ok().filter(|value: &f64| !value.is_nan());
                let hint = || unit::hint(trimmed, variable.unit()).map_or_else(String::new, |hint| format!(" {hint}"));
                value.map(Self::Real).ok_or_else(|| unreadable(variable, text, &format!("a number{}", hint())))
            }
            Kind::Integer { .. } => {
                let value = trimmed.parse().map_err(|_| unreadable(variable, text, "an integer of 32 bits"))?;
                Ok(Self::Integer(value))
            }
            Kind::Boolean { .. } => match trimmed {
                "true" | "1" => Ok(Self::Boolean(true)),
                "false" | "0" => Ok(Self::Boolean(false)),
                _ => Err(unreadable(variable, text, "true or false")),
            },
            Kind::String { .. } if text.contains('\0') => Err(unreadable(variable, text, "text without zero bytes")),
            Kind::String { .. } => Ok(Self::String(text.to_owned())),
            Kind::Enumeration { .. } => item(description.enumeration(variable), variable, trimmed),
            Kind::Other => Err(unreadable(variable, text, "nothing: FMI 2.0 has no such type")),
        }
    }

    /// Whether it lies within the bounds of `variable`, which is of its type.
    ///
    /// # Errors
    /// When it does not.
    pub fn check(&self, variable: &Variable) -> Result<(), ValueError> {
        match (self, &variable.kind) {
            (Self::Real(value), Kind::Real { min, max, unit, .. }) => {
                in_range(variable, *value, *min, *max, unit.as_deref())
            }
            (Self::Integer(value), Kind::Integer { min, max, .. }) => {
                in_range(variable, i64::from(*value), *min, *max, None)
            }
            _ => Ok(()),
        }
    }

    /// The item of `variable`'s enumeration that travels as `value`.
    pub(super) fn of_enumeration(description: &ModelDescription, variable: &Variable, value: i32) -> Self {
        let items = description.enumeration(variable).map_or(&[][..], |enumeration| &enumeration.items);
        let name = items.iter().find(|item| item.value == value).map_or_else(String::new, |item| item.name.clone());
        Self::Enumeration { value, name }
    }
}

impl ModelDescription {
    /// The start value of this variable; none without one, nor of an integer beyond 32 bits.
    pub fn start(&self, variable: &Variable) -> Option<Value> {
        match &variable.kind {
            Kind::Real { start, .. } => start.map(Value::Real),
            Kind::Integer { start, .. } => start.and_then(|start| start.try_into().ok()).map(Value::Integer),
            Kind::Boolean { start } => start.map(Value::Boolean),
            Kind::String { start } => start.clone().map(Value::String),
            Kind::Enumeration { start } => start.map(|value| Value::of_enumeration(self, variable, value)),
            Kind::Other => None,
        }
    }
}

/// Finds the item of an enumeration by name or number.
fn item(enumeration: Option<&EnumerationType>, variable: &Variable, text: &str) -> Result<Value, ValueError> {
    let items = enumeration.map_or(&[][..], |enumeration| &enumeration.items);
    let number = text.parse::<i32>().ok();
    let found =
        items.iter().find(|item| item.name == text).or_else(|| items.iter().find(|item| Some(item.value) == number));
    if let Some(item) = found {
        return Ok(Value::Enumeration { value: item.value, name: item.name.clone() });
    }
    let names: Vec<_> = items.iter().map(|item| item.name.as_str()).collect();
    let hint = suggest::nearest(text, names.iter().copied());
    let hint = hint.map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"));
    Err(unreadable(variable, text, &format!("one of {}{hint}", names.join(", "))))
}

fn unreadable(variable: &Variable, found: &str, allowed: &str) -> ValueError {
    ValueError::Parse { variable: variable.name.clone(), found: found.to_owned(), allowed: allowed.to_owned() }
}

fn in_range<T: PartialOrd + fmt::Display + Copy>(
    variable: &Variable,
    value: T,
    min: Option<T>,
    max: Option<T>,
    unit: Option<&str>,
) -> Result<(), ValueError> {
    if min.is_none_or(|min| value >= min) && max.is_none_or(|max| value <= max) {
        return Ok(());
    }
    let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
    let allowed = match (min, max) {
        (Some(min), Some(max)) => format!("{min} .. {max}{unit}"),
        (Some(min), None) => format!("at least {min}{unit}"),
        (None, Some(max)) => format!("at most {max}{unit}"),
        (None, None) => "any".to_owned(),
    };
    Err(ValueError::Range { variable: variable.name.clone(), found: format!("{value}{unit}"), allowed })
}

#[cfg(test)]
mod tests {
    use super::Value;
    use crate::ModelDescription;

    fn parse(name: &str, text: &str) -> Result<Value, String> {
        let description = ModelDescription::parse(include_bytes!("testdata/good.xml"), "test").unwrap();
        let variable = description.variable(name).unwrap();
        Value::parse(&description, variable, text).map_err(|error| error.to_string())
    }

    #[test]
    fn text_reads_as_the_type_of_its_variable() {
        assert_eq!(parse("mass", " 2.5e0 "), Ok(Value::Real(2.5)));
        assert_eq!(parse("seed", "42"), Ok(Value::Integer(42)));
        assert_eq!(parse("enabled", "false"), Ok(Value::Boolean(false)));
        assert_eq!(parse("enabled", "1"), Ok(Value::Boolean(true)));
        assert_eq!(parse("label", " as it is "), Ok(Value::String(" as it is ".to_owned())));
        let compliant = Value::Enumeration { value: 2, name: "compliant".to_owned() };
        assert_eq!(parse("law", "compliant"), Ok(compliant.clone()));
        assert_eq!(parse("law", "2"), Ok(compliant));
    }

    #[test]
    fn errors_name_variable_found_and_allowed() {
        for (name, text, message) in [
            ("mass", "heavy", "mass = \"heavy\": allowed is a number"),
            ("mass", "11g", "mass = \"11g\": allowed is a number in kg; did you mean 0.011?"),
            ("mass", "11mm", "mass = \"11mm\": allowed is a number in kg, and mm is no such unit"),
            ("mass", "NaN", "mass = \"NaN\": allowed is a number"),
            ("mass", "inf", "mass = inf kg is out of range: allowed is 0 .. 10 kg"),
            ("mass", "11", "mass = 11 kg is out of range: allowed is 0 .. 10 kg"),
            ("mass", "-1e-3", "mass = -0.001 kg is out of range: allowed is 0 .. 10 kg"),
            ("seed", "1.5", "seed = \"1.5\": allowed is an integer of 32 bits"),
            ("seed", "101", "seed = 101 is out of range: allowed is 0 .. 100"),
            ("enabled", "yes", "enabled = \"yes\": allowed is true or false"),
            ("law", "3", "law = \"3\": allowed is one of impulsive, compliant"),
            (
                "law",
                "complient",
                "law = \"complient\": allowed is one of impulsive, compliant; did you mean \"compliant\"?",
            ),
            ("label", "a\0b", "label = \"a\\0b\": allowed is text without zero bytes"),
        ] {
            assert_eq!(parse(name, text), Err(message.to_owned()));
        }
    }
}
