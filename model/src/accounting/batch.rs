//! Impacts whose gains are not yet added.
//!
//! Under the impulsive law neither deflection nor gain of an impact acts on the motion. So the way to the next one does
//! not wait for them: they are worked out for several impacts in a row, whose powers and quotients a processor overlaps.

use super::ledger::Ledger;
use crate::membrane::Membrane;
use crate::motion::pulse::Pulses;
use crate::motion::side::Side;
use crate::shared::Shared;

/// Enough for the work of several impacts to overlap.
const CAPACITY: usize = 16;

/// Impacts in their order: time, s, side and relative speed, m/s.
pub struct Batch {
    list: [(f64, Side, f64); CAPACITY],
    len: usize,
}

impl Batch {
    pub const EMPTY: Self = Self { list: [(0.0, Side::Left, 0.0); CAPACITY], len: 0 };

    /// Notes an impact; true if there is no room for another.
    #[inline]
    #[must_use]
    pub fn push(&mut self, time: f64, side: Side, speed: f64) -> bool {
        self.list[self.len] = (time, side, speed);
        self.len += 1;
        self.len == CAPACITY
    }

    /// Adds the gains, Eqs. (10) to (13), and starts the pulses.
    pub fn settle(&mut self, membrane: &Shared<Membrane>, pulses: &mut Pulses, ledger: &mut Ledger) {
        let impacts = &self.list[..self.len];
        let (mut peaks, mut excesses) = ([0.0; CAPACITY], [0.0; CAPACITY]);
        for (peak, (_, _, speed)) in peaks.iter_mut().zip(impacts) {
            *peak = membrane.deflection(*speed);
        }
        for (excess, peak) in excesses.iter_mut().zip(&peaks[..impacts.len()]) {
            *excess = membrane.capacitance_excess(*peak);
        }
        excesses[..self.len].iter().for_each(|excess| ledger.credit(*excess));
        pulses.extend(membrane, impacts, &peaks[..impacts.len()]);
        self.len = 0;
    }
}
