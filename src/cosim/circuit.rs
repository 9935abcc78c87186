//! Circuits as the master sees them.

use super::{CircuitSample, CosimError};

/// A circuit that the master can step. To add one, implement this in a file of its own.
pub trait CircuitSlave {
    /// Name of the circuit in tables.
    fn label(&self) -> &str;

    /// Steps from `time` by `step`, s, while the capacitances (left, right), F, run linearly from `start` to `end`.
    fn step(&mut self, time: f64, step: f64, start: [f64; 2], end: [f64; 2]) -> Result<(), CosimError>;

    /// Outputs at the communication point.
    fn sample(&self) -> Result<CircuitSample, CosimError>;

    /// Saves the state in place of the one before.
    fn save(&mut self) -> Result<(), CosimError> {
        Err(CosimError::NoRollback { label: self.label().to_owned() })
    }

    /// Goes back to the state saved.
    fn restore(&mut self) -> Result<(), CosimError> {
        Err(CosimError::NoRollback { label: self.label().to_owned() })
    }
}
