//! C(t) of the last harvesters: runs that differ in the circuit only need not work it out again.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use videg_coupled::{CoupledError, Times, Track};
use videg_model::{ForceTable, Parameters, Recording, Setup};

/// Harvesters that are remembered: some for each thread of a map whose rows are of one harvester.
const MOST: usize = 8;

/// What a harvester is made from.
#[derive(Clone)]
pub(super) struct Mechanics {
    pub parameters: Parameters,
    pub recording: Option<Arc<Recording>>,
    pub table: Option<Arc<ForceTable>>,
}

/// What is known of a harvester.
enum Known {
    /// It ran once. Most harvesters of a sweep run once only, and are not worth more.
    Seen,
    /// A thread works C(t) out, or it is too long to be kept.
    Without,
    Kept(Arc<Track>),
}

/// The last harvesters, the latest first.
#[derive(Default)]
pub(super) struct Tracks(Mutex<VecDeque<(Mechanics, Known)>>);

impl Mechanics {
    pub fn setup(&self) -> Setup<'_> {
        self.parameters.with_recording(self.recording.as_deref()).with_table(self.table.as_deref())
    }
}

impl PartialEq for Mechanics {
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
    /// C(t) of `mechanics`, if it is asked for once more.
    pub fn of(&self, mechanics: &Mechanics, times: &Times) -> Result<Option<Arc<Track>>, CoupledError> {
        {
            let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            match last.iter_mut().find(|(it, _)| it == mechanics).map(|(_, known)| known) {
                Some(Known::Kept(track)) => return Ok(Some(Arc::clone(track))),
                Some(Known::Without) => return Ok(None),
                Some(known @ Known::Seen) => *known = Known::Without,
                None => {
                    last.push_front((mechanics.clone(), Known::Seen));
                    last.truncate(MOST);
                    return Ok(None);
                }
            }
        }
        let Some(track) = Track::of(mechanics.setup(), times)?.map(Arc::new) else { return Ok(None) };
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = last.iter_mut().find(|(it, _)| it == mechanics) {
            *known = Known::Kept(Arc::clone(&track));
        }
        Ok(Some(track))
    }
}
