//! Documentation in an FMU: a page about the model, its picture, the licenses.

use askama::Template;

use super::entries::Entries;
use super::error::{PackageError, Result};
use fmu_import::{Causality, EnumerationItem, Kind, ModelDescription, Variable};

/// The licenses, wherever this program runs.
const LICENSES: [(&str, &str); 4] = [
    ("LICENSE-MIT", include_str!("../../LICENSE-MIT")),
    ("LICENSE-APACHE", include_str!("../../LICENSE-APACHE")),
    // The name under which FMI 2.0.4 has importers look first.
    ("license.txt", include_str!("license.txt")),
    ("spdx.txt", "SPDX-License-Identifier: MIT OR Apache-2.0\n"),
];

/// The pictures, which tools show as icons; `model.png` is made of them.
const HARVESTER_PICTURE: &str = include_str!("../../fmu/harvester/documentation/model.svg");
const CIRCUIT_PICTURE: &str = include_str!("../../fmu/circuit/documentation/model.svg");

/// Headings, in the order in which a user needs them.
const GROUPS: [(Causality, &str); 5] = [
    (Causality::Parameter, "Parameters"),
    (Causality::CalculatedParameter, "Calculated parameters"),
    (Causality::Input, "Inputs"),
    (Causality::Output, "Outputs"),
    (Causality::Local, "Local variables: derivatives of the states (model exchange), and what is no Real"),
];

#[derive(Template)]
#[template(path = "harvester/documentation/index.html")]
struct HarvesterPage {
    page: Page,
}

#[derive(Template)]
#[template(path = "circuit/documentation/index.html")]
struct CircuitPage {
    page: Page,
}

/// What the pages say about every model.
struct Page {
    name: String,
    description: String,
    identifier: String,
    guid: String,
    version: String,
    tool: String,
    groups: Vec<Group>,
}

struct Group {
    heading: &'static str,
    rows: Vec<Row>,
}

struct Row {
    name: String,
    unit: String,
    start: String,
    range: String,
    meaning: String,
}

/// Adds page, picture and licenses to an archive.
///
/// # Errors
/// When the page or the picture cannot be written.
pub(super) fn add(description: &ModelDescription, entries: &mut Entries) -> Result<()> {
    if let Some((page, picture)) = page_and_picture(description)? {
        entries.add("documentation/index.html", page);
        entries.add(if description.is_fmi_3() { "terminalsAndIcons/icon.png" } else { "model.png" }, picture);
    }
    for (name, text) in LICENSES {
        entries.add(&format!("documentation/licenses/{name}"), text);
    }
    Ok(())
}

/// The page and the PNG picture of a model; none for a model unknown here.
fn page_and_picture(description: &ModelDescription) -> Result<Option<(String, Vec<u8>)>> {
    let identifier = &description.co_simulation.model_identifier;
    let page = Page {
        name: description.model_name.clone(),
        description: description.description.clone().unwrap_or_default(),
        identifier: identifier.clone(),
        guid: description.guid.clone(),
        version: description.fmi_version.clone(),
        tool: description.generation_tool.clone().unwrap_or_default(),
        groups: GROUPS.iter().filter_map(|(causality, heading)| group(description, *causality, heading)).collect(),
    };
    let (page, picture) = match identifier.as_str() {
        "VibroImpactHarvester" => (HarvesterPage { page }.render(), HARVESTER_PICTURE),
        "HarvestingCircuit" => (CircuitPage { page }.render(), CIRCUIT_PICTURE),
        _ => return Ok(None),
    };
    let page = page.map_err(PackageError::template(format!("the documentation of {identifier}")))?;
    let picture = videg_report::render_png(picture, 1.0)
        .map_err(|cause| PackageError::Picture { identifier: identifier.clone(), cause })?;
    Ok(Some((page, picture)))
}

fn group(description: &ModelDescription, causality: Causality, heading: &'static str) -> Option<Group> {
    let variables = description.variables.iter().filter(|variable| variable.causality == causality);
    let rows: Vec<_> = variables.map(|variable| row(description, variable)).collect();
    (!rows.is_empty()).then_some(Group { heading, rows })
}

