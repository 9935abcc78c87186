//! Settings by name: those of the harvester, those of the circuit, and defaults of the circuit.

use fmu_import::{ModelDescription, nearest_name};
use videg_circuit::{Choice, Settings, names};
use videg_coupled::Given;

use super::{CosimError, EmbeddedCircuit};
use crate::ngspice::NgspiceError;
use crate::scenario::{Origin, Setting};

/// Settings of the circuit that were asked for. Those left out follow from the harvester.
#[derive(Debug, Clone, Default)]
pub struct CircuitRequest {
    values: Settings,
    given: Vec<Setting>,
}

impl CircuitRequest {
    /// Divides `settings` into those of the harvester and those of the circuit. A name that both have is the harvester's. An
    /// error is a setting that neither has, or a value that the circuit cannot take.
    pub fn split(harvester: &ModelDescription, settings: &[Setting]) -> Result<(Vec<Setting>, Self), CosimError> {
        let (mut mechanical, mut circuit) = (Vec::new(), Self::default());
        for setting in settings {
            if harvester.variable(&setting.name).is_ok() {
                mechanical.push(setting.clone());
            } else if EmbeddedCircuit::apply(&mut circuit.values, setting)? {
                circuit.given.push(setting.clone());
            } else {
                let harvester = harvester.variables.iter().map(|variable| variable.name.as_str());
                let quantities = Settings::QUANTITIES.iter().map(|quantity| quantity.name);
                let choices = Settings::CHOICES.iter().map(|choice| choice.name);
                return Err(unknown(harvester.chain(quantities).chain(choices), setting));
            }
        }
        Ok((mechanical, circuit))
    }

    /// The variables that were set, with commas between them; none if none was.
    pub fn names(&self) -> Option<String> {
        let names: Vec<_> = self.given.iter().map(|setting| setting.name.as_str()).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }

    /// The circuit beside a harvester of `bias_voltage`, V: supplied at it and released at the supply voltage, as in
    /// Section 4.1, or into a storage at the voltage with the largest net gain at the capacitance `ratio` `C_3` / `C_2`,
    /// unless something else was asked for.
    pub fn resolve(&self, bias_voltage: f64, ratio: f64) -> Settings {
        let given = Given::among(self.given.iter().map(|setting| setting.name.as_str()));
        given.complete(self.values, bias_voltage, ratio)
    }

    /// The `error` of a circuit with these `settings`, with the places where the user set the variables that it names.
    pub fn located(&self, error: impl Into<CosimError>, settings: &Settings) -> CosimError {
        let cause = error.into();
        let named = match &cause {
            CosimError::Netlist(NgspiceError::Value { name, .. }) => vec![name.as_str()],
            _ => settings.parameters().validate().err().map_or_else(Vec::new, |error| error.variables()),
        };
        let is_last = |index: usize, name: &str| self.given[index + 1..].iter().all(|later| later.name != name);
        let places: Vec<_> = self
            .given
            .iter()
            .enumerate()
            .filter(|(index, setting)| named.contains(&setting.name.as_str()) && is_last(*index, &setting.name))
            .filter(|(_, setting)| setting.origin != Origin::Program)
            .map(|(_, setting)| setting.place())
            .collect();
        if places.is_empty() {
            return cause;
        }
        CosimError::Located { cause: Box::new(cause), places: places.join(", ") }
    }
}

fn unknown<'a>(names: impl Iterator<Item = &'a str>, setting: &Setting) -> CosimError {
    let nearest = nearest_name(&setting.name, names);
    let hint = nearest.map_or_else(|| "see videg fmu info".to_owned(), |nearest| format!("did you mean {nearest}?"));
    CosimError::UnknownVariable { place: setting.place(), hint }
}

/// Divides `settings` into those of the harvester and those of a user's `circuit` FMU. A name that both have is the harvester's.
///
/// # Errors
/// A setting that neither has.
pub fn split_between(
    harvester: &ModelDescription,
    circuit: &ModelDescription,
    settings: &[Setting],
) -> Result<[Vec<Setting>; 2], CosimError> {
    let mut parts = [Vec::new(), Vec::new()];
    for setting in settings {
        let side = [harvester, circuit].iter().position(|description| description.variable(&setting.name).is_ok());
        let names = || [harvester, circuit].into_iter().flat_map(|it| &it.variables).map(|it| it.name.as_str());
        parts[side.ok_or_else(|| unknown(names(), setting))?].push(setting.clone());
    }
    Ok(parts)
}

/// Name of a circuit in tables.
pub fn label(settings: &Settings) -> String {
    let [topology, release] = [Choice::TOPOLOGY, Choice::RELEASE].map(|choice| choice.chosen(settings));
    format!("{topology}, {release} at {:.0} V", settings.circuit.release_voltage())
}

/// The warning about a supply that is not at the bias voltage of the harvester, V.
pub fn voltage_warning(settings: &Settings, bias_voltage: f64) -> Option<String> {
    let supply = settings.circuit.supply_voltage;
    let name = names::SUPPLY_VOLTAGE;
    (supply != bias_voltage).then(|| {
        format!(
            "{name} = {supply} V differs from biasVoltage = {bias_voltage} V: Eqs. (12) to (15) are evaluated at the \
             latter, the circuit runs at the former"
        )
    })
}
