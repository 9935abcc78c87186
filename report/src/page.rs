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
    pub(super) is_paired: bool,
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

    /// Puts two sections with one figure each side by side, where there is room. There is no list of sections: thumbnails lead to them.
    pub fn paired(self) -> Self {
        Self { is_paired: true, ..self }
    }

    /// Adds a section at the end.
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }
}

/// One heading and what stands under it, in the order in which it was added.
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Section {
    pub(super) heading: String,
    pub(super) id: String,
    pub(super) blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Debug, Clone)]
pub(super) enum Block {
    Text(String),
    Note(Note),
    Keys(Vec<KeyNumber>),
    Table(Table),
    Figure(Illustration),
    /// Figures side by side where there is room.
    Grid(Vec<Illustration>),
    /// What a reader opens to see; its heading is the line to click on.
    Folded(Section),
    /// Small pictures of all figures of the page below, which lead to their sections.
    Thumbnails,
}

impl Section {
    /// A section with nothing but its heading.
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), ..Self::default() }
    }

    fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds a paragraph of plain text.
    pub fn text(self, paragraph: impl Into<String>) -> Self {
        self.with(Block::Text(paragraph.into()))
    }

    /// Sets the name that links lead to, instead of a number: small letters, digits, `.`, `-` and `_`. A folded section has none.
    pub fn id(self, id: impl Into<String>) -> Self {
        Self { id: id.into(), ..self }
    }

    /// Adds numbers in big type, the main one first.
    pub fn keys(self, numbers: impl IntoIterator<Item = KeyNumber>) -> Self {
        self.with(Block::Keys(numbers.into_iter().collect()))
    }

    /// Adds a table.
    pub fn table(self, table: Table) -> Self {
        self.with(Block::Table(table))
    }

    /// Adds a figure: the output of [`render_svg`](super::render_svg) and a caption.
    pub fn figure(self, svg: impl Into<String>, caption: impl Into<String>) -> Self {
        self.with(Block::Figure(Illustration::still(svg, caption)))
    }

    /// Adds a figure that a reader can look into: the page then carries the script of the charts, some 4.7 MB.
    pub fn drawing(self, drawing: Drawing, caption: impl Into<String>) -> Self {
        self.with(Block::Figure(Illustration::interactive(drawing, caption)))
    }

    /// Adds still figures with their captions side by side, where there is room.
    pub fn figures<S: Into<String>>(self, figures: impl IntoIterator<Item = (S, S)>) -> Self {
        let stills = figures.into_iter().map(|(svg, caption)| Illustration::still(svg, caption));
        self.with(Block::Grid(stills.collect()))
    }

    /// Adds figures to look into likewise.
    pub fn drawings<S: Into<String>>(self, drawings: impl IntoIterator<Item = (Drawing, S)>) -> Self {
        let drawings = drawings.into_iter().map(|(drawing, caption)| Illustration::interactive(drawing, caption));
        self.with(Block::Grid(drawings.collect()))
    }

    /// Adds a part that a reader opens by its heading.
    pub fn folded(self, inner: Section) -> Self {
        self.with(Block::Folded(inner))
    }

    /// Adds small pictures of all figures in the other sections of the page, which lead there.
    pub fn thumbnails(self) -> Self {
        self.with(Block::Thumbnails)
    }

    /// Adds a remark.
    pub fn note(self, text: impl Into<String>) -> Self {
        self.with(Block::Note(Note { is_warning: false, text: text.into() }))
    }

    /// Adds a warning.
    pub fn warning(self, text: impl Into<String>) -> Self {
        self.with(Block::Note(Note { is_warning: true, text: text.into() }))
    }

    /// All figures, those of folded parts included.
    pub(super) fn illustrations(&self) -> Vec<&Illustration> {
        self.blocks.iter().flat_map(Block::illustrations).collect()
    }

    /// All tables likewise.
    pub(super) fn tables(&self) -> Vec<&Table> {
        self.blocks.iter().flat_map(Block::tables).collect()
    }
}

impl Block {
    fn illustrations(&self) -> Vec<&Illustration> {
        match self {
            Self::Figure(figure) => vec![figure],
            Self::Grid(figures) => figures.iter().collect(),
            Self::Folded(inner) => inner.illustrations(),
            _ => Vec::new(),
        }
    }

    fn tables(&self) -> Vec<&Table> {
        match self {
            Self::Table(table) => vec![table],
            Self::Folded(inner) => inner.tables(),
            _ => Vec::new(),
        }
    }
}

/// A number in big type.
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct KeyNumber {
    pub(super) label: String,
    pub(super) value: String,
    pub(super) unit: String,
    pub(super) note: String,
    pub(super) is_main: bool,
}

impl KeyNumber {
    /// What it is, its value and its unit; an empty unit takes no space.
    pub fn new(label: impl Into<String>, value: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), value: value.into(), unit: unit.into(), ..Self::default() }
    }

    /// Adds a short line below.
    pub fn note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// Makes it the answer of the page: larger than the others.
    pub fn main(self) -> Self {
        Self { is_main: true, ..self }
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

impl Illustration {
    fn still(svg: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { svg: svg.into(), chart: None, caption: caption.into() }
    }

    fn interactive(Drawing { svg, chart }: Drawing, caption: impl Into<String>) -> Self {
        Self { svg, chart: Some(chart), caption: caption.into() }
    }
}

/// A remark, set off from the text.
#[derive(Debug, Clone)]
pub(super) struct Note {
    /// Whether the reader should doubt a number.
    pub is_warning: bool,
    pub text: String,
}
