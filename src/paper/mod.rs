//! Every table and figure of the paper, computed through the harvester FMU, and what lies beyond it, partly by the model alone.
//!
//! An [`Item`] is one table or figure, a file of this module each. [`reproduce`] makes an [`Artefact`] of each with the
//! [`Study`]: numbers beside the paper's ([`Finding`]), data ([`Sheet`]), pictures and words. The same items give the same bytes whenever
//! they are made: runs are counted, not timed, and random numbers follow from a seed.

mod artefact;
mod basins;
mod coupled;
mod dynamics;
mod ensemble;
mod error;
mod excitation;
mod fig16;
mod fig17;
mod fig4;
mod fig7;
mod fig8;
mod leakage;
mod motion;
mod orbit;
mod patterns;
mod peak;
mod power;
mod recording;
mod restitution;
mod stability;
mod statistics;
mod study;
mod table1;
mod table2;
mod table3;
mod tuning;

pub use artefact::{Artefact, Finding, Picture, Sheet, Verdict};
pub use error::PaperError;
pub use study::{Effort, Run, Study};

use crate::progress::during;

/// Averaging window of the paper, s (Section 5).
const WINDOW: [f64; 2] = [50.0, 100.0];

/// Volume of the device of Table 3, cm^3 (Section 5.3).
const VOLUME: f64 = 42.2;

/// Makes a table or figure.
pub type Make = fn(&Study<'_>) -> Result<Artefact, PaperError>;

/// A table or figure that can be made.
#[derive(Debug)]
pub struct Item {
    /// Its name on the command line, e.g. `fig14`.
    pub name: &'static str,
    /// Its title, e.g. `Figure 14`.
    pub title: &'static str,
    /// Makes it.
    pub make: Make,
}

/// Makes the items whose names are `wanted`, lazily. The observer of the `study` follows each.
pub fn reproduce<'a>(
    study: &'a Study<'_>,
    wanted: impl Fn(&str) -> bool + 'a,
) -> impl Iterator<Item = Result<(&'static Item, Artefact), PaperError>> + 'a {
    ITEMS.iter().filter(move |item| wanted(item.name)).map(|item| {
        let failed = |cause| PaperError::Item { name: item.name, cause: Box::new(cause) };
        let artefact = during(study.observer, item.name, item.title, || (item.make)(study)).map_err(failed)?;
        Ok((item, artefact))
    })
}

/// All items, in the order of the report.
pub const ITEMS: &[Item] = &[
    item("table1", "Table 1: the stages of a membrane", table1::make),
    item("table2", "Table 2: voltage gain", table2::make),
    item("table3", "Table 3: power density", table3::make),
    item("fig4", "Figure 4: force law", fig4::make),
    item("restitution", "Restitution of viscous films", restitution::make),
    item("fig7", "Figure 7: shape of the membrane", fig7::make),
    item("fig8", "Figure 8(b): one harvesting cycle", fig8::make),
    item("fig9", "Figure 9: no impact", |study| motion::make(study, &motion::FIG9)),
    item("fig10", "Figure 10: saw-tooth motion", stability::make),
    item("fig11", "Figure 11: saw-tooth start, A = 0.5 N", |study| motion::make(study, &motion::FIG11)),
    item("fig12", "Figure 12: start outside the gap", |study| motion::make(study, &motion::FIG12)),
    item("fig13", "Figure 13: zero start", |study| motion::make(study, &motion::FIG13)),
    item("fig14", "Figure 14: r = 0.6", |study| motion::make(study, &motion::FIG14)),
    item("fig15", "Figure 15: r = 0.3", |study| motion::make(study, &motion::FIG15)),
    item("fig16", "Figure 16: amplitude and frequency", fig16::make),
    item("fig17", "Figure 17: phase noise", fig17::make),
    item("tuning", "Tuning of the circuit", tuning::make),
    item("leakage", "Leakage of the film and the best load", leakage::make),
    item("power", "Power density by Eq. (14) and by net gain", power::make),
    item("dynamics", "Poincare sections and bifurcation diagrams", dynamics::make),
    item("basins", "Basins of attraction", basins::make),
];

const fn item(name: &'static str, title: &'static str, make: Make) -> Item {
    Item { name, title, make }
}
