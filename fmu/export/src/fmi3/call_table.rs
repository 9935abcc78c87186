//! Which function of FMI 3.0 is legal in which state, after the states of sections 2.3, 3.2 and 4.2. Which variables a legal Get
//! or Set may name is in `access.rs`.
//!
//! There are no structural parameters: no instance is ever in configuration or reconfiguration mode. Intermediate values are
//! only read. An error leads to state `terminated`. Where the standard contradicts itself, the list of the state counts.

use crate::call_state::{
    BOTH, CONT, CS, CallState, EVENT, FATAL, INIT, INST, INTER, Interface, Legality, ME, NONE, Row, STEP, TERM,
    call_table,
};

// Sets of states that several rows share.
const SETTABLE: u16 = INST | INIT | EVENT | CONT | STEP | TERM;
const READABLE: u16 = SETTABLE | INTER;
const WRITABLE: u16 = INST | INIT | EVENT | CONT | STEP;
const DIFFERENTIABLE: u16 = INIT | EVENT | CONT | STEP | TERM;
const EXCHANGED: u16 = INIT | EVENT | CONT | TERM;

call_table! {
    // function                      C name                                 interface legal                tolerated
    SetDebugLogging                "fmi3SetDebugLogging"                  BOTH, SETTABLE,             NONE;
    FreeInstance                   "fmi3FreeInstance"                     BOTH, SETTABLE,             FATAL;
    EnterInitializationMode        "fmi3EnterInitializationMode"          BOTH, INST,                 NONE;
    ExitInitializationMode         "fmi3ExitInitializationMode"           BOTH, INIT,                 NONE;
    EnterEventMode                 "fmi3EnterEventMode"                   BOTH, CONT | STEP,          NONE;
    Terminate                      "fmi3Terminate"                        BOTH, EVENT | CONT | STEP,  NONE;
    Reset                          "fmi3Reset"                            BOTH, SETTABLE,             NONE;
    GetFloat32                     "fmi3GetFloat32"                       BOTH, READABLE,             NONE;
    GetFloat64                     "fmi3GetFloat64"                       BOTH, READABLE,             NONE;
    GetInt8                        "fmi3GetInt8"                          BOTH, READABLE,             NONE;
    GetUInt8                       "fmi3GetUInt8"                         BOTH, READABLE,             NONE;
    GetInt16                       "fmi3GetInt16"                         BOTH, READABLE,             NONE;
    GetUInt16                      "fmi3GetUInt16"                        BOTH, READABLE,             NONE;
    GetInt32                       "fmi3GetInt32"                         BOTH, READABLE,             NONE;
    GetUInt32                      "fmi3GetUInt32"                        BOTH, READABLE,             NONE;
    GetInt64                       "fmi3GetInt64"                         BOTH, READABLE,             NONE;
    GetUInt64                      "fmi3GetUInt64"                        BOTH, READABLE,             NONE;
    GetBoolean                     "fmi3GetBoolean"                       BOTH, READABLE,             NONE;
    GetString                      "fmi3GetString"                        BOTH, READABLE,             NONE;
    GetBinary                      "fmi3GetBinary"                        BOTH, READABLE,             NONE;
    GetClock                       "fmi3GetClock"                         BOTH, EVENT,                NONE;
    SetFloat32                     "fmi3SetFloat32"                       BOTH, WRITABLE,             NONE;
    SetFloat64                     "fmi3SetFloat64"                       BOTH, WRITABLE,             NONE;
    SetInt8                        "fmi3SetInt8"                          BOTH, WRITABLE,             NONE;
    SetUInt8                       "fmi3SetUInt8"                         BOTH, WRITABLE,             NONE;
    SetInt16                       "fmi3SetInt16"                         BOTH, WRITABLE,             NONE;
    SetUInt16                      "fmi3SetUInt16"                        BOTH, WRITABLE,             NONE;
    SetInt32                       "fmi3SetInt32"                         BOTH, WRITABLE,             NONE;
    SetUInt32                      "fmi3SetUInt32"                        BOTH, WRITABLE,             NONE;
    SetInt64                       "fmi3SetInt64"                         BOTH, WRITABLE,             NONE;
    SetUInt64                      "fmi3SetUInt64"                        BOTH, WRITABLE,             NONE;
    SetBoolean                     "fmi3SetBoolean"                       BOTH, WRITABLE,             NONE;
    SetString                      "fmi3SetString"                        BOTH, WRITABLE,             NONE;
    SetBinary                      "fmi3SetBinary"                        BOTH, WRITABLE,             NONE;
    SetClock                       "fmi3SetClock"                         BOTH, EVENT,                NONE;
    GetNumberOfVariableDependencies "fmi3GetNumberOfVariableDependencies" BOTH, READABLE,             NONE;
    GetVariableDependencies        "fmi3GetVariableDependencies"          BOTH, READABLE,             NONE;
    GetFmuState                    "fmi3GetFMUState"                      BOTH, SETTABLE,             NONE;
    SetFmuState                    "fmi3SetFMUState"                      BOTH, SETTABLE,             NONE;
    FreeFmuState                   "fmi3FreeFMUState"                     BOTH, SETTABLE,             FATAL;
    SerializedFmuStateSize         "fmi3SerializedFMUStateSize"           BOTH, SETTABLE,             NONE;
    SerializeFmuState              "fmi3SerializeFMUState"                BOTH, SETTABLE,             NONE;
    DeserializeFmuState            "fmi3DeserializeFMUState"              BOTH, SETTABLE,             NONE;
    GetDirectionalDerivative       "fmi3GetDirectionalDerivative"         BOTH, DIFFERENTIABLE,       NONE;
    GetAdjointDerivative           "fmi3GetAdjointDerivative"             BOTH, DIFFERENTIABLE,       NONE;
    EnterConfigurationMode         "fmi3EnterConfigurationMode"           BOTH, INST,                 NONE;
    ExitConfigurationMode          "fmi3ExitConfigurationMode"            BOTH, NONE,                 NONE;
    GetIntervalDecimal             "fmi3GetIntervalDecimal"               BOTH, INIT | EVENT,         NONE;
    GetIntervalFraction            "fmi3GetIntervalFraction"              BOTH, INIT | EVENT,         NONE;
    GetShiftDecimal                "fmi3GetShiftDecimal"                  BOTH, INIT,                 NONE;
    GetShiftFraction               "fmi3GetShiftFraction"                 BOTH, INIT,                 NONE;
    SetIntervalDecimal             "fmi3SetIntervalDecimal"               BOTH, INIT,                 NONE;
    SetIntervalFraction            "fmi3SetIntervalFraction"              BOTH, INIT,                 NONE;
    SetShiftDecimal                "fmi3SetShiftDecimal"                  BOTH, INIT,                 NONE;
    SetShiftFraction               "fmi3SetShiftFraction"                 BOTH, INIT,                 NONE;
    EvaluateDiscreteStates         "fmi3EvaluateDiscreteStates"           BOTH, EVENT,                NONE;
    UpdateDiscreteStates           "fmi3UpdateDiscreteStates"             BOTH, EVENT,                NONE;
    EnterContinuousTimeMode        "fmi3EnterContinuousTimeMode"          ME,   EVENT,                NONE;
    CompletedIntegratorStep        "fmi3CompletedIntegratorStep"          ME,   CONT,                 NONE;
    SetTime                        "fmi3SetTime"                          ME,   CONT,                 NONE;
    SetContinuousStates            "fmi3SetContinuousStates"              ME,   CONT,                 NONE;
    GetContinuousStateDerivatives  "fmi3GetContinuousStateDerivatives"    ME,   EXCHANGED,            NONE;
    GetEventIndicators             "fmi3GetEventIndicators"               ME,   EXCHANGED,            NONE;
    GetContinuousStates            "fmi3GetContinuousStates"              ME,   EXCHANGED,            NONE;
    GetNominals                    "fmi3GetNominalsOfContinuousStates"    ME,   EXCHANGED,            NONE;
    GetNumberOfEventIndicators     "fmi3GetNumberOfEventIndicators"       ME,   INST | EVENT,         NONE;
    GetNumberOfContinuousStates    "fmi3GetNumberOfContinuousStates"      ME,   INST | EVENT,         NONE;
    EnterStepMode                  "fmi3EnterStepMode"                    CS,   EVENT,                NONE;
    GetOutputDerivatives           "fmi3GetOutputDerivatives"             CS,   STEP | INTER | TERM,  NONE;
    DoStep                         "fmi3DoStep"                           CS,   STEP,                 NONE;
    ActivateModelPartition         "fmi3ActivateModelPartition"           BOTH, NONE,                 NONE;
}
