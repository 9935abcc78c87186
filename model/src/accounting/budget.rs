//! The number of events that one second of simulated time may have.

use crate::error::ModelError;
use crate::parameters::Parameters;

/// Events allowed within one second. Forged states use all of them up, which a fuzzer has no time for.
const LIMIT: u64 = if cfg!(fuzzing) { 2_000 } else { 1_000_000 };

/// Events counted in the present second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// The second, s.
    pub second: f64,
    /// Events in it.
    pub events: u64,
    travel: f64,
    restitution: f64,
}

impl Budget {
    /// A budget of which `events` are used in this `second`, s.
    pub fn new(p: &Parameters, second: f64, events: u64) -> Self {
        Self { second, events, travel: p.travel(), restitution: p.restitution }
    }

    /// Counts an event at `time`, s.
    pub fn spend(&mut self, time: f64) -> Result<(), ModelError> {
        if !(0.0..1.0).contains(&(time - self.second)) {
            (self.second, self.events) = (time.floor(), 0);
        }
        self.events += 1;
        if self.events > LIMIT { Err(self.exceeded(time)) } else { Ok(()) }
    }

    /// The error of a run that has more events than can be resolved up to `time`, s.
    pub fn exceeded(&self, time: f64) -> ModelError {
        let Self { travel, restitution, .. } = *self;
        ModelError::TooManyEvents { time, limit: LIMIT, travel, restitution }
    }
}
