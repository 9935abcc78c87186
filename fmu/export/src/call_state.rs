//! States of an instance, and which function is legal in which: the table of FMI 2.0, after those for model exchange (section
//! 3.2.3) and co-simulation (section 4.2.4). That of FMI 3.0 is in `fmi3/call_table.rs`. Which variables a legal Get or Set may
//! name, their footnotes, is in `access.rs`.
//!
//! One rule of section 4.2.4 is left to the importer: that no Get follows a Set before the next step. Importers do it at
//! every communication point, and what they read is well defined: outputs of the last step, inputs as set.

use core::fmt;

/// The interface that an instance was made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interface {
    /// Model exchange.
    ModelExchange,
    /// Co-simulation.
    CoSimulation,
}

impl fmt::Display for Interface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ModelExchange => "model-exchange",
            Self::CoSimulation => "co-simulation",
        })
    }
}

macro_rules! call_states {
    ($($(#[$doc:meta])* $state:ident $name:literal $bit:ident;)*) => {
        /// State of an instance.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        #[repr(u8)]
        pub enum CallState {
            $($(#[$doc])* $state,)*
        }

        impl CallState {
            /// All states, in the order of their numbers.
            pub const ALL: [Self; 13] = [$(Self::$state,)*];
        }

        impl fmt::Display for CallState {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Self::$state => $name,)* })
            }
        }

        $(pub(crate) const $bit: u16 = CallState::$state.bit();)*
    };
}

call_states! {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated "instantiated" INST;
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    InitializationMode "initializationMode" INIT;
    /// FMI 2.0: initialised, between two steps.
    StepComplete "stepComplete" DONE;
    /// An asynchronous step is under way. No instance of this exporter ever is here.
    StepInProgress "stepInProgress" BUSY;
    /// The last step was discarded.
    StepFailed "stepFailed" FAIL;
    /// The last step was cancelled. No instance of this exporter ever is here.
    StepCanceled "stepCanceled" CANC;
    /// After `fmi2Terminate`.
    Terminated "terminated" TERM;
    /// FMI 2.0: after any call that returned `fmi2Error`.
    Error "error" ERR;
    /// After a call that returned `fmi2Fatal`.
    Fatal "fatal" FATAL;
    /// Initialised, at an event; co-simulation of FMI 2.0 has none.
    EventMode "eventMode" EVENT;
    /// Model exchange: between events.
    ContinuousTimeMode "continuousTimeMode" CONT;
    /// FMI 3.0, co-simulation: initialised, between two steps.
    StepMode "stepMode" STEP;
    /// FMI 3.0, co-simulation: within a step, while the importer looks at intermediate values.
    IntermediateUpdateMode "intermediateUpdateMode" INTER;
}

impl CallState {
    const fn bit(self) -> u16 {
        1 << self as u8
    }

    /// Whether initialisation is still ahead, so that calculated values are brought up to date by
    /// [`Slave::update`](crate::Slave::update).
    pub(crate) const fn is_before_initialization(self) -> bool {
        matches!(self, Self::Instantiated | Self::InitializationMode)
    }
}

/// What the table says of a function in a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Legality {
    /// FMI 2.0 allows it.
    Legal,
    /// The standard forbids it, but importers do it and no harm comes of it: it works, and is logged.
    Tolerated,
    /// Refused with an error.
    Illegal,
}

/// A row of the table: a function of the C interface that acts on an instance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    /// Name of the C function.
    pub(crate) name: &'static str,
    /// The interface that it belongs to; `None` if to both.
    pub(crate) interface: Option<Interface>,
    /// The states in which it is legal, as bits.
    pub(crate) legal: u16,
    /// Those in which it is tolerated.
    pub(crate) tolerated: u16,
}

impl Row {
    /// What this row says of a state of an instance for `interface`.
    #[inline]
    pub(crate) fn legality(&self, interface: Interface, state: CallState) -> Legality {
        if self.interface.is_some_and(|own| own != interface) {
            Legality::Illegal
        } else if self.legal & state.bit() != 0 {
            Legality::Legal
        } else if self.tolerated & state.bit() != 0 {
            Legality::Tolerated
        } else {
            Legality::Illegal
        }
    }

    /// The states in which this function is legal, for messages.
    pub(crate) fn legal_states(&self, interface: Interface) -> String {
        let legal = |state: &CallState| self.legality(interface, *state) == Legality::Legal;
        let names: Vec<_> = CallState::ALL.into_iter().filter(legal).map(|s| s.to_string()).collect();
        if names.is_empty() { format!("no state of a {interface} instance") } else { names.join(", ") }
    }
}

pub(crate) const NONE: u16 = 0;
pub(crate) const BOTH: Option<Interface> = None;
pub(crate) const ME: Option<Interface> = Some(Interface::ModelExchange);
pub(crate) const CS: Option<Interface> = Some(Interface::CoSimulation);
// Sets of states that several rows share.
const AT_REST: u16 = INST | INIT | DONE | FAIL | CANC | TERM | ERR | EVENT | CONT;
const READABLE: u16 = INIT | DONE | FAIL | CANC | TERM | ERR | EVENT | CONT;
const EXCHANGED: u16 = INIT | TERM | ERR | EVENT | CONT;

