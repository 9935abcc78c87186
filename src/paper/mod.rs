//! Every table and figure of the paper, and what lies beyond it, computed through the harvester FMU.
//!
//! An [`Item`] is one table or figure, a file of this module each. It makes an [`Artefact`] with the [`Workshop`]: numbers
//! beside the paper's ([`Finding`]), data ([`Sheet`]), pictures and words. The same items give the same bytes whenever
//! they are made: runs are counted, not timed, and random numbers follow from a seed.

mod artefact;
mod basins;
mod bifurcation;
mod coupled;
mod dynamics;
mod error;
mod excitation;
mod fig16;
mod fig17;
mod lyapunov;
mod poincare;
mod power;
mod statistics;
mod stroboscope;
mod tuning;
mod workshop;

pub use artefact::{Artefact, Finding, Picture, Sheet, Verdict};
pub use error::PaperError;
pub use workshop::{Averages, Effort, Run, Watch, Workshop};

/// A table or figure that can be made.
pub struct Item {
    /// What the command line calls it, e.g. `fig14`.
    pub name: &'static str,
    /// What it is, e.g. `Figure 14`.
    pub title: &'static str,
    /// Makes it.
    pub make: fn(&Workshop<'_>) -> Result<Artefact, PaperError>,
}

/// All items, in the order of the report.
pub const ITEMS: &[Item] = &[
    Item { name: "fig16", title: "Figure 16", make: fig16::make },
    Item { name: "fig17", title: "Figure 17", make: fig17::make },
    Item { name: "tuning", title: "Tuning of the circuit", make: tuning::make },
    Item { name: "power", title: "Power density, honestly", make: power::make },
    Item { name: "dynamics", title: "Poincare sections and bifurcation diagrams", make: dynamics::make },
    Item { name: "basins", title: "Basins of attraction", make: basins::make },
];
