//! Directional derivatives: which variables may be asked for in which state, and the sum over the knowns.

use super::values::variable;
use super::{Call, Instance};
use crate::error::CallError;
use crate::slave::Slave;
use crate::variable::{Causality, Kind, Variability, Variable};

impl<S: Slave> Instance<S> {
    /// `fmi2GetDirectionalDerivative`: for each unknown the sum of its partial derivatives times the seeds.
    pub(crate) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        mut put: impl FnMut(usize, f64),
    ) -> Call {
        if !S::INFO.directional_derivatives {
            return Err(CallError::Unsupported("directional derivatives"));
        }
        self.update();
        let knowns = knowns.iter().map(|&reference| self.known(reference)).collect::<Call<Vec<_>>>()?;
        let unknowns = unknowns.iter().map(|&reference| self.unknown(reference)).collect::<Call<Vec<_>>>()?;
        for (i, unknown) in unknowns.into_iter().enumerate() {
            let terms = knowns.iter().zip(seeds).filter(|(_, seed)| **seed != 0.0);
            put(i, terms.map(|(known, seed)| self.partial_derivative(unknown, known) * seed).sum());
        }
        Ok(())
    }

    /// After initialisation an output depends on what its row of the table says, and on nothing else.
    fn partial_derivative(&self, unknown: &Variable<S>, known: &Variable<S>) -> f64 {
        let ask = self.core.state.is_before_initialization()
            || unknown.dependencies().is_none_or(|names| names.contains(&known.name()));
        if ask { self.core.model.partial_derivative(unknown, known) } else { 0.0 }
    }

    /// During initialisation a parameter or a continuous input, afterwards a continuous input.
    fn known(&self, reference: u32) -> Call<&'static Variable<S>> {
        let variable = variable::<S>(reference)?;
        let may_be = match variable.causality() {
            Causality::Parameter => self.core.state.is_before_initialization(),
            Causality::Input => variable.variability() == Variability::Continuous,
            _ => false,
        };
        self.check_real(variable, may_be, "known")
    }

    /// A continuous output; during initialisation a calculated parameter, too.
    fn unknown(&self, reference: u32) -> Call<&'static Variable<S>> {
        let variable = variable::<S>(reference)?;
        let may_be = match variable.causality() {
            Causality::CalculatedParameter => self.core.state.is_before_initialization(),
            Causality::Output => variable.variability() == Variability::Continuous,
            _ => false,
        };
        self.check_real(variable, may_be, "unknown")
    }

    fn check_real(
        &self,
        variable: &'static Variable<S>,
        may_be: bool,
        role: &'static str,
    ) -> Call<&'static Variable<S>> {
        if may_be && matches!(variable.kind(), Kind::Real(_)) {
            return Ok(variable);
        }
        Err(CallError::NoDerivative {
            name: variable.name(),
            type_name: variable.kind().type_name(),
            causality: variable.causality().as_str(),
            variability: variable.variability().as_str(),
            role,
            state: self.core.state,
        })
    }
}
