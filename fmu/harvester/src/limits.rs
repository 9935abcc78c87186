//! Warnings of the material's limits: each once for each membrane and run.

use fmu_export::Logger;
use videg_model::{Harvester as Model, Limit, Membrane, Peak, Setup, Side};

/// Limits of a membrane: area, field, tension, and, if it is measured, where its table ends.
const LIMITS: u32 = 4;

/// Whether nothing is left to warn of.
fn all_given(is_measured: bool, log: &Logger) -> bool {
    let limits = if is_measured { LIMITS } else { LIMITS - 1 };
    (0..2).all(|side| (0..limits).all(|limit| log.has_given(LIMITS * side + limit)))
}

/// Warns of limits that the membranes exceed at present under these voltages, V.
pub(crate) fn check_present(model: &Model, voltages: [f64; 2], log: &Logger) {
    if all_given(model.membrane().table().is_some(), log) {
        return;
    }
    for side in [Side::Left, Side::Right] {
        let (deflection, voltage) = (model.deflection(side).value, voltages[side.index()]);
        warn(model.membrane(), &Peak { time: model.time(), side, deflection, voltage }, log);
    }
}

/// The same of a membrane that takes time to make.
pub(crate) fn check(setup: Setup<'_>, peak: &Peak, log: &Logger) {
    if !all_given(setup.table.is_some(), log) {
        warn(&Membrane::new(setup), peak, log);
    }
}

/// Warns of limits that `peak` exceeds.
pub(crate) fn warn(membrane: &Membrane, peak: &Peak, log: &Logger) {
    if all_given(membrane.table().is_some(), log) {
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
            Limit::Tension | Limit::OwnTension => 2,
            Limit::Measured => 3,
        },
    );
    LIMITS * side + limit
}
