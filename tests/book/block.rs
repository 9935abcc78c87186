//! Code blocks of a page and what the comments before them say.

use std::ops::Range;

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// What a comment before a block says of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Mark {
    /// It is the content of a file of this name.
    File(String),
    /// A test elsewhere runs it: its path from the root of the source tree.
    RunBy(String),
    /// It does not run.
    NotRun {
        /// Why.
        reason: String,
        /// Only lines with one of these are left out, if there are any.
        parts: Vec<String>,
    },
}

/// A fenced code block.
#[derive(Debug, Clone)]
pub struct Block {
    /// First word behind the fence.
    pub language: String,
    /// What stands between the fences.
    pub text: String,
    /// Where that is in the page, bytes.
    pub range: Range<usize>,
    /// Line of the opening fence, from 1.
    pub line: usize,
    /// The comment before it.
    pub mark: Option<Mark>,
}

impl Block {
    /// The name of the file that it is.
    pub fn file(&self) -> Option<&str> {
        match &self.mark {
            Some(Mark::File(name)) => Some(name),
            _ => None,
        }
    }

    /// Why all of it does not run.
    pub fn not_run(&self) -> Option<&str> {
        match &self.mark {
            Some(Mark::NotRun { reason, parts }) if parts.is_empty() => Some(reason),
            Some(Mark::RunBy(test)) => Some(test),
            _ => None,
        }
    }

    /// Why a `line` of it does not run.
    pub fn line_not_run(&self, line: &str) -> Option<&str> {
        match &self.mark {
            Some(Mark::NotRun { reason, parts }) if parts.iter().any(|part| line.contains(part)) => Some(reason),
            _ => self.not_run(),
        }
    }
}

/// Every fenced block of a page, in order.
pub fn blocks(page: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let (mut mark, mut open): (Option<Mark>, Option<(String, usize)>) = (None, None);
    let mut inner: Option<Range<usize>> = None;
    for (event, range) in Parser::new_ext(page, Options::ENABLE_TABLES).into_offset_iter() {
        match event {
            Event::Html(text) => mark = parse_mark(&text).or(mark),
            Event::Start(Tag::HtmlBlock) | Event::End(TagEnd::HtmlBlock) => {}
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))) => {
                let language = info.split([' ', ',']).next().unwrap_or_default().to_owned();
                open = Some((language, range.start));
                inner = None;
            }
            Event::Text(_) if open.is_some() => {
                inner = Some(inner.map_or(range.clone(), |inner| inner.start..range.end));
            }
            Event::End(TagEnd::CodeBlock) => {
                let Some((language, start)) = open.take() else { continue };
                let line = page[..start].lines().count() + 1;
                let end = start + page[start..].find('\n').map_or(0, |at| at + 1);
                let range = inner.take().unwrap_or(end..end);
                found.push(Block { language, text: page[range.clone()].to_owned(), range, line, mark: mark.take() });
            }
            _ if open.is_none() => mark = None,
            _ => {}
        }
    }
    found
}

fn parse_mark(comment: &str) -> Option<Mark> {
    let inner = comment.trim().strip_prefix("<!--")?.strip_suffix("-->")?.trim();
    if let Some(name) = inner.strip_prefix("file:") {
        return Some(Mark::File(name.trim().to_owned()));
    }
    if let Some(test) = inner.strip_prefix("run by") {
        return Some(Mark::RunBy(test.trim().to_owned()));
    }
    let (parts, reason) = inner.strip_prefix("not run")?.split_once(": ")?;
    let parts = parts.split('"').skip(1).step_by(2).map(str::to_owned).collect();
    Some(Mark::NotRun { reason: reason.trim().to_owned(), parts })
}

#[test]
fn blocks_are_found_with_the_comments_before_them() {
    let page = "<!-- file: a.c -->\n```c\nint x;\n```\n\ntext\n\n<!-- not run \"win64\" \"mac\": no Wine -->\n\n```sh\na\n\nb win64\n```\n\n\
                <!-- file: lost -->\nwords\n\n```python\n```\n\n\
                <!-- run by a.py -->\n```python\nb\n```\n";
    let found = blocks(page);
    let languages: Vec<_> = found.iter().map(|block| (block.language.as_str(), block.line)).collect();
    assert_eq!(languages, [("c", 2), ("sh", 10), ("python", 19), ("python", 23)]);
    assert_eq!((found[0].file(), found[0].text.as_str()), (Some("a.c"), "int x;\n"));
    assert_eq!((found[1].text.as_str(), found[1].not_run()), ("a\n\nb win64\n", None));
    assert_eq!((found[1].line_not_run("b win64"), found[1].line_not_run("a")), (Some("no Wine"), None));
    assert_eq!((found[2].mark.clone(), found[2].text.as_str()), (None, ""));
    assert_eq!((found[3].mark.clone(), found[3].not_run()), (Some(Mark::RunBy("a.py".to_owned())), Some("a.py")));
}
