//! The GUID that ties the shared library to its `modelDescription.xml`.

use core::fmt;

/// A GUID that is a hash of the interface: everything in the table and in [`ModelInfo`](crate::ModelInfo) that
/// changes what an importer may do, the version of the model included. Texts such as descriptions are not part
/// of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guid(pub(crate) u128);

impl fmt::Display for Guid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hex = format!("{:032x}", self.0);
        let (a, b, c) = (&hex[..8], &hex[8..12], &hex[12..16]);
        write!(f, "{{{a}-{b}-{c}-{}-{}}}", &hex[16..20], &hex[20..])
    }
}
