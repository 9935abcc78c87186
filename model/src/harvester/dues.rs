//! What impacts are still to be credited with.
//!
//! Under the impulsive law neither deflection nor gain of an impact acts on the motion. So the way to the next one does
//! not wait for them: they are worked out for several impacts in a row, whose powers and quotients a processor overlaps.

use super::Harvester;
use crate::flight::Side;
use crate::pulse::{Pulse, PulseChange};

/// Impacts that are kept before they are credited: enough for their work to overlap.
const CAPACITY: usize = 16;

/// An impact: time, s, side and relative speed, m/s.
#[derive(Debug, Clone, Copy)]
struct Due {
    time: f64,
    side: Side,
    speed: f64,
}

/// Impacts that are not credited yet, in their order.
#[derive(Debug)]
pub(super) struct Dues {
    list: [Due; CAPACITY],
    len: usize,
}

impl Dues {
    pub(super) const NONE: Self = Self { list: [Due { time: 0.0, side: Side::Left, speed: 0.0 }; CAPACITY], len: 0 };
}

impl Harvester {
    /// Notes an impact to be credited later.
    #[inline]
    pub(super) fn owe(&mut self, dues: &mut Dues, time: f64, side: Side, speed: f64) {
        if dues.len == CAPACITY {
            self.settle_dues(dues);
        }
        dues.list[dues.len] = Due { time, side, speed };
        dues.len += 1;
    }

    /// Credits the impacts that are due, Eqs. (10) to (13), and has their pulses begin.
    pub(super) fn settle_dues(&mut self, dues: &mut Dues) {
        let due = &dues.list[..dues.len];
        let (mut peaks, mut excesses) = ([0.0; CAPACITY], [0.0; CAPACITY]);
        for (peak, Due { speed, .. }) in peaks.iter_mut().zip(due) {
            *peak = self.membrane.deflection(*speed);
        }
        for (excess, peak) in excesses.iter_mut().zip(&peaks[..due.len()]) {
            *excess = self.membrane.capacitance_excess(*peak);
        }
        for (Due { time, side, speed }, (peak, excess)) in due.iter().zip(peaks.iter().zip(&excesses)) {
            let pulse = Pulse { start: *time, speed: *speed, peak: *peak, change: PulseChange::default() };
            self.pulses[side.index()].push(&self.shape, pulse);
            self.credit(*excess);
        }
        dues.len = 0;
    }
}
