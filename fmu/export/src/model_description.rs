//! The writer of `modelDescription.xml`, from the variable table.
//!
//! Elements come in the order that the schema of FMI 2.0 prescribes. The text is the same on every run (it holds
//! no date), so that it can be kept under version control and compared.

use crate::check::{TableError, check_fmu};
use crate::guid::Guid;
use crate::info::ModelInfo;
use crate::logger::LogCategory;
use crate::slave::Slave;
use crate::units::{BaseUnit, base_unit};
use crate::variable::{Causality, EnumerationType, Kind, Variable, value_reference};
use quick_xml::events::{BytesDecl, Event};
use quick_xml::writer::Writer;
use std::io;

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
pub fn model_description<S: Slave>() -> Result<String, DescriptionError> {
    check_fmu::<S>()?;
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let mut root = vec![("fmiVersion", "2.0".to_owned())];
    root.extend(root_attributes(&S::INFO, Guid::of::<S>()));
    let structured = S::variables().iter().all(|v| is_structured(v.name()));
    let convention = if structured { "structured" } else { "flat" };
    root.push(("variableNamingConvention", convention.to_owned()));
    root.push(("numberOfEventIndicators", S::INFO.model_exchange.unwrap_or(0).to_string()));
    element(&mut xml, "fmiModelDescription", &root, |xml| {
        model_exchange::<S>(xml)?;
        co_simulation::<S>(xml)?;
        unit_definitions(xml, S::variables())?;
        type_definitions(xml, S::variables())?;
        log_categories(xml)?;
        default_experiment(xml, &S::INFO)?;
        model_variables(xml, S::variables())?;
        model_structure(xml, S::variables())
    })?;
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

fn root_attributes(info: &ModelInfo, guid: Guid) -> Vec<Attribute> {
    let mut attributes = vec![("modelName", info.model_name.to_owned()), ("guid", guid.to_string())];
    attributes.extend(text("description", info.description));
    attributes.extend(text("author", info.author));
    attributes.extend(text("version", info.version));
    attributes.extend(text("copyright", info.copyright));
    attributes.extend(text("license", info.license));
    attributes.extend(text("generationTool", info.generation_tool));
    attributes
}

/// The same for model exchange, if it is offered.
fn model_exchange<S: Slave>(xml: &mut Xml) -> Written {
    let info = S::INFO;
    if info.model_exchange.is_none() {
        return Ok(());
    }
    let flags = [
        ("modelIdentifier", info.model_identifier.to_owned()),
        ("needsExecutionTool", false.to_string()),
        ("completedIntegratorStepNotNeeded", true.to_string()),
        ("canBeInstantiatedOnlyOncePerProcess", false.to_string()),
        ("canNotUseMemoryManagementFunctions", true.to_string()),
        ("canGetAndSetFMUstate", true.to_string()),
        ("canSerializeFMUstate", info.can_serialize.to_string()),
        ("providesDirectionalDerivative", info.directional_derivatives.to_string()),
    ];
    empty(xml, "ModelExchange", &flags)
}

/// The capabilities, each as it is: what this exporter never does is said to be false.
fn co_simulation<S: Slave>(xml: &mut Xml) -> Written {
    let info = S::INFO;
    let real = |v: &Variable<S>| match v.kind() {
        Kind::Real(s) => Some((s.input_derivatives.is_some(), s.output_derivatives.map_or(0, |d| d.0))),
        _ => None,
    };
    let derivatives = || S::variables().iter().filter_map(real);
    let interpolates = derivatives().any(|(input, _)| input);
    let order = derivatives().map(|(_, order)| order).max().unwrap_or(0);
    let flags = [
        ("modelIdentifier", info.model_identifier.to_owned()),
        ("needsExecutionTool", false.to_string()),
        ("canHandleVariableCommunicationStepSize", info.variable_step_size.to_string()),
        ("canInterpolateInputs", interpolates.to_string()),
        ("maxOutputDerivativeOrder", order.to_string()),
        ("canRunAsynchronuously", false.to_string()), // The schema spells it so.
        ("canBeInstantiatedOnlyOncePerProcess", false.to_string()),
        ("canNotUseMemoryManagementFunctions", true.to_string()), // Rust's allocator serves the FMU.
        ("canGetAndSetFMUstate", true.to_string()),
        ("canSerializeFMUstate", info.can_serialize.to_string()),
        ("providesDirectionalDerivative", info.directional_derivatives.to_string()),
    ];
    empty(xml, "CoSimulation", &flags)
}

/// The units in use, in the order of their first use.
fn unit_definitions<M>(xml: &mut Xml, table: &[Variable<M>]) -> Written {
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

fn type_definitions<M>(xml: &mut Xml, table: &[Variable<M>]) -> Written {
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
    element(xml, "TypeDefinitions", &[], |xml| types.iter().try_for_each(|t| simple_type(xml, t)))
}

fn simple_type(xml: &mut Xml, enumeration: &EnumerationType) -> Written {
    let mut attributes = vec![("name", enumeration.name.to_owned())];
    attributes.extend(text("description", enumeration.description));
    element(xml, "SimpleType", &attributes, |xml| {
        element(xml, "Enumeration", &[], |xml| {
            for (number, (name, description)) in (1_i32..).zip(enumeration.items) {
                let mut attributes = vec![("name", (*name).to_owned()), ("value", number.to_string())];
                attributes.extend(text("description", description));
                empty(xml, "Item", &attributes)?;
            }
            Ok(())
        })
    })
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

fn model_variables<M>(xml: &mut Xml, table: &[Variable<M>]) -> Written {
    element(xml, "ModelVariables", &[], |xml| {
        table.iter().enumerate().try_for_each(|(i, v)| scalar_variable(xml, table, i, v))
    })
}

fn scalar_variable<M>(xml: &mut Xml, table: &[Variable<M>], index: usize, variable: &Variable<M>) -> Written {
    let mut attributes = vec![("name", variable.name().to_owned()), ("valueReference", index.to_string())];
    attributes.extend(text("description", variable.description()));
    attributes.push(("causality", variable.causality().as_str().to_owned()));
    attributes.push(("variability", variable.variability().as_str().to_owned()));
    attributes.extend(variable.initial().map(|i| ("initial", i.as_str().to_owned())));
    element(xml, "ScalarVariable", &attributes, |xml| {
        let mut attributes = type_attributes(variable.kind());
        attributes.extend(variable.derivative_of().map(|state| ("derivative", positions(table, &[state]))));
        attributes.extend(variable.reinit().then(|| ("reinit", true.to_string())));
        empty(xml, variable.kind().type_name(), &attributes)
    })
}

fn type_attributes<M>(kind: &Kind<M>) -> Vec<Attribute> {
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
            attributes.extend((s.min != i32::MIN).then(|| ("min", s.min.to_string())));
            attributes.extend((s.max != i32::MAX).then(|| ("max", s.max.to_string())));
            attributes.extend(s.start.map(|v| ("start", v.to_string())));
        }
        Kind::Boolean(s) => attributes.extend(s.start.map(|v| ("start", v.to_string()))),
        Kind::String(s) => attributes.extend(s.start.map(|v| ("start", v.to_owned()))),
        Kind::Enumeration(s) => {
            attributes.push(("declaredType", s.of.name.to_owned()));
            attributes.extend(s.start.map(|v| ("start", v.to_string())));
        }
    }
    attributes
}

/// Every output, the derivatives of the continuous states, and the unknowns of the initialisation.
fn model_structure<M>(xml: &mut Xml, table: &[Variable<M>]) -> Written {
    let output = |v: &Variable<M>| v.causality() == Causality::Output;
    let derivative = |v: &Variable<M>| v.derivative_of().is_some();
    element(xml, "ModelStructure", &[], |xml| {
        let present = |v: &Variable<M>| v.dependencies().map(<[&str]>::to_vec);
        let initial = |v: &Variable<M>| v.initial_dependencies().map(<[&[&str]]>::concat);
        unknowns(xml, "Outputs", table, output, present)?;
        unknowns(xml, "Derivatives", table, derivative, present)?;
        unknowns(xml, "InitialUnknowns", table, |v| v.is_initial_unknown(table), initial)
    })
}

fn unknowns<M>(
    xml: &mut Xml,
    name: &str,
    table: &[Variable<M>],
    is_listed: impl Fn(&Variable<M>) -> bool,
    dependencies: impl Fn(&Variable<M>) -> Option<Vec<&'static str>>,
) -> Written {
    let listed: Vec<_> = (1..).zip(table).filter(|(_, v)| is_listed(v)).collect();
    if listed.is_empty() {
        return Ok(());
    }
    element(xml, name, &[], |xml| {
        listed.iter().try_for_each(|(position, variable)| {
            let position: u32 = *position;
            let mut attributes = vec![("index", position.to_string())];
            attributes.extend(dependencies(variable).map(|names| ("dependencies", positions(table, &names))));
            empty(xml, "Unknown", &attributes)
        })
    })
}

/// Positions, counted from 1 and ascending, of the variables with these names.
fn positions<M>(table: &[Variable<M>], names: &[&str]) -> String {
    let references = names.iter().filter_map(|name| value_reference(table, name));
    let mut positions: Vec<u32> = references.map(|r| r + 1).collect();
    positions.sort_unstable();
    positions.dedup();
    let words: Vec<_> = positions.iter().map(u32::to_string).collect();
    words.join(" ")
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
