//! Bytes of a serialised FMU state: its content, in the format of postcard, and the envelope around it.
//!
//! Layout of the envelope, little-endian: magic (8 bytes), format version (u32), GUID of the FMU (16 bytes),
//! length of the content (u64), content, FNV-1a checksum of all that (u64). A blob that is foreign, truncated,
//! padded or damaged is refused before the model sees a byte of it. postcard reserves no more memory for a list than its
//! bytes justify, whatever count they claim.

use serde::{Deserialize, Serialize};

use crate::fnv::fnv64;
use crate::guid::Guid;

const MAGIC: [u8; 8] = *b"FMI2RsSt";
const FORMAT: u32 = 4;
const HEADER: usize = 8 + 4 + 16 + 8;
const CHECKSUM: usize = 8;

/// Why the bytes of a serialised state are refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// The content cannot be written or read as what it is.
    #[error("its content is malformed: {0}")]
    Malformed(#[from] postcard::Error),
    /// Bytes are left over.
    #[error("{0} bytes left over")]
    LeftOver(usize),
    /// The bytes are no serialised state.
    #[error("not a serialised FMU state (no magic number)")]
    NoMagic,
    /// A newer or older layout.
    #[error("format version {0}; known: {FORMAT}")]
    Format(u32),
    /// The state of another FMU, or of another version of this one.
    #[error("it belongs to the FMU with GUID {found}, this one has {expected}")]
    Guid {
        /// GUID in the bytes.
        found: String,
        /// GUID of this FMU.
        expected: String,
    },
    /// The size given is not the size written in the header.
    #[error("{found} bytes given, {expected} expected from its header")]
    Size {
        /// Bytes given.
        found: usize,
        /// Bytes expected.
        expected: u64,
    },
    /// The bytes changed since they were written.
    #[error("the checksum is wrong: the bytes are damaged")]
    Checksum,
    /// The bytes are intact but describe no valid state.
    #[error("{0}")]
    Invalid(String),
    /// The model cannot be serialised.
    #[error("the model does not implement it")]
    Unsupported,
}

/// Takes the state of a model as bytes.
#[derive(Debug, Default)]
pub struct StateWriter {
    bytes: Vec<u8>,
}

impl StateWriter {
    /// Writes a value, numbers with all their bits.
    ///
    /// # Errors
    /// If the value is of a kind that cannot be written, such as a list of unknown length.
    pub fn write(&mut self, value: &impl Serialize) -> Result<(), StateError> {
        self.bytes.extend(postcard::to_stdvec(value)?);
        Ok(())
    }

    /// What was written.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Gives the state of a model back, in the order in which it was written.
#[derive(Debug)]
pub struct StateReader<'a> {
    bytes: &'a [u8],
}

impl<'a> StateReader<'a> {
    /// A reader of these bytes.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    /// Reads a value.
    ///
    /// # Errors
    /// If the bytes end too early or are no such value.
    pub fn take<T: Deserialize<'a>>(&mut self) -> Result<T, StateError> {
        let (value, rest) = postcard::take_from_bytes(self.bytes)?;
        self.bytes = rest;
        Ok(value)
    }

    /// Ends reading.
    ///
    /// # Errors
    /// If bytes are left over.
    pub const fn finish(self) -> Result<(), StateError> {
        match self.bytes.len() {
            0 => Ok(()),
            left => Err(StateError::LeftOver(left)),
        }
    }
}

/// Puts content into the envelope.
pub(crate) fn seal(guid: Guid, content: &[u8]) -> Vec<u8> {
    let length = content.len() as u64;
    let header = [&MAGIC[..], &FORMAT.to_le_bytes(), &guid.0.to_le_bytes(), &length.to_le_bytes()];
    let mut bytes = [&header.concat(), content].concat();
    bytes.extend(fnv64(&bytes).to_le_bytes());
    bytes
}

/// Takes content out of the envelope.
pub(crate) fn unseal(guid: Guid, blob: &[u8]) -> Result<&[u8], StateError> {
    let size = |expected| StateError::Size { found: blob.len(), expected };
    let too_short = || size((HEADER + CHECKSUM) as u64);
    let (magic, rest) = blob.split_first_chunk().ok_or_else(too_short)?;
    let (format, rest) = rest.split_first_chunk().ok_or_else(too_short)?;
    let (found, rest) = rest.split_first_chunk().ok_or_else(too_short)?;
    let (length, rest) = rest.split_first_chunk().ok_or_else(too_short)?;
    let (content, checksum) = rest.split_last_chunk().ok_or_else(too_short)?;
    if *magic != MAGIC {
        return Err(StateError::NoMagic);
    }
    let format = u32::from_le_bytes(*format);
    if format != FORMAT {
        return Err(StateError::Format(format));
    }
    let length = u64::from_le_bytes(*length);
    if content.len() as u64 != length {
        return Err(size(length.saturating_add((HEADER + CHECKSUM) as u64)));
    }
    if u64::from_le_bytes(*checksum) != fnv64(&blob[..HEADER + content.len()]) {
        return Err(StateError::Checksum);
    }
    let found = Guid(u128::from_le_bytes(*found));
    if found != guid {
        return Err(StateError::Guid { found: found.to_string(), expected: guid.to_string() });
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back_bit_for_bit_and_nothing_else_is() {
        let value = (-0.0, vec![1.0, f64::INFINITY, 5e-324], Some(2.5), "a\0b".to_owned(), i64::MIN);
        let mut out = StateWriter::default();
        out.write(&value).unwrap();
        let bytes = out.into_bytes();
        let mut from = StateReader::new(&bytes);
        let found: (f64, Vec<f64>, Option<f64>, String, i64) = from.take().unwrap();
        assert!(found == value && found.0.is_sign_negative());
        from.finish().unwrap();
        assert!(matches!(StateReader::new(&bytes[..7]).take::<f64>(), Err(StateError::Malformed(_))));
        assert_eq!(StateReader::new(&bytes).finish(), Err(StateError::LeftOver(bytes.len())));
    }

    #[test]
    fn a_count_beyond_the_bytes_is_refused_before_memory_is_taken() {
        let mut out = StateWriter::default();
        out.write(&(u64::MAX / 8)).unwrap();
        let bytes = out.into_bytes();
        assert!(matches!(StateReader::new(&bytes).take::<Vec<f64>>(), Err(StateError::Malformed(_))));
    }

    #[test]
    fn any_changed_bit_and_any_other_length_is_refused() {
        let blob = seal(Guid(7), b"content");
        assert_eq!(unseal(Guid(7), &blob).unwrap(), b"content");
        assert!(matches!(unseal(Guid(8), &blob), Err(StateError::Guid { .. })));
        for bit in 0..blob.len() * 8 {
            let mut damaged = blob.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(unseal(Guid(7), &damaged).is_err(), "bit {bit}");
        }
        for length in 0..blob.len() {
            assert!(unseal(Guid(7), &blob[..length]).is_err(), "length {length}");
        }
        let longer = [blob.as_slice(), &[0]].concat();
        assert!(unseal(Guid(7), &longer).is_err());
    }
}
