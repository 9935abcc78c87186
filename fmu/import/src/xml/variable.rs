//! One variable: defaults of the standard, attributes of its type definition, base type. In FMI 2.0 the type is an element in
//! `ScalarVariable`, in FMI 3.0 the element is the type.

use std::str::FromStr;
use std::sync::Arc;

use super::element::{Element, TRUTHS, missing, truth};
use super::types::{SimpleType, Types};
use super::{Causality, Initial, Kind, Result, Variability, Variable};

/// The types of FMI 3.0.
pub(super) const TYPES_3: [&str; 15] = [
    "Float64",
    "Float32",
    "Int8",
    "UInt8",
    "Int16",
    "UInt16",
    "Int32",
    "UInt32",
    "Int64",
    "UInt64",
    "Boolean",
    "String",
    "Enumeration",
    "Clock",
    "Binary",
];

/// Reads the variable at `position` (from 0).
pub(super) fn variable(element: &Element<'_>, position: usize, types: &Types) -> Result<Variable> {
    let name = element.required(&format!("{} {}", element.name(), position + 1), "name")?;
    let place = format!("variable \"{name}\"");
    let value_reference = element.integer(&place, "valueReference")?;
    let causality = keyword(element, &place, "causality", Causality::ALLOWED)?.unwrap_or(Causality::Local);
    let variability = keyword(element, &place, "variability", Variability::ALLOWED)?;
    let initial = keyword(element, &place, "initial", Initial::ALLOWED)?;
    let type_name = TYPES_3.into_iter().find(|type_name| *type_name == element.name());
    let (kind, declared_type) = match type_name {
        Some(type_name) => kind_3(type_name, element, &place, types)?,
        None => kind(element, &place, types)?,
    };
    let type_name = type_name.unwrap_or(kind.name());
    let is_real = matches!(kind, Kind::Real { .. });
    let variability = variability.unwrap_or(if is_real { Variability::Continuous } else { Variability::Discrete });
    Ok(Variable {
        value_reference: value_reference.ok_or_else(|| missing(&place, "valueReference"))?,
        name,
        description: element.attribute("description")?,
        causality,
        variability,
        initial: initial.or_else(|| default_initial(causality, variability)),
        declared_type,
        kind,
        type_name,
    })
}

fn keyword<T: FromStr>(element: &Element<'_>, place: &str, name: &str, allowed: &[&str]) -> Result<Option<T>> {
    element.read(place, name, |text| text.parse().ok(), &allowed.join(", "))
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
fn kind(element: &Element<'_>, place: &str, types: &Types) -> Result<(Kind, Option<String>)> {
    let declared = |own: &Element<'_>| own.attribute("declaredType");
    if let Some(own) = element.child("Real")? {
        let declared = declared(own)?;
        Ok((real(own, place, types.get(declared.as_deref()), || own.real(place, "start"))?, declared))
    } else if let Some(own) = element.child("Integer")? {
        let declared = declared(own)?;
        let [least, most] = types.get(declared.as_deref()).map_or([None; 2], |it| it.integer);
        let (min, max) = (own.whole(place, "min")?.or(least), own.whole(place, "max")?.or(most));
        Ok((Kind::Integer { start: own.whole(place, "start")?, min, max }, declared))
    } else if let Some(own) = element.child("Boolean")? {
        Ok((Kind::Boolean { start: own.boolean(place, "start")? }, declared(own)?))
    } else if let Some(own) = element.child("String")? {
        Ok((Kind::String { start: own.attribute("start")? }, declared(own)?))
    } else if let Some(own) = element.child("Enumeration")? {
        let declared = own.required(place, "declaredType")?;
        types.check_enumeration(place, &declared)?;
        Ok((Kind::Enumeration { start: own.integer(place, "start")? }, Some(declared)))
    } else {
        Err(missing(place, "type element (Real, Integer, Boolean, String or Enumeration)"))
    }
}

/// The same of FMI 3.0. Of an array the first value is shown.
fn kind_3(type_name: &str, own: &Element<'_>, place: &str, types: &Types) -> Result<(Kind, Option<String>)> {
    let declared = own.attribute("declaredType")?;
    let inherited = types.get(declared.as_deref());
    let kind = match type_name {
        "Float64" | "Float32" => {
            real(own, place, inherited, || first(own, place, "a number", |text| text.parse().ok()))?
        }
        "Boolean" => Kind::Boolean { start: first(own, place, TRUTHS, truth)? },
        "String" => {
            let start = own.children("Start").next();
            Kind::String { start: start.map(|start| start.required(place, "value")).transpose()? }
        }
        "Enumeration" => {
            types.check_enumeration(place, declared.as_deref().unwrap_or_default())?;
            Kind::Enumeration { start: first(own, place, "an integer of 32 bits", |text| text.parse().ok())? }
        }
        "Clock" | "Binary" => Kind::Other,
        _ => {
            let [least, most] = inherited.map_or([None; 2], |it| it.integer);
            let (min, max) = (own.integer(place, "min")?.or(least), own.integer(place, "max")?.or(most));
            // Of 64 bits without a sign, what is beyond those with one shows as the largest.
            let read = |text: &str| text.parse().ok().or_else(|| text.parse::<u64>().ok().map(|_| i64::MAX));
            Kind::Integer { start: first(own, place, "an integer", read)?, min, max }
        }
    };
    Ok((kind, declared))
}

/// A Real, whose type gives what it does not say itself.
fn real(
    own: &Element<'_>,
    place: &str,
    inherited: Option<&SimpleType>,
    start: impl FnOnce() -> Result<Option<f64>>,
) -> Result<Kind> {
    let [least, most] = inherited.map_or([None; 2], |it| it.real);
    let unit = own.attribute("unit")?.map(Arc::from).or_else(|| inherited.and_then(|it| it.unit.clone()));
    let (min, max) = (own.real(place, "min")?.or(least), own.real(place, "max")?.or(most));
    Ok(Kind::Real { unit, start: start()?, min, max })
}

/// The first value of `start`.
fn first<T>(own: &Element<'_>, place: &str, allowed: &str, read: impl Fn(&str) -> Option<T>) -> Result<Option<T>> {
    own.read(place, "start", |text| text.split_whitespace().next().and_then(&read), allowed)
}
