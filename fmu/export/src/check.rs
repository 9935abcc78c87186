//! Checks of a table and its [`ModelInfo`] as a whole, once per process: a mistake in it would otherwise surface
//! as an FMU that some importers refuse.

use crate::added::Added;
use crate::info::{ModelInfo, Terminal};
use crate::slave::Slave;
use crate::variable::{
    Causality, ClockInterval, ClockSpec, EnumerationType, Initial, Kind, RealSpec, Variability, Variable,
};
use std::collections::{HashMap, HashSet};

/// A mistake in a variable table or in the facts about the FMU.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{subject}: {mistake}")]
pub struct TableError {
    subject: String,
    mistake: String,
}

type Check = Result<(), TableError>;

fn mistake<T>(subject: &str, mistake: impl Into<String>) -> Result<T, TableError> {
    Err(TableError { subject: subject.to_owned(), mistake: mistake.into() })
}

fn ensure(holds: bool, subject: &str, what: impl FnOnce() -> String) -> Check {
    if holds { Ok(()) } else { mistake(subject, what()) }
}

/// Checks all there is to know about an FMU before it runs.
pub(crate) fn check_fmu<S: Slave>() -> Check {
    check_info(&S::INFO)?;
    check_table(S::variables())?;
    check_states(S::variables(), S::INFO.model_exchange.is_some())?;
    check_terminals(S::INFO.terminals, S::variables())
}

fn check_info(info: &ModelInfo) -> Check {
    let name = info.model_identifier;
    let identifier = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    ensure(identifier, name, || {
        "the model identifier is no C identifier: letters, digits and _, no digit in front".into()
    })?;
    let texts = [
        info.model_name,
        info.description,
        info.author,
        info.version,
        info.copyright,
        info.license,
        info.generation_tool,
    ];
    texts.into_iter().try_for_each(|text| check_text(name, text))?;
    let Some(experiment) = info.default_experiment else {
        return Ok(());
    };
    let sensible = experiment.start_time.is_finite()
        && experiment.stop_time.is_finite()
        && experiment.stop_time > experiment.start_time
        && experiment.step_size.is_finite()
        && experiment.step_size > 0.0
        && experiment.tolerance.is_none_or(|t| t.is_finite() && t > 0.0);
    ensure(sensible, name, || format!("{experiment:?} is no experiment"))
}

fn check_table<M>(table: &[Variable<M>]) -> Check {
    let mut names = HashSet::new();
    let mut types: HashMap<&str, &EnumerationType> = HashMap::new();
    for variable in table {
        let name = variable.name;
        ensure(!name.is_empty(), "variable", || "its name is empty".into())?;
        check_text(name, name)?;
        check_text(name, variable.description)?;
        ensure(names.insert(name), name, || "its name occurs twice".into())?;
        check_variability(variable)?;
        check_kind(variable)?;
        if let Kind::Enumeration(spec) = &variable.kind {
            let first = types.entry(spec.of.name).or_insert(spec.of);
            ensure(**first == *spec.of, name, || format!("there are two enumerations named {}", spec.of.name))?;
        }
    }
    let clash = types.keys().find(|name| names.contains(*name));
    ensure(clash.is_none(), clash.unwrap_or(&""), || "a variable and an enumeration share this name".into())?;
    let times = table.iter().filter(|v| v.causality == Causality::Independent).count();
    ensure(times <= 1, "table", || "there are two independent variables".into())?;
    let is_free = times == 1 || !names.contains(Added::TIME);
    ensure(is_free, Added::TIME, || {
        "FMI 3.0 adds a variable of this name; take another, or Variable::independent".into()
    })?;
    table.iter().try_for_each(|v| check_dependencies(v, &names))?;
    table.iter().try_for_each(|v| check_clocks(v, table).and_then(|()| check_alias(v, table)))?;
    table.iter().try_for_each(|v| check_initial_dependencies(v, table))
}

fn check_terminals<M>(terminals: &[Terminal], table: &[Variable<M>]) -> Check {
    for terminal in terminals {
        for (member, name) in terminal.members {
            check_text(terminal.name, member)?;
            let known = table.iter().any(|row| row.name == *name);
            ensure(known, terminal.name, || format!("its member {member} is {name}, which is not in the table"))?;
        }
    }
    Ok(())
}

/// Only a continuous state of model exchange can jump.
fn check_states<M>(table: &[Variable<M>], exchange: bool) -> Check {
    table.iter().filter(|v| v.reinit).try_for_each(|v| {
        ensure(exchange, v.name, || "it jumps at events, but this FMU is not for model exchange".into())?;
        ensure(v.is_continuous_state(table), v.name, || "it jumps at events, but is no continuous state".into())
    })
}

/// XML attributes normalise line breaks and cannot hold other control characters.
fn check_text(subject: &str, text: &str) -> Check {
    ensure(!text.contains(char::is_control), subject, || format!("{text:?} contains a control character"))
}

fn check_variability<M>(variable: &Variable<M>) -> Check {
    let real = matches!(variable.kind, Kind::Real(_));
    let allowed = match variable.causality {
        Causality::Parameter | Causality::CalculatedParameter => {
            matches!(variable.variability, Variability::Fixed | Variability::Tunable)
        }
        Causality::Input | Causality::Output | Causality::Local => match variable.variability {
            Variability::Continuous => real,
            Variability::Discrete => true,
            Variability::Fixed | Variability::Tunable => false,
        },
        Causality::Independent => real && variable.variability == Variability::Continuous,
    };
    ensure(allowed, variable.name, || {
        let (v, c) = (variable.variability.as_str(), variable.causality.as_str());
        format!("a {} cannot be a {v} {c}", variable.kind.type_name())
    })
}

