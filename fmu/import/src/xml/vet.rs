//! The first pass: what must never be interpreted, and what would take memory or time without bound.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::{Error, Result, missing};

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

/// Refuses document types, another root or a second one, another FMI version, and what passes a bound.
pub(super) fn vet(text: &str) -> Result<()> {
    let mut reader = Reader::from_str(text);
    let mut depth = 0_usize;
    let mut elements = 0_usize;
    loop {
        let event = reader
            .read_event()
            .map_err(|error| Error::Syntax { position: reader.error_position(), cause: error.to_string() })?;
        let syntax = |cause: &str| Error::Syntax { position: reader.buffer_position(), cause: cause.to_owned() };
        match &event {
            Event::DocType(_) => return Err(Error::Doctype),
            Event::Start(element) | Event::Empty(element) => {
                bound_attributes(element)?;
                if elements == 0 {
                    check_root(element, reader.buffer_position())?;
                } else if depth == 0 {
                    return Err(syntax("the document has a second root element"));
                }
                elements += 1;
                if elements > MAX_ELEMENTS {
                    return Err(Error::Elements { allowed: MAX_ELEMENTS });
                }
                depth += usize::from(matches!(event, Event::Start(_)));
                if depth > MAX_DEPTH {
                    return Err(Error::Depth { allowed: MAX_DEPTH });
                }
            }
            Event::End(_) => depth = depth.saturating_sub(1),
            Event::Eof if depth > 0 || elements == 0 => return Err(syntax("the document ends too early")),
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
}

fn bound_attributes(element: &BytesStart<'_>) -> Result<()> {
    let shown = |name: &str| name.chars().take(100).collect::<String>();
    let mut attributes = element.attributes();
    // What is not well-formed is told by the second pass.
    for (count, attribute) in attributes.with_checks(false).flatten().enumerate() {
        if count == MAX_ATTRIBUTES {
            return Err(Error::Attributes { element: shown(element.name().as_ref()), allowed: MAX_ATTRIBUTES });
        }
        let found = attribute.value.len();
        if found > MAX_VALUE && !UNREAD.contains(&attribute.key.as_ref()) {
            let (element, attribute) = (shown(element.name().as_ref()), shown(attribute.key.as_ref()));
            return Err(Error::Value { element, attribute, found, allowed: MAX_VALUE });
        }
    }
    Ok(())
}

/// Name and version of the root element.
fn check_root(element: &BytesStart<'_>, position: u64) -> Result<()> {
    let name = element.name().as_ref().to_owned();
    if name != "fmiModelDescription" {
        return Err(Error::Root { found: name });
    }
    let version = element
        .try_get_attribute("fmiVersion")
        .map_err(|error| Error::Syntax { position, cause: error.to_string() })?
        .ok_or_else(|| missing("fmiModelDescription", "fmiVersion"))?;
    let version = version.value.into_owned();
    if version == "2.0" { Ok(()) } else { Err(Error::Version { found: version }) }
}
