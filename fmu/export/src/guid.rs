//! The GUID that ties the shared library to its `modelDescription.xml`.

use core::fmt;

/// A GUID that is a hash of the interface: everything in the table and in [`ModelInfo`](crate::ModelInfo) that
/// changes what an importer may do, the version of the model included. Texts such as descriptions are not part
/// of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guid(pub(crate) u128);

impl Guid {
    /// Marks the hash as a UUID of version 8 (RFC 9562: contents defined by the implementation).
    pub(crate) const fn as_uuid(hash: u128) -> Self {
        let version = (hash & !(0xf << 76)) | (8 << 76);
        Self((version & !(0b11 << 62)) | (0b10 << 62))
    }
}

impl fmt::Display for Guid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hex = format!("{:032x}", self.0);
        let (a, b, c) = (&hex[..8], &hex[8..12], &hex[12..16]);
        write!(f, "{{{a}-{b}-{c}-{}-{}}}", &hex[16..20], &hex[20..])
    }
}
