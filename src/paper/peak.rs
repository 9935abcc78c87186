//! The largest deflection of a run: stage 3 of Table 1.

use super::{PaperError, Workshop};
use crate::fmi::Instance;

/// A membrane pressed in to the largest deflection of a run, as the FMU says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// Time, s.
    pub(super) time: f64,
    /// delta, m.
    pub(super) deflection: f64,
    /// `C_3`, F.
    pub(super) capacitance: f64,
    /// `A_3` / `A_2`.
    pub(super) area_ratio: f64,
}

const OF_A_MEMBRANE: [&str; 3] = ["deflection", "capacitance", "areaRatio"];

/// The largest deflection of either membrane between `from` and `to`, s, in a run of a case of the paper; peaks are
/// landed on.
pub(super) fn largest(workshop: &Workshop<'_>, case: &str, [from, to]: [f64; 2]) -> Result<Peak, PaperError> {
    let mut instance = workshop.start(&workshop.case(case)?)?;
    let names = ["left", "right"].map(|side| OF_A_MEMBRANE.map(|name| format!("{side}.{name}")));
    let references = names.iter().flatten().map(|name| workshop.reference(name)).collect::<Result<Vec<_>, _>>()?;
    let ahead = [workshop.reference("pulse.nextKnot")?, workshop.reference("impact.nextTime")?];
    let mut largest = Peak { time: from, deflection: 0.0, capacitance: 0.0, area_ratio: 1.0 };
    let mut time = from;
    instance.do_step(0.0, from)?;
    while time < to {
        let next = next_knot(&instance, ahead)?.min(to);
        instance.do_step(time, next - time)?;
        time = next;
        let mut values = [0.0; 6];
        instance.get_real(&references, &mut values)?;
        for side in values.chunks_exact(3) {
            if side[0] > largest.deflection {
                largest = Peak { time, deflection: side[0], capacitance: side[1], area_ratio: side[2] };
            }
        }
    }
    instance.terminate()?;
    Ok(largest)
}

fn next_knot(instance: &Instance, ahead: [u32; 2]) -> Result<f64, PaperError> {
    let mut times = [0.0; 2];
    instance.get_real(&ahead, &mut times)?;
    Ok(times[0].min(times[1]))
}
