//! Random arguments of one call, with a note whether one of them is surely wrong.

use crate::{Fmu, Random};
use core::ptr::{null, null_mut};

/// Source of the arguments of one call.
pub(crate) struct Arguments<'a> {
    pub(crate) random: &'a mut Random,
    pub(crate) fmu: &'a Fmu,
    /// One of the arguments so far must be refused.
    pub(crate) wrong: bool,
}

impl Arguments<'_> {
    /// Notes that a fact makes the call wrong.
    pub(crate) fn wrong_if(&mut self, wrong: bool) {
        self.wrong |= wrong;
    }

    /// The address of an array, seldom NULL, which is right for an empty one only.
    pub(crate) fn array<T>(&mut self, values: &[T]) -> *const T {
        if !self.random.once_in(40) {
            return values.as_ptr();
        }
        self.wrong_if(!values.is_empty());
        null()
    }

    /// The same for an array to be filled.
    pub(crate) fn room<T>(&mut self, values: &mut [T]) -> *mut T {
        if !self.random.once_in(40) {
            return values.as_mut_ptr();
        }
        self.wrong_if(!values.is_empty());
        null_mut()
    }

    /// The same for one value.
    pub(crate) fn place<T>(&mut self, value: &mut T) -> *mut T {
        self.room(core::slice::from_mut(value))
    }

    /// Value references, seldom one that is none.
    pub(crate) fn references(&mut self, size: usize) -> Vec<u32> {
        let variables = self.fmu.variables;
        let reference = |random: &mut Random| match random.below(60) {
            0 => variables,
            1 => u32::MAX,
            _ => u32::try_from(random.below(variables as usize)).unwrap_or_default(),
        };
        let references: Vec<_> = (0..size).map(|_| reference(self.random)).collect();
        self.wrong_if(references.iter().any(|reference| *reference >= variables));
        references
    }

    /// Reals; those that are no number are wrong everywhere.
    pub(crate) fn reals(&mut self, size: usize) -> Vec<f64> {
        let values: Vec<_> = (0..size).map(|_| self.random.real()).collect();
        self.wrong_if(values.iter().any(|value| value.is_nan()));
        values
    }

    /// Integers.
    pub(crate) fn integers(&mut self, size: usize) -> Vec<i32> {
        (0..size).map(|_| self.random.integer()).collect()
    }

    /// A Real that must be finite.
    pub(crate) fn finite(&mut self) -> f64 {
        let value = self.random.real();
        self.wrong_if(!value.is_finite());
        value
    }
}
