//! Libraries that were built elsewhere: checks before they go into an archive.

use std::path::PathBuf;

use object::read::macho::{FatArch, MachOFatFile32, MachOFatFile64};
use object::read::{File, FileKind, NameOrOrdinal, Object, ObjectKind};
use object::{Architecture, BinaryFormat};

use super::error::PackageError;
use super::platform::Platform;
use super::target::Target;
use super::version::FmiVersion;

/// The function that makes a library that of an FMU for co-simulation.
fn entry_point(version: FmiVersion) -> &'static str {
    match version {
        FmiVersion::Fmi2 => "fmi2Instantiate",
        FmiVersion::Fmi3 => "fmi3InstantiateCoSimulation",
    }
}

/// A library that was built elsewhere, and where it belongs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AddedBinary {
    /// The platform that it runs on.
    pub platform: Platform,
    /// The file.
    pub path: PathBuf,
}

impl AddedBinary {
    /// Reads `PLATFORM=PATH`, such as `darwin64=libLag.dylib`, and checks that the file is what it is said to be: a library of some FMU
    /// of this version. Whether it is that of the same model shows at instantiation only.
    ///
    /// # Errors
    /// When the platform is unknown, or the file is no such library.
    pub fn parse(text: &str, version: FmiVersion) -> Result<Self, PackageError> {
        let Some((platform, path)) = text.split_once('=').filter(|(_, path)| !path.is_empty()) else {
            return Err(PackageError::AddedForm { found: text.to_owned() });
        };
        let platform = Platform::of_folder(platform).ok_or_else(|| {
            let (found, allowed) = (platform.to_owned(), Platform::FOLDERS.join(", "));
            PackageError::PlatformName { found, allowed }
        })?;
        let path = PathBuf::from(path);
        let data = videg_input::read(&path).map_err(PackageError::io("read", &path))?;
        match check(&data, platform, entry_point(version)) {
            Ok(()) => Ok(Self { platform, path }),
            Err(Fault::Is(found)) => Err(PackageError::AddedLibrary { path, found, platform }),
            Err(Fault::NoEntryPoint) => Err(PackageError::AddedExport { path, symbol: entry_point(version) }),
        }
    }

    /// Refuses two libraries of the FMU `identifier` for one platform.
    ///
    /// # Errors
    /// When two of `added` are for one platform, or one is for that of a target.
    pub fn check_all(identifier: &str, added: &[Self], targets: &[Target]) -> Result<(), PackageError> {
        for (index, Self { platform, path }) in added.iter().enumerate() {
            let twin = added.iter().take(index).find(|it| it.platform == *platform);
            let target = targets.iter().find(|target| target.platform == *platform);
            let other = twin.map(|twin| twin.path.display().to_string());
            if let Some(other) = other.or_else(|| target.map(|target| format!("the target {}", target.argument()))) {
                let (identifier, path) = (identifier.to_owned(), path.clone());
                return Err(PackageError::AddedTwice { identifier, platform: *platform, path, other });
            }
        }
        Ok(())
    }
}

/// Why a file is no library of an FMU.
enum Fault {
    /// It is something else.
    Is(String),
    NoEntryPoint,
}

impl From<object::read::Error> for Fault {
    fn from(cause: object::read::Error) -> Self {
        Self::Is(format!("a broken file ({cause})"))
    }
}

/// Checks that `data` is a shared library of the platform with the functions of an FMU.
fn check(data: &[u8], platform: Platform, symbol: &str) -> Result<(), Fault> {
    let kind = FileKind::parse(data).map_err(|_| Fault::Is("no library at all".to_owned()))?;
    match kind {
        FileKind::MachOFat32 => check_parts(MachOFatFile32::parse(data)?.arches(), data, platform, symbol),
        FileKind::MachOFat64 => check_parts(MachOFatFile64::parse(data)?.arches(), data, platform, symbol),
        FileKind::Elf32 | FileKind::Elf64 | FileKind::MachO32 | FileKind::MachO64 | FileKind::Pe32 | FileKind::Pe64 => {
            check_file(&File::parse(data)?, platform, symbol)
        }
        other => Err(Fault::Is(format!("a file of another kind ({other:?})"))),
    }
}

/// One file for several machines: each part counts.
fn check_parts<Arch: FatArch>(parts: &[Arch], data: &[u8], platform: Platform, symbol: &str) -> Result<(), Fault> {
    if parts.is_empty() {
        return Err(Fault::Is("a Mach-O file of no machine".to_owned()));
    }
    parts.iter().try_for_each(|part| check_file(&File::parse(part.data(data)?)?, platform, symbol))
}

fn check_file(file: &File<'_>, platform: Platform, symbol: &str) -> Result<(), Fault> {
    let (format, machine) = (file.format(), file.architecture());
    if format != format_of(platform) || !machines_of(platform).contains(&machine) {
        let bits = if file.is_64() { 64 } else { 32 };
        return Err(Fault::Is(format!("a {} file of {bits} bits for {machine:?}", format_name(format))));
    }
    if file.kind() != ObjectKind::Dynamic {
        return Err(Fault::Is(format!("no shared library ({:?})", file.kind())));
    }
    let is_there = file.exports()?.any(|export| export.is_ok_and(|export| is_named(export.name(), symbol)));
    if is_there { Ok(()) } else { Err(Fault::NoEntryPoint) }
}

fn is_named(name: NameOrOrdinal<&[u8]>, symbol: &str) -> bool {
    // C names begin with an underscore on macOS.
    matches!(name, NameOrOrdinal::Name(name) if name.strip_prefix(b"_").unwrap_or(name) == symbol.as_bytes())
}

fn format_of(platform: Platform) -> BinaryFormat {
    match platform.folder.as_bytes() {
        [b'w', ..] => BinaryFormat::Pe,
        [b'd', ..] => BinaryFormat::MachO,
        _ => BinaryFormat::Elf,
    }
}

/// FMI 2.0 tells no machines apart, and tools on ARM look into the same folders.
fn machines_of(platform: Platform) -> &'static [Architecture] {
    if platform.folder.ends_with("64") {
        &[Architecture::X86_64, Architecture::Aarch64]
    } else {
        &[Architecture::I386, Architecture::Arm]
    }
}

fn format_name(format: BinaryFormat) -> &'static str {
    match format {
        BinaryFormat::Elf => "Linux (ELF)",
        BinaryFormat::Pe => "Windows (PE)",
        BinaryFormat::MachO => "macOS (Mach-O)",
        _ => "foreign",
    }
}

#[cfg(test)]
#[path = "binary_tests.rs"]
mod tests;
