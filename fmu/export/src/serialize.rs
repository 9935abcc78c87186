//! Bytes of a serialised FMU state: a writer, a bounds-checked reader and the envelope around both.
//!
//! Layout of the envelope, little-endian: magic (8 bytes), format version (u32), GUID of the FMU (16 bytes),
//! length of the content (u64), content, FNV-1a checksum of all that (u64). A blob that is foreign, truncated,
//! padded or damaged is refused before the model sees a byte of it.

use crate::fnv::fnv64;
use crate::guid::Guid;

const MAGIC: [u8; 8] = *b"FMI2RsSt";
const FORMAT: u32 = 1;
const HEADER: usize = 8 + 4 + 16 + 8;
const CHECKSUM: usize = 8;

/// Why the bytes of a serialised state are refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// The bytes end too early.
    #[error("{wanted} bytes wanted at offset {offset}, {left} left")]
    Truncated {
        /// Where reading stopped, from the start of the content.
        offset: usize,
        /// How many bytes were wanted.
        wanted: usize,
        /// How many there were.
        left: usize,
    },
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

/// Gives the state of a model back, in the order in which it was written.
#[derive(Debug)]
pub struct StateReader<'a> {
    bytes: &'a [u8],
    offset: usize,
}

macro_rules! numbers {
    ($($name:ident)*) => {
        impl StateWriter {
            $(#[doc = concat!("Writes one `", stringify!($name), "`, bit for bit.")]
            pub fn $name(&mut self, value: $name) {
                self.bytes.extend_from_slice(&value.to_le_bytes());
            })*
        }
        impl StateReader<'_> {
            $(#[doc = concat!("Reads one `", stringify!($name), "`.")]
            ///
            /// # Errors
            /// If the bytes end too early.
            pub fn $name(&mut self) -> Result<$name, StateError> {
                self.array().map($name::from_le_bytes)
            })*
        }
    };
}
numbers!(u8 u32 i32 u64 i64 u128 f64);

impl StateWriter {
    /// A writer with nothing in it.
    pub fn new() -> Self {
        Self::default()
    }

    /// What was written.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Writes a bool.
    pub fn bool(&mut self, value: bool) {
        self.u8(u8::from(value));
    }

    /// Writes a length or count.
    pub fn len(&mut self, value: usize) {
        self.u64(value as u64);
    }

    /// Writes a string.
    pub fn str(&mut self, value: &str) {
        self.len(value.len());
        self.bytes.extend_from_slice(value.as_bytes());
    }

    /// Writes an optional number.
    pub fn option_f64(&mut self, value: Option<f64>) {
        self.bool(value.is_some());
        self.f64(value.unwrap_or_default());
    }

    /// Writes a list of numbers.
    pub fn f64s(&mut self, values: &[f64]) {
        self.len(values.len());
        for &value in values {
            self.f64(value);
        }
    }
}

