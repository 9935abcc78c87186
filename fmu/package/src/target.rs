//! Build targets: what a user may ask for, and how it is built.

use super::error::{PackageError, Result};
use super::platform::Platform;
use super::version::FmiVersion;

/// The C library that `linux64` must run with: that of the oldest distributions which simulation tools still support.
const OLDEST_GLIBC: &str = "2.17";

/// A machine to build for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target {
    /// As Rust names it.
    pub triple: String,
    /// Version of the GNU C library to link with, when it is to be another than this machine's.
    pub glibc: Option<String>,
    /// As FMI names it.
    pub platform: Platform,
}

impl Target {
    /// Reads a platform of FMI (`linux64`, `win64`, `darwin64`) or a Rust triple, which may name a C library:
    /// `x86_64-unknown-linux-gnu.2.17`. `linux64` means binaries that run anywhere, thus an old C library.
    ///
    /// # Errors
    /// When FMI 2.0 has no name for it, or it cannot be built on this machine.
    pub fn parse(asked: &str) -> Result<Self> {
        let (triple, glibc) = match asked {
            "linux64" => ("x86_64-unknown-linux-gnu", Some(OLDEST_GLIBC)),
            "win64" => ("x86_64-pc-windows-gnu", None),
            "darwin64" if cfg!(target_arch = "x86_64") => ("x86_64-apple-darwin", None),
            "darwin64" => ("aarch64-apple-darwin", None),
            other => other.split_once('.').map_or((other, None), |(triple, glibc)| (triple, Some(glibc))),
        };
        let unknown = || PackageError::Platform { triple: asked.to_owned() };
        let platform = Platform::of_triple(triple).ok_or_else(unknown)?;
        if glibc.is_some_and(|version| !triple.contains("linux-gnu") || !is_version(version)) {
            return Err(unknown());
        }
        if platform.folder.starts_with("darwin") && !cfg!(target_os = "macos") {
            return Err(PackageError::NeedsMac { target: asked.to_owned(), platform });
        }
        Ok(Self { triple: triple.to_owned(), glibc: glibc.map(ToOwned::to_owned), platform })
    }

    /// The name that the build command gets.
    pub fn argument(&self) -> String {
        let suffix = self.glibc.as_ref().map(|version| format!(".{version}")).unwrap_or_default();
        format!("{}{suffix}", self.triple)
    }

    /// The subcommand of Cargo that builds it.
    pub fn subcommand(&self) -> &'static str {
        if self.glibc.is_some() { "zigbuild" } else { "build" }
    }
}

/// Reads the targets. Each may be named once; FMI 2.0, which does not tell machines apart, has one for each system.
///
/// # Errors
/// As [`Target::parse`], and when two are for one folder of the archive.
pub fn targets(asked: &[String], version: FmiVersion) -> Result<Vec<Target>> {
    let targets = asked.iter().map(|asked| Target::parse(asked)).collect::<Result<Vec<_>>>()?;
    for (index, target) in targets.iter().enumerate() {
        let same = |first: &&Target| match version {
            FmiVersion::Fmi2 => first.platform == target.platform,
            FmiVersion::Fmi3 => first.triple == target.triple,
        };
        if let Some(first) = targets.iter().take(index).find(same) {
            let (first, second) = (first.argument(), target.argument());
            return Err(PackageError::SamePlatform { platform: target.platform, first, second });
        }
    }
    Ok(targets)
}

fn is_version(text: &str) -> bool {
    text.split('.').all(|part| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands(asked: &str) -> (String, &'static str, &'static str) {
        let target = Target::parse(asked).unwrap();
        (target.argument(), target.subcommand(), target.platform.folder)
    }

    #[test]
    fn platforms_and_triples_are_understood() {
        let old = "x86_64-unknown-linux-gnu.2.17".to_owned();
        assert_eq!(commands("linux64"), (old.clone(), "zigbuild", "linux64"));
        assert_eq!(commands(&old), (old, "zigbuild", "linux64"));
        let plain = "aarch64-unknown-linux-gnu";
        assert_eq!(commands(plain), (plain.to_owned(), "build", "linux64"));
        assert_eq!(commands("win64"), ("x86_64-pc-windows-gnu".to_owned(), "build", "win64"));
    }

    #[test]
    fn an_archive_of_fmi_3_takes_two_machines_of_one_system() {
        let asked = |names: [&str; 2]| names.map(str::to_owned);
        let both = asked(["x86_64-unknown-linux-gnu", "aarch64-unknown-linux-gnu"]);
        assert_eq!(targets(&both, FmiVersion::Fmi3).unwrap().len(), 2);
        let error = targets(&both, FmiVersion::Fmi2).unwrap_err().to_string();
        assert!(error.starts_with("two targets for the platform linux64: "), "{error}");
        assert!(targets(&asked(["win64", "win64"]), FmiVersion::Fmi3).is_err());
    }

    #[test]
    fn what_no_tool_could_build_is_refused() {
        for asked in ["linux65", "x86_64-pc-windows-gnu.2.17", "x86_64-unknown-linux-gnu.", "wasm32-unknown-unknown"] {
            let error = Target::parse(asked).unwrap_err().to_string();
            assert!(error.starts_with(&format!("no FMI 2.0 platform for the target {asked};")), "{error}");
        }
    }

    #[test]
    #[cfg(not(target_os = "macos"))]
    fn macos_is_refused_elsewhere_and_the_way_round_is_named() {
        for asked in ["darwin64", "aarch64-apple-darwin"] {
            let error = Target::parse(asked).unwrap_err().to_string();
            assert!(error.starts_with(&format!("cannot build for {asked} on this machine")), "{error}");
            assert!(error.contains("--add-binary darwin64="), "{error}");
        }
    }
}
