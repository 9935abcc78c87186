//! The writers of `modelDescription.xml`, from the variable table: what FMI 2.0 and 3.0 have in common; `fmi2.rs` and `fmi3.rs` have
//! what differs.
//!
//! Elements come in the order that the schema prescribes. The text is the same on every run (it holds no date), so that it can be
//! kept under version control and compared.

mod fmi2;
mod fmi3;
mod terminals;

use crate::check::{TableError, check_fmu};
use crate::guid::Guid;
use crate::info::ModelInfo;
use crate::logger::LogCategory;
use crate::slave::Slave;
use crate::standard::Standard;
use crate::units::{BaseUnit, base_unit};
use crate::variable::{EnumerationType, IntegerWidth, Kind, Variable};
use quick_xml::events::{BytesDecl, Event};
use quick_xml::writer::Writer;
use std::io;

pub use terminals::terminals_and_icons;

/// Why there is no model description.
#[derive(Debug, thiserror::Error)]
pub enum DescriptionError {
    /// The variable table has a mistake.
    #[error("the FMU is faulty: {0}")]
    Table(#[from] TableError),
    /// Writing failed.
    #[error("the XML could not be written: {0}")]
    Write(#[from] io::Error),
    /// The text is not UTF-8.
    #[error("the XML is not UTF-8: {0}")]
    Encoding(#[from] std::string::FromUtf8Error),
}

type Xml = Writer<Vec<u8>>;
type Written = io::Result<()>;

/// The text of `modelDescription.xml`.
///
/// # Errors
/// If the variable table has a mistake.
pub fn model_description<S: Slave>(standard: Standard) -> Result<String, DescriptionError> {
    check_fmu::<S>()?;
    let (table, info) = (S::variables(), &S::INFO);
    document("fmiModelDescription", &root_attributes::<S>(standard), |xml| {
        match standard {
            Standard::Fmi2 => fmi2::interfaces::<S>(xml)?,
            Standard::Fmi3 => fmi3::interfaces::<S>(xml)?,
        }
        let rows: Vec<_> = table.iter().filter(|row| row.is_of(standard)).collect();
        unit_definitions(xml, &rows)?;
        type_definitions(xml, &rows, standard)?;
        log_categories(xml)?;
        default_experiment(xml, info)?;
        match standard {
            Standard::Fmi2 => fmi2::variables(xml, table),
            Standard::Fmi3 => fmi3::variables::<S>(xml),
        }
    })
}

/// A document of one element.
fn document(
    name: &str,
    attributes: &[Attribute],
    content: impl FnOnce(&mut Xml) -> Written,
) -> Result<String, DescriptionError> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    element(&mut xml, name, attributes, content)?;
    let mut text = String::from_utf8(xml.into_inner())?;
    text.push('\n');
    Ok(text)
}

type Attribute = (&'static str, String);

/// An element with content.
fn element(xml: &mut Xml, name: &str, attributes: &[Attribute], content: impl FnOnce(&mut Xml) -> Written) -> Written {
    let attributes = attributes.iter().map(|(key, value)| (*key, value.as_str()));
    let start = xml.create_element(name).with_attributes(attributes);
    start.write_inner_content(content)?;
    Ok(())
}

/// An element without content.
fn empty(xml: &mut Xml, name: &str, attributes: &[Attribute]) -> Written {
    let attributes = attributes.iter().map(|(key, value)| (*key, value.as_str()));
    xml.create_element(name).with_attributes(attributes).write_empty()?;
    Ok(())
}

/// A number as `xs:double` has it.
fn double(value: f64) -> String {
    if value.is_infinite() {
        return if value > 0.0 { "INF" } else { "-INF" }.to_owned();
    }
    format!("{value:?}")
}

/// An attribute, unless its text is empty.
fn text(name: &'static str, value: &str) -> Option<Attribute> {
    (!value.is_empty()).then(|| (name, value.to_owned()))
}

/// Whether a name is made of identifiers with array indices, separated by dots, as in `membrane[2].radius`. That is
/// the naming convention "structured" without its quoted names and higher derivatives.
fn is_structured(name: &str) -> bool {
    let name = name.strip_prefix("der(").and_then(|inner| inner.strip_suffix(')')).unwrap_or(name);
    name.split('.').all(|part| {
        let (identifier, indices) = match part.strip_suffix(']').map(|p| p.split_once('[')) {
            None => (part, None),
            Some(None) => return false,
            Some(Some((identifier, indices))) => (identifier, Some(indices)),
        };
        let is_index = |index: &str| !index.is_empty() && index.bytes().all(|b| b.is_ascii_digit());
        identifier.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && identifier.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
            && indices.is_none_or(|list| list.split(',').all(is_index))
    })
}

fn root_attributes<S: Slave>(standard: Standard) -> Vec<Attribute> {
    let (info, guid) = (&S::INFO, Guid::of::<S>(standard));
    let (version, token) = match standard {
        Standard::Fmi2 => ("2.0", "guid"),
        Standard::Fmi3 => ("3.0", "instantiationToken"),
    };
    let mut attributes = vec![("fmiVersion", version.to_owned())];
    attributes.extend([("modelName", info.model_name.to_owned()), (token, guid.to_string())]);
    attributes.extend(text("description", info.description));
    attributes.extend(text("author", info.author));
    attributes.extend(text("version", info.version));
    attributes.extend(text("copyright", info.copyright));
    attributes.extend(text("license", info.license));
    attributes.extend(text("generationTool", info.generation_tool));
    let structured = S::variables().iter().all(|v| is_structured(v.name()));
    attributes.push(("variableNamingConvention", if structured { "structured" } else { "flat" }.to_owned()));
    if standard == Standard::Fmi2 {
        attributes.push(("numberOfEventIndicators", info.model_exchange.unwrap_or(0).to_string()));
    }
    attributes
}

/// The highest order of the derivatives of outputs, and whether inputs take some.
fn derivative_orders<M>(table: &[Variable<M>]) -> (u32, bool) {
    let real = |v: &Variable<M>| match v.kind() {
        Kind::Real(s) => Some((s.output_derivatives.map_or(0, |d| d.0), s.input_derivatives.is_some())),
        _ => None,
    };
    table.iter().filter_map(real).fold((0, false), |(order, takes), row| (order.max(row.0), takes || row.1))
}

/// The units in use, in the order of their first use.
fn unit_definitions<M>(xml: &mut Xml, table: &[&Variable<M>]) -> Written {
    let mut units: Vec<&str> = Vec::new();
    for variable in table {
        if let Kind::Real(spec) = variable.kind()
            && spec.unit != "1"
            && !units.contains(&spec.unit)
        {
            units.push(spec.unit);
        }
    }
    if units.is_empty() {
        return Ok(());
    }
    element(xml, "UnitDefinitions", &[], |xml| {
        units.iter().try_for_each(|name| {
            let attributes = [("name", (*name).to_owned())];
            match base_unit(name) {
                None => empty(xml, "Unit", &attributes),
                Some(base) => element(xml, "Unit", &attributes, |xml| empty(xml, "BaseUnit", &base_attributes(base))),
            }
        })
    })
}

fn base_attributes(base: BaseUnit) -> Vec<Attribute> {
    let powers = BaseUnit::NAMES.into_iter().zip(base.exponents);
    let powers = powers.filter(|(_, power)| *power != 0);
    let mut attributes: Vec<_> = powers.map(|(name, power)| (name, power.to_string())).collect();
    if base.factor != 1.0 {
        attributes.push(("factor", double(base.factor)));
    }
    attributes
}

fn type_definitions<M>(xml: &mut Xml, table: &[&Variable<M>], standard: Standard) -> Written {
    let mut types: Vec<&EnumerationType> = Vec::new();
    for variable in table {
        if let Kind::Enumeration(spec) = variable.kind()
            && !types.contains(&spec.of)
        {
            types.push(spec.of);
        }
    }
    if types.is_empty() {
        return Ok(());
    }
    element(xml, "TypeDefinitions", &[], |xml| {
        types.iter().try_for_each(|of| {
            let mut attributes = vec![("name", of.name.to_owned())];
            attributes.extend(text("description", of.description));
            match standard {
                Standard::Fmi2 => element(xml, "SimpleType", &attributes, |xml| {
                    element(xml, "Enumeration", &[], |xml| items(xml, of))
                }),
                Standard::Fmi3 => element(xml, "EnumerationType", &attributes, |xml| items(xml, of)),
            }
        })
    })
}

fn items(xml: &mut Xml, of: &EnumerationType) -> Written {
    for (number, (name, description)) in (1_i32..).zip(of.items) {
        let mut attributes = vec![("name", (*name).to_owned()), ("value", number.to_string())];
        attributes.extend(text("description", description));
        empty(xml, "Item", &attributes)?;
    }
    Ok(())
}

fn log_categories(xml: &mut Xml) -> Written {
    element(xml, "LogCategories", &[], |xml| {
        let all = (LogCategory::ALL_NAME, "All messages");
        let categories = LogCategory::ALL.map(|c| (c.name(), c.description()));
        for (name, description) in categories.into_iter().chain([all]) {
            let attributes = [("name", name.to_owned()), ("description", description.to_owned())];
            empty(xml, "Category", &attributes)?;
        }
        Ok(())
    })
}

fn default_experiment(xml: &mut Xml, info: &ModelInfo) -> Written {
    let Some(experiment) = info.default_experiment else {
        return Ok(());
    };
    let mut attributes = vec![("startTime", double(experiment.start_time)), ("stopTime", double(experiment.stop_time))];
    attributes.extend(experiment.tolerance.map(|t| ("tolerance", double(t))));
    attributes.push(("stepSize", double(experiment.step_size)));
    empty(xml, "DefaultExperiment", &attributes)
}

/// Unit, bounds, nominal and start value. FMI 2.0 has one Integer, of 32 bits: what can be set tells the bounds of its width.
fn type_attributes<M>(kind: &Kind<M>, standard: Standard) -> Vec<Attribute> {
    let mut attributes = Vec::new();
    match kind {
        Kind::Real(s) => {
            attributes.extend((s.unit != "1").then(|| ("unit", s.unit.to_owned())));
            attributes.extend(s.min.is_finite().then(|| ("min", double(s.min))));
            attributes.extend(s.max.is_finite().then(|| ("max", double(s.max))));
            attributes.extend(s.nominal.map(|n| ("nominal", double(n))));
            attributes.extend(s.start.map(|v| ("start", double(v))));
        }
        Kind::Integer(s) => {
            let in_2 = standard == Standard::Fmi2;
            // What is too large for 32 bits shows as the nearest one.
            let (low, high) = IntegerWidth::Int32.bounds();
            let shown = |value: i64| if in_2 { value.clamp(low, high) } else { value };
            let (min, max) = s.width.bounds();
            let (min, max) = if in_2 && s.set.is_some() { (low, high) } else { (shown(min), shown(max)) };
            attributes.extend((shown(s.min) != min).then(|| ("min", shown(s.min).to_string())));
            attributes.extend((shown(s.max) != max).then(|| ("max", shown(s.max).to_string())));
            attributes.extend(s.start.map(|v| ("start", shown(v).to_string())));
        }
        Kind::Boolean(s) => attributes.extend(s.start.map(|v| ("start", v.to_string()))),
        Kind::String(s) => attributes.extend(s.start.map(|v| ("start", v.to_owned()))),
        Kind::Enumeration(s) => {
            attributes.push(("declaredType", s.of.name.to_owned()));
            attributes.extend(s.start.map(|v| ("start", v.to_string())));
        }
        Kind::Clock(_) => {}
    }
    attributes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structured_names_are_told_from_flat_ones() {
        for name in ["a", "ball.mass", "_x1.y_2", "left[1].u", "m[1,22].x[3]", "der(a.b)"] {
            assert!(is_structured(name), "{name}");
        }
        for name in
            ["", "a.", ".a", "a b", "1a", "a[", "a]", "a[]", "a[x]", "a[1,]", "der(x", "der()", "a[1]b", "\u{e4}"]
        {
            assert!(!is_structured(name), "{name}");
        }
    }

    #[test]
    fn numbers_are_written_as_the_schema_wants_them_and_read_back_exactly() {
        let written = [1.0, 3.5e-3, 1e-300, f64::INFINITY, f64::NEG_INFINITY].map(double);
        assert_eq!(written, ["1.0", "0.0035", "1e-300", "INF", "-INF"]);
        assert_eq!(double(0.1 + 0.2).parse(), Ok(0.1 + 0.2));
    }
}
