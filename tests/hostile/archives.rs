//! Archives that are no FMUs, or want out of their folder, or want to fill the disk.

use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::sandbox::{Input, refused};
use super::toy::{DESCRIPTION, library_name, zipped};

/// An archive with a good description and one more entry.
fn with(name: &str, content: &[u8]) -> Vec<u8> {
    zipped(&[("modelDescription.xml", DESCRIPTION.as_bytes()), (&library_name(), b"x"), (name, content)])
}

fn check(what: &'static str, bytes: Vec<u8>) -> Input {
    refused(what, &["fmu", "check", "toy.fmu"], vec![("toy.fmu", bytes)])
}

fn renamed(mut bytes: Vec<u8>, from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    for at in 0..bytes.len() - from.len() {
        if bytes[at..].starts_with(from) {
            bytes[at..at + from.len()].copy_from_slice(to);
        }
    }
    bytes
}

fn linked() -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    writer.start_file("modelDescription.xml", SimpleFileOptions::default()).unwrap();
    writer.write_all(DESCRIPTION.as_bytes()).unwrap();
    writer.add_symlink("resources", "/etc", SimpleFileOptions::default()).unwrap();
    writer.finish().unwrap().into_inner()
}

/// Two entries of the directory that point to one place.
fn overlapping() -> Vec<u8> {
    let mut bytes = with("resources/two", b"twice the same");
    let last = bytes.windows(4).rposition(|window| window == b"PK\x01\x02").unwrap();
    let first = bytes.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    let offset = bytes[first + 42..first + 46].to_vec();
    bytes[last + 42..last + 46].copy_from_slice(&offset);
    bytes
}

/// An entry that announces 10 bytes and unpacks to 4 MiB.
fn understated() -> Vec<u8> {
    let size = (4_usize << 20) + 12_345;
    let bytes = with("resources/zeros", &vec![0; size]);
    renamed(bytes, &u32::try_from(size).unwrap().to_le_bytes(), &10_u32.to_le_bytes())
}

fn zip64() -> Vec<u8> {
    let mut bytes = with("resources/a", b"");
    let end = bytes.len() - 22;
    bytes.splice(end..end, b"PK\x06\x07".iter().copied().chain([0; 16]));
    bytes
}

fn many_entries() -> Vec<u8> {
    let names: Vec<_> = (0..10_001).map(|k| format!("resources/{k}")).collect();
    let entries: Vec<_> = names.iter().map(|name| (name.as_str(), &b""[..])).collect();
    zipped(&entries)
}

/// Names that come to 279,000 folders.
fn many_folders() -> Vec<u8> {
    let names: Vec<_> = (0..9000).map(|k| format!("{k}/{}", "x/".repeat(30))).collect();
    let entries: Vec<_> = names.iter().map(|name| (name.as_str(), &b""[..])).collect();
    zipped(&entries)
}

fn truncated() -> Vec<u8> {
    let mut bytes = with("resources/a", b"some text");
    bytes.truncate(bytes.len() / 2);
    bytes
}

fn flipped() -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, text) in [("modelDescription.xml", DESCRIPTION), (&library_name(), "a library, or nearly so")] {
        writer.start_file(name, stored).unwrap();
        writer.write_all(text.as_bytes()).unwrap();
    }
    let mut bytes = writer.finish().unwrap().into_inner();
    let at = bytes.windows(9).position(|window| window == b"a library").unwrap();
    bytes[at] ^= 0x55;
    bytes
}

/// All of them.
pub fn inputs() -> Vec<Input> {
    let mut inputs = vec![
        refused("a file that is not there", &["fmu", "check", "toy.fmu"], Vec::new()),
        refused("a folder in place of a file", &["fmu", "check", "out"], Vec::new()),
        check("no archive at all", b"no zip at all".to_vec()),
        check("an empty file", Vec::new()),
        check("half of an archive", truncated()),
        check("a byte changed in the library", flipped()),
        check("no model description", zipped(&[("readme.txt", b"hello")])),
        check("no library for this machine", zipped(&[("modelDescription.xml", DESCRIPTION.as_bytes())])),
        check("a bomb: 32 MiB of zeros", with("resources/zeros", &vec![0; 32 << 20])),
        check("a bomb that announces 10 bytes", understated()),
        check("10001 entries", many_entries()),
        check("9000 entries in 279,000 folders", many_folders()),
        check("a name of 499 parts", with(&"x/".repeat(499), b"")),
        check("a zip64 directory", zip64()),
        check("a symbolic link", linked()),
        check("two entries that share their bytes", overlapping()),
        check("two names that differ in case", with("MODELDESCRIPTION.XML", b"another")),
        check("a file in the place of a folder", with("binaries", b"a file")),
        check("a name of 2000 bytes", with(&"x/".repeat(1000), b"")),
    ];
    let twice = zipped(&[("modelDescription.xml", DESCRIPTION.as_bytes()), ("aaa", b"1"), ("bbb", b"2")]);
    inputs.push(check("two entries of one name", renamed(twice, b"bbb", b"aaa")));
    let names = [
        ("a name that climbs", "../canary"),
        ("a name that climbs later", "resources/../../canary"),
        ("an absolute name", "/canary"),
        ("a drive letter", "C:/canary"),
        ("a backslash", "..\\canary"),
        ("a name on a server", "\\\\host\\canary"),
        ("a zero byte in a name", "resources/a\0b"),
        ("an end of line in a name", "resources/a\nb"),
        ("a stream of a file on Windows", "resources/a:b"),
        ("a device on Windows", "resources/NUL.txt"),
        ("a blank at the end, which Windows drops", "resources/a "),
    ];
    inputs.extend(names.map(|(what, name)| check(what, with(name, b"evil"))));
    let info = vec![("toy.fmu", with("../canary", b"evil"))];
    inputs.push(refused("a name that climbs, only looked at", &["fmu", "info", "toy.fmu"], info));
    inputs
}