/// A table: an enumeration of its functions, and what it says of each.
macro_rules! call_table {
    ($($function:ident $name:literal $interface:expr, $legal:expr, $tolerated:expr;)*) => {
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
                self.row().name
            }

            /// The interface that it belongs to; `None` if to both.
            pub const fn interface(self) -> Option<Interface> {
                self.row().interface
            }

            /// What the table says of this function in `state` of an instance for `interface`.
            pub fn legality(self, interface: Interface, state: CallState) -> Legality {
                self.row().legality(interface, state)
            }

            /// Its row.
            #[inline]
            pub(crate) const fn row(self) -> Row {
                match self {
                    $(Self::$function => {
                        Row { name: $name, interface: $interface, legal: $legal, tolerated: $tolerated }
                    })*
                }
            }
        }
    };
}
pub(crate) use call_table;

// Tolerated are
// - Get before initialisation: importers show start values,
// - `fmi2SetTime` in event mode, where the standard wants a purely discrete FMU: importers go to the time of an event on either
//   side of `fmi2EnterEventMode`,
// - giving memory back after a fatal error: otherwise it would be lost.
call_table! {
    // function                C name                                interface legal               tolerated
    SetDebugLogging          "fmi2SetDebugLogging"                 BOTH, AT_REST | BUSY,                 NONE;
    FreeInstance             "fmi2FreeInstance"                    BOTH, AT_REST,                        FATAL;
    SetupExperiment          "fmi2SetupExperiment"                 BOTH, INST,                           NONE;
    EnterInitializationMode  "fmi2EnterInitializationMode"         BOTH, INST,                           NONE;
    ExitInitializationMode   "fmi2ExitInitializationMode"          BOTH, INIT,                           NONE;
    Terminate                "fmi2Terminate"                       BOTH, DONE | FAIL | EVENT | CONT,     NONE;
    Reset                    "fmi2Reset"                           BOTH, AT_REST,                        NONE;
    GetReal                  "fmi2GetReal"                         BOTH, READABLE,                       INST;
    GetInteger               "fmi2GetInteger"                      BOTH, READABLE,                       INST;
    GetBoolean               "fmi2GetBoolean"                      BOTH, READABLE,                       INST;
    GetString                "fmi2GetString"                       BOTH, READABLE,                       INST;
    SetReal                  "fmi2SetReal"                         BOTH, INST | INIT | DONE | EVENT | CONT, NONE;
    SetInteger               "fmi2SetInteger"                      BOTH, INST | INIT | DONE | EVENT,     NONE;
    SetBoolean               "fmi2SetBoolean"                      BOTH, INST | INIT | DONE | EVENT,     NONE;
    SetString                "fmi2SetString"                       BOTH, INST | INIT | DONE | EVENT,     NONE;
    GetFmuState              "fmi2GetFMUstate"                     BOTH, AT_REST,                        NONE;
    SetFmuState              "fmi2SetFMUstate"                     BOTH, AT_REST,                        NONE;
    FreeFmuState             "fmi2FreeFMUstate"                    BOTH, AT_REST,                        FATAL;
    SerializedFmuStateSize   "fmi2SerializedFMUstateSize"          BOTH, AT_REST,                        NONE;
    SerializeFmuState        "fmi2SerializeFMUstate"               BOTH, AT_REST,                        NONE;
    DeSerializeFmuState      "fmi2DeSerializeFMUstate"             BOTH, AT_REST,                        NONE;
    GetDirectionalDerivative "fmi2GetDirectionalDerivative"        BOTH, READABLE,                       NONE;
    SetRealInputDerivatives  "fmi2SetRealInputDerivatives"         CS,   INST | INIT | DONE,             NONE;
    GetRealOutputDerivatives "fmi2GetRealOutputDerivatives"        CS,   DONE | FAIL | CANC | TERM | ERR, NONE;
    DoStep                   "fmi2DoStep"                          CS,   DONE,                           NONE;
    CancelStep               "fmi2CancelStep"                      CS,   BUSY,                           NONE;
    GetStatus                "fmi2GetStatus"                       CS,   DONE | BUSY | FAIL | TERM,      NONE;
    GetRealStatus            "fmi2GetRealStatus"                   CS,   DONE | BUSY | FAIL | TERM,      NONE;
    GetIntegerStatus         "fmi2GetIntegerStatus"                CS,   DONE | BUSY | FAIL | TERM,      NONE;
    GetBooleanStatus         "fmi2GetBooleanStatus"                CS,   DONE | BUSY | FAIL | TERM,      NONE;
    GetStringStatus          "fmi2GetStringStatus"                 CS,   DONE | BUSY | FAIL | TERM,      NONE;
    EnterEventMode           "fmi2EnterEventMode"                  ME,   EVENT | CONT,                   NONE;
    NewDiscreteStates        "fmi2NewDiscreteStates"               ME,   EVENT,                          NONE;
    EnterContinuousTimeMode  "fmi2EnterContinuousTimeMode"         ME,   EVENT,                          NONE;
    CompletedIntegratorStep  "fmi2CompletedIntegratorStep"         ME,   CONT,                           NONE;
    SetTime                  "fmi2SetTime"                         ME,   CONT,                           EVENT;
    SetContinuousStates      "fmi2SetContinuousStates"             ME,   CONT,                           NONE;
    GetDerivatives           "fmi2GetDerivatives"                  ME,   EXCHANGED,                      NONE;
    GetEventIndicators       "fmi2GetEventIndicators"              ME,   EXCHANGED,                      NONE;
    GetContinuousStates      "fmi2GetContinuousStates"             ME,   EXCHANGED,                      NONE;
    GetNominals              "fmi2GetNominalsOfContinuousStates"   ME,   INST | EXCHANGED,               NONE;
}
