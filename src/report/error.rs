//! What can be wrong with a figure or a report.

/// Why a figure or a report could not be rendered.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A figure without panels shows nothing.
    #[error("figure `{figure}` has no panels")]
    NoPanels {
        /// Title of the figure.
        figure: String,
    },
    /// The two columns of a series differ in length.
    #[error("series `{series}` in panel `{panel}`: {xs} x values for {ys} y values")]
    LengthMismatch {
        /// Title of the panel.
        panel: String,
        /// Label of the series.
        series: String,
        /// Number of x values.
        xs: usize,
        /// Number of y values.
        ys: usize,
    },
    /// An axis whose ends are not finite, not in ascending order, or too close to be told apart.
    #[error("panel `{panel}`: {axis} range {low} to {high} is not a finite, ascending interval")]
    InvalidRange {
        /// Title of the panel.
        panel: String,
        /// `x` or `y`.
        axis: &'static str,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// A reference line at a value that is not finite.
    #[error("panel `{panel}`: reference line `{line}` at {value} is not finite")]
    InvalidLine {
        /// Title of the panel.
        panel: String,
        /// Label of the line.
        line: String,
        /// Its value.
        value: f64,
    },
    /// A width or height outside what a page can carry.
    #[error("{what} is {value} px, allowed are {min} to {max} px")]
    InvalidSize {
        /// Which size.
        what: String,
        /// The size asked for, in px.
        value: f64,
        /// Smallest size allowed, in px.
        min: f64,
        /// Largest size allowed, in px.
        max: f64,
    },
    /// A table row with more or fewer cells than the table has columns.
    #[error("section `{section}`: table row {row} has {found} cells for {expected} columns")]
    RaggedTable {
        /// Heading of the section.
        section: String,
        /// Row number, from 1.
        row: usize,
        /// Cells in this row.
        found: usize,
        /// Columns of the table.
        expected: usize,
    },
    /// An illustration that is not a plain SVG element: it is copied into the page as it is.
    #[error("section `{section}`: the figure is not a passive SVG element ({reason})")]
    UnsafeFigure {
        /// Heading of the section.
        section: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The plotting library refused.
    #[error("drawing failed: {0}")]
    Draw(String),
    /// The template engine refused.
    #[error("rendering the page failed: {0}")]
    Template(#[from] askama::Error),
}
