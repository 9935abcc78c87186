//! C(t) of the last harvesters: runs that differ in the circuit only need not work it out again.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use videg_coupled::{CoupledError, Times, Track};
use videg_model::{ForceTable, Parameters, Recording, Setup};

/// Harvesters that are remembered: some for each thread of a map whose rows are of one harvester.
const MOST: usize = 8;

/// What a harvester is made from.
#[derive(Clone)]
pub(super) struct HarvesterInputs {
    pub parameters: Parameters,
    pub recording: Option<Arc<Recording>>,
    pub table: Option<Arc<ForceTable>>,
}

/// What is known of a harvester.
enum Known {
    /// It ran once. Most harvesters of a sweep run once only, and are not worth more.
    Seen,
    /// A thread works C(t) out, or there is none that could be kept.
    NotKept,
    Kept(Arc<Track>),
}

/// The last harvesters, the latest first.
#[derive(Default)]
pub(super) struct Tracks(Mutex<VecDeque<(HarvesterInputs, Known)>>);

impl HarvesterInputs {
    pub fn setup(&self) -> Setup<'_> {
        self.parameters.with_recording(self.recording.as_deref()).with_table(self.table.as_deref())
    }
}

impl PartialEq for HarvesterInputs {
    /// Files are read once, so that the same file is the same data.
    fn eq(&self, other: &Self) -> bool {
        fn is_same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
            a.map(Arc::as_ptr) == b.map(Arc::as_ptr)
        }
        self.parameters == other.parameters
            && is_same(self.recording.as_ref(), other.recording.as_ref())
            && is_same(self.table.as_ref(), other.table.as_ref())
    }
}

impl Tracks {
    /// C(t) of the harvester of `inputs`, from the second time on that it is asked for.
    ///
    /// # Errors
    /// As [`Track::of`].
    pub fn of(&self, inputs: &HarvesterInputs, times: &Times) -> Result<Option<Arc<Track>>, CoupledError> {
        {
            let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            // One that is asked for again goes to the front.
            let there = last.iter().position(|(it, _)| it == inputs).and_then(|place| last.remove(place));
            let (next, found) = match there.map(|(_, known)| known) {
                Some(Known::Kept(track)) => (Known::Kept(Arc::clone(&track)), Some(Ok(Some(track)))),
                Some(Known::NotKept) => (Known::NotKept, Some(Ok(None))),
                Some(Known::Seen) => (Known::NotKept, None),
                None => (Known::Seen, Some(Ok(None))),
            };
            last.push_front((inputs.clone(), next));
            last.truncate(MOST);
            if let Some(found) = found {
                return found;
            }
        }
        let Some(track) = Track::of(inputs.setup(), times)?.map(Arc::new) else { return Ok(None) };
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = last.iter_mut().find(|(it, _)| it == inputs) {
            *known = Known::Kept(Arc::clone(&track));
        }
        Ok(Some(track))
    }
}
