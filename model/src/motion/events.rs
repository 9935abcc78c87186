//! What comes next, and how far the way ahead has been searched.

use super::side::Side;
use crate::noise::intervals::{Anchored, HoldState};

/// What the next event is. Times in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prediction {
    Impact {
        time: f64,
        side: Side,
    },
    Release {
        time: f64,
    },
    /// The contact turns, ends or goes on.
    ContactChange {
        time: f64,
    },
    /// The phase noise takes its next sample.
    NoiseSample {
        time: f64,
    },
}

impl Prediction {
    pub fn time(self) -> f64 {
        match self {
            Self::Impact { time, .. }
            | Self::Release { time }
            | Self::ContactChange { time }
            | Self::NoiseSample { time } => time,
        }
    }
}

/// How far the present flight (or rest) has been searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Windows before this one hold no event.
    pub(super) window: u64,
    pub found: Option<Prediction>,
    /// Relative speed, m/s, of the impact that has been found.
    pub speed: f64,
    /// Time of the first impact after the release that has been found, s, infinity if none is predicted; none before it
    /// has been looked for.
    pub after_release: Option<f64>,
    /// With phase noise: the begin of the first hold interval that has not been searched, or of that in which the event is
    /// that has been found, unless it is the present one.
    pub ahead: Option<Anchored>,
    /// With phase noise: the begin of an earlier hold interval of the block, which the present one follows from.
    pub anchor: Option<HoldState>,
    /// No event will ever come.
    pub(super) exhausted: bool,
}

impl Search {
    pub fn new() -> Self {
        Self { window: 0, found: None, speed: 0.0, after_release: None, ahead: None, anchor: None, exhausted: false }
    }

    /// No search at all: no event is predicted.
    pub fn none() -> Self {
        Self { exhausted: true, ..Self::new() }
    }

    pub(super) fn has_ended(&self) -> bool {
        self.found.is_some() || self.exhausted
    }
}
