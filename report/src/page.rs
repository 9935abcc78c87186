//! Content of a report: sections of text, tables, figures and notes.

use super::drawing::Drawing;
use super::table::Table;

/// A page, rendered by [`render_html`](super::render_html).
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Report {
    pub(super) title: String,
    pub(super) lead: String,
    pub(super) command: String,
    pub(super) generated_by: String,
    pub(super) sections: Vec<Section>,
}

impl Report {
    /// A page without sections. The lead is what the reader should know first, in one paragraph.
    pub fn new(title: impl Into<String>, lead: impl Into<String>) -> Self {
        Self { title: title.into(), lead: lead.into(), ..Self::default() }
    }

    /// Sets the command line that made the report; empty for none.
    pub fn command(self, command: impl Into<String>) -> Self {
        Self { command: command.into(), ..self }
    }

    /// Sets name and version of the program.
    pub fn generated_by(self, program: impl Into<String>) -> Self {
        Self { generated_by: program.into(), ..self }
    }

    /// Adds a section at the end.
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }
}

/// One heading and what stands under it: notes, text, tables, figures, in this order.
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Section {
    pub(super) heading: String,
    pub(super) text: Vec<String>,
    pub(super) id: String,
    pub(super) tables: Vec<Table>,
    pub(super) figures: Vec<Illustration>,
    pub(super) notes: Vec<Note>,
}

impl Section {
    /// A section with nothing but its heading.
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), ..Self::default() }
    }

    /// Adds a paragraph of plain text.
    pub fn text(mut self, paragraph: impl Into<String>) -> Self {
        self.text.push(paragraph.into());
        self
    }

    /// Sets the name that links lead to, instead of a number: small letters, digits, `.`, `-` and `_`.
    pub fn id(self, id: impl Into<String>) -> Self {
        Self { id: id.into(), ..self }
    }

    /// Adds a table.
    pub fn table(mut self, table: Table) -> Self {
        self.tables.push(table);
        self
    }

    /// Adds a figure: the output of [`render_svg`](super::render_svg) and a caption.
    pub fn figure(mut self, svg: impl Into<String>, caption: impl Into<String>) -> Self {
        self.figures.push(Illustration { svg: svg.into(), chart: None, caption: caption.into() });
        self
    }

    /// Adds a figure that a reader can look into: the page then carries the script of the charts, some 4.7 MB.
    pub fn drawing(mut self, drawing: Drawing, caption: impl Into<String>) -> Self {
        let Drawing { svg, chart } = drawing;
        self.figures.push(Illustration { svg, chart: Some(chart), caption: caption.into() });
        self
    }

    /// Adds a remark.
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(Note { is_warning: false, text: text.into() });
        self
    }

    /// Adds a warning.
    pub fn warning(mut self, text: impl Into<String>) -> Self {
        self.notes.push(Note { is_warning: true, text: text.into() });
        self
    }
}

/// A figure in a report.
#[derive(Debug, Clone)]
pub(super) struct Illustration {
    /// An SVG element, copied into the page as it is: without scripts and links.
    pub svg: String,
    /// The data of an interactive chart, see [`Drawing::chart`].
    pub chart: Option<String>,
    pub caption: String,
}

/// A remark, set off from the text.
#[derive(Debug, Clone)]
pub(super) struct Note {
    /// Whether the reader should doubt a number.
    pub is_warning: bool,
    pub text: String,
}
