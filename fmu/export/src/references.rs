//! Value references from one model description to the next. Masters compile them in, so one that is known must not move.

use std::collections::BTreeMap;

use quick_xml::Reader;
use quick_xml::events::Event;

/// What the text of a model description `made` now has otherwise than the one `kept`: a line for each variable that has
/// another value reference, or is gone. New variables change nothing.
///
/// # Errors
/// What is no XML.
pub fn changed_references(kept: &str, made: &str) -> Result<Vec<String>, quick_xml::Error> {
    let (kept, made) = (references(kept)?, references(made)?);
    let changed = kept.iter().filter_map(|(name, before)| match made.get(name) {
        Some(now) if now == before => None,
        Some(now) => Some(format!("{name} had value reference {before}, now {now}")),
        None => Some(format!("{name}, value reference {before}, is gone")),
    });
    Ok(changed.collect())
}

/// The value reference of each variable, by its name.
fn references(document: &str) -> Result<BTreeMap<String, String>, quick_xml::Error> {
    let mut reader = Reader::from_str(document);
    let mut found = BTreeMap::new();
    loop {
        match reader.read_event()? {
            Event::Eof => return Ok(found),
            Event::Start(tag) | Event::Empty(tag) => {
                let text = |name| -> Result<Option<String>, quick_xml::Error> {
                    Ok(tag.try_get_attribute(name)?.map(|it| it.value.into_owned()))
                };
                // Nothing but a variable has both, in any version of FMI.
                if let (Some(name), Some(reference)) = (text("name")?, text("valueReference")?) {
                    found.insert(name, reference);
                }
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A description whose variables have their places as value references.
    fn description(names: &[&str]) -> String {
        let rows = names.iter().enumerate().map(|(reference, name)| {
            format!("<ScalarVariable name=\"{name}\" valueReference=\"{reference}\"><Real/></ScalarVariable>")
        });
        format!(
            "<fmiModelDescription><ModelVariables>{}</ModelVariables></fmiModelDescription>",
            rows.collect::<String>()
        )
    }

    fn changed(made: &[&str]) -> Vec<String> {
        changed_references(&description(&["mass", "der(x)", "x"]), &description(made)).unwrap()
    }

    #[test]
    fn a_variable_at_the_end_of_the_table_moves_none() {
        assert_eq!(changed(&["mass", "der(x)", "x"]), [""; 0]);
        assert_eq!(changed(&["mass", "der(x)", "x", "stiffness"]), [""; 0]);
        assert_eq!(changed_references("", &description(&["mass"])).unwrap(), [""; 0]);
    }

    #[test]
    fn each_variable_that_moves_or_goes_is_named_with_its_reference() {
        let moved = ["der(x) had value reference 1, now 2", "x had value reference 2, now 3"];
        assert_eq!(changed(&["mass", "stiffness", "der(x)", "x"]), moved);
        assert_eq!(changed(&["mass", "der(x)"]), ["x, value reference 2, is gone"]);
        assert_eq!(changed(&["mass", "der(x)", "y"]), ["x, value reference 2, is gone"]);
    }
}
