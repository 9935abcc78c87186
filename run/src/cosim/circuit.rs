//! Circuits as the master sees them.

use super::{CircuitSample, CosimError, ElementEnergy};

/// A circuit that the master can step. To add one, implement this in a file of its own.
pub trait CircuitSlave {
    /// Name of the circuit in tables.
    fn label(&self) -> &str;

    /// Steps from `time` by `step`, s, while the capacitances (left, right), F, run linearly from `start` to `end`.
    fn step(&mut self, time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError>;

    /// Outputs at the communication point.
    fn sample(&self) -> Result<CircuitSample, CosimError>;

    /// Names and values of the waveforms that were asked for, at the communication point.
    fn probes(&self) -> (&[String], &[f64]) {
        (&[], &[])
    }

    /// Energies that the elements took so far, if the circuit has a ledger of them.
    fn elements(&mut self) -> Result<Vec<ElementEnergy>, CosimError> {
        Ok(Vec::new())
    }

    /// What the user should know of the circuit.
    fn notes(&self) -> &[String] {
        &[]
    }

    /// Saves the state in place of the one before.
    fn save(&mut self) -> Result<(), CosimError> {
        Err(CosimError::NoRollback { label: self.label().to_owned() })
    }

    /// Goes back to the state saved.
    fn restore(&mut self) -> Result<(), CosimError> {
        Err(CosimError::NoRollback { label: self.label().to_owned() })
    }
}
