//! What the two processes say to each other: frames of a length and a message, numbers with all their bits.

use std::ffi::CString;
use std::io::{self, Read, Write};
use std::path::PathBuf;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::fmi::logging::LogRecord;

/// Largest serialised state that is passed on, bytes.
pub(in crate::fmi) const LONGEST_STATE: usize = 256 << 20;
/// Longest message, bytes: a state and what goes with it.
const LONGEST: usize = LONGEST_STATE + (1 << 16);
/// Bytes of the length in front of a message.
const HEAD: usize = 4;

/// First message to the worker.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Opening {
    /// The process that asks: when it is gone, the worker goes.
    pub host: u32,
    /// The library, unpacked.
    pub library: PathBuf,
    /// What errors call it: its path into the archive.
    pub shown: PathBuf,
    /// Address space that the worker may take, bytes.
    pub memory: Option<u64>,
}

/// Functions that take nothing but the instance.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) enum Plain {
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
}

/// Each further message to the worker: a call. States go by numbers from 1 on; 0 is none.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Request {
    Instantiate {
        name: CString,
        guid: CString,
        resources: CString,
        debug: bool,
    },
    Free,
    /// Unloads the library.
    Unload,
    SetDebugLogging {
        on: i32,
        categories: Vec<CString>,
    },
    SetupExperiment {
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    },
    Plain(Plain),
    DoStep {
        time: f64,
        step: f64,
        keeps_no_state: i32,
    },
    GetReal {
        references: Vec<u32>,
    },
    GetInteger {
        references: Vec<u32>,
    },
    GetBoolean {
        references: Vec<u32>,
    },
    GetString {
        references: Vec<u32>,
    },
    SetReal {
        references: Vec<u32>,
        values: Vec<f64>,
    },
    SetInteger {
        references: Vec<u32>,
        values: Vec<i32>,
    },
    SetBoolean {
        references: Vec<u32>,
        values: Vec<i32>,
    },
    SetString {
        references: Vec<u32>,
        values: Vec<CString>,
    },
    SetInputDerivatives {
        references: Vec<u32>,
        orders: Vec<i32>,
        values: Vec<f64>,
    },
    GetOutputDerivatives {
        references: Vec<u32>,
        orders: Vec<i32>,
    },
    DirectionalDerivative {
        unknowns: Vec<u32>,
        knowns: Vec<u32>,
        seed: Vec<f64>,
    },
    GetState {
        state: u64,
    },
    SetState {
        state: u64,
    },
    FreeState {
        state: u64,
    },
    StateSize {
        state: u64,
    },
    SerializeState {
        state: u64,
        size: u64,
    },
    DeserializeState {
        bytes: Vec<u8>,
    },
    RealStatus {
        kind: i32,
    },
    BooleanStatus {
        kind: i32,
    },
}

/// Each message from the worker.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Reply {
    /// The library is loaded.
    Loaded,
    /// It is not, and why.
    Refused(String),
    /// A message of the FMU, on the way to the answer.
    Log(LogRecord),
    /// The answer to a call: the status, and what else the function gave.
    Done { status: i32, given: Given },
}

/// What a function gave besides its status.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Given {
    Nothing,
    Reals(Vec<f64>),
    Integers(Vec<i32>),
    Texts(Vec<CString>),
    Bytes(Vec<u8>),
    Number(u64),
}

/// A message as it travels.
///
/// # Errors
/// If it is longer than any may be.
pub(super) fn frame(message: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut frame = postcard::to_extend(message, vec![0; HEAD]).map_err(io::Error::other)?;
    let length = frame.len() - HEAD;
    if length > LONGEST {
        return Err(io::Error::other(format!("a message of {length} bytes, allowed are {LONGEST}")));
    }
    let head = u32::try_from(length).map_err(io::Error::other)?.to_le_bytes();
    frame[..HEAD].copy_from_slice(&head);
    Ok(frame)
}

