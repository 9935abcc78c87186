//! Settings by name: which of them are the harvester's, which the circuit's.

use videg_circuit::Settings;

use crate::cosim::EmbeddedCircuit;
use crate::fmi::{ModelDescription, nearest_name};
use crate::scenario::{Scenario, Setting};

/// Settings of the harvester, and those of the circuit. A name that both have is the harvester's.
pub fn split(harvester: &ModelDescription, scenario: &Scenario) -> anyhow::Result<(Vec<Setting>, Vec<Setting>)> {
    let (mut mechanical, mut electrical) = (Vec::new(), Vec::new());
    for setting in &scenario.settings {
        let of_circuit = EmbeddedCircuit::apply(&mut Settings::default(), setting)?;
        if harvester.variable(&setting.name).is_ok() {
            mechanical.push(setting.clone());
        } else if of_circuit {
            electrical.push(setting.clone());
        } else {
            anyhow::bail!(unknown(harvester, &setting.name));
        }
    }
    Ok((mechanical, electrical))
}

fn unknown(harvester: &ModelDescription, name: &str) -> String {
    let harvester = harvester.variables.iter().map(|variable| variable.name.as_str());
    let quantities = Settings::QUANTITIES.iter().map(|quantity| quantity.name);
    let choices = Settings::CHOICES.iter().map(|choice| choice.name);
    let hint = nearest_name(name, harvester.chain(quantities).chain(choices));
    let hint = hint.map_or_else(|| "see videg fmu info".to_owned(), |nearest| format!("did you mean {nearest}?"));
    format!("--set {name}: neither the harvester nor the circuit has such a variable; {hint}")
}