fn check_kind<M>(variable: &Variable<M>) -> Check {
    let name = variable.name;
    match &variable.kind {
        Kind::Real(spec) => check_real(variable, spec),
        Kind::Integer(spec) => {
            ensure(spec.min <= spec.max, name, || "its min is above its max".into())?;
            let (low, high) = spec.width.bounds();
            let fits = low <= spec.min && spec.max <= high;
            ensure(fits, name, || format!("its bounds {} and {} are beyond {:?}", spec.min, spec.max, spec.width))?;
            check_start(name, spec.start, |start| spec.complaint(start))
        }
        Kind::Enumeration(spec) => {
            ensure(!spec.of.items.is_empty(), spec.of.name, || "it has no items".into())?;
            let mut names = HashSet::new();
            for (item, description) in spec.of.items {
                ensure(names.insert(item), item, || "the item occurs twice".into())?;
                check_text(spec.of.name, item)?;
                check_text(item, description)?;
            }
            check_text(spec.of.name, spec.of.name)?;
            check_text(spec.of.name, spec.of.description)?;
            check_start(name, spec.start, |start| spec.complaint(start))
        }
        Kind::Boolean(_) => Ok(()),
        Kind::Clock(spec) => check_clock(variable, spec),
        Kind::String(spec) => check_text(name, spec.start.unwrap_or_default()),
    }
}

fn check_real<M>(variable: &Variable<M>, spec: &RealSpec<M>) -> Check {
    let name = variable.name;
    check_text(name, spec.unit)?;
    ensure(!spec.unit.is_empty(), name, || "its unit is empty; use \"1\" for none".into())?;
    ensure(spec.min <= spec.max, name, || "its min is above its max".into())?;
    let nominal = spec.nominal.is_none_or(|n| n.is_finite() && n > 0.0);
    ensure(nominal, name, || "its nominal value is not positive".into())?;
    let input = spec.input_derivatives.is_none() || variable.causality == Causality::Input;
    ensure(input, name, || "only an input takes input derivatives".into())?;
    let output = spec.output_derivatives.is_none() || variable.causality == Causality::Output;
    ensure(output, name, || "only an output gives output derivatives".into())?;
    check_start(name, spec.start, |start| spec.complaint(start))
}

/// Only what the environment sets can tick at times that the description tells.
fn check_clock<M>(variable: &Variable<M>, spec: &ClockSpec<M>) -> Check {
    let ClockInterval::Periodic { interval, shift } = spec.interval else { return Ok(()) };
    let sensible = interval.is_finite() && interval > 0.0 && shift.is_finite() && shift >= 0.0;
    ensure(sensible, variable.name, || format!("a clock cannot tick every {interval} s from {shift} s on"))
}

fn check_clocks<M>(variable: &Variable<M>, table: &[Variable<M>]) -> Check {
    for name in variable.clocks() {
        let known = table.iter().any(|row| row.is_clock() && row.name == *name);
        ensure(known, variable.name, || format!("it belongs to {name}, which is no clock"))?;
        let discrete = variable.variability == Variability::Discrete && !variable.is_clock();
        ensure(discrete, variable.name, || "only a discrete variable belongs to a clock".into())?;
    }
    Ok(())
}

/// FMI 3.0 has one variable for both, so all of the other row must hold for this one.
fn check_alias<M>(variable: &Variable<M>, table: &[Variable<M>]) -> Check {
    let Some(name) = variable.alias_of() else { return Ok(()) };
    let Some(other) = table.iter().find(|row| row.name == name) else {
        return mistake(variable.name, format!("it is an alias of {name}, which is not in the table"));
    };
    let unit = |row: &Variable<M>| if let Kind::Real(spec) = &row.kind { Some(spec.unit) } else { None };
    let fits = unit(variable).is_some() && unit(variable) == unit(other) && other.derivative_of().is_none();
    ensure(fits, variable.name, || format!("it cannot be an alias of {name}: another unit, or a derivative itself"))
}

fn check_start<T: Copy + ToString>(name: &str, start: Option<T>, complaint: impl FnOnce(T) -> Option<String>) -> Check {
    let Some(start) = start else {
        return Ok(());
    };
    match complaint(start) {
        None => Ok(()),
        Some(bound) => mistake(name, format!("start {}: {bound}", start.to_string())),
    }
}

fn check_dependencies<M>(variable: &Variable<M>, names: &HashSet<&str>) -> Check {
    if let Some(state) = variable.derivative_of {
        ensure(names.contains(state), variable.name, || format!("it derives {state}, which is not in the table"))?;
    }
    let dependencies = variable.dependencies.unwrap_or_default();
    for other in dependencies {
        ensure(names.contains(other), variable.name, || format!("it depends on {other}, which is not in the table"))?;
    }
    Ok(())
}

/// What an initial value may depend on is known before: inputs, and what has `initial = "exact"` (section 2.2.8).
fn check_initial_dependencies<M>(variable: &Variable<M>, table: &[Variable<M>]) -> Check {
    let is_known = |row: &Variable<M>| row.causality == Causality::Input || row.initial() == Some(Initial::Exact);
    let groups = variable.initial_dependencies.unwrap_or_default();
    groups.iter().copied().flatten().try_for_each(|other| {
        let known = table.iter().any(|row| row.name == *other && is_known(row));
        ensure(known, variable.name, || format!("it initially depends on {other}, which is no input or parameter"))
    })
}
