//! Mean flows of energy over the averaging window, for an energy-flow diagram.

use videg_circuit::Ledger;

use super::EnergyBalance;
use super::balance::ENERGIES;

/// Energies of [`ENERGIES`] at a time, J.
type Energies = [f64; ENERGIES.len()];

/// Mean flows over the averaging window, W: changes of energies over its length.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Flows {
    /// Of the harvester, if it sums them up.
    pub mechanics: Option<EnergyBalance>,
    /// Of the first circuit, if there is one; its charges are mean currents, A.
    pub circuit: Option<Ledger>,
}

impl Flows {
    /// The flows over `window`, s, from the sums at its edges.
    pub(super) fn over([from, to]: [f64; 2], energies: [Option<Energies>; 2], ledgers: [Option<&Ledger>; 2]) -> Self {
        let circuit = ledgers[0].zip(ledgers[1]).map(|(before, after)| after.flows_since(before, to - from));
        let mechanics = energies[0].zip(energies[1]).map(|(before, after)| {
            let [before, after] = [before, after].map(|energies| energies.map(|energy| energy / (to - from)));
            EnergyBalance::new(before, after, &circuit.unwrap_or_default())
        });
        Self { mechanics, circuit }
    }
}
