//! Errors of figures and reports.

/// Why a figure or a report could not be rendered.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ReportError {
    /// A figure without panels, or with columns that cannot stand side by side.
    #[error("figure `{figure}` {reason}")]
    Figure { figure: String, reason: String },
    /// Data or axes of a panel that cannot be drawn.
    #[error("panel `{panel}`: {reason}")]
    Panel { panel: String, reason: String },
    /// A picture or a figure too small, too large or too fine.
    #[error("{what} is {value}, allowed are {min} to {max}")]
    Size { what: String, value: String, min: f64, max: f64 },
    /// A section with an id, a link, a table or a figure that no page can carry.
    #[error("section `{section}`: {reason}")]
    Section { section: String, reason: String },
    /// An SVG document that cannot be turned into pixels.
    #[error("making a PNG failed: {0}")]
    Png(String),
    /// The plotting library refused.
    #[error("drawing failed: {0}")]
    Draw(String),
    /// The template engine refused.
    #[error("rendering the page failed: {0}")]
    Template(#[from] askama::Error),
}