fn row(description: &ModelDescription, variable: &Variable) -> Row {
    let mut meaning = variable.description.clone().unwrap_or_default();
    let (unit, start, range) = match &variable.kind {
        Kind::Real { start, min, max, .. } => {
            (variable.unit().unwrap_or("1"), start.map(number), range(min.map(number), max.map(number)))
        }
        Kind::Integer { start, min, max } => (
            "integer",
            start.map(|value| value.to_string()),
            range(min.map(|value| value.to_string()), max.map(|value| value.to_string())),
        ),
        Kind::Boolean { start } => ("boolean", start.map(|value| value.to_string()), String::new()),
        Kind::String { start } => ("text", start.clone(), String::new()),
        Kind::Enumeration { start } => {
            let items = description.enumeration(variable).map(|it| it.items.as_slice()).unwrap_or_default();
            let explained = |item: &EnumerationItem| {
                format!(". {} ({}): {}", item.name, item.value, item.description.as_deref().unwrap_or_default())
            };
            meaning.extend(items.iter().map(explained));
            let chosen = items.iter().find(|item| Some(item.value) == *start);
            ("enumeration", chosen.map(|item| item.name.clone()), String::new())
        }
        Kind::Other => ("clock", None, String::new()),
    };
    Row { name: variable.name.clone(), unit: unit.to_owned(), start: start.unwrap_or_default(), range, meaning }
}

/// A number as people write it.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

fn range(min: Option<String>, max: Option<String>) -> String {
    match (min, max) {
        (None, None) => String::new(),
        (Some(min), None) => format!("at least {min}"),
        (None, Some(max)) => format!("at most {max}"),
        (Some(min), Some(max)) => format!("{min} to {max}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::package::FMUS;

    fn described(identifier: &str) -> (ModelDescription, String, Vec<u8>) {
        let path = format!("{}/modelDescription/{identifier}.xml", env!("CARGO_MANIFEST_DIR"));
        let description = ModelDescription::parse(&std::fs::read(&path).unwrap(), &path).unwrap();
        let (page, picture) = page_and_picture(&description).unwrap().unwrap();
        (description, page, picture)
    }

    #[test]
    fn each_page_has_its_text_and_a_row_for_every_variable_loads_nothing_and_has_a_picture() {
        for fmu in FMUS {
            let (description, page, picture) = described(fmu.identifier);
            for heading in ["Purpose", "Equations", "How it is solved", "Assumptions and limits", "Parameters"] {
                assert!(page.contains(&format!(">{heading}</h")), "{}: {heading}", fmu.identifier);
            }
            for variable in &description.variables {
                assert!(page.contains(&format!("<td><code>{}</code></td>", variable.name)), "{}", variable.name);
            }
            assert_eq!(page.matches("<tr><td>").count(), description.variables.len());
            for loaded in ["src=", "href=", "url(", "@import", "<script"] {
                assert!(!page.contains(loaded), "{}: {loaded}", fmu.identifier);
            }
            assert!(page.is_ascii(), "{}", fmu.identifier);
            // A PNG file of 600 x 400 pixels.
            assert_eq!(picture.get(..8), Some(&b"\x89PNG\r\n\x1a\n"[..]), "{}", fmu.identifier);
            assert_eq!(picture.get(16..24), Some(&[0, 0, 2, 88, 0, 0, 1, 144][..]), "{}", fmu.identifier);
        }
        let (_, page, _) = described("VibroImpactHarvester");
        let row = "<tr><td><code>ball.mass</code></td><td>kg</td><td>0.0035</td><td>1e-9 to 1e6</td>";
        assert!(page.contains(row) && page.contains("<td>enumeration</td><td>impulsive</td>"), "{page}");
    }

    #[test]
    fn the_picture_of_the_harvester_is_to_scale() {
        let (description, ..) = described("VibroImpactHarvester");
        let millimetres = |name: &str| match description.variable(name).unwrap().kind {
            Kind::Real { start: Some(start), .. } => 1e3 * start,
            _ => panic!("{name} is a Real with a start value"),
        };
        let Kind::Real { start: Some(stretch), .. } = description.variable("membrane.prestretch").unwrap().kind else {
            panic!("the pre-stretch is a Real with a start value");
        };
        let (length, width) = (millimetres("cylinder.length"), millimetres("frame.width"));
        let inner = stretch * millimetres("membrane.initialRadius");
        let membrane = length / 2.0 + width;
        for drawn in [
            format!("class=\"ball\" r=\"{}\"", millimetres("ball.radius")),
            format!("class=\"cylinder\" x=\"-{}\" y=\"{inner}\" width=\"{length}\"", length / 2.0),
            format!("class=\"frame\" d=\"M-{} {inner}h{width}v", membrane + width),
            format!("class=\"membrane\" d=\"M-{membrane}-"),
        ] {
            assert!(HARVESTER_PICTURE.contains(&drawn), "{drawn}");
        }
    }
}
