//! The present state of an instance and those that the importer has saved. It holds tokens, never pointers to memory: a
//! token that was not given out, or was freed, or belongs to another instance is recognised, and no token is ever given out
//! twice.
//!
//! Masters that try steps save, restore and free a state at each of them, so the state that was saved or restored last
//! is the present one until that changes or another is saved. Only then is it given a copy, in memory that was freed
//! before if there is some. Restoring and freeing copy nothing, nor does saving a state that has changed since the last
//! one was saved or restored.

use super::{Call, Core};
use crate::error::CallError;
use crate::slave::Slave;
use core::ops::{Deref, DerefMut, Range};
use core::sync::atomic::{AtomicUsize, Ordering};

/// Numbers below this one are taken: instances take a block of them at a time.
static COUNTER: AtomicUsize = AtomicUsize::new(0);

/// A token is a number plus this. The address of the counter keeps the tokens of different FMUs in one process apart.
fn base() -> usize {
    const ODD: usize = usize::MAX / 13 * 8 + 1; // golden ratio, so that near addresses end up far apart
    (&raw const COUNTER).addr().wrapping_mul(ODD)
}

/// Numbers that no state in this process has had, in increasing order.
struct Numbers(Range<usize>);

impl Numbers {
    /// How many an instance takes at a time.
    const BLOCK: usize = 64;

    fn fresh(&mut self) -> usize {
        loop {
            if self.0.is_empty() {
                let first = COUNTER.fetch_add(Self::BLOCK, Ordering::Relaxed);
                self.0 = first..first.wrapping_add(Self::BLOCK);
            }
            let number = self.0.start;
            self.0.start = number.wrapping_add(1);
            // NULL means "no state".
            if base().wrapping_add(number) != 0 {
                return number;
            }
        }
    }
}

/// A state that the importer holds.
struct Saved<S> {
    number: usize,
    /// None if it is the present one, or if making its copy panicked.
    core: Option<Box<Core<S>>>,
}

/// Dereferences to the present state. To do so mutably settles what is saved of it before.
pub(super) struct Cores<S: Slave> {
    present: Box<Core<S>>,
    /// Number of the saved state that is the present one.
    twin: Option<usize>,
    /// In increasing order of their numbers.
    saved: Vec<Saved<S>>,
    /// Memory for the next copy.
    spare: Option<Box<Core<S>>>,
    numbers: Numbers,
}

impl<S: Slave> Deref for Cores<S> {
    type Target = Core<S>;

    fn deref(&self) -> &Core<S> {
        &self.present
    }
}

impl<S: Slave> DerefMut for Cores<S> {
    #[inline]
    fn deref_mut(&mut self) -> &mut Core<S> {
        if self.twin.is_some() {
            self.settle();
        }
        &mut self.present
    }
}

impl<S: Slave> Cores<S> {
    pub(super) fn new(core: Core<S>) -> Self {
        let (present, numbers) = (Box::new(core), Numbers(0..0));
        Self { present, twin: None, saved: Vec::new(), spare: None, numbers }
    }

    /// All states in memory.
    pub(super) fn into_all(self) -> impl Iterator<Item = Box<Core<S>>> {
        let saved = self.saved.into_iter().filter_map(|saved| saved.core);
        core::iter::once(self.present).chain(saved).chain(self.spare)
    }

    /// The state with this token.
    pub(super) fn saved(&self, token: usize) -> Call<&Core<S>> {
        match &self.saved[self.position(token)?].core {
            Some(core) => Ok(core),
            None if self.is_twin(token) => Ok(&self.present),
            None => Err(CallError::UnknownFmuState(token)),
        }
    }

    /// Saves the present state: as a new one if `token` is NULL, else in place of that one. Returns its token.
    pub(super) fn save(&mut self, token: usize) -> Call<usize> {
        if self.is_twin(token) {
            return Ok(token);
        }
        self.settle();
        let position = self.place(token)?;
        let Saved { number, core } = &mut self.saved[position];
        let (number, before) = (*number, core.take());
        self.twin = Some(number); // first: to drop a spare may panic
        self.keep(before);
        Ok(base().wrapping_add(number))
    }

    /// Keeps `core` as [`save`](Self::save) keeps the present state.
    pub(super) fn add(&mut self, token: usize, core: Core<S>) -> Call<usize> {
        let position = self.place(token)?;
        let Saved { number, core: slot } = &mut self.saved[position];
        *slot = Some(Box::new(core));
        self.twin = self.twin.filter(|twin| twin != number);
        Ok(base().wrapping_add(*number))
    }

    /// Goes to the state with this token. If the present one is a saved one, it is handed back to that.
    pub(super) fn restore(&mut self, token: usize) -> Call {
        if self.is_twin(token) {
            return Ok(());
        }
        let position = self.position(token)?;
        let Saved { number, core } = &mut self.saved[position];
        let core = core.take().ok_or(CallError::UnknownFmuState(token))?;
        let number = *number;
        let before = core::mem::replace(&mut self.present, core);
        match self.twin.replace(number).and_then(|twin| self.find(twin).ok()) {
            Some(twin) => self.saved[twin].core = Some(before),
            None => self.keep(Some(before)),
        }
        Ok(())
    }

    /// Forgets the state with this token.
    pub(super) fn free(&mut self, token: usize) -> Call {
        let Saved { number, core } = self.saved.remove(self.position(token)?);
        self.twin = self.twin.filter(|twin| *twin != number);
        self.keep(core);
        Ok(())
    }

    /// Keeps memory for the next copy.
    fn keep(&mut self, spare: Option<Box<Core<S>>>) {
        if spare.is_some() {
            self.spare = spare;
        }
    }

    fn is_twin(&self, token: usize) -> bool {
        self.twin.is_some_and(|number| base().wrapping_add(number) == token)
    }

    /// Gives the saved state that is the present one a copy of its own.
    pub(super) fn settle(&mut self) {
        let Some(number) = self.twin.take() else { return };
        let Ok(position) = self.find(number) else { return };
        match &mut self.spare {
            Some(spare) => spare.as_mut().clone_from(&self.present),
            None => self.spare = Some(Box::new(self.present.as_ref().clone())),
        }
        self.saved[position].core = self.spare.take();
    }

    /// Where the state with this token is kept, or a new one if it is NULL.
    fn place(&mut self, token: usize) -> Call<usize> {
        if token != 0 {
            return self.position(token);
        }
        self.saved.push(Saved { number: self.numbers.fresh(), core: None });
        Ok(self.saved.len() - 1)
    }

    fn position(&self, token: usize) -> Call<usize> {
        self.find(token.wrapping_sub(base())).map_err(|_| CallError::UnknownFmuState(token))
    }

    /// The state that was saved last is looked at first.
    fn find(&self, number: usize) -> Result<usize, usize> {
        match self.saved.last() {
            Some(last) if last.number == number => Ok(self.saved.len() - 1),
            _ => self.saved.binary_search_by_key(&number, |saved| saved.number),
        }
    }
}
