//! An FMU that is put together: what FMI 2.0 and 3.0 want where.

use std::path::{Path, PathBuf};

use fmu_import::ModelDescription;
use object::Architecture;
use object::read::macho::{FatArch, MachOFatFile32, MachOFatFile64};
use object::read::{File, FileKind, Object};

use super::documentation::page;
use super::entries::Entries;
use super::error::{PackageError, Result};
use super::platform::Platform;
use super::shared_file::write_shared;
use super::version::FmiVersion;

/// The entries of an FMU, which begin with its model description.
#[derive(Debug)]
pub struct Fmu {
    description: ModelDescription,
    entries: Entries,
}

impl Fmu {
    /// An FMU with the model description `text`; errors name its `origin`.
    ///
    /// # Errors
    /// When that is no model description.
    pub fn new(text: impl Into<Vec<u8>>, origin: &str) -> Result<Self> {
        let text = text.into();
        let description = ModelDescription::parse(&text, origin)?;
        let mut entries = Entries::default();
        entries.add("modelDescription.xml", text);
        Ok(Self { description, entries })
    }

    /// Its model description.
    pub fn description(&self) -> &ModelDescription {
        &self.description
    }

    /// Its model identifier: the name of libraries and archive.
    pub fn identifier(&self) -> &str {
        &self.description.co_simulation.model_identifier
    }

    /// Its version of FMI.
    pub fn version(&self) -> FmiVersion {
        if self.description.is_fmi_3() { FmiVersion::Fmi3 } else { FmiVersion::Fmi2 }
    }

    /// The name of its archive.
    pub fn file_name(&self) -> PathBuf {
        PathBuf::from(format!("{}.fmu", self.identifier()))
    }

    /// All entries.
    pub fn entries(&self) -> &Entries {
        &self.entries
    }

    /// The same to be changed.
    pub fn entries_mut(&mut self) -> &mut Entries {
        &mut self.entries
    }

    /// Adds a library: in FMI 3.0 into the folder `<architecture>-<system>` of each machine that it is for.
    ///
    /// # Errors
    /// In FMI 3.0: when it is for no machine.
    pub fn add_library(&mut self, platform: Platform, library: &[u8]) -> Result<()> {
        let identifier = self.identifier().to_owned();
        match self.version() {
            FmiVersion::Fmi2 => self.entries.add(&platform.entry(&identifier), library),
            FmiVersion::Fmi3 => {
                let broken = |cause| PackageError::Machine { identifier: identifier.clone(), platform, cause };
                for tuple in tuples(platform.folder, library).map_err(broken)? {
                    let file = platform.file_name(&identifier);
                    self.entries.add(&format!("binaries/{tuple}/{file}"), library);
                }
            }
        }
        Ok(())
    }

    /// The same with the bytes of a file.
    ///
    /// # Errors
    /// When it cannot be read, and as [`add_library`](Self::add_library).
    pub fn add_library_file(&mut self, platform: Platform, file: &Path) -> Result<()> {
        self.add_library(platform, &std::fs::read(file).map_err(PackageError::io("read", file))?)
    }

    /// Adds a picture of the model, a PNG file, which tools show as its icon. FMI 3.0 wants `terminalsAndIcons.xml` to tell of it.
    pub fn add_picture(&mut self, png: impl Into<Vec<u8>>) {
        self.entries.add(picture(self.version()), png);
    }

    /// Adds the page `documentation/index.html`: what the description says about the model, `text`, which is HTML, and tables of the
    /// variables.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn add_page(&mut self, text: &str) -> Result<()> {
        let page = page(&self.description, text)?;
        self.entries.add("documentation/index.html", page);
        Ok(())
    }

    /// The bytes of the archive.
    ///
    /// # Errors
    /// When they cannot be packed.
    pub fn packed(&self) -> Result<Vec<u8>> {
        self.entries.packed(&self.file_name())
    }

    /// Writes the archive into `folder`, atomically, and returns its path.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf> {
        let path = folder.join(self.file_name());
        write_shared(&path, &self.packed()?)?;
        Ok(path)
    }
}

/// The name of a picture of the model in an archive.
pub(crate) fn picture(version: FmiVersion) -> &'static str {
    match version {
        FmiVersion::Fmi2 => "model.png",
        FmiVersion::Fmi3 => "terminalsAndIcons/icon.png",
    }
}

/// The folders of FMI 3.0, `<architecture>-<system>`, for a library that FMI 2.0 has in `folder`. One for several machines
/// goes into the folder of each.
fn tuples(folder: &str, library: &[u8]) -> object::read::Result<Vec<String>> {
    let machines = match FileKind::parse(library)? {
        FileKind::MachOFat32 => machines(MachOFatFile32::parse(library)?.arches()),
        FileKind::MachOFat64 => machines(MachOFatFile64::parse(library)?.arches()),
        _ => vec![File::parse(library)?.architecture()],
    };
    let system = match folder.trim_end_matches(|digit: char| digit.is_ascii_digit()) {
        "win" => "windows",
        other => other,
    };
    Ok(machines.into_iter().map(|machine| format!("{}-{system}", architecture(machine))).collect())
}
fn machines<Arch: FatArch>(parts: &[Arch]) -> Vec<Architecture> {
    parts.iter().map(FatArch::architecture).collect()
}

/// Names of FMI 3.0, section 2.5.1.4.1; others as the compilers of Rust have them.
fn architecture(machine: Architecture) -> String {
    match machine {
        Architecture::X86_64 => "x86_64".to_owned(),
        Architecture::I386 => "x86".to_owned(),
        Architecture::Aarch64 => "aarch64".to_owned(),
        Architecture::Arm => "aarch32".to_owned(),
        Architecture::Riscv64 => "riscv64".to_owned(),
        other => format!("{other:?}").to_lowercase(),
    }
}

#[cfg(test)]
mod tests {
    use super::tuples;

    /// A file that is nothing but the head of a library for this machine.
    fn elf(machine: u16) -> Vec<u8> {
        let mut bytes = vec![0; 64];
        bytes[..7].copy_from_slice(b"\x7fELF\x02\x01\x01");
        bytes[16] = 3;
        bytes[18..20].copy_from_slice(&machine.to_le_bytes());
        bytes[20] = 1;
        bytes[52] = 64;
        bytes
    }

    #[test]
    fn folders_are_named_after_machine_and_system() {
        for (folder, machine, tuple) in [
            ("linux64", 62, "x86_64-linux"),
            ("linux64", 183, "aarch64-linux"),
            ("linux64", 243, "riscv64-linux"),
            ("win64", 62, "x86_64-windows"),
            ("darwin64", 183, "aarch64-darwin"),
        ] {
            assert_eq!(tuples(folder, &elf(machine)).unwrap(), [tuple]);
        }
        assert!(tuples("linux64", b"no library").is_err());
    }
}
