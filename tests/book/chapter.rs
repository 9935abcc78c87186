//! The pages: the README, and the chapters that `docs/SUMMARY.md` lists.

use std::path::{Path, PathBuf};

use pulldown_cmark::{Event, Parser, Tag};

use crate::block::{Block, blocks};
use crate::root;

/// A page with its code blocks.
pub struct Chapter {
    /// Path from the root of the source tree.
    pub path: PathBuf,
    /// All of it.
    pub text: String,
    /// Its code blocks.
    pub blocks: Vec<Block>,
}

impl Chapter {
    /// The page at `path`, from the root of the source tree.
    pub fn read(path: &Path) -> Self {
        let text =
            std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Self { path: path.to_owned(), blocks: blocks(&text), text }
    }

    /// Where a block is, for messages.
    pub fn place(&self, block: &Block) -> String {
        format!("{}:{}", self.path.display(), block.line)
    }
}

/// Paths of the chapters, in the order of the summary.
pub fn paths() -> Vec<PathBuf> {
    let summary = std::fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let link = |event| match event {
        Event::Start(Tag::Link { dest_url, .. }) => Some(Path::new("docs").join(&*dest_url)),
        _ => None,
    };
    Parser::new(&summary).filter_map(link).collect()
}

/// The README and all chapters.
pub fn all() -> Vec<Chapter> {
    std::iter::once(PathBuf::from("README.md")).chain(paths()).map(|path| Chapter::read(&path)).collect()
}

#[test]
fn every_page_under_docs_is_a_chapter_and_every_chapter_is_there() {
    let mut listed = paths();
    listed.sort();
    let mut there = pages(Path::new("docs"));
    there.retain(|path| path != Path::new("docs/SUMMARY.md"));
    there.sort();
    assert_eq!(there, listed, "docs/SUMMARY.md (right) must list each page under docs (left) once");
}

fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap().map(|entry| folder.join(entry.unwrap().file_name()));
    let of = |path: PathBuf| {
        if root().join(&path).is_dir() { pages(&path) } else { vec![path] }
    };
    entries.flat_map(of).filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect()
}
