//! A figure as a reader gets it.

use super::error::ReportError;
use super::figure::Figure;
use super::layout::plan;
use super::plotly::chart;
use super::svg::{document, prepared};

/// A figure, drawn.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// One SVG element.
    pub svg: String,
    /// The data of an interactive chart, as JSON for the script of the page.
    pub chart: String,
}

impl Drawing {
    /// Draws `figure`.
    ///
    /// # Errors
    /// A figure that makes no sense, see [`render_svg`](super::render_svg).
    pub fn new(figure: &Figure<'_>) -> Result<Self, ReportError> {
        let figure = prepared(figure)?;
        let plan = plan(&figure)?;
        Ok(Self { svg: document(&figure, &plan)?, chart: chart(&figure, &plan) })
    }
}
