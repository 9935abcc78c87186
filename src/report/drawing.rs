//! A figure as a reader gets it.

use super::error::ReportError;
use super::figure::Figure;
use super::svg::render_svg;

/// A figure, drawn.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// One SVG element.
    pub svg: String,
}

impl Drawing {
    /// Draws `figure`.
    ///
    /// # Errors
    /// A figure that makes no sense.
    pub fn new(figure: &Figure<'_>) -> Result<Self, ReportError> {
        Ok(Self { svg: render_svg(figure)? })
    }
}
