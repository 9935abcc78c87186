//! Platforms: from Rust's target triples to the folder names of FMI 2.0.

use fmu_import::{HOST_PLATFORM, library_extension};

/// A folder of `binaries/`. FMI 2.0 tells platforms by system and pointer size only, so an archive holds either the
/// x86-64 or the `AArch64` library of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Platform {
    /// Name of the folder.
    pub folder: &'static str,
}

impl Platform {
    /// The platform that this program runs on.
    pub const HOST: Self = Self { folder: HOST_PLATFORM };

    /// All folders that FMI 2.0 names.
    pub const FOLDERS: [&str; 6] = ["linux32", "linux64", "win32", "win64", "darwin32", "darwin64"];

    /// The platform of a target triple, such as `x86_64-unknown-linux-gnu`.
    /// None if FMI 2.0 has no name for it.
    pub fn of_triple(triple: &str) -> Option<Self> {
        let architecture = triple.split('-').next().unwrap_or_default();
        let wide = match architecture {
            "x86_64" | "aarch64" | "riscv64gc" | "powerpc64le" => true,
            "i586" | "i686" | "armv7" | "arm" => false,
            _ => return None,
        };
        let has = |part| triple.split('-').any(|other| other == part);
        let folder = match (has("linux"), has("windows"), has("darwin"), wide) {
            (true, false, false, true) => "linux64",
            (true, false, false, false) => "linux32",
            (false, true, false, true) => "win64",
            (false, true, false, false) => "win32",
            (false, false, true, true) => "darwin64",
            _ => return None,
        };
        Some(Self { folder })
    }

    /// The platform with this folder, if there is one.
    pub fn of_folder(folder: &str) -> Option<Self> {
        Self::FOLDERS.into_iter().find(|known| *known == folder).map(|folder| Self { folder })
    }

    /// Name of the library inside the archive: no `lib` in front.
    pub fn entry(self, identifier: &str) -> String {
        format!("binaries/{}/{}", self.folder, self.file_name(identifier))
    }

    /// Name of the library in the folder of its platform, in any version of FMI.
    pub fn file_name(self, identifier: &str) -> String {
        format!("{identifier}.{}", library_extension(self.folder))
    }

    /// Name that Cargo gives to the library.
    pub fn cargo_name(self, identifier: &str) -> String {
        let prefix = if self.folder.starts_with("win") { "" } else { "lib" };
        format!("{prefix}{identifier}.{}", library_extension(self.folder))
    }
}

#[cfg(test)]
mod tests {
    use super::Platform;

    #[test]
    fn triples_map_to_the_folders_of_fmi() {
        for (triple, entry, cargo) in [
            ("x86_64-unknown-linux-gnu", "binaries/linux64/Toy.so", "libToy.so"),
            ("aarch64-unknown-linux-musl", "binaries/linux64/Toy.so", "libToy.so"),
            ("i686-unknown-linux-gnu", "binaries/linux32/Toy.so", "libToy.so"),
            ("x86_64-pc-windows-gnu", "binaries/win64/Toy.dll", "Toy.dll"),
            ("i686-pc-windows-msvc", "binaries/win32/Toy.dll", "Toy.dll"),
            ("aarch64-apple-darwin", "binaries/darwin64/Toy.dylib", "libToy.dylib"),
        ] {
            let platform = Platform::of_triple(triple).unwrap();
            assert_eq!((platform.entry("Toy").as_str(), platform.cargo_name("Toy").as_str()), (entry, cargo));
        }
        assert_eq!(Platform::of_triple("wasm32-unknown-unknown"), None);
    }
}
