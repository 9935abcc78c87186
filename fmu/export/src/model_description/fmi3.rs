//! What the description of FMI 3.0 has of its own.

use super::{Attribute, Written, Xml, derivative_orders, double, element, empty, text, type_attributes};
use crate::added::{Added, has_events};
use crate::fmi3::is_intermediate;
use crate::slave::Slave;
use crate::standard::Standard;
use crate::variable::{Causality, ClockInterval, Kind, Variable, value_reference};

/// The interfaces, with their capabilities; those that are left out are false. There is no scheduled execution.
pub(super) fn interfaces<S: Slave>(xml: &mut Xml) -> Written {
    let info = S::INFO;
    let flags = [
        ("modelIdentifier", info.model_identifier.to_owned()),
        ("canGetAndSetFMUState", true.to_string()),
        ("canSerializeFMUState", info.can_serialize.to_string()),
        ("providesDirectionalDerivatives", info.directional_derivatives.to_string()),
        ("providesAdjointDerivatives", info.directional_derivatives.to_string()),
    ];
    if info.model_exchange.is_some() {
        empty(xml, "ModelExchange", &flags)?;
    }
    let own = [
        ("canHandleVariableCommunicationStepSize", info.variable_step_size.to_string()),
        ("maxOutputDerivativeOrder", derivative_orders(S::variables()).0.to_string()),
        ("providesIntermediateUpdate", true.to_string()),
        ("mightReturnEarlyFromDoStep", info.stops_at_events.to_string()),
        ("canReturnEarlyAfterIntermediateUpdate", true.to_string()),
        ("hasEventMode", has_events::<S>().to_string()),
    ];
    empty(xml, "CoSimulation", &[&flags[..], &own].concat())
}

/// The variables, those among them that the exporter adds, and what is known of their dependencies.
pub(super) fn variables<S: Slave>(xml: &mut Xml) -> Written {
    element(xml, "ModelVariables", &[], |xml| {
        let rows = (0_u32..).zip(S::variables()).filter(|(_, row)| row.alias_of().is_none());
        rows.into_iter().try_for_each(|(reference, row)| variable::<S>(xml, reference, row))?;
        Added::all::<S>().try_for_each(|(reference, added)| empty(xml, "Float64", &added_attributes(reference, added)))
    })?;
    structure::<S>(xml)
}

/// One that the exporter adds.
fn added_attributes(reference: u32, added: Added) -> Vec<Attribute> {
    let (name, description, causality) = match added {
        Added::Time => (Added::TIME.to_owned(), "Time, s", Causality::Independent),
        Added::Indicator(k) => (
            format!("eventIndicator[{}]", k + 1),
            "A change of its sign is an event of model exchange",
            Causality::Local,
        ),
    };
    vec![
        ("name", name),
        ("valueReference", reference.to_string()),
        ("description", description.to_owned()),
        ("causality", causality.as_str().to_owned()),
        ("variability", "continuous".to_owned()),
    ]
}

fn variable<S: Slave>(xml: &mut Xml, reference: u32, row: &Variable<S>) -> Written {
    let table = S::variables();
    let mut attributes = vec![("name", row.name().to_owned()), ("valueReference", reference.to_string())];
    attributes.extend(text("description", row.description()));
    attributes.push(("causality", row.causality().as_str().to_owned()));
    attributes.push(("variability", row.variability().as_str().to_owned()));
    attributes.extend(row.initial().filter(|_| !row.is_clock()).map(|i| ("initial", i.as_str().to_owned())));
    attributes.extend((!row.clocks().is_empty()).then(|| ("clocks", references(table, row.clocks()))));
    attributes.extend(is_intermediate::<S>(reference).then(|| ("intermediateUpdate", true.to_string())));
    // A row that is an alias is not written: what it says stands here.
    let alias = table.iter().find(|other| other.alias_of() == Some(row.name()));
    let derived = alias.unwrap_or(row).derivative_of();
    attributes.extend(derived.map(|state| ("derivative", references(table, &[state]))));
    attributes.extend(row.reinit().then(|| ("reinit", true.to_string())));
    let mut own = type_attributes(row.kind(), Standard::Fmi3);
    let mut start = None;
    match row.kind() {
        Kind::String(spec) => {
            own.clear();
            start = spec.start;
        }
        Kind::Clock(spec) => match spec.interval {
            ClockInterval::Triggered => own.push(("intervalVariability", "triggered".to_owned())),
            ClockInterval::Periodic { interval, shift } => own.extend([
                ("intervalVariability", "constant".to_owned()),
                ("intervalDecimal", double(interval)),
                ("shiftDecimal", double(shift)),
            ]),
        },
        _ => {}
    }
    attributes.extend(own);
    let name = row.kind().type_name_3();
    match start {
        None => empty(xml, name, &attributes),
        Some(value) => element(xml, name, &attributes, |xml| empty(xml, "Start", &[("value", value.to_owned())])),
    }
}

/// Every output, the derivatives of the continuous states, the unknowns of the initialisation, and the event indicators.
fn structure<S: Slave>(xml: &mut Xml) -> Written {
    let table = S::variables();
    element(xml, "ModelStructure", &[], |xml| {
        let mut list = |name: &str, reference: String, dependencies: Option<Vec<&str>>| {
            let mut attributes = vec![("valueReference", reference)];
            attributes.extend(dependencies.map(|names| ("dependencies", references(table, &names))));
            empty(xml, name, &attributes)
        };
        let present = |row: &Variable<S>| row.dependencies().map(<[&str]>::to_vec);
        let initial = |row: &Variable<S>| row.initial_dependencies().map(<[&[&str]]>::concat);
        for row in table.iter().filter(|row| row.causality() == Causality::Output) {
            list("Output", references(table, &[row.name()]), present(row))?;
        }
        for row in table.iter().filter(|row| row.derivative_of().is_some()) {
            list("ContinuousStateDerivative", references(table, &[row.name()]), present(row))?;
        }
        let mut listed = Vec::new();
        // The standard gives clocks no initial value, but validators miss those that are outputs.
        let is_clock = |row: &Variable<S>| row.is_clock() && row.causality() == Causality::Output;
        for row in table.iter().filter(|row| row.is_initial_unknown(table) || is_clock(row)) {
            let reference = references(table, &[row.name()]);
            // An alias is in the list once.
            if !listed.contains(&reference) {
                list("InitialUnknown", reference.clone(), initial(row))?;
                listed.push(reference);
            }
        }
        Added::all::<S>()
            .filter(|(_, added)| matches!(added, Added::Indicator(_)))
            .try_for_each(|(reference, _)| list("EventIndicator", reference.to_string(), None))
    })
}

/// Value references, ascending, of the variables with these names; of an alias, that of the other name.
fn references<M>(table: &[Variable<M>], names: &[&str]) -> String {
    let own = |name: &&str| {
        let row = table.iter().find(|row| row.name() == *name)?;
        value_reference(table, row.alias_of().unwrap_or(name))
    };
    let mut references: Vec<u32> = names.iter().filter_map(own).collect();
    references.sort_unstable();
    references.dedup();
    let words: Vec<_> = references.iter().map(u32::to_string).collect();
    words.join(" ")
}
