use std::fs;
use std::io::{Cursor, Write};
use std::path::PathBuf;

use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::{Archive, Limits};
use crate::{FmiError, Fmu, Refusal};

const GOOD: &[u8] = include_bytes!("../testdata/good.xml");

/// A folder that lives as long as the test, and the archive in it.
fn saved(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("test.fmu");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn zipped(entries: &[(&str, &[u8])]) -> (TempDir, PathBuf) {
    saved(&zip_bytes(entries))
}

fn zip_bytes(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        writer.start_file(*name, SimpleFileOptions::default()).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn refusal(result: Result<impl Sized, FmiError>) -> Refusal {
    match result.err().unwrap() {
        FmiError::Refused { reason, .. } => reason,
        other => panic!("{other}"),
    }
}

#[test]
fn a_description_is_read_without_unpacking() {
    let (_folder, path) =
        zipped(&[("modelDescription.xml", GOOD), ("binaries/win64/Toy.dll", b"x"), ("binaries/linux64/Toy.so", b"x")]);
    let mut archive = Archive::open(&path).unwrap();
    assert_eq!(archive.description().unwrap().co_simulation.model_identifier, "Toy");
    assert_eq!(archive.platforms(), ["linux64", "win64"]);
}

#[test]
fn unpacking_gives_the_files_back_and_cleans_up() {
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), ("resources/a/b.txt", b"hello")]);
    let unpacked = Archive::open(&path).unwrap().unpack().unwrap();
    assert_eq!(fs::read(unpacked.path().join("resources/a/b.txt")).unwrap(), b"hello");
    #[cfg(unix)]
    for name in ["resources/a/b.txt", "modelDescription.xml"] {
        let found = fs::metadata(unpacked.path().join(name)).unwrap();
        let mode = std::os::unix::fs::PermissionsExt::mode(&found.permissions());
        assert_eq!(mode & 0o777, 0o600, "{name}");
    }
    let place = unpacked.path().to_path_buf();
    drop(unpacked);
    assert!(!place.exists());
}

#[test]
fn names_that_leave_the_folder_are_refused() {
    for name in ["../evil", "a/../../evil", "/etc/evil", "C:/evil", "c:evil", "a\\..\\evil", "\\\\host\\evil", "a/.."] {
        let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), (name, b"evil")]);
        let reason = refusal(Archive::open(&path));
        assert!(matches!(&reason, Refusal::Path { entry, .. } if entry == name), "{name}: {reason}");
    }
}

/// The bytes with every `from` replaced by `to`, which is as long.
fn renamed(mut bytes: Vec<u8>, from: &[u8], to: &[u8]) -> Vec<u8> {
    for at in 0..bytes.len() - from.len() {
        if bytes[at..].starts_with(from) {
            bytes[at..at + from.len()].copy_from_slice(to);
        }
    }
    bytes
}

#[test]
fn two_entries_of_one_name_are_refused() {
    let bytes = zip_bytes(&[("modelDescription.xml", GOOD), ("one", b"1"), ("two", b"2")]);
    let (_folder, path) = saved(&renamed(bytes, b"two", b"one"));
    assert_eq!(refusal(Archive::open(&path)), Refusal::Duplicates { listed: 3, found: 2 });
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), ("one", b"1"), ("ONE", b"2")]);
    assert!(matches!(refusal(Archive::open(&path)), Refusal::Collision { .. }));
}

#[test]
fn entries_that_share_bytes_are_refused() {
    let mut bytes = zip_bytes(&[("a", b"some bytes"), ("b", b"some bytes")]);
    // The second header of the directory, to whose offset of 4 bytes that of the first entry is written.
    let at = bytes.windows(4).rposition(|window| window == b"PK\x01\x02").unwrap() + 42;
    bytes[at..at + 4].fill(0);
    let (_folder, path) = saved(&bytes);
    let error = Archive::open(&path).err().unwrap();
    assert!(
        matches!(error, FmiError::Refused { reason: Refusal::Overlap, .. } | FmiError::NotAnArchive { .. }),
        "{error}"
    );
}

#[test]
fn symbolic_links_are_refused() {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    writer.add_symlink("resources", "/etc", SimpleFileOptions::default()).unwrap();
    let (_folder, path) = saved(&writer.finish().unwrap().into_inner());
    assert_eq!(refusal(Archive::open(&path)), Refusal::SpecialFile { entry: "resources".into() });
}

#[test]
fn a_bomb_is_stopped_by_its_ratio() {
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), ("resources/zeros", &vec![0; 4 << 20])]);
    let reason = refusal(Archive::open(&path).unwrap().unpack());
    assert!(matches!(reason, Refusal::Ratio { allowed: 100, .. }), "{reason}");
}

