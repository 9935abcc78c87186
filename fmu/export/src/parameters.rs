//! Parameters in a serialised state, as the table has them.

use crate::serialize::{StateError, StateReader, StateWriter};
use crate::slave::Slave;
use crate::variable::{AsBoolean, AsInteger, AsReal, AsString, Causality, Transfer, Variable};

impl StateWriter {
    /// Writes the parameters of a model in the order of its table: the Reals, then those that choose, count or switch, then the Strings.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_parameters<S: Slave>(&mut self, slave: &S) -> Result<(), StateError> {
        let reals: Vec<f64> = parameters().filter_map(|row| AsReal::get(row, slave)).collect();
        let choices: Vec<i32> = parameters().filter_map(|row| choice(row, slave)).collect();
        self.write(&(reals, choices))?;
        parameters().filter_map(|row| AsString::get(row, slave)).try_for_each(|text| self.write(&text))
    }
}

impl StateReader<'_> {
    /// Sets the parameters that [`StateWriter::write_parameters`] wrote. Reals are not checked.
    ///
    /// # Errors
    /// As [`take`](Self::take), or if these are not as many parameters, or no choices.
    pub fn read_parameters<S: Slave>(&mut self, slave: &mut S) -> Result<(), StateError> {
        let (reals, choices): (Vec<f64>, Vec<i32>) = self.take()?;
        let (mut reals, mut choices) = (reals.into_iter(), choices.into_iter());
        let other_number = || StateError::Invalid("another number of parameters".to_owned());
        for row in parameters::<S>() {
            if AsReal::get(row, slave).is_some() {
                AsReal::set(row, slave, reals.next().ok_or_else(other_number)?);
            } else if choice(row, slave).is_some() {
                let item = choices.next().ok_or_else(other_number)?;
                AsInteger::set(row, slave, item);
                AsBoolean::set(row, slave, item != 0);
                if choice(row, slave) != Some(item) {
                    return Err(StateError::Invalid(format!("{} = {item} is no choice", row.name())));
                }
            }
        }
        if reals.next().is_some() || choices.next().is_some() {
            return Err(other_number());
        }
        for row in parameters::<S>() {
            if AsString::get(row, slave).is_none() {
                continue;
            }
            let text: &str = self.take()?;
            if let Some(Err(refused)) = AsString::check(row, Ok(text)) {
                return Err(StateError::Invalid(refused.to_string()));
            }
            AsString::set(row, slave, Ok(text));
        }
        Ok(())
    }
}

fn parameters<S: Slave>() -> impl Iterator<Item = &'static Variable<S>> {
    S::variables().iter().filter(|row| row.causality() == Causality::Parameter)
}

/// An Integer, the item of an enumeration, or a Boolean as 0 or 1.
fn choice<S: Slave>(row: &Variable<S>, slave: &S) -> Option<i32> {
    AsInteger::get(row, slave).or_else(|| AsBoolean::get(row, slave))
}