impl<'a> StateReader<'a> {
    /// A reader of these bytes.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, offset: 0 }
    }

    /// Reads a bool.
    ///
    /// # Errors
    /// If the bytes end too early or hold neither 0 nor 1.
    pub fn bool(&mut self) -> Result<bool, StateError> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(StateError::Invalid(format!("{other} is no bool"))),
        }
    }

    /// Reads a length or count. It is checked against the bytes that are left, at `size` bytes an element (at
    /// least 1), so that a damaged count cannot ask for more memory than that.
    ///
    /// # Errors
    /// If the bytes cannot hold so many elements.
    pub fn len(&mut self, size: usize) -> Result<usize, StateError> {
        let count = self.u64()?;
        let left = self.left();
        usize::try_from(count)
            .ok()
            .filter(|n| n.checked_mul(size.max(1)).is_some_and(|bytes| bytes <= left))
            .ok_or_else(|| StateError::Invalid(format!("{count} elements in {left} bytes")))
    }

    /// Reads a string.
    ///
    /// # Errors
    /// If the bytes end too early or are not UTF-8.
    pub fn str(&mut self) -> Result<&'a str, StateError> {
        let length = self.len(1)?;
        core::str::from_utf8(self.take(length)?).map_err(|e| StateError::Invalid(e.to_string()))
    }

    /// Reads an optional number.
    ///
    /// # Errors
    /// If the bytes end too early.
    pub fn option_f64(&mut self) -> Result<Option<f64>, StateError> {
        let some = self.bool()?;
        let value = self.f64()?;
        Ok(some.then_some(value))
    }

    /// Reads a list of numbers.
    ///
    /// # Errors
    /// If the bytes end too early.
    pub fn f64s(&mut self) -> Result<Vec<f64>, StateError> {
        let count = self.len(size_of::<f64>())?;
        (0..count).map(|_| self.f64()).collect()
    }

    /// Ends reading.
    ///
    /// # Errors
    /// If bytes are left over.
    pub fn finish(self) -> Result<(), StateError> {
        match self.left() {
            0 => Ok(()),
            left => Err(StateError::LeftOver(left)),
        }
    }

    const fn left(&self) -> usize {
        self.bytes.len() - self.offset
    }

    fn take(&mut self, wanted: usize) -> Result<&'a [u8], StateError> {
        let error = StateError::Truncated { offset: self.offset, wanted, left: self.left() };
        let end = self.offset.checked_add(wanted).ok_or(error.clone())?;
        let taken = self.bytes.get(self.offset..end).ok_or(error)?;
        self.offset = end;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], StateError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }
}

/// Puts content into the envelope.
pub(crate) fn seal(guid: Guid, content: &[u8]) -> Vec<u8> {
    let mut out = StateWriter { bytes: Vec::with_capacity(HEADER + content.len() + CHECKSUM) };
    out.bytes.extend_from_slice(&MAGIC);
    out.u32(FORMAT);
    out.u128(guid.0);
    out.len(content.len());
    out.bytes.extend_from_slice(content);
    let checksum = fnv64(&out.bytes);
    out.u64(checksum);
    out.bytes
}

/// Takes content out of the envelope.
pub(crate) fn unseal(guid: Guid, blob: &[u8]) -> Result<&[u8], StateError> {
    let mut header = StateReader::new(blob);
    if header.array()? != MAGIC {
        return Err(StateError::NoMagic);
    }
    let format = header.u32()?;
    if format != FORMAT {
        return Err(StateError::Format(format));
    }
    let found = Guid(header.u128()?);
    let length = header.u64()?;
    let expected = length.saturating_add((HEADER + CHECKSUM) as u64);
    if blob.len() as u64 != expected {
        return Err(StateError::Size { found: blob.len(), expected });
    }
    let content = header.take(header.left() - CHECKSUM)?;
    if header.u64()? != fnv64(&blob[..blob.len() - CHECKSUM]) {
        return Err(StateError::Checksum);
    }
    if found != guid {
        return Err(StateError::Guid { found: found.to_string(), expected: guid.to_string() });
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back_bit_for_bit() {
        let mut out = StateWriter::new();
        out.f64(-0.0);
        out.f64s(&[1.0, f64::INFINITY, 5e-324]);
        out.option_f64(None);
        out.option_f64(Some(2.5));
        out.str("a\0b");
        out.bool(true);
        out.i64(i64::MIN);
        let bytes = out.into_bytes();
        let mut from = StateReader::new(&bytes);
        assert_eq!(from.f64().unwrap().to_bits(), (-0.0_f64).to_bits());
        assert_eq!(from.f64s().unwrap(), [1.0, f64::INFINITY, 5e-324]);
        assert_eq!(from.option_f64().unwrap(), None);
        assert_eq!(from.option_f64().unwrap(), Some(2.5));
        assert_eq!(from.str().unwrap(), "a\0b");
        assert!(from.bool().unwrap());
        assert_eq!(from.i64().unwrap(), i64::MIN);
        from.finish().unwrap();
    }

    #[test]
    fn a_count_beyond_the_bytes_is_refused_before_memory_is_taken() {
        let mut out = StateWriter::new();
        out.u64(u64::MAX / 8);
        let bytes = out.into_bytes();
        assert!(matches!(StateReader::new(&bytes).f64s(), Err(StateError::Invalid(_))));
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