#[test]
fn a_description_that_inflates_is_stopped_by_its_ratio() {
    let bomb = [GOOD, &vec![b' '; 4 << 20]].concat();
    let (_folder, path) = zipped(&[("modelDescription.xml", &bomb)]);
    let reason = refusal(Archive::open(&path).unwrap().description());
    assert!(
        matches!(&reason, Refusal::Ratio { entry, allowed: 100, .. } if entry == "modelDescription.xml"),
        "{reason}"
    );
}

#[test]
fn a_bomb_that_declares_a_small_size_is_measured() {
    let size = (4_u32 << 20) + 12_345;
    let mut bytes = zip_bytes(&[("resources/zeros", &vec![0; size as usize])]);
    let declared = size.to_le_bytes();
    let places: Vec<_> = (0..bytes.len() - 4).filter(|&at| bytes[at..at + 4] == declared).collect();
    assert_eq!(places.len(), 2);
    for at in places {
        bytes[at..at + 4].copy_from_slice(&10_u32.to_le_bytes());
    }
    let (_folder, path) = saved(&bytes);
    let error = Archive::open(&path).unwrap().unpack().unwrap_err();
    assert!(matches!(error, FmiError::Refused { .. } | FmiError::NotAnArchive { .. }), "{error}");
}

#[test]
fn sizes_and_numbers_are_bounded() {
    let noise: Vec<u8> = (0..200_000_u32).map(|i| i.wrapping_mul(2_654_435_761).to_be_bytes()[0]).collect();
    let (_folder, path) = zipped(&[("a", &noise), ("b", &noise), ("c", b"")]);
    let opened = |limits| Archive::open_with(&path, limits);
    let reason = refusal(opened(Limits { unpacked_bytes: 300_000, ..Limits::default() }).unwrap().unpack());
    assert_eq!(reason, Refusal::UnpackedSize { entry: "b".into(), allowed: 300_000 });
    let reason = refusal(opened(Limits { archive_bytes: 100, ..Limits::default() }));
    assert!(matches!(reason, Refusal::ArchiveSize { allowed: 100, .. }));
    let reason = refusal(opened(Limits { entries: 2, ..Limits::default() }));
    assert_eq!(reason, Refusal::Entries { found: 3, allowed: 2 });
}

#[test]
fn a_zip64_directory_is_refused() {
    let mut bytes = zip_bytes(&[("modelDescription.xml", GOOD)]);
    let end = bytes.len() - 22;
    bytes.splice(end..end, b"PK\x06\x07".iter().copied().chain([0; 16]));
    let (_folder, path) = saved(&bytes);
    assert_eq!(refusal(Archive::open(&path)), Refusal::Zip64);
}

#[test]
fn an_identifier_that_leaves_the_folder_is_refused() {
    let evil = String::from_utf8_lossy(GOOD).replace("modelIdentifier=\"Toy\"", "modelIdentifier=\"../../evil\"");
    let (_folder, path) = zipped(&[("modelDescription.xml", evil.as_bytes()), ("binaries/linux64/Toy.so", b"x")]);
    let error = Fmu::open(&path).unwrap_err().to_string();
    assert!(error.contains("modelIdentifier is \"../../evil\", allowed is a C identifier"), "{error}");
}

#[test]
fn a_huge_description_is_refused_while_unpacking() {
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD)]);
    let limits = Limits { description_bytes: 1000, ..Limits::default() };
    let error = Archive::open_with(&path, limits).unwrap().description().unwrap_err().to_string();
    assert!(error.contains("allowed are 1000"), "{error}");
}

#[test]
fn files_that_are_no_fmu_are_named() {
    let (_folder, path) = saved(b"no zip at all");
    assert!(matches!(Archive::open(&path).unwrap_err(), FmiError::NotAnArchive { .. }));
    let error = Archive::open("/nowhere.fmu").unwrap_err().to_string();
    assert!(error.starts_with("cannot open /nowhere.fmu: "), "{error}");
    assert!(matches!(Archive::open(std::env::temp_dir()).unwrap_err(), FmiError::Io { .. }));
}

#[test]
fn missing_parts_are_named() {
    let (_folder, path) = zipped(&[("readme.txt", b"hello")]);
    let error = Fmu::open(&path).unwrap_err().to_string();
    assert!(error.ends_with("test.fmu: the archive has no modelDescription.xml"), "{error}");
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), ("binaries/atari/Toy.prg", b"x")]);
    let error = Fmu::open(&path).unwrap_err().to_string();
    assert!(error.contains("no binary for this platform") && error.ends_with("the FMU has: atari)"), "{error}");
}

#[test]
fn a_binary_that_is_no_library_is_an_error() {
    let entry = crate::library::entry_name(crate::HOST_PLATFORM, "Toy");
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), (&entry, b"no library")]);
    assert!(matches!(Fmu::open(&path).unwrap_err(), FmiError::Load { .. }));
}
