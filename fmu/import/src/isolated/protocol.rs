//! What the two processes say to each other.

use std::ffi::{CStr, CString, OsString};

use serde::{Deserialize, Serialize};

use crate::logging::LogRecord;
use crate::request::{Request, Results};
use videg_system::messages::{self, LONGEST};

/// Largest serialised state that is passed on, bytes.
pub(crate) const LONGEST_STATE: usize = LONGEST - SPARE;
/// What a message may have besides values, bytes: the longest log record, for one.
pub(super) const SPARE: usize = 1 << 16;
/// Longest Strings that a call may give altogether, bytes.
const LONGEST_TEXTS: usize = 16 << 20;

/// First message to the worker: which build asks.
pub(super) fn build() -> String {
    messages::build(&[include_bytes!("protocol.rs"), include_bytes!("../logging.rs"), include_bytes!("../request.rs")])
}

/// Second message to the worker.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Opening {
    /// The process that asks: when it is gone, the worker goes.
    pub host: u32,
    /// The library, unpacked: a path, which need not be UTF-8.
    pub library: OsString,
    /// What errors call it: its path into the archive.
    pub shown: OsString,
    /// Address space that the worker may take, bytes.
    pub memory: Option<u64>,
}

/// Each further message to the worker: a request and the number of the call, from 1 on.
pub(super) type Call = (u64, Request<'static>);

/// Longest answer to a request, bytes.
pub(super) fn longest_answer(request: &Request<'_>) -> usize {
    let values = match request {
        Request::GetReal { references }
        | Request::GetInteger { references }
        | Request::GetBoolean { references }
        | Request::GetOutputDerivatives { references, .. } => 8 * references.len(),
        Request::DirectionalDerivative { unknowns, .. } => 8 * unknowns.len(),
        Request::GetString { .. } => LONGEST_TEXTS,
        Request::SerializeState { size, .. } => usize::try_from(*size).unwrap_or(LONGEST_STATE),
        _ => 0,
    };
    values.saturating_add(SPARE).min(LONGEST)
}

/// Each message from the worker.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Reply {
    /// It cannot begin, and why. The first, so that every build reads it as this.
    Unable(String),
    /// The library is loaded.
    Loaded,
    /// It is not, and why.
    Refused(String),
    /// A message of the FMU, on the way to the answer.
    Log(LogRecord),
    /// The answer to the call of this number: the status, and what else the function gave.
    Done { call: u64, status: i32, given: Given },
}

impl Reply {
    /// What it is, in few words: its content may be of any length.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Unable(_) => "that it cannot begin",
            Self::Loaded => "that the library is loaded",
            Self::Refused(_) => "that the library is refused",
            Self::Log(_) => "a log record",
            Self::Done { .. } => "the answer to a call",
        }
    }
}

/// What a function gave besides its status. None takes more memory than bytes of its message.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Given {
    Nothing,
    Reals(Vec<f64>),
    /// Little-endian: as numbers, small ones would travel in one byte each.
    Integers(Vec<[u8; 4]>),
    /// One behind the other, each with a zero at its end: however many, they take as many bytes as they have.
    Texts(Vec<u8>),
    Bytes(Vec<u8>),
    Number(u64),
}

impl Given {
    pub fn integers(values: Vec<i32>) -> Self {
        Self::Integers(values.into_iter().map(i32::to_le_bytes).collect())
    }

    pub fn texts(texts: Vec<CString>) -> Self {
        Self::Texts(texts.into_iter().flat_map(CString::into_bytes_with_nul).collect())
    }

