//! Which variables a Get or Set that is legal as such may name: the footnotes of the tables of FMI 2.0, sections 3.2.3
//! and 4.2.4, and the descriptions of the states of FMI 3.0.

use crate::call_state::{CallState, Legality};
use crate::standard::Standard;
use crate::variable::{Causality, Initial, Variability, Variable};

impl<M> Variable<M> {
    /// Whether it is among the `InitialUnknowns` of `ModelStructure` (section 2.2.8): calculated outputs, calculated
    /// parameters, continuous states and their derivatives; no clocks and what belongs to them.
    pub fn is_initial_unknown(&self, table: &[Self]) -> bool {
        self.initial() == Some(Initial::Calculated)
            && self.is_of(Standard::Fmi2)
            && (matches!(self.causality(), Causality::Output | Causality::CalculatedParameter)
                || self.derivative_of().is_some()
                || self.is_continuous_state(table))
    }

    /// Whether the table holds its time derivative.
    pub fn is_continuous_state(&self, table: &[Self]) -> bool {
        table.iter().any(|row| row.derivative_of() == Some(self.name()))
    }

    /// Whether it may be set in a state, if a Set of its type is legal there: before initialisation what has
    /// `initial = "exact"`; in initialization mode inputs, too; afterwards inputs and tunable parameters; in
    /// continuous-time mode continuous inputs and continuous states.
    ///
    /// Inputs of FMI 2.0 have no `initial`, so that standard does not let them be set before initialization mode. Importers set all
    /// start values there: tolerated.
    pub fn may_be_set(&self, table: &[Self], state: CallState, standard: Standard) -> Legality {
        use CallState::{ContinuousTimeMode, EventMode, InitializationMode, Instantiated, StepComplete, StepMode};
        let legal = match (self.causality(), state) {
            (Causality::Input, Instantiated) if standard == Standard::Fmi2 => return Legality::Tolerated,
            (Causality::Parameter, Instantiated | InitializationMode)
            | (Causality::Input, Instantiated | InitializationMode | StepComplete | EventMode) => true,
            (Causality::Input, StepMode) => self.clocks().is_empty(),
            (Causality::Parameter, StepComplete | StepMode | EventMode) => self.variability() == Variability::Tunable,
            (Causality::Input, ContinuousTimeMode) => self.variability() == Variability::Continuous,
            (_, ContinuousTimeMode) => self.is_continuous_state(table),
            _ => false,
        };
        if legal { Legality::Legal } else { Legality::Illegal }
    }

    /// Whether it may be read in a state, if a Get is legal there: in initialization mode outputs and initial unknowns,
    /// elsewhere everything. Importers show parameters and inputs in initialization mode, too: tolerated. FMI 3.0 restricts clocked
    /// variables only, which are there at events; importers show them all the time: tolerated.
    pub fn may_be_read(&self, table: &[Self], state: CallState, standard: Standard) -> Legality {
        if standard == Standard::Fmi3 {
            let at_event = matches!(state, CallState::InitializationMode | CallState::EventMode);
            return if at_event || self.clocks().is_empty() { Legality::Legal } else { Legality::Tolerated };
        }
        let restricted = state == CallState::InitializationMode && !self.is_initial_unknown(table);
        if restricted && self.causality() != Causality::Output { Legality::Tolerated } else { Legality::Legal }
    }
}
