//! The contents of an FMU.

use std::fs;
use std::path::Path;

use super::entries::Entries;
use super::error::{PackageError, Result};
use super::platform::Platform;
use fmu_import::ModelDescription;

/// What goes into an FMU.
#[derive(Debug, Clone)]
pub struct Contents {
    description: ModelDescription,
    /// The entries of the archive.
    pub entries: Entries,
}

impl Contents {
    /// Begins with the model description at `description`, after reading it.
    ///
    /// # Errors
    /// When it cannot be used, or belongs to another model than `identifier`.
    pub fn new(identifier: &str, description: &Path) -> Result<Self> {
        let text = fs::read(description).map_err(PackageError::io("read", description))?;
        let parsed = ModelDescription::parse(&text, &description.display().to_string())?;
        let found = &parsed.co_simulation.model_identifier;
        if found != identifier {
            let found = found.clone();
            let (path, allowed) = (description.to_path_buf(), identifier.to_owned());
            return Err(PackageError::Identifier { path, found, allowed });
        }
        let mut entries = Entries::default();
        entries.add_bytes("modelDescription.xml", text);
        Ok(Self { description: parsed, entries })
    }

    /// The model description.
    pub fn description(&self) -> &ModelDescription {
        &self.description
    }

    /// Adds the library of a platform, under the name that FMI wants.
    pub fn add_library(&mut self, platform: Platform, library: &Path) {
        let name = platform.entry(&self.description.co_simulation.model_identifier);
        self.entries.add_file(&name, library);
    }
}
