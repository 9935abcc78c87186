//! An FMU from anywhere: nothing leaves the folder that it is unpacked into, and what comes out keeps to the limits.

use std::fs;
use std::io::{Cursor, Write as _};
use std::path::Path;

use fmu_import::{Archive, Limits};
use zip::CompressionMethod::{Deflated, Stored};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::{Target, fmu};

pub(crate) const TARGET: Target = Target { name: "archive", check, seeds };

const UNPACKED: u64 = 1 << 20;

fn check(bytes: &[u8]) -> bool {
    let around = tempfile::tempdir().unwrap();
    let path = around.path().join("fuzzed.fmu");
    fs::write(&path, bytes).unwrap();
    let limits = Limits { unpacked_bytes: UNPACKED, description_bytes: UNPACKED, ..Limits::default() };
    let Ok(mut archive) = Archive::open_with(&path, limits) else { return false };
    let _ = archive.description();
    if let Ok(folder) = archive.unpack() {
        assert!(bytes_below(folder.path()) <= UNPACKED);
    }
    let beside = fs::read_dir(around.path()).unwrap().count();
    assert_eq!(beside, 1, "something was written beside the archive");
    true
}

/// Bytes of all files below a folder, none of which may be anything but a file or a folder.
fn bytes_below(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let sizes = entries.map(|entry| {
        let Ok(metadata) = entry.path().symlink_metadata() else { return 0 };
        assert!(metadata.is_dir() || metadata.is_file(), "{}", entry.path().display());
        if metadata.is_dir() { bytes_below(&entry.path()) } else { metadata.len() }
    });
    sizes.sum()
}

fn seeds() -> Vec<Vec<u8>> {
    let description = ("modelDescription.xml", fmu::SMALL_DESCRIPTION.as_bytes());
    let library = ("binaries/linux64/Toy.so", &[0; 300][..]);
    [&[description][..], &[description, library], &[("resources/", &[]), ("resources/a/b.txt", b"text"), description]]
        .into_iter()
        .flat_map(|entries| [Stored, Deflated].map(|method| zipped(entries, method)))
        .collect()
}

fn zipped(entries: &[(&str, &[u8])], method: zip::CompressionMethod) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method);
    for (name, content) in entries {
        match name.strip_suffix('/') {
            Some(folder) => writer.add_directory(folder, options).unwrap(),
            None => writer.start_file(*name, options).unwrap(),
        }
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}
