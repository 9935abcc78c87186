//! Every table and figure of the paper, and what lies beyond it, computed through the harvester FMU.
//!
//! An [`Item`] is one table or figure, a file of this module each. It makes an [`Artefact`] with the [`Workshop`]: numbers
//! beside the paper's ([`Finding`]), data ([`Sheet`]), pictures and words. The same items give the same bytes whenever
//! they are made: runs are counted, not timed, and random numbers follow from a seed.

mod artefact;
mod error;
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
pub const ITEMS: &[Item] = &[];
