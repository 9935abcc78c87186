//! Settings by name: which of them are the harvester's, which the circuit's.

use anyhow::anyhow;
use videg_circuit::Settings;

use crate::cosim::EmbeddedCircuit;
use crate::scenario::{Origin, Scenario, Setting};
use fmu_import::{ModelDescription, nearest_name};

/// Settings of the harvester, and those of the circuit. A name that both have is the harvester's.
pub fn split(harvester: &ModelDescription, scenario: &Scenario) -> anyhow::Result<(Vec<Setting>, Vec<Setting>)> {
    let (mut mechanical, mut electrical) = (Vec::new(), Vec::new());
    for setting in &scenario.settings {
        let of_circuit = EmbeddedCircuit::apply(&mut Settings::default(), setting);
        let of_circuit = of_circuit.map_err(|error| anyhow!("{}: {error}", setting.place()))?;
        if harvester.variable(&setting.name).is_ok() {
            mechanical.push(setting.clone());
        } else if of_circuit {
            electrical.push(setting.clone());
        } else {
            anyhow::bail!(unknown(harvester, setting));
        }
    }
    Ok((mechanical, electrical))
}

/// An error about values that do not go together, with where those of `settings` were said.
pub fn placed(settings: &[Setting], error: impl Into<anyhow::Error>) -> anyhow::Error {
    let error = error.into();
    let text = format!("{error:#}");
    let is_named = |index: usize, setting: &Setting| {
        let is_last = settings[index + 1..].iter().all(|later| later.name != setting.name);
        is_last && setting.origin != Origin::Program && text.contains(&format!("{} = ", setting.name))
    };
    let named = settings.iter().enumerate().filter(|(index, setting)| is_named(*index, setting));
    let places: Vec<_> = named.map(|(_, setting)| setting.place()).collect();
    if places.is_empty() { error } else { anyhow!("{text} ({})", places.join(", ")) }
}

fn unknown(harvester: &ModelDescription, setting: &Setting) -> String {
    let harvester = harvester.variables.iter().map(|variable| variable.name.as_str());
    let quantities = Settings::QUANTITIES.iter().map(|quantity| quantity.name);
    let choices = Settings::CHOICES.iter().map(|choice| choice.name);
    let hint = nearest_name(&setting.name, harvester.chain(quantities).chain(choices));
    let hint = hint.map_or_else(|| "see videg fmu info".to_owned(), |nearest| format!("did you mean {nearest}?"));
    format!("{}: neither the harvester nor the circuit has such a variable; {hint}", setting.place())
}
