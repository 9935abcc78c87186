//! Files that parameters name: where they are looked for, and when they are read.

use std::path::{Component, Path};
use std::sync::Arc;

use videg_data::{DataError, membrane, recording};
use videg_model::{ForceTable, Recording};

/// Most bytes of the name of a file: more than a system takes.
pub(crate) const LONGEST: usize = 4096;

/// What a file may hold.
pub(crate) trait Content: Sized {
    /// Variable that names the file.
    const VARIABLE: &'static str;

    /// Reads the file at this path.
    fn read(path: &Path) -> Result<Self, DataError>;
}

impl Content for Recording {
    const VARIABLE: &'static str = "excitation.file";

    fn read(path: &Path) -> Result<Self, DataError> {
        recording::read(path)
    }
}

impl Content for ForceTable {
    const VARIABLE: &'static str = "membrane.file";

    fn read(path: &Path) -> Result<Self, DataError> {
        membrane::read(path)
    }
}

/// The files of a harvester.
#[derive(Clone)]
pub(crate) struct Files {
    /// `excitation.file`
    pub(crate) excitation: Arc<str>,
    /// `membrane.file`
    pub(crate) membrane: Arc<str>,
    /// Folder `resources` of the unpacked FMU.
    pub(crate) resources: Option<Arc<Path>>,
    /// What was read from the first file, or from one that was set before.
    pub(crate) recorded: Loaded<Recording>,
    /// The same of the second.
    pub(crate) measured: Loaded<ForceTable>,
}

impl Files {
    /// No file.
    pub(crate) fn nothing() -> Self {
        let (recorded, measured) = (Loaded::nothing(), Loaded::nothing());
        Self { excitation: "".into(), membrane: "".into(), resources: None, recorded, measured }
    }

    /// No file, but what these hold, lest it is read again.
    pub(crate) fn unnamed(&self) -> Self {
        let (recorded, measured) = (self.recorded.if_read(), self.measured.if_read());
        Self { resources: self.resources.clone(), recorded, measured, ..Self::nothing() }
    }

    /// Whether they are those that were read last.
    pub(crate) fn are_read(&self) -> bool {
        self.recorded.file == self.excitation && self.measured.file == self.membrane
    }

    /// Reads them, unless they were the last ones to be read.
    pub(crate) fn read(&mut self) {
        if self.recorded.file != self.excitation {
            self.read_recording();
        }
        if self.measured.file != self.membrane {
            self.read_table();
        }
    }

    /// Reads the first, even if it was read before.
    pub(crate) fn read_recording(&mut self) {
        self.recorded = Loaded::read(&self.excitation, self.resources.as_deref());
    }

    /// Reads the second, even if it was read before.
    pub(crate) fn read_table(&mut self) {
        self.measured = Loaded::read(&self.membrane, self.resources.as_deref());
    }

    /// The measured membrane, if it could be read.
    pub(crate) fn table(&self) -> Option<&ForceTable> {
        self.measured.content().ok().flatten()
    }
}

/// What a file was found to hold. Clones share it.
#[derive(Clone)]
pub(crate) struct Loaded<T> {
    /// Name of the file as it was set; empty for none.
    pub(crate) file: Arc<str>,
    /// The content, or why there is none.
    content: Result<Option<T>, Arc<str>>,
}

impl<T: Content> Loaded<T> {
    /// No file.
    pub(crate) fn nothing() -> Self {
        Self { file: "".into(), content: Ok(None) }
    }

    /// The same, or nothing if there is no content.
    fn if_read(&self) -> Self
    where
        T: Clone,
    {
        if self.content.is_ok() { self.clone() } else { Self::nothing() }
    }

    /// Reads `file`, which may be in `resources`.
    pub(crate) fn read(file: &Arc<str>, resources: Option<&Path>) -> Self {
        let content = if file.is_empty() { Ok(None) } else { find(Path::new(&**file), resources).map(Some) };
        let named = |reason: String| Self::named(file, reason).into();
        Self { file: file.clone(), content: content.map_err(named) }
    }

    /// A `reason` why `file` cannot be used, with the names of file and variable.
    pub(crate) fn named(file: &str, reason: impl core::fmt::Display) -> String {
        format!("{} = {file:?}: {reason}", T::VARIABLE)
    }

    /// The content, if there is one.
    pub(crate) fn content(&self) -> Result<Option<&T>, &str> {
        self.content.as_ref().map(Option::as_ref).map_err(|reason| &**reason)
    }
}

/// Looks for a relative name in `resources` first, so that an FMU with its files is the same wherever it runs.
fn find<T: Content>(file: &Path, resources: Option<&Path>) -> Result<T, String> {
    let packed = resources.filter(|folder| is_below(file) && has_files(folder)).map(|folder| folder.join(file));
    let found = packed.as_deref().filter(|path| path.exists()).unwrap_or(file);
    T::read(found).map_err(|error| {
        let here = std::path::absolute(found).unwrap_or_else(|_| found.to_owned());
        match packed.as_deref().filter(|packed| *packed != found) {
            Some(packed) => format!("{error} (looked for as {} and {})", packed.display(), here.display()),
            None if here == file => error.to_string(),
            None => format!("{error} ({})", here.display()),
        }
    })
}

/// Whether there is anything in a folder. Importers make one for FMUs without resources, too.
fn has_files(folder: &Path) -> bool {
    folder.read_dir().is_ok_and(|mut files| files.next().is_some())
}

/// Whether a path leads to a place below that from which it starts.
fn is_below(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_)))
}
