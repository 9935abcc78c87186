//! Causes: what is wrong with an archive, a description or a value.

use thiserror::Error;

/// Which safety rule an archive breaks.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum Refusal {
    /// The file is too large.
    #[error("the archive has {found} bytes, allowed are {allowed}")]
    ArchiveSize {
        /// Size of the file.
        found: u64,
        /// Bound.
        allowed: u64,
    },
    /// Too many entries.
    #[error("the archive has {found} entries, allowed are {allowed}")]
    Entries {
        /// Number of entries.
        found: usize,
        /// Bound.
        allowed: usize,
    },
    /// Its names come to too many files and folders.
    #[error("the archive has more than {allowed} files and folders")]
    Paths {
        /// Bound.
        allowed: usize,
    },
    /// The archive uses the zip64 directory.
    #[error("the archive has a zip64 directory, which only archives beyond 65535 entries or 4 GiB need")]
    Zip64,
    /// Unpacked it would be too large.
    #[error("unpacking passed {allowed} bytes at entry \"{}\"", entry.escape_debug())]
    UnpackedSize {
        /// Entry at which the bound was passed.
        entry: String,
        /// Bound.
        allowed: u64,
    },
    /// An entry inflates too much.
    #[error("entry \"{}\" inflates its {packed} bytes more than {allowed} times", entry.escape_debug())]
    Ratio {
        /// The entry.
        entry: String,
        /// Its compressed size.
        packed: u64,
        /// Bound.
        allowed: u64,
    },
    /// An entry would be written outside its folder.
    #[error("entry \"{}\" may leave the folder: {why}", entry.escape_debug())]
    Path {
        /// The entry.
        entry: String,
        /// What is wrong with its name.
        why: &'static str,
    },
    /// Two entries would be written to one place, at least where file systems do not tell case apart.
    #[error("entry \"{}\" would take the place of \"{}\"", entry.escape_debug(), other.escape_debug())]
    Collision {
        /// The later entry.
        entry: String,
        /// What was there.
        other: String,
    },
    /// Entries share a name.
    #[error("the archive lists {listed} entries with {found} different names")]
    Duplicates {
        /// Number of entries.
        listed: usize,
        /// Number of names.
        found: usize,
    },
    /// Entries share bytes.
    #[error("the entries overlap: some bytes of the archive belong to two of them")]
    Overlap,
    /// An entry is neither a file nor a folder.
    #[error("entry \"{}\" is a symbolic link or a special file", entry.escape_debug())]
    SpecialFile {
        /// The entry.
        entry: String,
    },
}

/// What is wrong with a model description.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum DescriptionError {
    /// The document is too large.
    #[error("the model description has {found} bytes, allowed are {allowed}")]
    Size {
        /// Size of the document.
        found: u64,
        /// Bound.
        allowed: u64,
    },
    /// The document is neither UTF-8 nor declared as ISO-8859-1.
    #[error("the model description is not UTF-8 (first bad byte at {position})")]
    Encoding {
        /// Position of the first byte that is not.
        position: usize,
    },
    /// The document is not well-formed.
    #[error("the model description is not well-formed XML at byte {position}: {cause}")]
    Syntax {
        /// Byte position.
        position: u64,
        /// What the parser said.
        cause: String,
    },
    /// An element or attribute stands where it must not, or a reference cannot be resolved.
    #[error("the model description cannot be read: {cause}")]
    Content {
        /// What the parser said.
        cause: String,
    },
    /// A document type declaration could define entities.
    #[error("the model description has a DOCTYPE, which is not allowed (entities are never expanded)")]
    Doctype,
    /// Elements are nested too deeply.
    #[error("the model description nests elements deeper than {allowed}")]
    Depth {
        /// Bound.
        allowed: usize,
    },
    /// An element has too many attributes.
    #[error("the model description has an element <{element}> with more than {allowed} attributes")]
    Attributes {
        /// Name of the element.
        element: String,
        /// Bound.
        allowed: usize,
    },
    /// The document has too many elements.
    #[error("the model description has more than {allowed} elements")]
    Elements {
        /// Bound.
        allowed: usize,
    },
    /// The value of an attribute is too long.
    #[error(
        "the model description has an element <{element}> whose {attribute} has {found} bytes, allowed are {allowed}"
    )]
    Value {
        /// Name of the element.
        element: String,
        /// Name of the attribute.
        attribute: String,
        /// Length of the value, bytes.
        found: usize,
        /// Bound.
        allowed: usize,
    },
    /// The root element is another one.
    #[error("the root element is <{found}>, allowed is <fmiModelDescription>")]
    Root {
        /// Name of the root element.
        found: String,
    },
    /// The FMU is of another FMI version.
    #[error("fmiVersion is \"{found}\", allowed is \"2.0\"")]
    Version {
        /// The version found.
        found: String,
    },
    /// A required attribute or element is missing.
    #[error("{place} has no {what}")]
    Missing {
        /// Where.
        place: String,
        /// The missing attribute or element.
        what: &'static str,
    },
    /// An attribute has a value that it must not have.
    #[error("{place}: {attribute} is \"{found}\", allowed is {allowed}")]
    Attribute {
        /// Where.
        place: String,
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        found: String,
        /// What it may be.
        allowed: String,
    },
    /// Two variables share a name.
    #[error("two variables are named \"{name}\"")]
    Duplicate {
        /// The name.
        name: String,
    },
}

/// Why a value does not suit its variable.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum ValueError {
    /// The variable cannot be set from outside.
    #[error("{variable} cannot be set: it is {variability} {causality}; inputs and parameters can be set")]
    NotSettable {
        /// Name of the variable.
        variable: String,
        /// Its variability.
        variability: &'static str,
        /// Its causality.
        causality: &'static str,
    },
    /// The text does not read as the type of the variable.
    #[error("{variable} = \"{}\": allowed is {allowed}", found.escape_debug())]
    Parse {
        /// Name of the variable.
        variable: String,
        /// The text.
        found: String,
        /// What would be allowed.
        allowed: String,
    },
    /// The value lies outside its bounds.
    #[error("{variable} = {found} is out of range: allowed is {allowed}")]
    Range {
        /// Name of the variable.
        variable: String,
        /// The value.
        found: String,
        /// The bounds, with the unit.
        allowed: String,
    },
    /// The value is of another type than its variable.
    #[error("{variable} is of type {wanted}, not {found}")]
    Type {
        /// Name of the variable.
        variable: String,
        /// Type of the variable.
        wanted: &'static str,
        /// Type of the value.
        found: &'static str,
    },
}
