//! Variables of the circuit, and the powers, beside those of the harvester.

use fmu_import::{Causality, FmiError, Kind, ModelDescription, Variability, Variable};
use videg_circuit::Settings;
use videg_coupled::OVER_LIMITS;

use crate::cosim::CircuitSample;

/// Mean powers over the averaging window, W, that runs with a circuit have.
pub const POWERS: [&str; 3] = ["net_power", "load_power", "supply_power"];

/// The variables of the `harvester`, of the circuit, and the powers. A name that both have is the harvester's.
///
/// # Errors
/// None: they are part of this program.
pub fn with_circuit(harvester: ModelDescription) -> Result<ModelDescription, FmiError> {
    let document = include_bytes!("../../modelDescription/HarvestingCircuit.xml");
    let circuit = ModelDescription::parse(document, "modelDescription/HarvestingCircuit.xml")?;
    let powers = POWERS.map(|name| output(name, "W", "Mean over the averaging window"));
    let limits = OVER_LIMITS.map(|name| output(name, "1", "Most that the run takes of a limit of the film, over it"));
    // C(t) comes from the harvester.
    let of_circuit = circuit.variables.into_iter().filter(|variable| !variable.is_input());
    Ok(harvester.with(of_circuit.chain(powers).chain(limits), circuit.enumerations))
}

fn output(name: &str, unit: &str, description: &str) -> Variable {
    Variable {
        name: name.to_owned(),
        value_reference: u32::MAX,
        description: Some(description.to_owned()),
        causality: Causality::Output,
        variability: Variability::Continuous,
        initial: None,
        declared_type: None,
        kind: Kind::Real { unit: Some(unit.into()), start: None, min: None, max: None },
        type_name: "Real",
    }
}

/// Whether a variable of `system_description` is one of the circuit, a power, or of what a run takes of the film's limits.
pub fn is_electrical(variable: &Variable) -> bool {
    let name = variable.name.as_str();
    let quantities = Settings::QUANTITIES.iter().map(|it| it.name);
    let mut names = quantities.chain(Settings::CHOICES.iter().map(|it| it.name)).chain(outputs());
    POWERS.contains(&name) || OVER_LIMITS.contains(&name) || names.any(|known| known == name)
}

/// Energy that the mechanics gave, which follows from the others.
pub const CONVERTED: &str = "converted.energy";

/// Outputs of the circuit alone: the names of the others are those of inputs of the harvester.
fn outputs() -> impl Iterator<Item = &'static str> {
    let alone = |name: &&str| !matches!(*name, "left.voltage" | "right.voltage");
    CircuitSample::NAMES.into_iter().filter(alone).chain([CONVERTED])
}
