//! One `ScalarVariable`: defaults of the standard, attributes of its type definition, base type.

use std::str::FromStr;
use std::sync::Arc;

use super::types::Types;
use super::{
    Causality, Error, Initial, Kind, Result, Variability, Variable, attribute, boolean, integer, missing, optional,
    raw, real,
};

/// Reads the variable at `position` (from 0).
pub(super) fn convert(raw: raw::ScalarVariable, position: usize, types: &Types) -> Result<Variable> {
    let name = raw.name.clone().ok_or_else(|| missing(&format!("ScalarVariable {}", position + 1), "name"))?;
    let place = format!("variable \"{name}\"");
    let reference = raw.value_reference.as_deref().ok_or_else(|| missing(&place, "valueReference"))?;
    let value_reference = integer(&place, "valueReference", reference)?;
    let causality = keyword(&place, "causality", raw.causality.as_deref(), Causality::ALLOWED)?;
    let causality = causality.unwrap_or(Causality::Local);
    let variability = keyword(&place, "variability", raw.variability.as_deref(), Variability::ALLOWED)?;
    let is_real = raw.real.is_some();
    let variability = variability.unwrap_or(if is_real { Variability::Continuous } else { Variability::Discrete });
    let initial = keyword(&place, "initial", raw.initial.as_deref(), Initial::ALLOWED)?;
    let description = raw.description.clone();
    let (kind, declared_type) = kind(raw, &place, types)?;
    let initial = initial.or_else(|| default_initial(causality, variability));
    Ok(Variable { name, value_reference, description, causality, variability, initial, declared_type, kind })
}

fn keyword<T: FromStr>(place: &str, name: &'static str, text: Option<&str>, allowed: &[&str]) -> Result<Option<T>> {
    let Some(text) = text else { return Ok(None) };
    text.parse().map(Some).map_err(|_| attribute(place, name, text, allowed.join(", ")))
}

/// The default that the standard gives where `initial` is absent.
fn default_initial(causality: Causality, variability: Variability) -> Option<Initial> {
    match causality {
        Causality::Parameter => Some(Initial::Exact),
        Causality::Input | Causality::Independent => None,
        _ if variability == Variability::Constant => Some(Initial::Exact),
        Causality::CalculatedParameter | Causality::Output | Causality::Local => Some(Initial::Calculated),
    }
}

/// The base type, and the name of the type definition.
fn kind(raw: raw::ScalarVariable, place: &str, types: &Types) -> Result<(Kind, Option<String>)> {
    let raw::ScalarVariable { real: as_real, integer: as_integer, boolean: as_boolean, string, enumeration, .. } = raw;
    let (kind, declared) = if let Some(own) = as_real {
        let inherited = types.get(own.declared_type.as_deref());
        let number = |name, text: &Option<String>| optional(text.as_deref(), |text| real(place, name, text));
        let (start, min, max) = (number("start", &own.start)?, number("min", &own.min)?, number("max", &own.max)?);
        let [least, most] = inherited.map_or([None; 2], |it| it.real);
        let unit = own.unit.map(Arc::from).or_else(|| inherited.and_then(|it| it.unit.clone()));
        (Kind::Real { unit, start, min: min.or(least), max: max.or(most) }, own.declared_type)
    } else if let Some(own) = as_integer {
        let number = |name, text: &Option<String>| optional(text.as_deref(), |text| integer(place, name, text));
        let (start, min, max) = (number("start", &own.start)?, number("min", &own.min)?, number("max", &own.max)?);
        let [least, most] = types.get(own.declared_type.as_deref()).map_or([None; 2], |it| it.integer);
        (Kind::Integer { start, min: min.or(least), max: max.or(most) }, own.declared_type)
    } else if let Some(own) = as_boolean {
        let start = optional(own.start.as_deref(), |text| boolean(place, "start", text))?;
        (Kind::Boolean { start }, own.declared_type)
    } else if let Some(own) = string {
        (Kind::String { start: own.start }, own.declared_type)
    } else if let Some(own) = enumeration {
        let start = optional(own.start.as_deref(), |text| integer(place, "start", text))?;
        let declared = own.declared_type.ok_or_else(|| missing(place, "declaredType"))?;
        require_enumeration(&declared, place, types)?;
        (Kind::Enumeration { start }, Some(declared))
    } else {
        return Err(missing(place, "type element (Real, Integer, Boolean, String or Enumeration)"));
    };
    Ok((kind, declared))
}

fn require_enumeration(declared: &str, place: &str, types: &Types) -> Result<()> {
    if types.get(Some(declared)).is_some_and(|simple| simple.is_enumeration) {
        return Ok(());
    }
    let allowed = format!("an enumeration of TypeDefinitions ({})", types.enumerations().join(", "));
    Err::<(), Error>(attribute(place, "declaredType", declared, allowed))
}
