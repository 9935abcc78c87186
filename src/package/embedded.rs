//! FMUs inside the program, for use without the source tree: the feature `embedded-fmus`.
//!
//! They are packaged before the program is compiled, for all platforms of a release. The program then does all that it does in its
//! source tree, except building for other targets.

use std::path::Path;

use fmu_package::{Entries, Fmu};

use super::error::{PackageError, Result};
use super::{AddedBinary, FMUS, FmuPackage, Options, add_resources, added, locate};

/// Bytes of an archive in the folder that `VIDEG_FMUS` named when the program was compiled.
#[cfg(feature = "embedded-fmus")]
macro_rules! archive {
    ($name:literal) => {
        include_bytes!(concat!(
            env!(
                "VIDEG_FMUS",
                "the feature embedded-fmus needs VIDEG_FMUS: the absolute path of a folder with both .fmu"
            ),
            "/",
            $name
        ))
    };
}

/// The archives, in the order of [`FMUS`].
#[cfg(feature = "embedded-fmus")]
const ARCHIVES: Option<[&[u8]; FMUS.len()]> =
    Some([archive!("VibroImpactHarvester.fmu"), archive!("HarvestingCircuit.fmu")]);
#[cfg(not(feature = "embedded-fmus"))]
const ARCHIVES: Option<[&[u8]; FMUS.len()]> = None;

/// The model descriptions that this program was compiled with, in the order of [`FMUS`].
const DESCRIPTIONS: [&str; FMUS.len()] = [
    include_str!("../../modelDescription/VibroImpactHarvester.xml"),
    include_str!("../../modelDescription/HarvestingCircuit.xml"),
];

/// The archives inside the program, if it has any and is to use them.
pub(super) fn archives(options: &Options) -> Option<[&'static [u8]; FMUS.len()]> {
    ARCHIVES.filter(|_| takes_embedded(options, locate::around_program().as_deref()))
}

/// Whether the FMU `identifier` inside the program has a library of these bytes.
pub(super) fn has(identifier: &str, library: &[u8]) -> bool {
    let archives = ARCHIVES.iter().flatten().zip(&FMUS);
    let mut own = archives.filter(|(_, fmu)| fmu.identifier == identifier);
    own.any(|(archive, _)| has_library(archive, library))
}

fn has_library(archive: &[u8], library: &[u8]) -> bool {
    let Ok(entries) = Entries::read(archive) else { return false };
    entries.names().any(|name| name.starts_with("binaries/") && entries.bytes(name) == Some(library))
}

/// Whether the program is outside of a source tree and no other targets are asked for.
fn takes_embedded(options: &Options, around_program: Option<&Path>) -> bool {
    around_program.is_none() && options.targets.is_empty()
}

/// The archives with the added libraries, which replace those inside, and with the resources.
///
/// # Errors
/// When an archive is broken or belongs to another version of the program, or a file cannot be read.
pub(super) fn with_added(archives: [&[u8]; FMUS.len()], options: &Options) -> Result<Vec<Vec<u8>>> {
    let Options { added, resources, .. } = options;
    let parts = FMUS.iter().zip(archives).zip(DESCRIPTIONS);
    parts
        .map(|((fmu, archive), description)| {
            let mut whole = whole(fmu, archive, description, added)?;
            add_resources(fmu, resources, &mut whole)?;
            // The same entries, packed again, may get other bytes.
            if added.is_empty() && resources.is_empty() { Ok(archive.to_vec()) } else { Ok(whole.packed()?) }
        })
        .collect()
}

/// The FMU in an archive inside the program, with the added libraries.
fn whole(fmu: &FmuPackage, archive: &[u8], description: &str, added: &[AddedBinary]) -> Result<Fmu> {
    let refuse = |why: String| PackageError::Embedded { identifier: fmu.identifier, why };
    let entries = Entries::read(archive).map_err(|cause| refuse(format!("is broken: {cause}")))?;
    if entries.bytes("modelDescription.xml") != Some(description.as_bytes()) {
        return Err(refuse("has another model description; package the FMUs and compile videg again".to_owned()));
    }
    let mut whole = Fmu::new(description, "modelDescription.xml")?;
    for name in entries.names() {
        whole.entries_mut().add(name, entries.bytes(name).unwrap_or_default());
    }
    for binary in added::of(fmu.identifier, added) {
        whole.add_library_file(binary.platform, &binary.path)?;
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmu_package::Platform;

    /// A library that does not go through a packer in one piece.
    fn library() -> Vec<u8> {
        (0..200_000_u32).flat_map(|k| k.wrapping_mul(k).to_le_bytes()).collect()
    }

    /// An archive as it is packaged, as bytes.
    fn packaged(description: &str) -> Vec<u8> {
        let mut entries = Entries::default();
        entries.add("modelDescription.xml", description);
        entries.add("binaries/linux64/VibroImpactHarvester.so", library());
        entries.packed(Path::new("it.fmu")).unwrap()
    }

    #[test]
    fn archives_come_out_with_the_bytes_that_went_in() {
        let archives = DESCRIPTIONS.map(packaged);
        assert!(
            with_added(archives.each_ref().map(Vec::as_slice), &Options::default()).unwrap() == archives,
            "other bytes"
        );
    }

    #[test]
    fn a_library_inside_is_known_by_its_bytes() {
        let archive = packaged(DESCRIPTIONS[0]);
        assert!(has_library(&archive, &library()));
        assert!(!has_library(&archive, &library()[1..]), "another library");
        assert!(!has_library(&archive, DESCRIPTIONS[0].as_bytes()), "no library");
        assert!(!has_library(b"no zip", &library()));
    }

    #[test]
    fn an_added_library_joins_those_inside_or_takes_the_place_of_one() {
        let folder = tempfile::tempdir().unwrap();
        let added_library = folder.path().join("library");
        std::fs::write(&added_library, "added").unwrap();
        let archive = packaged(DESCRIPTIONS[0]);
        for (platform, wanted) in [("linux64", b"added".to_vec()), ("win64", library())] {
            let platform = Platform::of_folder(platform).unwrap();
            let binary = fmu_package::AddedBinary { platform, path: added_library.clone() };
            let added = AddedBinary { identifier: FMUS[0].identifier, binary };
            let found = whole(&FMUS[0], &archive, DESCRIPTIONS[0], &[added]).unwrap();
            let found = found.entries();
            let inside = found.bytes("binaries/linux64/VibroImpactHarvester.so");
            assert!(inside == Some(&wanted[..]), "{}", platform.folder);
            assert_eq!(found.bytes(&platform.entry(FMUS[0].identifier)), Some(&b"added"[..]));
        }
    }

    #[test]
    fn an_archive_of_other_sources_is_refused() {
        let other_guid = DESCRIPTIONS[0].replacen("guid=\"{", "guid=\"{0", 1);
        let error = whole(&FMUS[0], &packaged(&other_guid), DESCRIPTIONS[0], &[]).unwrap_err().to_string();
        assert!(
            error.starts_with("the VibroImpactHarvester.fmu inside videg has another model description"),
            "{error}"
        );
        let error = whole(&FMUS[1], b"no zip", DESCRIPTIONS[1], &[]).unwrap_err().to_string();
        assert!(error.starts_with("the HarvestingCircuit.fmu inside videg is broken: "), "{error}");
    }

    #[test]
    fn a_source_tree_or_a_target_comes_before_what_is_inside() {
        assert!(takes_embedded(&Options::default(), None));
        assert!(!takes_embedded(&Options::default(), Some(Path::new("tree"))));
        assert!(!takes_embedded(&Options { targets: vec!["win64".to_owned()], ..Options::default() }, None));
    }
}
