//! Get and Set of variables. A Set is all or nothing: every value is checked before the first is written.

use super::{Call, Instance};
use crate::added::Added;
use crate::call_state::{CallState, Legality};
use crate::error::CallError;
use crate::logger::c_string;
use crate::slave::Slave;
use crate::standard::Standard;
use crate::variable::{AsString, Transfer, Variable};
use core::ffi::c_char;

/// The variable with this value reference.
pub(super) fn variable<S: Slave>(reference: u32) -> Call<&'static Variable<S>> {
    let table = S::variables();
    let found = usize::try_from(reference).ok().and_then(|i| table.get(i));
    found.ok_or(CallError::UnknownReference { reference, last: table.len().saturating_sub(1) })
}

impl<S: Slave> Instance<S> {
    /// Name of the type of a variable, in this version of FMI.
    pub(super) fn type_name(&self, variable: &Variable<S>) -> &'static str {
        match self.session.standard {
            Standard::Fmi2 => variable.kind().type_name(),
            Standard::Fmi3 => variable.kind().type_name_3(),
        }
    }

    /// A variable that is of another type than is asked for, or of none.
    pub(crate) fn wrong_type(&self, reference: u32, wanted: &'static str) -> CallError {
        match variable::<S>(reference) {
            Err(_) if self.session.standard == Standard::Fmi3 && Added::of::<S>(reference).is_some() => {
                CallError::WrongType { name: "time or event indicator", reference, actual: "Float64", wanted }
            }
            Err(unknown) => unknown,
            Ok(variable) => {
                CallError::WrongType { name: variable.name(), reference, actual: self.type_name(variable), wanted }
            }
        }
    }

    /// `fmi3GetFloat64`: any other Get, and one of the variables that the exporter adds to the table.
    pub(crate) fn get_floats<T>(&mut self, references: &[u32], mut write: impl FnMut(usize, f64)) -> Call
    where
        T: Transfer<S, Taken = f64>,
    {
        let added = |reference: u32| Added::of::<S>(reference);
        if references.iter().all(|reference| added(*reference).is_none()) {
            return self.get::<T>(references, write);
        }
        self.update()?;
        for (k, &reference) in references.iter().enumerate() {
            match added(reference) {
                Some(_) if self.core.state == CallState::IntermediateUpdateMode => {
                    return Err(CallError::NotIntermediate { name: "time or event indicator", type_name: T::NAME });
                }
                Some(Added::Time) => write(k, self.core.time),
                Some(Added::Indicator(index)) => {
                    let indicators = self.core.model.event_indicators();
                    write(k, indicators.get(index).copied().unwrap_or(f64::NAN));
                }
                None => self.get::<T>(&[reference], |_, value| write(k, value))?,
            }
        }
        Ok(())
    }

    /// `fmi2GetReal` and its kin. `write` takes each value with its position in the call.
    pub(crate) fn get<T: Transfer<S>>(&mut self, references: &[u32], mut write: impl FnMut(usize, T::Taken)) -> Call {
        self.update()?;
        for (i, &reference) in references.iter().enumerate() {
            let variable = variable::<S>(reference).map_err(|_| self.wrong_type(reference, T::NAME))?;
            let value = T::get(variable, &self.core.model).ok_or_else(|| self.wrong_type(reference, T::NAME))?;
            if self.may_be_read(variable, reference)? == Legality::Tolerated {
                self.tolerate(variable, "read");
            }
            write(i, value);
        }
        Ok(())
    }

    /// `fmi2GetString`. The strings live in the instance until the next call of this function.
    pub(crate) fn get_strings(&mut self, references: &[u32], mut write: impl FnMut(usize, *const c_char)) -> Call {
        let mut strings = Vec::with_capacity(references.len());
        self.get::<AsString>(references, |_, text| strings.push(c_string(&text)))?;
        self.strings = strings;
        for (i, string) in self.strings.iter().enumerate() {
            write(i, string.as_ptr());
        }
        Ok(())
    }

    /// `fmi2SetReal` and its kin. `take` converts a value from the type of the C interface.
    pub(crate) fn set<'a, T: Transfer<S>, V: Copy>(
        &mut self,
        references: &[u32],
        values: &[V],
        take: impl Fn(V) -> T::Given<'a>,
    ) -> Call {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = variable::<S>(reference)?;
            T::check(variable, take(value)).ok_or_else(|| self.wrong_type(reference, T::NAME))??;
            self.check_settable(variable)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            T::set(variable::<S>(reference)?, &mut self.core.model, take(value));
        }
        self.core.dirty = true;
        Ok(())
    }

    fn may_be_read(&self, variable: &Variable<S>, reference: u32) -> Call<Legality> {
        self.check_intermediate(variable, reference)?;
        Ok(variable.may_be_read(S::variables(), self.core.state, self.session.standard))
    }

    /// In intermediate update mode only what the importer asked for when it made the instance is read.
    pub(super) fn check_intermediate(&self, variable: &Variable<S>, reference: u32) -> Call {
        if self.core.state != CallState::IntermediateUpdateMode || self.session.is_intermediate(reference) {
            return Ok(());
        }
        let (name, type_name) = (variable.name(), variable.kind().type_name_3());
        Err(CallError::NotIntermediate { name, type_name })
    }

    pub(super) fn check_settable(&self, variable: &Variable<S>) -> Call {
        match variable.may_be_set(S::variables(), self.core.state, self.session.standard) {
            Legality::Legal => Ok(()),
            Legality::Tolerated => {
                self.tolerate(variable, "set");
                Ok(())
            }
            Legality::Illegal => Err(CallError::NotSettable {
                name: variable.name(),
                causality: variable.causality().as_str(),
                variability: variable.variability().as_str(),
                state: self.core.state,
            }),
        }
    }

    fn tolerate(&self, variable: &Variable<S>, what: &str) {
        let (name, causality) = (variable.name(), variable.causality().as_str());
        let (state, standard) = (self.core.state, self.session.standard);
        self.logger.tolerated(format_args!(
            "{standard} forbids that {causality} {name} be {what} in state {state}; tolerated"
        ));
    }
}
