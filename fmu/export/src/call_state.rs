//! Which function is legal in which state: one table, after the state machines of FMI 2.0.4 for model exchange (section
//! 3.2.3) and co-simulation (section 4.2.4). An instance is of one kind and never gets into a state of the other.

use crate::variable::{Causality, Variability};
use core::fmt;

/// State of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum CallState {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated,
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    InitializationMode,
    /// Initialised, between two steps.
    StepComplete,
    /// An asynchronous step is under way. No instance of this exporter ever is here.
    StepInProgress,
    /// The last step was discarded.
    StepFailed,
    /// The last step was cancelled. No instance of this exporter ever is here.
    StepCanceled,
    /// After `fmi2Terminate`.
    Terminated,
    /// After any call that returned `fmi2Error`.
    Error,
    /// After a call that returned `fmi2Fatal`.
    Fatal,
    /// Model exchange: initialised, at an event.
    EventMode,
    /// Model exchange: between events.
    ContinuousTimeMode,
}

impl CallState {
    /// All states, in the order of their numbers.
    pub const ALL: [Self; 11] = [
        Self::Instantiated,
        Self::InitializationMode,
        Self::StepComplete,
        Self::StepInProgress,
        Self::StepFailed,
        Self::StepCanceled,
        Self::Terminated,
        Self::Error,
        Self::Fatal,
        Self::EventMode,
        Self::ContinuousTimeMode,
    ];

    const fn bit(self) -> u16 {
        1 << self as u8
    }

    /// The state with this number.
    pub(crate) fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Whether initialisation is still ahead, so that calculated values are brought up to date by
    /// [`Slave::update`](crate::Slave::update).
    pub(crate) const fn is_before_initialization(self) -> bool {
        matches!(self, Self::Instantiated | Self::InitializationMode)
    }
}

impl fmt::Display for CallState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "instantiated",
            Self::InitializationMode => "initializationMode",
            Self::StepComplete => "stepComplete",
            Self::StepInProgress => "stepInProgress",
            Self::StepFailed => "stepFailed",
            Self::StepCanceled => "stepCanceled",
            Self::Terminated => "terminated",
            Self::Error => "error",
            Self::Fatal => "fatal",
            Self::EventMode => "eventMode",
            Self::ContinuousTimeMode => "continuousTimeMode",
        })
    }
}

/// What the table says of a function in a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Legality {
    /// FMI 2.0 allows it.
    Legal,
    /// FMI 2.0 forbids it, but importers do it and no harm comes of it: it works, with a warning.
    Tolerated,
    /// Refused with `fmi2Error`.
    Illegal,
}

const INST: u16 = CallState::Instantiated.bit();
const INIT: u16 = CallState::InitializationMode.bit();
const DONE: u16 = CallState::StepComplete.bit();
const BUSY: u16 = CallState::StepInProgress.bit();
const FAIL: u16 = CallState::StepFailed.bit();
const CANC: u16 = CallState::StepCanceled.bit();
const TERM: u16 = CallState::Terminated.bit();
const ERR: u16 = CallState::Error.bit();
const FATAL: u16 = CallState::Fatal.bit();
const EVENT: u16 = CallState::EventMode.bit();
const CONT: u16 = CallState::ContinuousTimeMode.bit();
const NONE: u16 = 0;
// Sets of states that several rows share.
const AT_REST: u16 = INST | INIT | DONE | FAIL | CANC | TERM | ERR | EVENT | CONT;
const READABLE: u16 = INIT | DONE | FAIL | CANC | TERM | ERR | EVENT | CONT;
const EXCHANGED: u16 = INIT | TERM | ERR | EVENT | CONT;

macro_rules! call_table {
    ($($function:ident $name:literal $legal:expr, $tolerated:expr;)*) => {
        /// A function of the C interface that acts on an instance.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Function {
            $(#[doc = concat!("`", $name, "`")] $function,)*
        }

        impl Function {
            /// All functions, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$function,)*];

            /// The name of the C function.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$function => $name,)* }
            }

            /// The states in which it is legal and in which it is tolerated, as bits.
            const fn states(self) -> (u16, u16) {
                match self { $(Self::$function => ($legal, $tolerated),)* }
            }
        }
    };
}

