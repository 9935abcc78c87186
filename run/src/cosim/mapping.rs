//! Which variables of a user's circuit FMU are which of ours, checked against its description.
//!
//! ```toml
//! [map]                                   # our names, dotted as they are
//! left.capacitance = "C_left"
//! left.voltage = { variable = "u_left", factor = 1e-3 }   # variable = factor * SI value
//! right = "none"                          # no right membrane
//! supply.energy = "none"                  # no supply: counts as 0
//!
//! [set]                                   # start values of the circuit FMU
//! R_load = 1e9
//! ```

use std::path::Path;

use fmu_import::{BaseUnit, Causality, Kind, ModelDescription, Variable, nearest_name};
use serde::Deserialize;
use toml::{Table, Value};

use super::{CircuitSample, CosimError, Coupling, Method};
use crate::scenario::{
    Origin, Scenario, Setting, check_characters, dotted, read_file, toml_error, value_text, with_plain_ends,
};

/// Inputs of a circuit, left and right.
const INPUTS: [&str; 2] = ["left.capacitance", "right.capacitance"];
const SIDES: [&str; 2] = ["left", "right"];
/// What is mapped to this is not there.
const NONE: &str = "none";

/// The user's names for the variables of a circuit. Variables that are called as those of `HarvestingCircuit` need no entry.
#[derive(Debug, Clone, Default)]
pub struct Mapping {
    /// One entry a name.
    entries: Vec<Entry>,
    /// Start values of the circuit FMU.
    pub settings: Vec<Setting>,
}

#[derive(Debug, Clone)]
struct Entry {
    /// Our name.
    name: String,
    /// The variable of the FMU; none if there is none.
    variable: Option<String>,
    /// The variable over its SI value, if that was given.
    factor: Option<f64>,
    origin: Origin,
}

/// Layout of the file; any other key is an error.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Layout {
    #[serde(default)]
    map: Table,
    #[serde(default)]
    set: Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Scaled {
    variable: String,
    factor: Option<f64>,
}

impl Mapping {
    /// The mapping in the file at `path` with `options` of the command line, `NAME=VARIABLE` or `NAME=VARIABLE*FACTOR`, which
    /// replace entries of the file.
    ///
    /// # Errors
    /// An unreadable file, an entry that says nothing, two options for one name.
    pub fn read(options: &[String], path: Option<&Path>) -> Result<Self, CosimError> {
        let mut mapping = match path {
            Some(path) => Self::from_file(path)?,
            None => Self::default(),
        };
        for text in options {
            let entry = Entry::of_option(text)?;
            if let Some(other) = mapping.entries.iter().find(|other| other.name == entry.name)
                && other.origin == Origin::Option
            {
                return Err(entry.refused("is given twice".to_owned()));
            }
            mapping.entries.retain(|other| other.name != entry.name);
            mapping.entries.push(entry);
        }
        Ok(mapping)
    }

    fn from_file(path: &Path) -> Result<Self, CosimError> {
        let (mut mapping, _) = read_file(path, Self::parse).map_err(Box::new)?;
        let origin = Origin::File(path.to_owned());
        mapping.entries.iter_mut().for_each(|entry| entry.origin = origin.clone());
        mapping.settings.iter_mut().for_each(|setting| setting.origin = origin.clone());
        Ok(mapping)
    }

    fn parse(text: &str) -> Result<Self, String> {
        let said = |error: toml::de::Error| toml_error(&error);
        let text = &with_plain_ends(text);
        let Layout { map, set } = toml::from_str(text).map_err(said)?;
        check_characters(&toml::from_str(text).map_err(said)?)?;
        let entries = dotted("", &map, |table| table.contains_key("variable"));
        let entries = entries.into_iter().map(|(name, value)| Entry::of_value(&name, value));
        let settings = dotted("", &set, |_| false).into_iter();
        let settings = settings.map(|(name, value)| Ok(Setting::new(&*name, value_text(&name, value)?)));
        Ok(Self { entries: entries.collect::<Result<_, _>>()?, settings: settings.collect::<Result<_, String>>()? })
    }

