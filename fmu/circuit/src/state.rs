//! The state of the slave as bytes. The envelope around them (version, GUID, checksum) is the exporter's.

use fmu_export::{StateError, StateReader, StateWriter};
use videg_circuit::{Circuit, Settings, State};

use crate::harvesting::{Harvesting, REST_CAPACITANCE, handed_over};

/// Values of the parameters, in the order of the two tables; capacitances and their rates; the state of the circuit.
type Content = (Vec<f64>, Vec<i32>, [f64; 2], [Option<f64>; 2], Option<State>);

impl Harvesting {
    /// Parameters, inputs and, once it has a state of its own, the circuit.
    pub(crate) fn write(&self, out: &mut StateWriter) -> Result<(), StateError> {
        let reals = Settings::QUANTITIES.iter().map(|quantity| (quantity.get)(&self.settings)).collect();
        let choices = Settings::CHOICES.iter().map(|choice| (choice.get)(&self.settings)).collect();
        // Otherwise it follows from the parameters; if they have changed since it was made, it is made anew anyway.
        let circuit = self.circuit().filter(|circuit| *circuit.parameters() == self.settings.parameters());
        let content: Content = (reals, choices, self.capacitance, self.rate, circuit.map(Circuit::state));
        out.put(&content)
    }

    /// What [`Harvesting::write`] wrote.
    pub(crate) fn read_from(from: &mut StateReader<'_>) -> Result<Self, StateError> {
        let (reals, choices, capacitance, rate, state): Content = from.take()?;
        let settings = settings(&reals, &choices)?;
        if let Some(bad) = capacitance.into_iter().chain(rate.into_iter().flatten()).find(|value| !value.is_finite()) {
            return Err(invalid(format!("a capacitance or its rate is {bad}")));
        }
        let circuit = if let Some(state) = state {
            let mut circuit = Circuit::new(settings.parameters(), state.capacitance).map_err(invalid)?;
            circuit.restore(&state).map_err(invalid)?;
            Ok(circuit)
        } else {
            Circuit::new(settings.parameters(), handed_over(capacitance, [REST_CAPACITANCE; 2]))
        };
        Ok(Self { settings, capacitance, rate, circuit })
    }
}

fn settings(reals: &[f64], choices: &[i32]) -> Result<Settings, StateError> {
    if (reals.len(), choices.len()) != (Settings::QUANTITIES.len(), Settings::CHOICES.len()) {
        return Err(invalid("another number of parameters"));
    }
    let mut settings = Settings::default();
    for (quantity, value) in Settings::QUANTITIES.iter().zip(reals) {
        (quantity.set)(&mut settings, *value);
    }
    for (choice, item) in Settings::CHOICES.iter().zip(choices) {
        (choice.set)(&mut settings, *item);
        if (choice.get)(&settings) != *item {
            return Err(invalid(format!("{} = {item} is no choice", choice.name)));
        }
    }
    Ok(settings)
}

#[allow(clippy::needless_pass_by_value)] // so that it fits into map_err
fn invalid(reason: impl core::fmt::Display) -> StateError {
    StateError::Invalid(reason.to_string())
}
