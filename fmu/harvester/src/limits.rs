//! Warnings of the material's limits: each once for each membrane and run.

use fmu_export::Logger;
use videg_model::{Harvester as Model, Limit, Membrane, Peak, Side};

/// Three limits of two membranes.
const WARNINGS: u32 = 6;

/// Whether nothing is left to warn of.
fn all_given(log: &Logger) -> bool {
    (0..WARNINGS).all(|number| log.has_given(number))
}

/// Warns of limits that the membranes exceed at present under these voltages, V.
pub(crate) fn check_present(model: &Model, voltages: [f64; 2], log: &Logger) {
    if all_given(log) {
        return;
    }
    for side in [Side::Left, Side::Right] {
        let (deflection, voltage) = (model.deflection(side).value, voltages[side.index()]);
        check(model.membrane(), &Peak { time: model.time(), side, deflection, voltage }, log);
    }
}

/// Warns of limits that `peak` exceeds.
pub(crate) fn check(membrane: &Membrane, peak: &Peak, log: &Logger) {
    if all_given(log) {
        return;
    }
    for excess in membrane.excesses(peak.deflection, peak.voltage, peak.time) {
        let side = if peak.side == Side::Left { "left" } else { "right" };
        log.warning_once(number(peak.side, excess.limit), format_args!("{side} membrane: {excess}"));
    }
}

fn number(side: Side, limit: Limit) -> u32 {
    let (side, limit) = (
        u32::from(side == Side::Right),
        match limit {
            Limit::Area => 0,
            Limit::Field => 1,
            Limit::Tension => 2,
        },
    );
    3 * side + limit
}