/// Takes the first message out of `bytes`, if it is there as a whole.
///
/// # Errors
/// A length that no message has; a message that is none.
pub(super) fn unframe<T: DeserializeOwned>(bytes: &mut Vec<u8>) -> io::Result<Option<T>> {
    let Some(&head) = bytes.first_chunk::<HEAD>() else { return Ok(None) };
    let end = HEAD + length(head)?;
    let Some(message) = bytes.get(HEAD..end) else { return Ok(None) };
    let message = decode(message)?;
    bytes.drain(..end);
    Ok(Some(message))
}

/// Writes a message.
///
/// # Errors
/// If it is too long or cannot be written.
pub(super) fn send(writer: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    writer.write_all(&frame(message)?)?;
    writer.flush()
}

/// Reads a message; none if the other side has closed.
///
/// # Errors
/// If it cannot be read, or is none.
pub(super) fn receive<T: DeserializeOwned>(reader: &mut impl Read) -> io::Result<Option<T>> {
    let mut head = Vec::with_capacity(HEAD);
    reader.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
    let Some(&head) = head.first_chunk::<HEAD>() else { return Ok(None) };
    let length = length(head)?;
    let mut message = Vec::new();
    // Memory is taken as bytes arrive, not as they are announced.
    reader.by_ref().take(length as u64).read_to_end(&mut message)?;
    if message.len() < length { Ok(None) } else { decode(&message).map(Some) }
}

fn length(head: [u8; HEAD]) -> io::Result<usize> {
    let length = usize::try_from(u32::from_le_bytes(head)).map_err(io::Error::other)?;
    if length <= LONGEST {
        return Ok(length);
    }
    Err(io::Error::other(format!("a message of {length} bytes is announced, allowed are {LONGEST}")))
}

fn decode<T: DeserializeOwned>(bytes: &[u8]) -> io::Result<T> {
    match postcard::take_from_bytes(bytes) {
        Ok((message, [])) => Ok(message),
        Ok((_, rest)) => Err(io::Error::other(format!("{} bytes follow a message", rest.len()))),
        Err(cause) => Err(io::Error::other(format!("{} bytes that are no message: {cause}", bytes.len()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_arrive_with_all_their_bits() {
        let values = vec![0.1 + 0.2, -0.0, f64::NAN, f64::INFINITY, -5e-324, f64::from_bits(0x7ff4_0000_0000_0001)];
        let message = Reply::Done { status: -77, given: Given::Reals(values.clone()) };
        let bytes = frame(&message).unwrap();
        let Some(Reply::Done { status: -77, given: Given::Reals(found) }) = receive(&mut &*bytes).unwrap() else {
            panic!("another message");
        };
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&found), bits(&values));
    }

    #[test]
    fn messages_are_taken_one_by_one_and_whole() {
        let one = frame(&Reply::Loaded).unwrap();
        let two = frame(&Reply::Refused("no".to_owned())).unwrap();
        let mut bytes = [one, two].concat();
        let last = bytes.pop().unwrap();
        assert!(matches!(unframe(&mut bytes).unwrap(), Some(Reply::Loaded)));
        assert!(unframe::<Reply>(&mut bytes).unwrap().is_none());
        bytes.push(last);
        assert!(matches!(unframe(&mut bytes).unwrap(), Some(Reply::Refused(text)) if text == "no"));
        assert!(bytes.is_empty());
    }

    #[test]
    fn garbage_is_an_error_and_takes_no_memory() {
        let vast = u32::MAX.to_le_bytes().to_vec();
        let vector = [&[12, 0, 0, 0, 3, 0, 1][..], &[0xff; 8], &[0x7f]].concat(); // Done with 2^63 Reals
        for mut garbage in [vast, vec![1, 0, 0, 0, 99], vec![2, 0, 0, 0, 0, 0], vector] {
            assert!(receive::<Reply>(&mut &*garbage).is_err());
            assert!(unframe::<Reply>(&mut garbage).is_err());
        }
        assert!(receive::<Reply>(&mut &[7, 0, 0, 0, 0][..]).unwrap().is_none(), "the stream ended");
    }
}
