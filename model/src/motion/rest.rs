//! Films that no ball presses: how those that are viscous recover.

use std::sync::{Arc, OnceLock};

use crate::contact::Creep;
use crate::membrane::viscosity::{Recovery, Viscosity};

/// A film since a ball last left it.
#[derive(Debug, Default)]
pub struct Resting {
    pub creep: Creep,
    /// Worked out when somebody asks for it.
    recovery: OnceLock<Arc<Recovery>>,
}

impl Clone for Resting {
    fn clone(&self) -> Self {
        Self { creep: self.creep, recovery: self.recovery.clone() }
    }

    /// Keeps what it has worked out where the creep is the same, as at each step that a master tries.
    fn clone_from(&mut self, source: &Self) {
        if self != source {
            *self = source.clone();
        }
    }
}

impl PartialEq for Resting {
    /// The recovery follows from the creep.
    fn eq(&self, other: &Self) -> bool {
        self.creep == other.creep
    }
}

impl From<Creep> for Resting {
    fn from(creep: Creep) -> Self {
        Self { creep, recovery: OnceLock::new() }
    }
}

impl Resting {
    /// The creep at `time`, s.
    pub fn creep_at(&self, viscosity: &Viscosity, time: f64) -> f64 {
        let Creep { since, value } = self.creep;
        self.recovery.get_or_init(|| Arc::new(viscosity.recovery(value))).at(time - since)
    }
}
