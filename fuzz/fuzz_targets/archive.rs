//! An FMU from anywhere: nothing leaves the folder that it is unpacked into, and what comes out keeps to the limits.
#![no_main]

use std::fs;
use std::path::Path;

use videg::fmi::{Archive, Limits};

const UNPACKED: u64 = 1 << 20;

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

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(around) = tempfile::tempdir() else { return };
    let path = around.path().join("fuzzed.fmu");
    if fs::write(&path, bytes).is_err() {
        return;
    }
    let limits = Limits { unpacked_bytes: UNPACKED, description_bytes: UNPACKED, ..Limits::default() };
    let Ok(mut archive) = Archive::open_with(&path, limits) else { return };
    let _ = archive.description();
    if let Ok(folder) = archive.unpack() {
        assert!(bytes_below(folder.path()) <= UNPACKED);
    }
    let beside = fs::read_dir(around.path()).into_iter().flatten().count();
    assert_eq!(beside, 1, "something was written beside the archive");
});
