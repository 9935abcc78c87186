//! The largest deflection of a run: stage 3 of Table 1.

use super::recording::{DEFLECTIONS, record};
use super::{PaperError, Study};

/// A membrane pressed in to the largest deflection of a run, as the FMU says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// Time, s.
    pub(super) time: f64,
    /// 0 for the left membrane, 1 for the right one.
    pub(super) side: usize,
    /// delta, m.
    pub(super) deflection: f64,
    /// `C_3`, F.
    pub(super) capacitance: f64,
    /// `A_3` / `A_2`.
    pub(super) area_ratio: f64,
}

const OF_A_MEMBRANE: [[&str; 3]; 2] = [
    ["left.deflection", "left.capacitance", "left.areaRatio"],
    ["right.deflection", "right.capacitance", "right.areaRatio"],
];

/// The case whose largest impact makes stage 3 of Table 1, and the window, s: the averages of the paper begin there, and
/// twenty periods show all.
pub(super) const CASE: &str = "fig14";
pub(super) const WHEN: [f64; 2] = [50.0, 60.0];

/// The impact that makes stage 3 of Table 1: the largest deflection of either membrane; peaks are landed on.
pub(super) fn stage_3(study: &Study<'_>) -> Result<Peak, PaperError> {
    let ([from, to], settings) = (WHEN, Study::case(CASE)?);
    let samples = record(study, &settings, WHEN, to - from)?.samples;
    let deflections = samples.iter().flat_map(|sample| {
        DEFLECTIONS.iter().enumerate().map(|(side, output)| (sample.values[*output], sample.time, side))
    });
    let (_, time, side) = deflections.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, from, 0));
    let mut instance = study.start(&settings)?;
    instance.do_step(0.0, time)?;
    let [deflection, capacitance, area_ratio] = study.reals(&instance, OF_A_MEMBRANE[side])?;
    instance.terminate()?;
    Ok(Peak { time, side, deflection, capacitance, area_ratio })
}
