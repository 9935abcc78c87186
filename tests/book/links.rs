//! Links between pages.

use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

use crate::chapter::{self, Chapter};
use crate::root;

/// Where the links and pictures of a page lead.
fn targets(page: &str) -> Vec<String> {
    let events = Parser::new_ext(page, Options::ENABLE_TABLES);
    let target = |event| match event {
        Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => Some(dest_url.to_string()),
        Event::Html(tag) | Event::InlineHtml(tag) => {
            tag.split_once("src=\"").and_then(|(_, rest)| Some(rest.split_once('"')?.0.to_owned()))
        }
        _ => None,
    };
    events.filter_map(target).collect()
}

/// File names of the pictures of a page that lie beside it.
pub fn pictures(page: &str) -> Vec<String> {
    let picture = |event| match event {
        Event::Start(Tag::Image { dest_url, .. }) if !dest_url.contains('/') => Some(dest_url.to_string()),
        _ => None,
    };
    Parser::new(page).filter_map(picture).collect()
}

/// Names of the headings of a page in links, as mdBook and code hosts make them.
fn anchors(page: &str) -> Vec<String> {
    let (mut found, mut heading): (Vec<String>, Option<String>) = (Vec::new(), None);
    for event in Parser::new_ext(page, Options::ENABLE_TABLES) {
        match (event, &mut heading) {
            (Event::Start(Tag::Heading { .. }), _) => heading = Some(String::new()),
            (Event::End(TagEnd::Heading(_)), Some(text)) => {
                found.push(slug(text));
                heading = None;
            }
            (Event::Text(text) | Event::Code(text), Some(heading)) => heading.push_str(&text),
            _ => {}
        }
    }
    found
}

fn slug(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// `folder` and `link` without `..`.
fn joined(folder: &Path, link: &str) -> PathBuf {
    let mut path = PathBuf::new();
    for part in folder.join(link).components() {
        if part == Component::ParentDir {
            path.pop();
        } else {
            path.push(part);
        }
    }
    path
}

/// What the stage `book` of the tests puts beside the pages.
const MADE: &str = "docs/explorer.html";

/// Why a link of a page leads nowhere.
fn broken(page: &Chapter, link: &str) -> Option<String> {
    if link.contains("://") || link.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = link.split_once('#').map_or((link, None), |(file, anchor)| (file, Some(anchor)));
    let path = if file.is_empty() { page.path.clone() } else { joined(page.path.parent().unwrap(), file) };
    if path == Path::new(MADE) {
        return None;
    }
    if !root().join(&path).exists() {
        return Some(format!("{} is not there", path.display()));
    }
    if page.path.starts_with("docs") && !path.starts_with("docs") {
        return Some(format!("{} is not in the book", path.display()));
    }
    let text = anchor.map(|_| std::fs::read_to_string(root().join(&path)).unwrap())?;
    let known = anchors(&text);
    let anchor = anchor?;
    (!known.iter().any(|name| name == anchor)).then(|| format!("{} has no heading {anchor}", path.display()))
}

#[test]
fn every_link_leads_somewhere_and_those_of_chapters_stay_in_the_book() {
    let others = ["CONTRIBUTING.md", "modelDescription/README.md", "docs/SUMMARY.md"];
    let others = others.map(|path| Chapter::read(Path::new(path)));
    let mut wrong = Vec::new();
    for page in chapter::all().iter().chain(&others) {
        let why = |link: String| Some(format!("{}: {link}: {}", page.path.display(), broken(page, &link)?));
        wrong.extend(targets(&page.text).into_iter().filter_map(why));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn pictures_in_html_are_targets_as_others_are() {
    let page = "[a](b.md) <img src=\"c.svg\" width=\"9\"> ![d](e.svg)\n\n<img src=\"f.svg\">\n<img src=\"g.svg\">\n";
    assert_eq!(targets(page), ["b.md", "c.svg", "e.svg", "f.svg", "g.svg"]);
}

#[test]
fn headings_have_the_names_that_links_use() {
    assert_eq!(anchors("# C(t) of `a.b`\n\n## Where to, then?\n"), ["ct-of-ab", "where-to-then"]);
    assert_eq!(joined(Path::new("docs/theory"), "../a.md"), Path::new("docs/a.md"));
}
