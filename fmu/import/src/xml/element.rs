//! A document as a tree of elements, read within bounds: nothing is interpreted that must not be, and nothing takes memory or
//! time without bound.

use std::borrow::Cow;
use std::fmt::Display;
use std::str::FromStr;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::Result;

/// Deepest nesting of elements; FMI 2.0 itself needs six, vendor annotations may add some.
const MAX_DEPTH: usize = 64;
/// Most attributes of an element; FMI 2.0 itself has 16. The reader compares each with all before it.
const MAX_ATTRIBUTES: usize = 256;
/// Longest value of an attribute, bytes as they stand in the document: errors and tables repeat it.
const MAX_VALUE: usize = 64 << 10;
/// Attributes of `Unknown`, long where all depends on all, which nobody here reads.
const UNREAD: [&str; 2] = ["dependencies", "dependenciesKind"];
/// Most elements: each takes some hundred bytes of memory, though it may have no more than four in the document. A variable has
/// two, and one more for each list of the model structure that names it.
const MAX_ELEMENTS: usize = 1_000_000;

/// An element with its attributes and child elements.
pub(super) struct Element<'a> {
    start: BytesStart<'a>,
    children: Vec<Element<'a>>,
}

impl<'a> Element<'a> {
    /// Reads a document: its root element. Refuses document types, a second root, and what passes a bound.
    pub fn parse(text: &'a str) -> Result<Self> {
        let mut reader = Reader::from_str(text);
        let (mut root, mut open) = (None, Vec::<Self>::new());
        let mut count = 0;
        loop {
            let event = reader.read_event().map_err(|error| malformed(reader.error_position(), &error.to_string()))?;
            let syntax = |cause| malformed(reader.buffer_position(), cause);
            let closed = match event {
                Event::DocType(_) => {
                    return Err(
                        "the model description has a DOCTYPE, which is not allowed (entities are never expanded)"
                            .to_owned(),
                    );
                }
                Event::Eof => {
                    let root = root.filter(|_| open.is_empty());
                    return root.ok_or_else(|| syntax("the document ends too early"));
                }
                Event::Start(_) | Event::Empty(_) if open.is_empty() && root.is_some() => {
                    return Err(syntax("the document has a second root element"));
                }
                Event::Start(_) | Event::Empty(_) if count == MAX_ELEMENTS => {
                    return Err(format!("the model description has more than {MAX_ELEMENTS} elements"));
                }
                Event::Start(_) if open.len() == MAX_DEPTH => {
                    return Err(format!("the model description nests elements deeper than {MAX_DEPTH}"));
                }
                Event::Start(start) => {
                    open.push(Self::new(start)?);
                    count += 1;
                    None
                }
                Event::Empty(start) => {
                    count += 1;
                    Some(Self::new(start)?)
                }
                Event::End(_) => open.pop(),
                _ => None,
            };
            match (closed, open.last_mut()) {
                (Some(element), Some(parent)) => parent.children.push(element),
                (Some(element), None) => root = Some(element),
                (None, _) => {}
            }
        }
    }

    fn new(start: BytesStart<'a>) -> Result<Self> {
        let shown = |name: &str| name.chars().take(100).collect::<String>();
        let element = || format!("the model description has an element <{}>", shown(start.name().as_ref()));
        for (count, attribute) in start.attributes().enumerate() {
            if count == MAX_ATTRIBUTES {
                return Err(format!("{} with more than {MAX_ATTRIBUTES} attributes", element()));
            }
            let attribute = attribute.map_err(unreadable)?;
            let found = attribute.value.len();
            if found > MAX_VALUE && !UNREAD.contains(&attribute.key.as_ref()) {
                let name = shown(attribute.key.as_ref());
                return Err(format!("{} whose {name} has {found} bytes, allowed are {MAX_VALUE}", element()));
            }
        }
        Ok(Self { start, children: Vec::new() })
    }

    /// Name of the element.
    pub fn name(&self) -> String {
        self.start.name().as_ref().to_owned()
    }

    /// The child elements of this name.
    pub fn children(&self, name: &str) -> impl Iterator<Item = &Self> {
        self.children.iter().filter(move |child| child.start.name().as_ref() == name)
    }

    /// All child elements.
    pub fn all_children(&self) -> impl Iterator<Item = &Self> {
        self.children.iter()
    }

    /// The child element of this name, of which there may be one.
    pub fn child(&self, name: &str) -> Result<Option<&Self>> {
        let mut children = self.children(name);
        match (children.next(), children.next()) {
            (child, None) => Ok(child),
            (_, Some(_)) => Err(unreadable(format!("there are two elements <{name}>"))),
        }
    }

    /// The children called `item` of the child called `list`, if there is one.
    pub fn list(&self, list: &str, item: &str) -> Result<impl Iterator<Item = &Self>> {
        Ok(self.child(list)?.into_iter().flat_map(move |list| list.children(item)))
    }

    /// An attribute, with references resolved.
    pub fn attribute(&self, name: &str) -> Result<Option<String>> {
        let found = self.start.try_get_attribute(name).map_err(unreadable)?;
        let value = found.map(|attribute| attribute.normalized_value(XmlVersion::Implicit1_0)).transpose();
        Ok(value.map_err(unreadable)?.map(Cow::into_owned))
    }

    /// An attribute that must be there; errors name the element by `place`.
    pub fn required(&self, place: &str, name: &str) -> Result<String> {
        self.attribute(name)?.ok_or_else(|| missing(place, name))
    }

    /// An attribute, read by `read`, that must have one of the `allowed` values.
    pub fn read<T>(
        &self,
        place: &str,
        name: &str,
        read: impl FnOnce(&str) -> Option<T>,
        allowed: &str,
    ) -> Result<Option<T>> {
        let Some(text) = self.attribute(name)? else { return Ok(None) };
        read(&text).map(Some).ok_or_else(|| not_allowed(place, name, &text, allowed))
    }

    pub fn real(&self, place: &str, name: &str) -> Result<Option<f64>> {
        self.read(place, name, |text| text.trim().parse().ok(), "a number")
    }

    pub fn integer<T: FromStr>(&self, place: &str, name: &str) -> Result<Option<T>> {
        self.read(place, name, |text| text.trim().parse().ok(), "an integer of the attribute's range")
    }

    /// An integer of FMI 2.0, which has 32 bits.
    pub fn whole(&self, place: &str, name: &str) -> Result<Option<i64>> {
        Ok(self.integer::<i32>(place, name)?.map(i64::from))
    }

    pub fn boolean(&self, place: &str, name: &str) -> Result<Option<bool>> {
        self.read(place, name, truth, TRUTHS)
    }
}

/// What [`truth`] reads, as errors say it.
pub(super) const TRUTHS: &str = "true or false";

pub(super) fn truth(text: &str) -> Option<bool> {
    match text.trim() {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

fn malformed(position: u64, cause: &str) -> String {
    format!("the model description is not well-formed XML at byte {position}: {cause}")
}

fn unreadable(cause: impl Display) -> String {
    format!("the model description cannot be read: {cause}")
}

pub(super) fn missing(place: &str, what: &str) -> String {
    format!("{place} has no {what}")
}

pub(super) fn not_allowed(place: &str, attribute: &str, found: &str, allowed: &str) -> String {
    format!("{place}: {attribute} is \"{found}\", allowed is {allowed}")
}
