//! What the importer sets, and the circuit that is driven by it.

use fmu_export::SlaveError;
use videg_circuit::{Circuit, Error, Settings};

/// Capacitance of the paper's membranes at rest, F: the start value of the inputs.
pub(crate) const REST_CAPACITANCE: f64 = 1.501_476_744_842_152e-11;

/// The capacitances `set`, or `otherwise` where nothing has been handed over, F.
pub(crate) fn handed_over(set: [f64; 2], otherwise: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|j| if set[j] == 0.0 { otherwise[j] } else { set[j] })
}

/// The harvesting circuit as a slave.
#[derive(Clone)]
pub struct Harvesting {
    pub(crate) settings: Settings,
    /// Capacitances at the communication point, left and right, F; 0 where nothing has been handed over yet.
    pub(crate) capacitance: [f64; 2],
    /// Their rates over the next step, F/s; none: the capacitance set is taken to be reached at the step's end.
    pub(crate) rate: [Option<f64>; 2],
    /// The circuit; before initialisation it is made anew from the parameters whenever they are read.
    pub(crate) circuit: Result<Circuit, Error>,
}

impl Harvesting {
    /// Reads a value from the circuit; NaN while the parameters contradict each other (before initialisation only).
    pub(crate) fn read(&self, value: impl FnOnce(&Circuit) -> f64) -> f64 {
        self.circuit.as_ref().map_or(f64::NAN, value)
    }

    /// The circuit, unless the parameters contradict each other.
    pub(crate) fn circuit(&self) -> Option<&Circuit> {
        self.circuit.as_ref().ok()
    }

    pub(crate) fn running(&mut self) -> Result<&mut Circuit, SlaveError> {
        self.circuit.as_mut().map_err(|error| SlaveError::error(error.to_string()))
    }
}