call_table! {
    // function                C name                            legal                      tolerated
    SetDebugLogging         "fmi2SetDebugLogging"         AT_REST | BUSY,            NONE;
    FreeInstance            "fmi2FreeInstance"            AT_REST,                   FATAL;
    SetupExperiment         "fmi2SetupExperiment"         INST,                      NONE;
    EnterInitializationMode "fmi2EnterInitializationMode" INST,                      NONE;
    ExitInitializationMode  "fmi2ExitInitializationMode"  INIT,                      NONE;
    Terminate               "fmi2Terminate"               DONE | FAIL | EVENT | CONT, NONE;
    Reset                   "fmi2Reset"                   AT_REST,                   NONE;
    GetReal                 "fmi2GetReal"                 READABLE,                  INST;
    GetInteger              "fmi2GetInteger"              READABLE,                  INST;
    GetBoolean              "fmi2GetBoolean"              READABLE,                  INST;
    GetString               "fmi2GetString"               READABLE,                  INST;
    SetReal                 "fmi2SetReal"                 INST | INIT | DONE | EVENT | CONT, NONE;
    SetInteger              "fmi2SetInteger"              INST | INIT | DONE | EVENT, NONE;
    SetBoolean              "fmi2SetBoolean"              INST | INIT | DONE | EVENT, NONE;
    SetString               "fmi2SetString"               INST | INIT | DONE | EVENT, NONE;
    GetFmuState             "fmi2GetFMUstate"             AT_REST,                   NONE;
    SetFmuState             "fmi2SetFMUstate"             AT_REST,                   NONE;
    FreeFmuState            "fmi2FreeFMUstate"            AT_REST,                   FATAL;
    SerializedFmuStateSize  "fmi2SerializedFMUstateSize"  AT_REST,                   NONE;
    SerializeFmuState       "fmi2SerializeFMUstate"       AT_REST,                   NONE;
    DeSerializeFmuState     "fmi2DeSerializeFMUstate"     AT_REST,                   NONE;
    GetDirectionalDerivative "fmi2GetDirectionalDerivative" READABLE,                NONE;
    SetRealInputDerivatives "fmi2SetRealInputDerivatives" INST | INIT | DONE,        NONE;
    GetRealOutputDerivatives "fmi2GetRealOutputDerivatives" DONE | FAIL | CANC | TERM | ERR, NONE;
    DoStep                  "fmi2DoStep"                  DONE,                      NONE;
    CancelStep              "fmi2CancelStep"              BUSY,                      NONE;
    GetStatus               "fmi2GetStatus"               DONE | BUSY | FAIL | TERM, NONE;
    GetRealStatus           "fmi2GetRealStatus"           DONE | BUSY | FAIL | TERM, NONE;
    GetIntegerStatus        "fmi2GetIntegerStatus"        DONE | BUSY | FAIL | TERM, NONE;
    GetBooleanStatus        "fmi2GetBooleanStatus"        DONE | BUSY | FAIL | TERM, NONE;
    GetStringStatus         "fmi2GetStringStatus"         DONE | BUSY | FAIL | TERM, NONE;
    EnterEventMode          "fmi2EnterEventMode"          CONT,                      EVENT;
    NewDiscreteStates       "fmi2NewDiscreteStates"       EVENT,                     NONE;
    EnterContinuousTimeMode "fmi2EnterContinuousTimeMode" EVENT,                     NONE;
    CompletedIntegratorStep "fmi2CompletedIntegratorStep" CONT,                      NONE;
    SetTime                 "fmi2SetTime"                 EVENT | CONT,              NONE;
    SetContinuousStates     "fmi2SetContinuousStates"     CONT,                      NONE;
    GetDerivatives          "fmi2GetDerivatives"          EXCHANGED,                 NONE;
    GetEventIndicators      "fmi2GetEventIndicators"      EXCHANGED,                 NONE;
    GetContinuousStates     "fmi2GetContinuousStates"     EXCHANGED,                 NONE;
    GetNominals             "fmi2GetNominalsOfContinuousStates" INST | EXCHANGED,    NONE;
}

impl Function {
    /// What the table says of this function in `state`.
    pub const fn legality(self, state: CallState) -> Legality {
        let (legal, tolerated) = self.states();
        if legal & state.bit() != 0 {
            Legality::Legal
        } else if tolerated & state.bit() != 0 {
            Legality::Tolerated
        } else {
            Legality::Illegal
        }
    }

    /// The states in which this function is legal, for messages.
    pub(crate) fn legal_states(self) -> String {
        let legal = CallState::ALL.into_iter().filter(|&state| self.legality(state) == Legality::Legal);
        legal.map(|s| s.to_string()).collect::<Vec<_>>().join(", ")
    }
}

/// Whether a variable may be set in a state (FMI 2.0.4, the footnotes of the tables): before initialisation what
/// has a start value, in initialization mode the same, after it inputs and tunable parameters; in continuous-time mode
/// continuous inputs.
pub const fn is_settable(causality: Causality, variability: Variability, state: CallState) -> bool {
    use CallState::{ContinuousTimeMode, EventMode, InitializationMode, Instantiated, StepComplete};
    match (causality, state) {
        (Causality::Input | Causality::Parameter, Instantiated | InitializationMode)
        | (Causality::Input, StepComplete | EventMode) => true,
        (Causality::Input, ContinuousTimeMode) => matches!(variability, Variability::Continuous),
        (Causality::Parameter, StepComplete | EventMode) => matches!(variability, Variability::Tunable),
        _ => false,
    }
}
