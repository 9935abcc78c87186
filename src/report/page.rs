//! What a report holds: sections of text, tables, figures and notes.

/// A page, rendered by [`render_html`](super::render_html).
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// Title of the page.
    pub title: String,
    /// What the reader should know first, in one paragraph.
    pub lead: String,
    /// The command line that made the report; empty for none.
    pub command: String,
    /// Name and version of the program.
    pub generated_by: String,
    /// In reading order.
    pub sections: Vec<Section>,
}

impl Report {
    /// A page without sections.
    pub fn new(title: impl Into<String>, lead: impl Into<String>) -> Self {
        Self { title: title.into(), lead: lead.into(), ..Self::default() }
    }

    /// Sets the command line that made the report.
    #[must_use]
    pub fn command(mut self, command: impl Into<String>) -> Self {
        self.command = command.into();
        self
    }

    /// Sets name and version of the program.
    #[must_use]
    pub fn generated_by(mut self, program: impl Into<String>) -> Self {
        self.generated_by = program.into();
        self
    }

    /// Adds a section at the end.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }
}

/// One heading and what stands under it: notes, text, table, figure, in this order.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// The heading.
    pub heading: String,
    /// Paragraphs of plain text.
    pub text: Vec<String>,
    /// A table.
    pub table: Option<Table>,
    /// A figure.
    pub figure: Option<Illustration>,
    /// Remarks and warnings, set off from the text.
    pub notes: Vec<Note>,
}

impl Section {
    /// A section with nothing but its heading.
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), ..Self::default() }
    }

    /// Adds a paragraph of plain text.
    #[must_use]
    pub fn text(mut self, paragraph: impl Into<String>) -> Self {
        self.text.push(paragraph.into());
        self
    }

    /// Sets the table.
    #[must_use]
    pub fn table(mut self, table: Table) -> Self {
        self.table = Some(table);
        self
    }

    /// Sets the figure: the output of [`render_svg`](super::render_svg) and a caption.
    #[must_use]
    pub fn figure(mut self, svg: impl Into<String>, caption: impl Into<String>) -> Self {
        self.figure = Some(Illustration { svg: svg.into(), caption: caption.into() });
        self
    }

    /// Adds a remark.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(Note { kind: NoteKind::Info, text: text.into() });
        self
    }

    /// Adds a warning.
    #[must_use]
    pub fn warning(mut self, text: impl Into<String>) -> Self {
        self.notes.push(Note { kind: NoteKind::Warning, text: text.into() });
        self
    }
}

/// A table; every row has one cell for each column.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// From left to right.
    pub columns: Vec<Column>,
    /// From top to bottom.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(columns: impl IntoIterator<Item = Column>) -> Self {
        Self { columns: columns.into_iter().collect(), rows: Vec::new() }
    }

    /// Adds a row at the bottom.
    #[must_use]
    pub fn row<C: Into<String>>(mut self, cells: impl IntoIterator<Item = C>) -> Self {
        self.rows.push(cells.into_iter().map(Into::into).collect());
        self
    }
}

/// A column of a table.
#[derive(Debug, Clone)]
pub struct Column {
    /// The heading.
    pub heading: String,
    /// Where its cells stand.
    pub align: Align,
}

impl Column {
    /// A column of words, set to the left.
    pub fn words(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), align: Align::Left }
    }

    /// A column of numbers, set to the right in figures of equal width.
    pub fn numbers(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), align: Align::Right }
    }
}

/// Alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Align {
    /// Words.
    #[default]
    Left,
    /// Numbers.
    Right,
}

impl Align {
    /// Whether the column holds numbers.
    pub fn is_right(self) -> bool {
        self == Self::Right
    }
}

/// A figure in a report.
#[derive(Debug, Clone)]
pub struct Illustration {
    /// An SVG element, copied into the page as it is: without scripts and links.
    pub svg: String,
    /// Text below the figure.
    pub caption: String,
}

/// A remark, set off from the text.
#[derive(Debug, Clone)]
pub struct Note {
    /// How urgent it is.
    pub kind: NoteKind,
    /// What it says, as plain text.
    pub text: String,
}

/// How urgent a note is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoteKind {
    /// Good to know.
    Info,
    /// The reader should doubt a number.
    Warning,
}

impl NoteKind {
    /// Whether it is a warning.
    pub fn is_warning(self) -> bool {
        self == Self::Warning
    }
}
