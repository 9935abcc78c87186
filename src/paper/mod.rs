//! Every table and figure of the paper, and what lies beyond it, computed through the harvester FMU.
//!
//! An [`Item`] is one table or figure, a file of this module each. It makes an [`Artefact`] with the [`Study`]: numbers
//! beside the paper's ([`Finding`]), data ([`Sheet`]), pictures and words. The same items give the same bytes whenever
//! they are made: runs are counted, not timed, and random numbers follow from a seed.

mod artefact;
mod basins;
mod bifurcation;
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
mod fixed_step;
mod lyapunov;
mod motion;
mod orbit;
mod patterns;
mod peak;
mod poincare;
mod power;
mod recording;
mod stability;
mod statistics;
mod stroboscope;
mod study;
mod table1;
mod table2;
mod table3;
mod tuning;

pub use artefact::{Artefact, Finding, Picture, Sheet, Verdict};
pub use error::PaperError;
pub use study::{Effort, Run, Study};

/// Averaging window of the paper, s (Section 5).
const WINDOW: [f64; 2] = [50.0, 100.0];

/// Volume of the device of Table 3, cm^3 (Section 5.3).
const VOLUME: f64 = 42.2;

/// A table or figure that can be made.
pub struct Item {
    /// What the command line calls it, e.g. `fig14`.
    pub name: &'static str,
    /// What it is, e.g. `Figure 14`.
    pub title: &'static str,
    /// Makes it.
    pub make: fn(&Study<'_>) -> Result<Artefact, PaperError>,
}

/// All items, in the order of the report.
pub const ITEMS: &[Item] = &[
    Item { name: "table1", title: "Table 1: the stages of a membrane", make: table1::make },
    Item { name: "table2", title: "Table 2: voltage gain", make: table2::make },
    Item { name: "table3", title: "Table 3: power density", make: table3::make },
    Item { name: "fig4", title: "Figure 4: force law", make: fig4::make },
    Item { name: "fig7", title: "Figure 7: shape of the membrane", make: fig7::make },
    Item { name: "fig8", title: "Figure 8(b): one harvesting cycle", make: fig8::make },
    Item { name: "fig9", title: "Figure 9: no impact", make: |study| motion::make(study, &motion::FIG9) },
    Item { name: "fig10", title: "Figure 10: saw-tooth motion", make: stability::make },
    Item {
        name: "fig11",
        title: "Figure 11: saw-tooth start, A = 0.5 N",
        make: |study| motion::make(study, &motion::FIG11),
    },
    Item {
        name: "fig12",
        title: "Figure 12: start outside the gap",
        make: |study| motion::make(study, &motion::FIG12),
    },
    Item { name: "fig13", title: "Figure 13: zero start", make: |study| motion::make(study, &motion::FIG13) },
    Item { name: "fig14", title: "Figure 14: r = 0.6", make: |study| motion::make(study, &motion::FIG14) },
    Item { name: "fig15", title: "Figure 15: r = 0.3", make: |study| motion::make(study, &motion::FIG15) },
    Item { name: "fig16", title: "Figure 16: amplitude and frequency", make: fig16::make },
    Item { name: "fig17", title: "Figure 17: phase noise", make: fig17::make },
    Item { name: "tuning", title: "Tuning of the circuit", make: tuning::make },
    Item { name: "power", title: "Power density by Eq. (14) and by net gain", make: power::make },
    Item { name: "dynamics", title: "Poincare sections and bifurcation diagrams", make: dynamics::make },
    Item { name: "basins", title: "Basins of attraction", make: basins::make },
];
