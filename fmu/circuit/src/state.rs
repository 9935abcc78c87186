//! The state of the slave as bytes. The envelope around them (version, GUID, checksum) is the exporter's.

use fmu_export::{StateError, StateReader, StateWriter};
use videg_circuit::{Circuit, Ledger, Settings, State};

use crate::harvesting::{Harvesting, REST_CAPACITANCE, handed_over};

impl Harvesting {
    /// Parameters, inputs and, once it has a state of its own, the circuit.
    pub(crate) fn write(&self, out: &mut StateWriter) {
        for quantity in Settings::QUANTITIES {
            out.f64((quantity.get)(&self.settings));
        }
        for choice in Settings::CHOICES {
            out.i32((choice.get)(&self.settings));
        }
        self.capacitance.into_iter().for_each(|value| out.f64(value));
        self.rate.into_iter().for_each(|value| out.option_f64(value));
        // Otherwise it follows from the parameters; if they have changed since it was made, it is made anew anyway.
        let circuit = self.circuit().filter(|circuit| *circuit.parameters() == self.settings.parameters());
        out.bool(circuit.is_some());
        if let Some(circuit) = circuit {
            write_state(&circuit.state(), out);
        }
    }

    /// What [`Harvesting::write`] wrote.
    pub(crate) fn read_from(from: &mut StateReader<'_>) -> Result<Self, StateError> {
        let mut settings = Settings::default();
        for quantity in Settings::QUANTITIES {
            (quantity.set)(&mut settings, from.f64()?);
        }
        for choice in Settings::CHOICES {
            let item = from.i32()?;
            if !(1..).zip(choice.items).any(|(number, _)| number == item) {
                return Err(invalid(format!("{}: no such item", choice.name)));
            }
            (choice.set)(&mut settings, item);
        }
        let capacitance = pair(from)?;
        let rate = [from.option_f64()?, from.option_f64()?];
        if let Some(bad) = capacitance.into_iter().chain(rate.into_iter().flatten()).find(|value| !value.is_finite()) {
            return Err(invalid(format!("a capacitance or its rate is {bad}")));
        }
        let circuit = if from.bool()? {
            let state = read_state(from)?;
            let mut circuit = Circuit::new(settings.parameters(), state.capacitance).map_err(invalid)?;
            circuit.restore(&state).map_err(invalid)?;
            Ok(circuit)
        } else {
            Circuit::new(settings.parameters(), handed_over(capacitance, [REST_CAPACITANCE; 2]))
        };
        Ok(Self { settings, capacitance, rate, circuit })
    }
}

#[allow(clippy::needless_pass_by_value)] // so that it fits into map_err
fn invalid(reason: impl core::fmt::Display) -> StateError {
    StateError::Invalid(format!("{reason}"))
}

fn pair(from: &mut StateReader<'_>) -> Result<[f64; 2], StateError> {
    Ok([from.f64()?, from.f64()?])
}

fn flags(from: &mut StateReader<'_>) -> Result<[bool; 2], StateError> {
    Ok([from.bool()?, from.bool()?])
}

fn write_state(state: &State, out: &mut StateWriter) {
    out.f64(state.time);
    state.charge.into_iter().chain(state.capacitance).for_each(|value| out.f64(value));
    let flags = state.charging.into_iter().chain(state.holding).chain(state.releasing);
    flags.for_each(|flag| out.bool(flag));
    let ledger = &state.ledger;
    for value in [
        state.load_voltage,
        state.load_current,
        state.supply_current,
        state.internal_step,
        state.initial_energy,
        ledger.supply,
        ledger.load,
        ledger.zener,
        ledger.diode,
        ledger.stored,
        ledger.mechanical,
        ledger.supply_charge,
        ledger.load_charge,
    ] {
        out.f64(value);
    }
    out.u64(state.events);
}

fn read_state(from: &mut StateReader<'_>) -> Result<State, StateError> {
    Ok(State {
        time: from.f64()?,
        charge: pair(from)?,
        capacitance: pair(from)?,
        charging: flags(from)?,
        holding: flags(from)?,
        releasing: flags(from)?,
        load_voltage: from.f64()?,
        load_current: from.f64()?,
        supply_current: from.f64()?,
        internal_step: from.f64()?,
        initial_energy: from.f64()?,
        ledger: Ledger {
            supply: from.f64()?,
            load: from.f64()?,
            zener: from.f64()?,
            diode: from.f64()?,
            stored: from.f64()?,
            mechanical: from.f64()?,
            supply_charge: from.f64()?,
            load_charge: from.f64()?,
        },
        events: from.u64()?,
    })
}
