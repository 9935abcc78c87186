//! Causes: faults of an archive, a description or a value.

use thiserror::Error;

/// Which safety rule an archive breaks.
#[derive(Debug, Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum Refusal {
    /// The file is too large.
    #[error("the archive has {found} bytes, allowed are {allowed}")]
    ArchiveSize { found: u64, allowed: u64 },
    /// Too many entries.
    #[error("the archive has {found} entries, allowed are {allowed}")]
    Entries { found: usize, allowed: usize },
    /// Its names come to too many files and folders.
    #[error("the archive has more than {allowed} files and folders")]
    Paths { allowed: usize },
    /// The archive uses the zip64 directory.
    #[error("the archive has a zip64 directory, which only archives beyond 65535 entries or 4 GiB need")]
    Zip64,
    /// Unpacked it would be too large.
    #[error("unpacking passed {allowed} bytes at entry \"{}\"", entry.escape_debug())]
    UnpackedSize { entry: String, allowed: u64 },
    /// An entry inflates too much.
    #[error("entry \"{}\" inflates its {packed} bytes more than {allowed} times", entry.escape_debug())]
    Ratio { entry: String, packed: u64, allowed: u64 },
    /// An entry would be written outside its folder.
    #[error("entry \"{}\" may leave the folder: {why}", entry.escape_debug())]
    Path { entry: String, why: &'static str },
    /// Two entries would be written to one place, at least where file systems do not tell case apart.
    #[error("entry \"{}\" would take the place of \"{}\"", entry.escape_debug(), other.escape_debug())]
    Collision { entry: String, other: String },
    /// Entries share a name.
    #[error("the archive lists {listed} entries with {found} different names")]
    Duplicates { listed: usize, found: usize },
    /// Entries share bytes.
    #[error("the entries overlap: some bytes of the archive belong to two of them")]
    Overlap,
    /// An entry is neither a file nor a folder.
    #[error("entry \"{}\" is a symbolic link or a special file", entry.escape_debug())]
    SpecialFile { entry: String },
}

/// What is wrong with a model description.
#[derive(Debug, Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum DescriptionError {
    /// The document is too large.
    #[error("the model description has {found} bytes, allowed are {allowed}")]
    Size { found: u64, allowed: u64 },
    /// The document is neither UTF-8 nor declared as ISO-8859-1.
    #[error("the model description is not UTF-8 (first bad byte at {position})")]
    Encoding { position: usize },
    /// The document is not well-formed.
    #[error("the model description is not well-formed XML at byte {position}: {cause}")]
    Syntax { position: u64, cause: String },
    /// An element or attribute stands where it must not, or a reference cannot be resolved.
    #[error("the model description cannot be read: {cause}")]
    Content { cause: String },
    /// A document type declaration could define entities.
    #[error("the model description has a DOCTYPE, which is not allowed (entities are never expanded)")]
    Doctype,
    /// Elements are nested too deeply.
    #[error("the model description nests elements deeper than {allowed}")]
    Depth { allowed: usize },
    /// An element has too many attributes.
    #[error("the model description has an element <{element}> with more than {allowed} attributes")]
    Attributes { element: String, allowed: usize },
    /// The document has too many elements.
    #[error("the model description has more than {allowed} elements")]
    Elements { allowed: usize },
    /// The value of an attribute is too long.
    #[error(
        "the model description has an element <{element}> whose {attribute} has {found} bytes, allowed are {allowed}"
    )]
    Value { element: String, attribute: String, found: usize, allowed: usize },
    /// The root element is another one.
    #[error("the root element is <{found}>, allowed is <fmiModelDescription>")]
    Root { found: String },
    /// The FMU is of another FMI version.
    #[error("fmiVersion is \"{found}\", allowed is \"2.0\"")]
    Version { found: String },
    /// A required attribute or element is missing.
    #[error("{place} has no {what}")]
    Missing { place: String, what: &'static str },
    /// An attribute has a value that it must not have.
    #[error("{place}: {attribute} is \"{found}\", allowed is {allowed}")]
    Attribute { place: String, attribute: &'static str, found: String, allowed: String },
    /// Two variables share a name.
    #[error("two variables are named \"{name}\"")]
    Duplicate { name: String },
}

/// Why a value does not suit its variable.
#[derive(Debug, Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ValueError {
    /// The variable cannot be set from outside.
    #[error("{variable} cannot be set: it is {variability} {causality}; inputs and parameters can be set")]
    NotSettable { variable: String, variability: &'static str, causality: &'static str },
    /// The text does not read as the type of the variable.
    #[error("{variable} = \"{}\": allowed is {allowed}", found.escape_debug())]
    Parse { variable: String, found: String, allowed: String },
    /// The value lies outside its bounds.
    #[error("{variable} = {found} is out of range: allowed is {allowed}")]
    Range { variable: String, found: String, allowed: String },
    /// The value is of another type than its variable.
    #[error("{variable} is of type {wanted}, not {found}")]
    Type { variable: String, wanted: &'static str, found: &'static str },
}
