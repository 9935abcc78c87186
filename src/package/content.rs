//! What an FMU of this project has beside model description and libraries: a page, a picture, licenses, and experiments with their
//! reference results after the layered standard FMI-LS-REF.

use fmu_package::{Entries, Fmu, Platform};

use super::error::{PackageError, Result};

/// The licenses, wherever this program runs.
const LICENSES: [(&str, &str); 4] = [
    ("LICENSE-MIT", include_str!("../../LICENSE-MIT")),
    ("LICENSE-APACHE", include_str!("../../LICENSE-APACHE")),
    // The name under which FMI 2.0.4 has importers look first.
    ("license.txt", include_str!("license.txt")),
    ("spdx.txt", "SPDX-License-Identifier: MIT OR Apache-2.0\n"),
];

/// Where the layered standard has its files.
const EXPERIMENTS: &str = "extra/org.fmi-standard.fmi-ls-ref";

/// Names and texts of these files.
type Files = &'static [(&'static str, &'static str)];

/// What a model has of its own.
struct Content {
    /// The text of its page.
    text: &'static str,
    /// Its picture, which tools show as an icon, as an SVG file.
    picture: &'static str,
    experiments: Files,
    /// What FMI 3.0 has in place of the model description of FMI 2.0, and beside it.
    fmi3: [&'static str; 2],
}

macro_rules! content {
    ($identifier:literal in $folder:literal: $($experiment:literal)*) => {
        Content {
            text: include_str!(concat!("../../fmu/", $folder, "/documentation/index.html")),
            picture: include_str!(concat!("../../fmu/", $folder, "/documentation/model.svg")),
            experiments: &[$((
                $experiment,
                include_str!(concat!("../../fmu/", $folder, "/extra/org.fmi-standard.fmi-ls-ref/", $experiment)),
            )),*],
            fmi3: [
                include_str!(concat!("../../modelDescription/fmi3/", $identifier, ".xml")),
                include_str!(concat!("../../modelDescription/fmi3/", $identifier, ".terminalsAndIcons.xml")),
            ],
        }
    };
}

const HARVESTER: Content = content!("VibroImpactHarvester" in "harvester":
    "fmi-ls-manifest.xml" "experiments.exp" "free-ref.csv" "forced-in.csv" "forced-ref.csv");
const CIRCUIT: Content = content!("HarvestingCircuit" in "circuit":
    "fmi-ls-manifest.xml" "experiments.exp" "pulses-in.csv" "pulses-ref.csv");

/// That of a model; none for a model unknown here.
fn of(identifier: &str) -> Option<Content> {
    match identifier {
        "VibroImpactHarvester" => Some(HARVESTER),
        "HarvestingCircuit" => Some(CIRCUIT),
        _ => None,
    }
}

/// Adds all of it to an FMU.
///
/// # Errors
/// When the page or the picture cannot be written.
pub(super) fn add(fmu: &mut Fmu) -> Result<()> {
    for (name, text) in LICENSES {
        fmu.entries_mut().add(&format!("documentation/licenses/{name}"), text);
    }
    let Some(content) = of(fmu.identifier()) else { return Ok(()) };
    for (name, text) in content.experiments {
        fmu.entries_mut().add(&format!("{EXPERIMENTS}/{name}"), *text);
    }
    fmu.add_page(content.text)?;
    let picture = videg_report::render_png(content.picture, 1.0)
        .map_err(|cause| PackageError::Picture { identifier: fmu.identifier().to_owned(), cause })?;
    fmu.add_picture(picture);
    Ok(())
}

/// The archive of FMI 2.0 of a model, whose libraries serve FMI 3.0, too, as that of FMI 3.0.
///
/// # Errors
/// When it cannot be read, or as [`add`].
pub(super) fn converted(identifier: &'static str, archive: &[u8]) -> Result<Fmu> {
    let refuse = |why: String| PackageError::Embedded { identifier, why };
    let archive = Entries::read(archive).map_err(|cause| refuse(format!("is broken: {cause}")))?;
    let Some(Content { fmi3: [description, terminals], .. }) = of(identifier) else {
        return Err(refuse("is unknown".to_owned()));
    };
    let mut fmu = Fmu::new(description, &format!("modelDescription/fmi3/{identifier}.xml"))?;
    fmu.entries_mut().add("terminalsAndIcons/terminalsAndIcons.xml", terminals);
    for name in archive.names() {
        let bytes = archive.bytes(name).unwrap_or_default();
        let mut parts = name.split('/');
        match (parts.next(), parts.next().and_then(Platform::of_folder)) {
            (Some("binaries"), Some(platform)) => fmu.add_library(platform, bytes)?,
            (Some("resources"), _) => fmu.entries_mut().add(name, bytes),
            _ => {}
        }
    }
    add(&mut fmu)?;
    Ok(fmu)
}

#[cfg(test)]
mod tests {
    use fmu_import::{Kind, ModelDescription};

    use super::*;
    use crate::package::FMUS;

    fn described(identifier: &str) -> (ModelDescription, String, Vec<u8>) {
        let path = format!("{}/modelDescription/{identifier}.xml", env!("CARGO_MANIFEST_DIR"));
        let mut fmu = Fmu::new(std::fs::read(&path).unwrap(), &path).unwrap();
        add(&mut fmu).unwrap();
        let entry = |name: &str| fmu.entries().bytes(name).unwrap().to_vec();
        let page = String::from_utf8(entry("documentation/index.html")).unwrap();
        (fmu.description().clone(), page, entry("model.png"))
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
            assert!(HARVESTER.picture.contains(&drawn), "{drawn}");
        }
    }
}
