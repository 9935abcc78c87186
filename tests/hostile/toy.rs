//! FMUs to order: an archive of any entries, and a library that does what C code says.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;

use fmu_import::{HOST_PLATFORM, LIBRARY_EXTENSION};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// The model description of the toy.
pub const DESCRIPTION: &str = include_str!("description.xml");

/// An archive of these entries.
pub fn zipped(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        writer.start_file(*name, SimpleFileOptions::default()).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// Name of the library in the archive.
pub fn library_name() -> String {
    format!("binaries/{HOST_PLATFORM}/Toy.{LIBRARY_EXTENSION}")
}

/// Compiles the library with these macros, each `NAME=C code`, into `folder`.
pub fn library(folder: &Path, macros: &[&str]) -> Vec<u8> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hostile/library.c");
    let file = folder.join("compiled.so");
    let mut command = Command::new("cc");
    command.args(["-shared", "-fPIC", "-O0", "-w", "-o"]).arg(&file).arg(source);
    command.args(macros.iter().map(|it| format!("-D{it}")));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{macros:?}: {}", String::from_utf8_lossy(&output.stderr));
    let bytes = std::fs::read(&file).unwrap();
    std::fs::remove_file(file).unwrap();
    bytes
}

/// Writes an FMU whose library is compiled with these macros.
pub fn fmu(folder: &Path, name: &str, macros: &[&str]) -> PathBuf {
    described(folder, name, DESCRIPTION, macros)
}

/// The same with another description.
pub fn described(folder: &Path, name: &str, description: &str, macros: &[&str]) -> PathBuf {
    let path = folder.join(name);
    let library = library(folder, macros);
    let entries: [(&str, &[u8]); 2] = [("modelDescription.xml", description.as_bytes()), (&library_name(), &library)];
    std::fs::write(&path, zipped(&entries)).unwrap();
    path
}
