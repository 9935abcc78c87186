//! Tables of a report.

/// A table; every row has one cell for each column.
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Table {
    pub(super) columns: Vec<Column>,
    pub(super) rows: Vec<Row>,
}

/// A row of a table.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub cells: Vec<Cell>,
    /// Whether it stands out from the others.
    pub is_marked: bool,
}

impl Table {
    /// A table without rows; its columns from left to right.
    pub fn new(columns: impl IntoIterator<Item = Column>) -> Self {
        Self { columns: columns.into_iter().collect(), rows: Vec::new() }
    }

    /// Adds a row at the bottom.
    pub fn row<C: Into<Cell>>(self, cells: impl IntoIterator<Item = C>) -> Self {
        self.with(cells, false)
    }

    /// Adds a row that stands out from the others.
    pub fn marked<C: Into<Cell>>(self, cells: impl IntoIterator<Item = C>) -> Self {
        self.with(cells, true)
    }

    fn with<C: Into<Cell>>(mut self, cells: impl IntoIterator<Item = C>, is_marked: bool) -> Self {
        self.rows.push(Row { cells: cells.into_iter().map(Into::into).collect(), is_marked });
        self
    }
}

/// A column of a table.
#[derive(Debug, Clone)]
pub struct Column {
    pub(super) heading: String,
    pub(super) is_number: bool,
}

impl Column {
    /// A column of words.
    pub fn words(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), is_number: false }
    }

    /// A column of numbers: set to the right, in figures of equal width.
    pub fn numbers(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), is_number: true }
    }
}

/// What stands in a row under one heading.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Cell {
    pub(super) text: String,
    pub(super) tone: Option<Tone>,
    pub(super) target: Option<String>,
}

impl Cell {
    /// A word that stands out, such as a verdict.
    pub fn badge(word: impl Into<String>, tone: Tone) -> Self {
        Self { text: word.into(), tone: Some(tone), target: None }
    }

    /// Text that leads to the section with the id `target`.
    pub fn link(text: impl Into<String>, target: impl Into<String>) -> Self {
        Self { text: text.into(), tone: None, target: Some(target.into()) }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, ..Self::default() }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

/// What a badge says, besides its word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// As it should be: green.
    Good,
    /// As it should be, within limits: blue.
    Near,
    /// Not as expected, for a reason that is known: amber.
    Noted,
    /// Not as it should be: red.
    Bad,
    /// Nothing to compare with: grey.
    Neutral,
}

impl Tone {
    /// The class that the style sheet knows.
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Near => "near",
            Self::Noted => "noted",
            Self::Bad => "bad",
            Self::Neutral => "neutral",
        }
    }
}
