//! A report as one HTML file: nothing loaded from elsewhere, and no scripts but those of interactive charts.

use askama::Template;
use serde::de::IgnoredAny;

use super::error::ReportError;
use super::page::{Block, Illustration, Report, Section};
use super::policy::{CHART_LIBRARY, PAGE_SCRIPT, policy};
use super::table::Table;

/// The page. The policy in its head forbids any request and all scripts but its own, whatever the text contains;
/// only these, the style sheet, and the checked figures with their inert data are inserted unescaped.
#[derive(Template)]
#[template(path = "page.html")]
struct Page<'a> {
    report: &'a Report,
    /// One for each section.
    ids: &'a [String],
    style: &'static str,
    policy: String,
    /// The library of the charts, which only the second, the page's own, brings to life.
    scripts: Option<(&'static str, &'static str)>,
}

impl<'a> Page<'a> {
    fn blocks(&self, section: &'a Section) -> Blocks<'a> {
        Blocks { section, page: self.report, ids: self.ids }
    }
}

/// What stands under a heading.
#[derive(Template)]
#[template(path = "blocks.html")]
struct Blocks<'a> {
    section: &'a Section,
    page: &'a Report,
    ids: &'a [String],
}

impl<'a> Blocks<'a> {
    fn of(&self, section: &'a Section) -> Self {
        Self { section, page: self.page, ids: self.ids }
    }

    fn picture(&self, figure: &'a Illustration) -> Picture<'a> {
        Picture { heading: &self.section.heading, figure, id: self.figure_id(figure) }
    }

    fn figure_id(&self, figure: &Illustration) -> String {
        let mut all = self.page.sections.iter().flat_map(Section::illustrations);
        format!("figure-{}", all.position(|other| std::ptr::eq(other, figure)).unwrap_or_default() + 1)
    }

    /// The first figure of each other section: its id, its box, and id and heading of the section.
    fn thumbnails(&self) -> Vec<(String, &'a str, &'a str, &'a str)> {
        let others =
            self.page.sections.iter().zip(self.ids).filter(|(section, _)| !std::ptr::eq(*section, self.section));
        let first = |(section, id): (&'a Section, &'a String)| {
            let figure = *section.illustrations().first()?;
            let view = figure.svg.split_once("viewBox=\"")?.1.split('"').next()?;
            Some((self.figure_id(figure), view, id.as_str(), section.heading.as_str()))
        };
        others.filter_map(first).collect()
    }
}

/// A figure with its caption.
#[derive(Template)]
#[template(path = "picture.html")]
struct Picture<'a> {
    heading: &'a str,
    figure: &'a Illustration,
    id: String,
}

impl Picture<'_> {
    /// The figure, with a name for what is drawn, without its title and its description, so that a thumbnail can show it again.
    fn svg(&self) -> String {
        let svg = self.figure.svg.trim();
        let tag = svg.find('>').map_or(0, |end| end + 1);
        let begin = ["title", "desc"].into_iter().fold(tag, |begin, name| {
            let is_next = svg[begin..].trim_start().starts_with(&format!("<{name}>"));
            let end = format!("</{name}>");
            svg[begin..].find(&end).filter(|_| is_next).map_or(begin, |place| begin + place + end.len())
        });
        let drawn = svg[begin..].strip_suffix("</svg>").unwrap_or_default();
        format!("{}<g id=\"{}\">{drawn}</g></svg>", &svg[..begin], self.id)
    }
}

/// Renders a report as one HTML file that needs nothing else.
///
/// All text is escaped; figures are copied and therefore have to be passive SVG. Only a report with a
/// [`Section::drawing`] carries scripts.
///
/// # Errors
/// A table row that does not fit its columns; a figure that is not SVG, or that carries a script, a
/// link or foreign content; data of a chart that are not JSON; an id that is none, or that two sections have; a link
/// that leads nowhere.
pub fn render_html(report: &Report) -> Result<String, ReportError> {
    let ids = section_ids(report)?;
    report.sections.iter().try_for_each(|section| {
        let section_error = |reason| ReportError::Section { section: section.heading.clone(), reason };
        check(section, &ids).map_err(section_error)
    })?;
    let has_charts = report.sections.iter().flat_map(Section::illustrations).any(|figure| figure.chart.is_some());
    let scripts = has_charts.then(|| (CHART_LIBRARY.as_str(), PAGE_SCRIPT));
    let page = Page { report, ids: &ids, style: include_str!("page.css"), policy: policy(has_charts), scripts };
    Ok(page.render()? + "\n")
}

/// Ids of all sections: their own, or numbers.
fn section_ids(report: &Report) -> Result<Vec<String>, ReportError> {
    let mut ids: Vec<String> = Vec::new();
    for (section, number) in report.sections.iter().zip(1..) {
        let id = if section.id.is_empty() { format!("section-{number}") } else { section.id.clone() };
        let is_name = id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "._-".contains(c));
        if !is_name || id == "chart-library" || ids.contains(&id) {
            let reason = format!("id `{id}` is taken, or has more than small letters, digits, `.`, `-` and `_`");
            return Err(ReportError::Section { section: section.heading.clone(), reason });
        }
        ids.push(id);
    }
    Ok(ids)
}