    /// Checks the mapping against the description of the circuit FMU and the `settings` of it, and that
    /// against the run.
    ///
    /// # Errors
    /// A name that no circuit has; a variable that the FMU does not have, of another type, causality or unit; a membrane
    /// without capacitance or voltage; steps that the FMU cannot take.
    pub(super) fn resolve(
        &self,
        circuit: &ModelDescription,
        settings: &[Setting],
        coupling: &Coupling,
        scenario: &Scenario,
    ) -> Result<Connection, CosimError> {
        check_steps(circuit, coupling, scenario)?;
        self.check_names()?;
        // What was given comes before what is missing.
        for entry in self.entries.iter().filter(|entry| !SIDES.contains(&entry.name.as_str())) {
            self.wire(circuit, &entry.name, 0)?;
        }
        let connection = self.connect(circuit)?;
        let mapped = |name: &str| connection.inputs.iter().any(|wire| wire.variable == name);
        match settings.iter().find(|setting| mapped(&setting.name)) {
            Some(setting) => Err(refused(setting.place(), "is an input that the harvester sets".to_owned())),
            None => Ok(connection),
        }
    }

    /// The variables of a circuit FMU by this mapping.
    ///
    /// # Errors
    /// As for [`Mapping::resolve`], but for the steps.
    pub(super) fn connect(&self, circuit: &ModelDescription) -> Result<Connection, CosimError> {
        let absent = SIDES.map(|side| self.entry(side).is_some());
        if absent == [true; 2] {
            return Err(refused("--map left=none, right=none".to_owned(), "a membrane at least is needed".to_owned()));
        }
        let mut connection =
            Connection { interpolates: circuit.co_simulation.can_interpolate_inputs, ..Connection::default() };
        for (side, name) in INPUTS.into_iter().enumerate().filter(|(side, _)| !absent[*side]) {
            let wire = self.wire(circuit, name, side)?;
            let wire = wire.ok_or_else(|| missing(circuit, name, SIDES[side]))?;
            if connection.inputs.iter().any(|other| other.reference == wire.reference) {
                let reason = format!("{} is the other capacitance already", wire.variable);
                return Err(refused(self.place(name), reason));
            }
            connection.inputs.push(wire);
        }
        for (column, name) in CircuitSample::NAMES.into_iter().enumerate() {
            let side = SIDES.get(column);
            if absent.get(column) == Some(&true) || self.entry(name).is_some_and(|entry| entry.variable.is_none()) {
                connection.zero.push(column);
                continue;
            }
            match (self.wire(circuit, name, column)?, side) {
                (Some(wire), _) => connection.outputs.push(wire),
                (None, Some(side)) => return Err(missing(circuit, name, side)),
                (None, None) => {}
            }
        }
        Ok(connection)
    }

    fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    fn place(&self, name: &str) -> String {
        self.entry(name).map_or_else(|| name.to_owned(), Entry::place)
    }

