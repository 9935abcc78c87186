//! What comes next, and how far the way ahead has been searched.

use super::ball::Start;
use super::cylinder::Drive;
use super::mount::Mount;
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
    /// A ball with friction comes to a halt on the cylinder.
    Turn {
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
            | Self::Turn { time }
            | Self::ContactChange { time }
            | Self::NoiseSample { time } => time,
        }
    }
}

impl Mount {
    /// The release `elapsed`, s, after `start`, s, up to `end`, s. Against friction it is rounded up: a time before would be one at which
    /// friction still holds the ball, under a force that grows so fast.
    pub(super) fn release(&self, start: f64, elapsed: f64, end: f64) -> Prediction {
        let time = start + elapsed;
        let is_early = self.friction > 0.0 && time - start < elapsed;
        Prediction::Release { time: if is_early { time.next_up() } else { time }.min(end) }
    }
}

/// The begin of a piece of the motion, for which a power series holds, or a segment of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// The cylinder.
    pub cylinder: Start,
    /// dz, m, and its rate, m/s.
    pub relative: [f64; 2],
    /// Energy that the damper has taken so far, over M, J/kg.
    pub damped: f64,
    /// What drives it.
    pub drive: Drive,
}

/// How far the present flight (or rest) has been searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Windows of the present piece, or of that ahead, before this one hold no event.
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
    /// Over a suspended cylinder, or with a recording: the begin of the first piece that has not been searched, or of that in which the event is
    /// that has been found, unless it is the present one.
    pub piece: Option<Piece>,
    /// No event will ever come.
    pub(super) exhausted: bool,
}

impl Search {
    pub fn new() -> Self {
        Self {
            window: 0,
            found: None,
            speed: 0.0,
            after_release: None,
            ahead: None,
            anchor: None,
            piece: None,
            exhausted: false,
        }
    }

    /// Begins anew: what is not set is not read, and writing all of a piece would cost as much as a short search.
    pub fn begin(&mut self) {
        (self.window, self.found, self.speed, self.exhausted) = (0, None, 0.0, false);
        (self.after_release, self.ahead, self.anchor, self.piece) = (None, None, None, None);
    }

    /// No search at all: no event is predicted.
    pub fn none() -> Self {
        Self { exhausted: true, ..Self::new() }
    }

    pub(super) fn has_ended(&self) -> bool {
        self.found.is_some() || self.exhausted
    }
}
