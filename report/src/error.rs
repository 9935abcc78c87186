//! Errors of figures and reports.

/// Why a figure or a report could not be rendered.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ReportError {
    /// A figure without panels shows nothing.
    #[error("figure `{figure}` has no panels")]
    NoPanels { figure: String },
    /// The two columns of a series differ in length.
    #[error("series `{series}` in panel `{panel}`: {xs} x values for {ys} y values")]
    LengthMismatch { panel: String, series: String, xs: usize, ys: usize },
    /// An axis whose ends are not finite, not in ascending order, or too close to be told apart.
    #[error("panel `{panel}`: {axis} range {low} to {high} is not a finite, ascending interval")]
    InvalidRange { panel: String, axis: &'static str, low: f64, high: f64 },
    /// A reference line at a value that is not finite.
    #[error("panel `{panel}`: reference line `{line}` at {value} is not finite")]
    InvalidLine { panel: String, line: String, value: f64 },
    /// Panels cannot stand in so many columns.
    #[error("figure `{figure}` has {columns} columns, allowed are 1 to {max}")]
    InvalidColumns { figure: String, columns: usize, max: usize },
    /// A map with more or fewer values than cells, or without cells.
    #[error("panel `{panel}`: {values} values for a map of {columns} x {rows} cells")]
    MapSize { panel: String, columns: usize, rows: usize, values: usize },
    /// A value that stands for no kind.
    #[error("panel `{panel}`: {value} is none of the {kinds} kinds of the map, which count from 0")]
    UnknownKind { panel: String, value: f64, kinds: usize },
    /// Values that should be finite and in ascending order are not.
    #[error("panel `{panel}`: {what}: {after} follows {before}, but the values must be finite and ascend")]
    NotAscending { panel: String, what: String, before: f64, after: f64 },
    /// The limits of a band or bar in the wrong order.
    #[error("panel `{panel}`: limits {low} to {high} at x = {x} are in the wrong order")]
    InvalidLimits { panel: String, x: f64, low: f64, high: f64 },
    /// A logarithmic axis on which nothing has a place.
    #[error("panel `{panel}`: no value on the logarithmic {axis} axis is above 0, or a cell of the map is not")]
    NoLogarithm { panel: String, axis: &'static str },
    /// A drawing to scale needs linear axes.
    #[error("panel `{panel}`: a drawing to scale has no logarithmic axes")]
    LogToScale { panel: String },
    /// A picture too small, too large or too fine.
    #[error("{what} is {value}, allowed are {min} to {max}")]
    InvalidScale { what: String, value: f64, min: f64, max: f64 },
    /// An SVG document that cannot be turned into pixels.
    #[error("making a PNG failed: {0}")]
    Png(String),
    /// A width or height outside what a page can carry.
    #[error("{what} is {value} px, allowed are {min} to {max} px")]
    InvalidSize { what: String, value: f64, min: f64, max: f64 },
    /// A table row with more or fewer cells than the table has columns.
    #[error("section `{section}`: table row {row} has {found} cells for {expected} columns")]
    RaggedTable { section: String, row: usize, found: usize, expected: usize },
    /// An id that no link can lead to.
    #[error("section `{section}`: id `{id}` is taken, or has more than small letters, digits, `.`, `-` and `_`")]
    InvalidId { section: String, id: String },
    /// A link to a section that does not exist.
    #[error("section `{section}`: a link leads to `{target}`, but no section has this id")]
    BrokenLink { section: String, target: String },
    /// An illustration that is not a plain SVG element: it is copied into the page as it is.
    #[error("section `{section}`: the figure is not a passive SVG element ({reason})")]
    UnsafeFigure { section: String, reason: &'static str },
    /// The plotting library refused.
    #[error("drawing failed: {0}")]
    Draw(String),
    /// The template engine refused.
    #[error("rendering the page failed: {0}")]
    Template(#[from] askama::Error),
}
