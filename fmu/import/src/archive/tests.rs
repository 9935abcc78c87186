use std::fs;
use std::io::{Cursor, Write};
use std::path::PathBuf;

use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::{Archive, Limits};
use crate::{FmiError, Fmu};

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

/// What is told of an archive that is opened, described and unpacked within `limits`.
fn refusal(bytes: &[u8], limits: Limits) -> String {
    let (_folder, path) = saved(bytes);
    let tried = Archive::open_with(&path, limits).and_then(|mut archive| {
        archive.description()?;
        archive.unpack().map(drop)
    });
    tried.unwrap_err().to_string()
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

/// The bytes with every `from` replaced by `to`, which is as long.
fn renamed(mut bytes: Vec<u8>, from: &[u8], to: &[u8]) -> Vec<u8> {
    for at in 0..bytes.len() - from.len() {
        if bytes[at..].starts_with(from) {
            bytes[at..at + from.len()].copy_from_slice(to);
        }
    }
    bytes
}

/// A good archive with further entries.
fn with(entries: &[(&str, &[u8])]) -> Vec<u8> {
    zip_bytes(&[&[("modelDescription.xml", GOOD)], entries].concat())
}

fn linked() -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    writer.add_symlink("resources", "/etc", SimpleFileOptions::default()).unwrap();
    writer.finish().unwrap().into_inner()
}

fn with_zip64_directory() -> Vec<u8> {
    let mut bytes = with(&[]);
    let end = bytes.len() - 22;
    bytes.splice(end..end, b"PK\x06\x07".iter().copied().chain([0; 16]));
    bytes
}

#[test]
fn unsafe_archives_and_those_beyond_bounds_are_refused() {
    let zeros = vec![0; 4 << 20];
    let noise: Vec<u8> = (0..200_000_u32).map(|i| i.wrapping_mul(2_654_435_761).to_be_bytes()[0]).collect();
    let bomb = [GOOD, &vec![b' '; 4 << 20]].concat();
    let any = Limits::default();
    for (bytes, limits, told) in [
        (renamed(with(&[("one", b"1"), ("two", b"2")]), b"two", b"one"), any, "lists 3 entries with 2 different names"),
        (with(&[("one", b"1"), ("ONE", b"2")]), any, "entry \"ONE\" would take the place of \"one\""),
        (linked(), any, "entry \"resources\" is a symbolic link or a special file"),
        (with_zip64_directory(), any, "the archive has a zip64 directory"),
        (with(&[("resources/zeros", &zeros)]), any, "bytes more than 100 times"),
        (zip_bytes(&[("modelDescription.xml", &bomb)]), any, "entry \"modelDescription.xml\" inflates its"),
        (
            with(&[("a", &noise), ("b", &noise)]),
            Limits { unpacked_bytes: 300_000, ..any },
            "unpacking passed 300000 bytes at entry \"b\"",
        ),
        (with(&[]), Limits { archive_bytes: 100, ..any }, "bytes, allowed are 100"),
        (with(&[("a", b""), ("b", b"")]), Limits { entries: 2, ..any }, "the archive has 3 entries, allowed are 2"),
        (with(&[]), Limits { description_bytes: 1000, ..any }, "allowed are 1000"),
    ] {
        let found = refusal(&bytes, limits);
        assert!(found.contains(told), "{told}: {found}");
    }
    for name in ["../evil", "a/../../evil", "/etc/evil", "C:/evil", "c:evil", "a\\..\\evil", "\\\\host\\evil", "a/.."] {
        let found = refusal(&with(&[(name, b"evil")]), any);
        let told = format!("entry \"{}\" may leave the folder: ", name.escape_debug());
        assert!(found.contains(&told), "{name}: {found}");
    }
}

#[test]
fn entries_that_share_bytes_or_declare_another_size_are_refused() {
    let mut shared = with(&[("b", b"some bytes")]);
    // The second header of the directory, to whose offset of 4 bytes that of the first entry is written.
    let at = shared.windows(4).rposition(|window| window == b"PK\x01\x02").unwrap() + 42;
    shared[at..at + 4].fill(0);
    let size = (4_u32 << 20) + 12_345;
    let zeros = with(&[("resources/zeros", &vec![0; size as usize])]);
    let understated = renamed(zeros, &size.to_le_bytes(), &10_u32.to_le_bytes());
    for bytes in [shared, understated] {
        let found = refusal(&bytes, Limits::default());
        assert!(found.contains("refused: ") || found.contains("not a readable FMU"), "{found}");
    }
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
fn missing_parts_and_an_identifier_that_leaves_the_folder_are_named() {
    let (_folder, path) = zipped(&[("readme.txt", b"hello")]);
    let error = Fmu::open(&path).unwrap_err().to_string();
    assert!(error.ends_with("test.fmu: the archive has no modelDescription.xml"), "{error}");
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), ("binaries/atari/Toy.prg", b"x")]);
    let error = Fmu::open(&path).unwrap_err().to_string();
    assert!(error.contains("no binary for this platform") && error.ends_with("the FMU has: atari)"), "{error}");
    let evil = String::from_utf8_lossy(GOOD).replace("modelIdentifier=\"Toy\"", "modelIdentifier=\"../../evil\"");
    let (_folder, path) = zipped(&[("modelDescription.xml", evil.as_bytes()), ("binaries/linux64/Toy.so", b"x")]);
    let error = Fmu::open(&path).unwrap_err().to_string();
    assert!(error.contains("modelIdentifier is \"../../evil\", allowed is a C identifier"), "{error}");
}

#[test]
fn a_binary_that_is_no_library_is_an_error() {
    let entry = crate::library::entry_name(crate::HOST_PLATFORM, "Toy");
    let (_folder, path) = zipped(&[("modelDescription.xml", GOOD), (&entry, b"no library")]);
    assert!(matches!(Fmu::open(&path).unwrap_err(), FmiError::Load { .. }));
}
