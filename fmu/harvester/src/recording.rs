//! The recording that `excitation.file` names: where it is looked for, and when it is read.

use std::path::{Component, Path};
use std::sync::Arc;

use videg_input::recording::{self, Samples};
use videg_model::{ExcitationKind, Recording};

/// Variable that names the file.
pub(crate) const FILE: &str = "excitation.file";

/// Most bytes of the name of a file: more than a system takes.
pub(crate) const LONGEST: usize = 4096;

/// What a file was found to hold. Clones share it.
#[derive(Clone)]
pub(crate) struct Recorded {
    /// Name of the file as it was set; empty for none.
    pub(crate) file: Arc<str>,
    /// The recording, or why there is none.
    read: Result<Option<Recording>, Arc<str>>,
}

impl Recorded {
    /// No file.
    pub(crate) fn nothing() -> Self {
        Self { file: "".into(), read: Ok(None) }
    }

    /// Reads `file`, which may be in `resources`.
    pub(crate) fn read(file: &Arc<str>, resources: Option<&Path>) -> Self {
        let read = if file.is_empty() { Ok(None) } else { read(Path::new(&**file), resources).map(Some) };
        let named = |reason: String| format!("{FILE} = {file:?}: {reason}").into();
        Self { file: file.clone(), read: read.map_err(named) }
    }

    /// The recording, if there is one.
    pub(crate) fn recording(&self) -> Result<Option<&Recording>, &str> {
        self.read.as_ref().map(Option::as_ref).map_err(|reason| &**reason)
    }
}

/// Looks for a relative name in `resources` first, so that an FMU with its recording is the same wherever it runs.
fn read(file: &Path, resources: Option<&Path>) -> Result<Recording, String> {
    let packed = resources.filter(|folder| is_below(file) && has_files(folder)).map(|folder| folder.join(file));
    let found = packed.as_deref().filter(|path| path.exists()).unwrap_or(file);
    let samples = recording::read(found).map_err(|error| {
        let here = std::path::absolute(found).unwrap_or_else(|_| found.to_owned());
        match packed.as_deref().filter(|packed| *packed != found) {
            Some(packed) => format!("{error} (looked for as {} and {})", packed.display(), here.display()),
            None if here == file => error.to_string(),
            None => format!("{error} ({})", here.display()),
        }
    })?;
    let Samples { is_acceleration, times, values } = samples;
    let kind = if is_acceleration { ExcitationKind::Motion } else { ExcitationKind::Force };
    Recording::new(kind, times, values).map_err(|error| error.to_string())
}

/// Whether there is anything in a folder. Importers make one for FMUs without resources, too.
fn has_files(folder: &Path) -> bool {
    folder.read_dir().is_ok_and(|mut files| files.next().is_some())
}

/// Whether a path leads to a place below that from which it starts.
fn is_below(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_)))
}