    /// Stores the values in `results`; whether they are of its kind, and as many.
    pub fn store(self, results: Results<'_>) -> bool {
        fn fill<T>(into: &mut [T], values: impl ExactSizeIterator<Item = T>) -> bool {
            let fits = values.len() == into.len();
            into.iter_mut().zip(values).for_each(|(place, value)| *place = value);
            fits
        }
        match (results, self) {
            (Results::None, _) => true,
            (Results::Reals(into), Self::Reals(values)) => fill(into, values.into_iter()),
            (Results::Integers(into), Self::Integers(values)) => fill(into, values.into_iter().map(i32::from_le_bytes)),
            (Results::Bytes(into), Self::Bytes(bytes)) => fill(into, bytes.into_iter()),
            (Results::Texts(into), Self::Texts(bytes)) => {
                // Memory is taken for as many as were asked for, if none is cut.
                let texts = || bytes.split_inclusive(|&byte| byte == 0).map(CStr::from_bytes_with_nul);
                let fits = texts().count() == into.len() && texts().all(|text| text.is_ok());
                into.iter_mut().zip(texts().flatten()).for_each(|(place, text)| text.clone_into(place));
                fits
            }
            (Results::Number(into), Self::Number(number)) => {
                *into = number;
                true
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use videg_system::messages::{frame, receive, take};

    use super::*;

    #[test]
    fn numbers_arrive_with_all_their_bits() {
        let values = vec![0.1 + 0.2, -0.0, f64::NAN, f64::INFINITY, -5e-324, f64::from_bits(0x7ff4_0000_0000_0001)];
        let message = Reply::Done { call: 3, status: -77, given: Given::Reals(values.clone()) };
        let bytes = frame(&message).unwrap();
        let Some(Reply::Done { call: 3, status: -77, given: Given::Reals(found) }) = receive(&mut &*bytes).unwrap()
        else {
            panic!("another message");
        };
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&found), bits(&values));
    }

    #[test]
    fn an_answer_may_be_as_long_as_its_call_lets_it() {
        let references = [0_u32; 1000];
        let reals = Given::Reals(vec![f64::MIN_POSITIVE; 1000]);
        let integers = || Given::integers(vec![i32::MIN; 1000]);
        let answer = |given| frame(&Reply::Done { call: u64::MAX, status: i32::MIN, given }).unwrap();
        let is_taken = |mut bytes, request: Request<'_>| {
            take::<Reply>(&mut bytes, longest_answer(&request)).is_ok_and(|reply| reply.is_some())
        };
        assert!(is_taken(answer(reals), Request::GetReal { references: references[..].into() }));
        assert!(is_taken(answer(integers()), Request::GetBoolean { references: references[..].into() }));
        let state = |size| answer(Given::Bytes(vec![0xff; size]));
        assert!(is_taken(state(1 << 20), Request::SerializeState { state: 1, size: 1 << 20 }));
        assert!(!is_taken(state(1 << 20), Request::SerializeState { state: 1, size: 1 << 10 }));
        assert!(!is_taken(state(1 << 20), Request::Free));
    }

    #[test]
    fn what_was_not_asked_for_takes_no_more_memory_than_its_message() {
        let count = 1 << 20;
        let message = |given| frame(&Reply::Done { call: 1, status: 0, given }).unwrap().len();
        assert!(message(Given::integers(vec![0; count])) > size_of::<[u8; 4]>() * count);
        assert!(message(Given::Reals(vec![0.0; count])) > size_of::<f64>() * count);
        assert_eq!(
            Given::texts(vec![CString::default(); count]),
            Given::Texts(vec![0; count]),
            "only the texts themselves"
        );
    }

    #[test]
    fn values_of_another_kind_or_number_and_cut_texts_are_none() {
        let texts = vec![c"one".to_owned(), CString::default(), c"three".to_owned()];
        let mut found = vec![CString::default(); 3];
        assert!(Given::texts(texts.clone()).store(Results::Texts(&mut found)));
        assert_eq!(found, texts);
        assert!(Given::texts(Vec::new()).store(Results::Texts(&mut [])));
        for (given, results) in [
            (Given::texts(texts), Results::Texts(&mut found[..2])),
            (Given::Texts(b"one\0tw".to_vec()), Results::Texts(&mut [CString::default(), CString::default()])),
            (Given::Reals(vec![1.0]), Results::Reals(&mut [0.0; 2])),
            (Given::Reals(vec![1.0]), Results::Integers(&mut [0])),
            (Given::Nothing, Results::Number(&mut 0)),
        ] {
            assert!(!given.store(results));
        }
    }

    #[cfg(unix)]
    #[test]
    fn paths_that_are_not_utf_8_arrive_as_they_are() {
        use std::os::unix::ffi::OsStringExt as _;
        let path = OsString::from_vec(b"/tmp/\xff/Toy.so".to_vec());
        let opening = Opening { host: 1, library: path.clone(), shown: path.clone(), memory: None };
        let found = receive::<Opening>(&mut &*frame(&opening).unwrap()).unwrap().unwrap();
        assert_eq!((&found.library, &found.shown), (&path, &path));
    }
}