fn check(section: &Section, ids: &[String]) -> Result<(), String> {
    section.tables().into_iter().try_for_each(|table| check_table(table, ids))?;
    let faulty = section.illustrations().into_iter().find_map(|figure| {
        let is_json = |chart: &String| serde_json::from_str::<IgnoredAny>(chart).is_ok();
        let has_data = figure.chart.as_ref().is_none_or(is_json);
        fault(&figure.svg).or((!has_data).then_some("the data of its chart are not JSON"))
    });
    faulty.map_or(Ok(()), |reason| Err(format!("the figure is not a passive SVG element ({reason})")))
}

fn check_table(table: &Table, ids: &[String]) -> Result<(), String> {
    let columns = table.columns.len();
    if let Some((row, number)) = table.rows.iter().zip(1..).find(|(row, _)| row.cells.len() != columns) {
        return Err(format!("table row {number} has {} cells for {columns} columns", row.cells.len()));
    }
    let mut targets = table.rows.iter().flat_map(|row| &row.cells).filter_map(|cell| cell.target.as_ref());
    match targets.find(|target| !ids.contains(target)) {
        Some(target) => Err(format!("a link leads to `{target}`, but no section has this id")),
        None => Ok(()),
    }
}

/// Why an SVG text must not be copied into a page.
///
/// In text, `<` and quotes are escaped: these patterns can only be markup.
fn fault(svg: &str) -> Option<&'static str> {
    let svg = svg.trim().to_ascii_lowercase();
    if !svg.starts_with("<svg") || !svg.ends_with("</svg>") {
        return Some("it is not one svg element");
    }
    let active = [
        ("<script", "it contains a script"),
        ("<foreignobject", "it contains foreign content"),
        ("href=\"", "it contains a link"),
        ("href='", "it contains a link"),
    ];
    active.into_iter().find(|(pattern, _)| svg.contains(pattern)).map(|(_, reason)| reason)
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Drawing;
    use super::super::figure::{Figure, Panel, Series};
    use super::super::page::KeyNumber;
    use super::super::table::{Cell, Column, Tone};
    use super::*;

    const SVG: &str = "<svg viewBox=\"0 0 1 1\"><title>t</title></svg>";

    fn page(section: Section) -> Result<String, ReportError> {
        let report = Report::new("Run", "What it shows.")
            .command("videg cosim --case fig14")
            .generated_by("videg 0.1.0")
            .section(section);
        render_html(&report)
    }

    #[test]
    fn every_text_is_escaped() {
        let evil = "<script>alert('x')</script>";
        let table = Table::new([Column::words(evil)]).row([evil]);
        let section = Section::new(evil).text(evil).note(evil).warning(evil).table(table);
        let report = Report::new(evil, evil).command(evil).generated_by(evil).section(section.figure(SVG, evil));
        let html = render_html(&report).unwrap();
        assert!(!html.contains("<script"));
        assert!(html.matches("&#60;script&#62;").count() >= 11);
    }

    #[test]
    fn the_page_needs_nothing_else() {
        let html = page(Section::new("Energy").figure(SVG, "A figure.")).unwrap();
        for foreign in ["http://", "https://", "src=", "@import", "url(", "<script"] {
            assert!(!html.contains(foreign), "{foreign}");
        }
        assert!(html.contains("default-src 'none'"));
        assert!(html.contains("prefers-color-scheme: dark") && html.contains("width=device-width"));
        assert!(html.contains("@media print"));
    }

    #[test]
    fn content_appears_in_order() {
        let table = Table::new([Column::words("quantity"), Column::numbers("J")]).row(["load", "1"]);
        let section =
            Section::new("Energy").warning("Beware.").keys([KeyNumber::new("net", "2.5", "mW").note("a gain").main()]);
        let inner = Section::new("Why").text("Words.").table(table);
        let html = page(section.folded(inner).figure(SVG, "Caption.")).unwrap();
        let marks = [
            "<h1>Run</h1>",
            "What it shows.",
            "<h2>Energy</h2>",
            "Beware.",
            "<dt>net</dt>",
            "a gain",
            "<summary>Why</summary>",
            "Words.",
            "<th scope=\"col\" class=\"number\">J</th>",
            "<td class=\"number\">1</td>",
            "<svg",
            "Caption.",
            "videg cosim",
            "Generated by videg 0.1.0.",
        ];
        let places: Vec<usize> = marks.iter().map(|m| html.find(m).expect(m)).collect();
        assert!(places.is_sorted(), "{places:?}");
        assert!(!html.contains("<nav"), "one section needs no list of sections");
    }

    #[test]
    fn sections_that_no_page_can_carry_are_refused_with_the_reason() {
        let section = || Section::new("S");
        let ragged = Table::new([Column::words("a"), Column::words("b")]).row(["1", "2"]).row(["3"]);
        let astray = Table::new([Column::words("a")]).row([Cell::link("Figure 14", "fig14")]);
        let broken = Drawing { svg: SVG.to_owned(), chart: "{} </script>".to_owned() };
        let active = [
            "<img src=x>",
            "<svg></svg><p>more",
            "<svg><SCRIPT>alert(1)</SCRIPT></svg>",
            "<svg><foreignObject/></svg>",
            "<svg><a href=\"x\"/></svg>",
        ];
        let active = active.map(|svg| (section().figure(svg, ""), "the figure is not a passive SVG element ("));
        let ids =
            ["a b", "\"", "chart-library"].map(|id| (section().id(id), "is taken, or has more than small letters"));
        let others = [
            (section().table(ragged), "table row 2 has 1 cells for 2 columns"),
            (section().table(astray), "a link leads to `fig14`, but no section has this id"),
            (section().drawing(broken, ""), "the data of its chart are not JSON"),
        ];
        for (section, told) in active.into_iter().chain(ids).chain(others) {
            let error = page(section).unwrap_err().to_string();
            assert!(error.starts_with("section `S`: ") && error.contains(told), "{told}: {error}");
        }
        let twice = Report::new("", "").section(Section::new("A").id("x")).section(Section::new("B").id("x"));
        assert!(render_html(&twice).unwrap_err().to_string().contains("`B`: id `x`"));
        let figure = Figure::new("href=\"x\" <script").panel(Panel::new("", "", ""));
        assert!(page(section().figure(Drawing::new(&figure).unwrap().svg, "")).is_ok());
    }

    #[test]
    fn data_of_a_chart_cannot_leave_their_script() {
        let evil = "</script><script>alert(1)</script><!--";
        let points = [(0.0, 1.0)];
        let panel = Panel::new(evil, evil, evil).series(Series::points(evil, &points)).line(evil, 1.0);
        let drawing = Drawing::new(&Figure::new(evil).panel(panel)).unwrap();
        let html = page(Section::new("S").drawing(drawing, evil)).unwrap();
        // The data, the library and the script of the page, and no other.
        assert_eq!((html.matches("<script").count(), html.matches("</script>").count()), (3, 3));
        assert!(!html.contains("alert(1)</script>"));
    }

    #[test]
    fn only_a_drawing_brings_scripts_and_the_policy_names_them() {
        let drawing = || Drawing::new(&Figure::new("").panel(Panel::new("", "", ""))).unwrap();
        let still = page(Section::new("S").figure(drawing().svg, "")).unwrap();
        let lively = page(Section::new("S").drawing(drawing(), "").drawing(drawing(), "")).unwrap();
        assert!(!still.contains("<script") && !still.contains("script-src") && still.len() < 100_000);
        assert!(lively.contains("default-src 'none'; script-src 'sha256-"));
        assert_eq!(lively.matches("id=\"chart-library\"").count(), 1);
        assert_eq!(lively.matches(">Look closer</button>").count(), 2);
    }

    #[test]
    fn what_is_folded_is_checked_as_well_and_thumbnails_show_what_is_there() {
        let folded = |inner: Section| page(Section::new("S").folded(Section::new("F").folded(inner)));
        let ragged = Table::new([Column::words("a")]).row(["1", "2"]);
        assert!(folded(Section::new("I").table(ragged)).is_err());
        assert!(folded(Section::new("I").figure("<img>", "")).is_err());
        let report = Report::new("", "")
            .section(Section::new("Summary").thumbnails())
            .section(Section::new("Words"))
            .section(Section::new("Two").id("two").text("").folded(Section::new("F").figures([(SVG, ""), (SVG, "")])));
        let html = render_html(&report).unwrap();
        assert_eq!(html.matches("<use ").count(), 1);
        assert!(html.contains("<a href=\"#two\"") && html.contains("<use href=\"#figure-1\"/>"));
        assert!(html.contains("</title><g id=\"figure-1\"></g></svg>") && html.contains("<g id=\"figure-2\">"));
    }

    #[test]
    fn badges_carry_their_word_and_links_lead_to_sections() {
        let cells = [Cell::badge("agrees", Tone::Good), Cell::link("Figure 14", "fig14")];
        let table = Table::new([Column::words("verdict"), Column::words("place")]).row(cells);
        let section = Section::new("S").id("fig14").table(table.clone()).table(table);
        let html = page(section).unwrap();
        assert_eq!(html.matches("<span class=\"badge good\">agrees</span>").count(), 2);
        assert!(html.contains("<a href=\"#fig14\">Figure 14</a>") && html.contains("<section id=\"fig14\">"));
    }
}
