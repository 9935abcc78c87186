//! Libraries for these tests are put together by hand: a Mach-O file needs but a header and a table of symbols.

use super::*;

const X86_64: u32 = 0x0100_0007;
const ARM64: u32 = 0x0100_000c;
const LIBRARY: u32 = 6;
const PROGRAM: u32 = 2;

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// A Mach-O file of 64 bits that exports one symbol.
fn mach_o(machine: u32, kind: u32, symbol: &str) -> Vec<u8> {
    const SYMBOLS: u32 = 32 + 24 + 80;
    let names = format!("\0{symbol}\0");
    let length = u32::try_from(names.len()).unwrap();
    // Header; LC_SYMTAB; LC_DYSYMTAB, which says that symbol 0 is an exported one.
    let mut file = words(&[0xfeed_facf, machine, 3, kind, 2, 24 + 80, 0, 0]);
    file.extend(words(&[2, 24, SYMBOLS, 1, SYMBOLS + 16, length]));
    file.extend(words(&[0xb, 80, 0, 0, 0, 1]));
    file.extend(words(&[0; 14]));
    // The symbol: name at 1, external, absolute, since there are no sections.
    file.extend(words(&[1]));
    file.extend([0x03, 0, 0, 0]);
    file.extend(words(&[0, 0]));
    file.extend(names.into_bytes());
    file
}

/// A file with one part for each machine.
fn fat(parts: &[(u32, Vec<u8>)]) -> Vec<u8> {
    let big = |words: &[u32]| words.iter().flat_map(|word| word.to_be_bytes()).collect::<Vec<_>>();
    let mut file = big(&[0xcafe_babe, u32::try_from(parts.len()).unwrap()]);
    let mut offset = 4096;
    for (machine, part) in parts {
        file.extend(big(&[*machine, 3, offset, u32::try_from(part.len()).unwrap(), 12]));
        offset += 4096;
    }
    for (index, (_, part)) in parts.iter().enumerate() {
        file.resize((index + 1) * 4096, 0);
        file.extend(part);
    }
    file
}

/// What adding a file of this name and content for a platform gives.
fn add(platform: &str, name: &str, content: &[u8]) -> std::result::Result<AddedBinary, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    AddedBinary::parse(&format!("{platform}={}", path.display()), FmiVersion::Fmi2).map_err(|error| error.to_string())
}

const NAME: &str = "libLag.dylib";

#[test]
fn a_library_for_either_mac_or_both_is_taken() {
    let (intel, arm) = (mach_o(X86_64, LIBRARY, "_fmi2Instantiate"), mach_o(ARM64, LIBRARY, "_fmi2Instantiate"));
    for content in [intel.clone(), arm.clone(), fat(&[(X86_64, intel), (ARM64, arm)])] {
        let added = add("darwin64", NAME, &content).unwrap();
        assert_eq!(added.platform.folder, "darwin64");
    }
}

#[test]
fn a_library_of_another_system_or_machine_is_refused() {
    let library = mach_o(X86_64, LIBRARY, "_fmi2Instantiate");
    let error = add("win64", NAME, &library).unwrap_err();
    assert!(error.ends_with("holds a macOS (Mach-O) file of 64 bits for X86_64, wanted is a win64 library"), "{error}");
    let error = add("darwin64", NAME, &mach_o(0x0100_0012, LIBRARY, "_fmi2Instantiate")).unwrap_err();
    assert!(error.contains("for PowerPc64, wanted is a darwin64 library"), "{error}");
    let mixed = fat(&[(X86_64, library), (X86_64, mach_o(0x0100_0012, LIBRARY, "_fmi2Instantiate"))]);
    assert!(add("darwin64", NAME, &mixed).is_err());
    assert!(add("darwin64", NAME, &fat(&[])).is_err());
}

#[test]
fn what_is_no_fmu_library_is_refused() {
    let error = add("darwin64", NAME, b"#!/bin/sh\nexit 1\n # of some length").unwrap_err();
    assert!(error.contains("holds no library at all, wanted is a darwin64 library"), "{error}");
    let error = add("darwin64", NAME, &mach_o(X86_64, PROGRAM, "_fmi2Instantiate")).unwrap_err();
    assert!(error.contains("holds no shared library (Executable)"), "{error}");
    let error = add("darwin64", NAME, &mach_o(X86_64, LIBRARY, "_fmi2InstantiateToo")).unwrap_err();
    assert!(error.ends_with("does not export fmi2Instantiate"), "{error}");
    let library = mach_o(X86_64, LIBRARY, "_fmi2Instantiate");
    for length in 0..library.len() {
        assert!(add("darwin64", NAME, &library[..length]).is_err(), "cut to {length} bytes");
    }
}

#[test]
fn the_argument_names_platform_and_file() {
    let library = mach_o(X86_64, LIBRARY, "_fmi2Instantiate");
    let error = add("macos", NAME, &library).unwrap_err();
    assert!(error.starts_with("no platform of FMI 2.0 is called \"macos\"; allowed are linux32, "), "{error}");
    let error = AddedBinary::parse("libLag.dylib", FmiVersion::Fmi2).unwrap_err().to_string();
    assert_eq!(error, "--add-binary wants PLATFORM=FILE, found \"libLag.dylib\"");
}

#[test]
fn a_platform_has_one_library() {
    let added = |platform: &str, path: &str| AddedBinary {
        platform: Platform::of_folder(platform).unwrap(),
        path: PathBuf::from(path),
    };
    let check = |added: &[AddedBinary], targets: &[Target]| {
        AddedBinary::check_all("Lag", added, targets).map_err(|error| error.to_string())
    };
    let both = [added("win64", "a.dll"), added("linux64", "b.so")];
    assert_eq!(check(&both, &[]), Ok(()));
    let twice = [added("win64", "a.dll"), added("win64", "b.dll")];
    assert_eq!(check(&twice, &[]), Err("two libraries of Lag for win64: b.dll and a.dll".to_owned()));
    let target = Target::parse("win64").unwrap();
    let said = "two libraries of Lag for win64: a.dll and the target x86_64-pc-windows-gnu";
    assert_eq!(check(&both, &[target]), Err(said.to_owned()));
}
