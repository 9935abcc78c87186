//! Libraries of this project's FMUs that were built elsewhere.

use fmu_package::FmiVersion;

use super::FMUS;
use super::error::{PackageError, Result};

/// A library that was built elsewhere, and where it belongs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AddedBinary {
    /// Model identifier of its FMU.
    pub identifier: &'static str,
    /// File and platform.
    pub binary: fmu_package::AddedBinary,
}

impl AddedBinary {
    /// Reads `PLATFORM=PATH`, such as `darwin64=libVibroImpactHarvester.dylib`, and checks that the file is what it is
    /// said to be. The file's name tells the FMU: it holds the model identifier.
    ///
    /// # Errors
    /// When the platform is unknown, the name tells no FMU, or the file is no such library.
    pub fn parse(text: &str) -> Result<Self> {
        let binary = fmu_package::AddedBinary::parse(text, FmiVersion::Fmi2)?;
        let name = binary.path.file_name().unwrap_or_default().to_string_lossy();
        let identifier = FMUS.iter().map(|fmu| fmu.identifier).find(|identifier| name.contains(identifier));
        let identifier = identifier.ok_or_else(|| PackageError::AddedName { path: binary.path.clone() })?;
        Ok(Self { identifier, binary })
    }
}

/// Those of one FMU.
pub(super) fn of(identifier: &str, added: &[AddedBinary]) -> Vec<fmu_package::AddedBinary> {
    added.iter().filter(|it| it.identifier == identifier).map(|it| it.binary.clone()).collect()
}
