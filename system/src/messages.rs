//! Messages between two processes: frames of a length and a message, numbers with all their bits.

use std::io::{self, Read, Write};

use serde::{Serialize, de::DeserializeOwned};

/// Longest message, bytes: a state of an FMU, of 256 MiB, and what goes with it.
pub const LONGEST: usize = (256 << 20) + (1 << 16);
/// Bytes of the length in front of a message.
const HEAD: usize = 4;

/// What two processes must agree on before they exchange messages: the version, and a hash of the `sources` that define the
/// messages, and of this one. Two builds need not mean the same by the same bytes.
pub fn build(sources: &[&[u8]]) -> String {
    // FNV-1a
    let hash = [include_bytes!("messages.rs"), sources.concat().as_slice()]
        .concat()
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{} with messages {hash:016x}", env!("CARGO_PKG_VERSION"))
}

/// A message as it travels.
///
/// # Errors
/// If it is longer than [`LONGEST`].
pub fn frame(message: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut frame = postcard::to_extend(message, vec![0; HEAD]).map_err(io::Error::other)?;
    let length = frame.len() - HEAD;
    if length > LONGEST {
        return Err(io::Error::other(format!("a message of {length} bytes, allowed are {LONGEST}")));
    }
    let head = u32::try_from(length).map_err(io::Error::other)?.to_le_bytes();
    frame[..HEAD].copy_from_slice(&head);
    Ok(frame)
}

/// Takes the first message, of at most `longest` bytes, out of `bytes`, if it is complete.
///
/// # Errors
/// If it is longer, or no message.
pub fn take<T: DeserializeOwned>(bytes: &mut Vec<u8>, longest: usize) -> io::Result<Option<T>> {
    let Some(&head) = bytes.first_chunk::<HEAD>() else { return Ok(None) };
    let end = HEAD + length(head, longest)?;
    let Some(message) = bytes.get(HEAD..end) else { return Ok(None) };
    let message = decode(message)?;
    bytes.drain(..end);
    Ok(Some(message))
}

/// Writes a message.
///
/// # Errors
/// If it is longer than [`LONGEST`] or cannot be written.
pub fn send(writer: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    writer.write_all(&frame(message)?)?;
    writer.flush()
}

/// Reads a message; none if the other side has closed.
///
/// # Errors
/// If it cannot be read, or is none.
pub fn receive<T: DeserializeOwned>(reader: &mut impl Read) -> io::Result<Option<T>> {
    let mut head = Vec::with_capacity(HEAD);
    reader.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
    let Some(&head) = head.first_chunk::<HEAD>() else { return Ok(None) };
    let length = length(head, LONGEST)?;
    let mut message = Vec::new();
    // Memory is taken as bytes arrive, not as they are announced.
    reader.by_ref().take(length as u64).read_to_end(&mut message)?;
    if message.len() < length { Ok(None) } else { decode(&message).map(Some) }
}

fn length(head: [u8; HEAD], longest: usize) -> io::Result<usize> {
    let length = usize::try_from(u32::from_le_bytes(head)).map_err(io::Error::other)?;
    if length <= longest {
        return Ok(length);
    }
    Err(io::Error::other(format!("a message of {length} bytes, allowed are {longest}")))
}

fn decode<T: DeserializeOwned>(bytes: &[u8]) -> io::Result<T> {
    match postcard::take_from_bytes(bytes) {
        Ok((message, [])) => Ok(message),
        Ok((_, rest)) => Err(io::Error::other(format!("{} bytes behind a message", rest.len()))),
        Err(cause) => Err(io::Error::other(format!("{} bytes that are no message: {cause}", bytes.len()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_arrive_with_all_their_bits() {
        let values = [0.1 + 0.2, -0.0, f64::NAN, f64::INFINITY, -5e-324, f64::from_bits(0x7ff4_0000_0000_0001)];
        let mut bytes = Vec::new();
        send(&mut bytes, &values).unwrap();
        let found = receive::<[f64; 6]>(&mut bytes.as_slice()).unwrap().unwrap();
        assert_eq!(found.map(f64::to_bits), values.map(f64::to_bits));
    }

    #[test]
    fn messages_are_taken_one_by_one_and_whole() {
        let mut bytes = [frame(&"one").unwrap(), frame(&"two\nlines").unwrap()].concat();
        let last = bytes.pop().unwrap();
        assert_eq!(take::<String>(&mut bytes, 100).unwrap().as_deref(), Some("one"));
        assert_eq!(take::<String>(&mut bytes, 100).unwrap(), None);
        bytes.push(last);
        assert_eq!(take::<String>(&mut bytes, 100).unwrap().as_deref(), Some("two\nlines"));
        assert!(bytes.is_empty());
    }

    #[test]
    fn garbage_is_an_error_and_takes_no_memory() {
        type Message = Result<Vec<f64>, bool>;
        let vast = u32::MAX.to_le_bytes().to_vec();
        let vector = [&[10, 0, 0, 0, 0][..], &[0xff; 8], &[0x7f]].concat(); // of 2^63 numbers
        for mut garbage in [vast, vec![1, 0, 0, 0, 99], vec![3, 0, 0, 0, 1, 0, 0], vector] {
            assert!(receive::<Message>(&mut &*garbage).is_err());
            assert!(take::<Message>(&mut garbage, LONGEST).is_err());
        }
        assert!(receive::<Message>(&mut &[7, 0, 0, 0, 0][..]).unwrap().is_none(), "the stream ended");
    }
}