    /// Every entry has a name that a circuit has, and only what may be absent is.
    fn check_names(&self) -> Result<(), CosimError> {
        let names = || INPUTS.into_iter().chain(CircuitSample::NAMES).chain(SIDES);
        for entry in &self.entries {
            let name = entry.name.as_str();
            if !names().any(|known| known == name) {
                let hint = nearest_name(name, names()).map_or_else(
                    || format!("allowed: {}", names().collect::<Vec<_>>().join(", ")),
                    |nearest| format!("did you mean {nearest}?"),
                );
                return Err(entry.refused(format!("a circuit has no such variable; {hint}")));
            }
            match (SIDES.into_iter().find(|side| name.starts_with(side)), &entry.variable) {
                (Some(side), Some(_)) if side == name => {
                    return Err(entry.refused(format!("allowed: {NONE}, if there is no {side} membrane")));
                }
                (Some(side), None) if side != name => {
                    return Err(
                        entry.refused(format!("is needed; for a circuit without a {side} membrane, {side}={NONE}"))
                    );
                }
                (Some(side), Some(_)) if self.entry(side).is_some() => {
                    return Err(entry.refused(format!("{side}={NONE} says that there is no {side} membrane")));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The variable that is our `name`, which has the index `ours`; none if there is none.
    fn wire(&self, circuit: &ModelDescription, name: &str, ours: usize) -> Result<Option<Wire>, CosimError> {
        let entry = self.entry(name);
        let Some(wanted) = entry.map_or(Some(name), |entry| entry.variable.as_deref()) else { return Ok(None) };
        let found = circuit.variable(wanted);
        let variable = match (found, entry) {
            (Ok(variable), _) => variable,
            (Err(_), None) => return Ok(None),
            (Err(cause), Some(entry)) => return Err(entry.refused(cause.to_string())),
        };
        let fail = |reason: String| refused(self.place(name), reason);
        if !matches!(variable.kind, Kind::Real { .. }) {
            return Err(fail(format!("{wanted} is of type {}, allowed is Real", variable.kind.name())));
        }
        let takes = INPUTS.contains(&name);
        if takes != variable.is_input() || variable.causality == Causality::Independent {
            let allowed = if takes { "an input" } else { "an output" };
            return Err(fail(format!(
                "{wanted} has the causality {}, allowed is {allowed}",
                variable.causality.as_str()
            )));
        }
        let factor = match entry.and_then(|entry| entry.factor) {
            Some(factor) => factor,
            None => factor(circuit, variable, name).map_err(fail)?,
        };
        let (variable, reference) = (wanted.to_owned(), variable.value_reference);
        Ok(Some(Wire { ours, variable, reference, factor }))
    }
}

impl Entry {
    fn of_option(text: &str) -> Result<Self, CosimError> {
        let place = format!("--map {text}");
        let fail = |reason: &str| refused(place.clone(), reason.to_owned());
        let (name, target) = text.split_once('=').map_or((text, ""), |(name, target)| (name.trim(), target.trim()));
        if name.is_empty() || target.is_empty() {
            return Err(fail("NAME=VARIABLE or NAME=VARIABLE*FACTOR is expected"));
        }
        // A name of FMI may have an asterisk; what follows the last one is a factor only if it is a number.
        let scaled =
            target.rsplit_once('*').and_then(|(variable, factor)| Some((variable, factor.trim().parse().ok()?)));
        let (variable, factor) =
            scaled.map_or((target, None), |(variable, factor): (&str, f64)| (variable.trim(), Some(factor)));
        let entry = Self::new(name.to_owned(), variable, factor).map_err(|reason| fail(&reason))?;
        Ok(Self { origin: Origin::Option, ..entry })
    }

    fn of_value(name: &str, value: &Value) -> Result<Self, String> {
        let fail = |reason: String| format!("map.{name}: {reason}");
        match value {
            Value::String(variable) => Self::new(name.to_owned(), variable, None).map_err(fail),
            Value::Table(table) => {
                let Scaled { variable, factor } = table.clone().try_into().map_err(|error| fail(toml_error(&error)))?;
                Self::new(name.to_owned(), &variable, factor).map_err(fail)
            }
            other => Err(fail(format!(
                "is of type {}: allowed is the name of a variable, or {{ variable = NAME, factor = NUMBER }}",
                other.type_str()
            ))),
        }
    }

    fn new(name: String, variable: &str, factor: Option<f64>) -> Result<Self, String> {
        match factor {
            Some(factor) if factor == 0.0 || !factor.is_finite() => {
                Err(format!("the factor {factor}: allowed are finite numbers other than 0"))
            }
            _ => {
                let variable = (variable != NONE).then(|| variable.to_owned());
                Ok(Self { name, variable, factor, origin: Origin::Program })
            }
        }
    }

    fn place(&self) -> String {
        match &self.origin {
            Origin::File(_) => self.origin.entry("map", &self.name),
            _ => format!("--map {}={}", self.name, self.variable.as_deref().unwrap_or(NONE)),
        }
    }

    fn refused(&self, reason: String) -> CosimError {
        refused(self.place(), reason)
    }
}

/// The error of a membrane of which a variable has no counterpart.
fn missing(circuit: &ModelDescription, name: &str, side: &str) -> CosimError {
    let inputs = INPUTS.contains(&name);
    let of_this_kind = |it: &&Variable| {
        matches!(it.kind, Kind::Real { .. }) && if inputs { it.is_input() } else { it.causality == Causality::Output }
    };
    let names: Vec<_> = circuit.variables.iter().filter(of_this_kind).map(|it| it.name.as_str()).take(8).collect();
    let (kind, names) = (if inputs { "inputs" } else { "outputs" }, names.join(", "));
    let names = if names.is_empty() { "none".to_owned() } else { names };
    refused(
        format!("--map {name}=VARIABLE"),
        format!(
            "is missing: {} has no variable of this name (its Real {kind}: {names}); without a {side} membrane: --map {side}={NONE}",
            circuit.model_name
        ),
    )
}

fn refused(place: String, reason: String) -> CosimError {
    CosimError::Mapping { place, reason }
}

/// The FMU takes the steps of the master.
fn check_steps(circuit: &ModelDescription, coupling: &Coupling, scenario: &Scenario) -> Result<(), CosimError> {
    let capabilities = &circuit.co_simulation;
    let name = &circuit.model_name;
    if coupling.tolerance.is_some() && !capabilities.can_get_and_set_fmu_state {
        return Err(CosimError::NoRollback { label: name.clone() });
    }
    if capabilities.can_handle_variable_communication_step_size {
        return Ok(());
    }
    let fail = |reason: String| Err(refused(format!("--circuit-fmu: {name}"), reason));
    let unable = "does not declare canHandleVariableCommunicationStepSize";
    if coupling.method != Method::Plain || coupling.tolerance.is_some() {
        return fail(format!("{unable}; only --master plain has constant steps"));
    }
    let is_on_grid = |time: f64| {
        let steps = time / scenario.step;
        (steps - steps.round()).abs() <= 1e-9 * steps.max(1.0)
    };
    let times = [scenario.until, scenario.window[0], scenario.window[1]];
    match times.into_iter().find(|&time| !is_on_grid(time)) {
        Some(time) => {
            fail(format!("{unable}; --until and --window must be multiples of --step {}, {time} is not", scenario.step))
        }
        None => Ok(()),
    }
}

/// The value of `variable` over that of our `name` in SI units, by its unit.
fn factor(circuit: &ModelDescription, variable: &Variable, name: &str) -> Result<f64, String> {
    // kg, m, s, A
    let (unit, exponents) = match name.rsplit('.').next() {
        Some("capacitance") => ("F", [-1, -2, 4, 2]),
        Some("voltage") => ("V", [1, 2, -3, -1]),
        Some("current") => ("A", [0, 0, 0, 1]),
        Some("charge") => ("C", [0, 0, 1, 1]),
        _ => ("J", [1, 2, -2, 0]),
    };
    let Some(found) = variable.unit() else { return Ok(1.0) };
    let base = circuit.units.iter().find(|unit| unit.name == found).and_then(|unit| unit.base.as_ref());
    let Some(BaseUnit { exponents: of_base, factor, offset }) = base else {
        return if found == unit {
            Ok(1.0)
        } else {
            Err(format!(
                "{} is in {found}, which the FMU does not define; {unit} is needed: give a factor",
                variable.name
            ))
        };
    };
    if of_base[..4] != exponents || of_base[4..] != [0; 4] {
        return Err(format!("{} is in {found}, which is no multiple of {unit}", variable.name));
    }
    if *offset != 0.0 || *factor == 0.0 || !factor.is_finite() {
        return Err(format!(
            "{} is in {found}, which is {factor} {unit} + {offset}; allowed are multiples",
            variable.name
        ));
    }
    Ok(1.0 / factor)
}

/// A variable of a circuit FMU that is one of ours.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wire {
    /// Index of ours.
    pub(super) ours: usize,
    pub(super) variable: String,
    pub(super) reference: u32,
    /// The variable over the SI value of ours.
    pub(super) factor: f64,
}

/// The variables of a circuit FMU that the master needs.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Connection {
    /// Capacitances; the index is the membrane's.
    pub(super) inputs: Vec<Wire>,
    /// Outputs; the index is that in [`CircuitSample::NAMES`].
    pub(super) outputs: Vec<Wire>,
    /// Outputs that are not there and count as 0. All others are not known.
    pub(super) zero: Vec<usize>,
    /// Whether inputs are given with their derivatives.
    pub(super) interpolates: bool,
}
