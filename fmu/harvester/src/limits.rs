//! Warnings of the material's limits.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use fmi2_export::Logger;
use videg_model::{Harvester as Model, Limit, Membrane, Peak, Side};

/// What has been warned of: each limit once for each membrane and run. All states of an instance share it, so that a
/// step that is taken back and tried again does not warn twice.
#[derive(Debug, Clone, Default)]
pub(crate) struct Warned(Arc<AtomicU8>);

impl Warned {
    const ALL: u8 = 0b11_1111;

    /// Warns of limits that the membranes exceed at present under these voltages, V.
    pub(crate) fn check_present(&self, model: &Model, voltages: [f64; 2], log: &Logger) {
        for side in [Side::Left, Side::Right] {
            let (deflection, voltage) = (model.deflection(side).value, voltages[side.index()]);
            self.check(model.membrane(), &Peak { time: model.time(), side, deflection, voltage }, log);
        }
    }

    /// Warns of limits that `peak` exceeds.
    pub(crate) fn check(&self, membrane: &Membrane, peak: &Peak, log: &Logger) {
        if self.0.load(Ordering::Relaxed) == Self::ALL {
            return;
        }
        for excess in membrane.excesses(peak.deflection, peak.voltage, peak.time) {
            let bit = bit(peak.side, excess.limit);
            if self.0.fetch_or(bit, Ordering::Relaxed) & bit == 0 {
                let side = if peak.side == Side::Left { "left" } else { "right" };
                log.warning(format_args!("{side} membrane: {excess}"));
            }
        }
    }
}

fn bit(side: Side, limit: Limit) -> u8 {
    let limit = match limit {
        Limit::Area => 0b1,
        Limit::Field => 0b10,
        Limit::Tension => 0b100,
    };
    limit << (3 * side.index())
}
