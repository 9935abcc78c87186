//! Harvester and circuit on their way, for a caller who looks at both.

use videg_circuit::{Circuit, Settings};
use videg_model::{Harvester, Setup};

use crate::averages::Gains;
use crate::mechanics::Mechanics;
use crate::{CoupledError, Electrics, Watch};

/// Harvester and circuit on their way from 0 s, both membranes charged.
pub struct Simulation<'w> {
    mechanics: Mechanics,
    pub(crate) electrics: Electrics<'w>,
}

impl<'w> Simulation<'w> {
    /// At 0 s. The circuit follows straight lines whose distance from C(t) is at most `tolerance` times C(t), while `watch` looks at the
    /// films.
    ///
    /// # Errors
    /// As [`run`](crate::run).
    pub fn new<'a>(
        setup: impl Into<Setup<'a>>,
        settings: &Settings,
        tolerance: f64,
        watch: &'w mut dyn Watch,
    ) -> Result<Self, CoupledError> {
        let mechanics = Mechanics::new(setup.into(), tolerance)?;
        watch.begin(mechanics.harvester().membrane());
        let electrics = Electrics::new(settings, mechanics.start(), watch)?;
        Ok(Self { mechanics, electrics })
    }

    /// Goes on to `time`, s; not back.
    ///
    /// # Errors
    /// More events than can be resolved; numbers that are none.
    pub fn advance(&mut self, time: f64) -> Result<(), CoupledError> {
        self.mechanics.follow(time, &mut self.electrics).map(|_| ())
    }

    /// The harvester where it is now.
    pub fn harvester(&self) -> &Harvester {
        self.mechanics.harvester()
    }

    /// The circuit where it is now.
    pub fn circuit(&self) -> &Circuit {
        &self.electrics.circuit
    }

    /// The sums of the harvester so far.
    pub fn gains(&self) -> Gains {
        Gains::from(self.harvester().totals())
    }
}
