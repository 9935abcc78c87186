//! What the description of FMI 2.0 has of its own. It sees no clocks, and none of the variables that belong to some.

use super::{Attribute, Written, Xml, derivative_orders, element, empty, text, type_attributes};
use crate::slave::Slave;
use crate::standard::Standard;
use crate::variable::{Causality, Variable};

/// The interfaces, with their capabilities, each as it is: what this exporter never does is said to be false.
pub(super) fn interfaces<S: Slave>(xml: &mut Xml) -> Written {
    if S::INFO.model_exchange.is_some() {
        empty(xml, "ModelExchange", &flags::<S>(&[("completedIntegratorStepNotNeeded", true.to_string())]))?;
    }
    let (order, interpolates) = derivative_orders(S::variables());
    let own = [
        ("canHandleVariableCommunicationStepSize", S::INFO.variable_step_size.to_string()),
        ("canInterpolateInputs", interpolates.to_string()),
        ("maxOutputDerivativeOrder", order.to_string()),
        ("canRunAsynchronuously", false.to_string()), // The schema spells it so.
    ];
    empty(xml, "CoSimulation", &flags::<S>(&own))
}

/// What both interfaces have, and what one has of its own.
fn flags<S: Slave>(own: &[Attribute]) -> Vec<Attribute> {
    let info = S::INFO;
    let mut flags =
        vec![("modelIdentifier", info.model_identifier.to_owned()), ("needsExecutionTool", false.to_string())];
    flags.extend_from_slice(own);
    flags.extend([
        ("canBeInstantiatedOnlyOncePerProcess", false.to_string()),
        ("canNotUseMemoryManagementFunctions", true.to_string()), // Rust's allocator serves the FMU.
        ("canGetAndSetFMUstate", true.to_string()),
        ("canSerializeFMUstate", info.can_serialize.to_string()),
        ("providesDirectionalDerivative", info.directional_derivatives.to_string()),
    ]);
    flags
}

/// The variables and what is known of their dependencies.
pub(super) fn variables<M>(xml: &mut Xml, table: &[Variable<M>]) -> Written {
    element(xml, "ModelVariables", &[], |xml| {
        let rows = table.iter().enumerate().filter(|(_, row)| row.is_of(Standard::Fmi2));
        rows.into_iter().try_for_each(|(i, v)| scalar_variable(xml, table, i, v))
    })?;
    model_structure(xml, table)
}

fn scalar_variable<M>(xml: &mut Xml, table: &[Variable<M>], index: usize, variable: &Variable<M>) -> Written {
    let mut attributes = vec![("name", variable.name().to_owned()), ("valueReference", index.to_string())];
    attributes.extend(text("description", variable.description()));
    attributes.push(("causality", variable.causality().as_str().to_owned()));
    attributes.push(("variability", variable.variability().as_str().to_owned()));
    attributes.extend(variable.initial().map(|i| ("initial", i.as_str().to_owned())));
    element(xml, "ScalarVariable", &attributes, |xml| {
        let mut attributes = type_attributes(variable.kind(), Standard::Fmi2);
        attributes.extend(variable.derivative_of().map(|state| ("derivative", positions(table, &[state]))));
        attributes.extend(variable.reinit().then(|| ("reinit", true.to_string())));
        empty(xml, variable.kind().type_name(), &attributes)
    })
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
    let listed: Vec<_> =
        (1..).zip(table.iter().filter(|row| row.is_of(Standard::Fmi2))).filter(|(_, v)| is_listed(v)).collect();
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
    let rows = (1_u32..).zip(table.iter().filter(|row| row.is_of(Standard::Fmi2)));
    let words: Vec<_> = rows.filter(|(_, row)| names.contains(&row.name())).map(|(k, _)| k.to_string()).collect();
    words.join(" ")
}
