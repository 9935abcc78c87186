//! What a study makes for a reader: data for CSV files, and pictures.

use videg_report::{Drawing, Figure, ReportError};

/// Columns that become a CSV file.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Name of the file, without extension.
    pub name: String,
    /// Headings with the unit, e.g. `time (s)`.
    pub columns: Vec<String>,
    /// Words at the beginning of each row; none if the sheet has numbers only.
    pub words: Vec<Vec<String>>,
    /// One value a column, behind the words; NaN for an empty cell.
    pub rows: Vec<Vec<f64>>,
}

impl Sheet {
    /// The file `name` with these headings and rows.
    pub(crate) fn new<C: Into<String>>(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = C>,
        rows: impl IntoIterator<Item = Vec<f64>>,
    ) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        Self { name: name.into(), columns, words: Vec::new(), rows: rows.into_iter().collect() }
    }

    /// The same with words before the numbers of each row.
    pub(crate) fn with_words<C: Into<String>>(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = C>,
        rows: impl IntoIterator<Item = (Vec<String>, Vec<f64>)>,
    ) -> Self {
        let (words, rows): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        Self { words, ..Self::new(name, columns, rows) }
    }
}

/// A figure, drawn.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Name of the file, without extension.
    pub name: String,
    /// The drawing.
    pub drawing: Drawing,
    /// Text below it, with the parameters.
    pub caption: String,
}

impl Picture {
    /// Draws `figure`.
    pub(crate) fn new<E: From<ReportError>>(
        name: impl Into<String>,
        figure: &Figure<'_>,
        caption: impl Into<String>,
    ) -> Result<Self, E> {
        Ok(Self { name: name.into(), drawing: Drawing::new(figure)?, caption: caption.into() })
    }
}
