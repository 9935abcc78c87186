//! FMUs of FMI 3.0: the archive of FMI 2.0, whose libraries serve both, laid out as FMI 3.0 has it.

use fmu_import::ModelDescription;
use object::Architecture;
use object::read::macho::{FatArch, MachOFatFile32, MachOFatFile64};
use object::read::{File, FileKind, Object};

use super::entries::Entries;
use super::error::{PackageError, Result};
use super::{FMUS, documentation, file_name};

/// What FMI 3.0 has in place of the model description of FMI 2.0, and beside it.
struct Texts {
    description: &'static str,
    terminals: &'static str,
}

macro_rules! texts {
    ($identifier:literal) => {
        Texts {
            description: include_str!(concat!("../../modelDescription/fmi3/", $identifier, ".xml")),
            terminals: include_str!(concat!("../../modelDescription/fmi3/", $identifier, ".terminalsAndIcons.xml")),
        }
    };
}

/// In the order of [`FMUS`].
const TEXTS: [Texts; FMUS.len()] = [texts!("VibroImpactHarvester"), texts!("HarvestingCircuit")];

/// The archives of FMI 2.0, in the order of [`FMUS`], as those of FMI 3.0.
pub(super) fn converted(archives: &[Vec<u8>]) -> Result<Vec<Vec<u8>>> {
    let parts = FMUS.iter().zip(archives).zip(&TEXTS);
    parts
        .map(|((fmu, archive), texts)| {
            let refuse = |why: String| PackageError::Embedded { identifier: fmu.identifier, why };
            let archive = Entries::read(archive).map_err(|cause| refuse(format!("is broken: {cause}")))?;
            let mut entries = Entries::default();
            entries.add("modelDescription.xml", texts.description);
            entries.add("terminalsAndIcons/terminalsAndIcons.xml", texts.terminals);
            for name in archive.names() {
                let bytes = archive.bytes(name).unwrap_or_default().to_vec();
                match name.split_once('/') {
                    Some(("binaries", rest)) => {
                        let (folder, file) = rest.split_once('/').unwrap_or((rest, ""));
                        for tuple in tuples(folder, &bytes).map_err(|cause| refuse(cause.to_string()))? {
                            entries.add(&format!("binaries/{tuple}/{file}"), bytes.clone());
                        }
                    }
                    _ if matches!(name, "modelDescription.xml" | "model.png") => {}
                    _ => entries.add(name, bytes),
                }
            }
            let origin = format!("modelDescription/fmi3/{}.xml", fmu.identifier);
            documentation::add(&ModelDescription::parse(texts.description.as_bytes(), &origin)?, &mut entries)?;
            entries.packed(&file_name(fmu))
        })
        .collect()
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
