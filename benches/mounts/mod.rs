//! The capsule of Fig. 14 beside the same one held in other ways.

use videg_model::{Case, Harvester, ModelError, Parameters, Totals};

/// Duration of the paper's runs, s.
pub const UNTIL: f64 = 100.0;

/// A capsule.
pub struct Mounted {
    pub name: &'static str,
    pub parameters: Parameters,
    /// Instructions that one of its events may have at most.
    #[allow(dead_code)] // the benchmark measures all
    pub allowed: Option<f64>,
}

/// Instructions of an event of the level capsule when the bounds of the others were set. It has become cheaper since, because most of
/// its flights are simple.
const LEVEL: f64 = 2003.0;

/// All of them; each has some 600 events in [`UNTIL`].
pub fn mounts() -> [Mounted; 5] {
    let level = Case::find("fig14").map_or_else(Parameters::default, |case| (case.parameters)());
    [
        ("level, free, without friction", level, None),
        ("inclined", Parameters { inclination: 0.02, ..level }, Some(1.5 * LEVEL)),
        ("with friction", Parameters { friction: 0.02, ..level }, Some(2.0 * LEVEL)),
        ("suspended", Parameters { suspension_stiffness: 5.0, suspension_damping: 0.02, ..level }, Some(4.0 * LEVEL)),
        ("keeping the momentum", Parameters { reaction: true, ..level }, None),
    ]
    .map(|(name, parameters, allowed)| Mounted { name, parameters, allowed })
}

/// One run in one go.
pub fn run(parameters: &Parameters) -> Result<Totals, ModelError> {
    let mut harvester = Harvester::new(parameters, 0.0)?;
    harvester.advance(UNTIL)?;
    Ok(*harvester.totals())
}
