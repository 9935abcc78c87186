//! The C types and function signatures of FMI 2.0 (2.0.4, files `fmi2TypesPlatform.h`, `fmi2FunctionTypes.h`
//! and `fmi2Functions.h`), spelled as the standard spells them.
//!
//! Nothing else lives here: the exporter and the importer meet on these types. Enumerations arrive from foreign
//! code, so they are plain integers with named constants: an unexpected value must not be undefined behaviour.
#![no_std]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]

use core::ffi::{c_char, c_double, c_int, c_uint, c_void};

/// Pointer to the component, opaque to the caller.
pub type fmi2Component = *mut c_void;
/// Pointer to the environment of the component, opaque to the FMU.
pub type fmi2ComponentEnvironment = *mut c_void;
/// Pointer to a saved state of the component, opaque to the caller.
pub type fmi2FMUstate = *mut c_void;
/// Handle of a variable, unique for its base type.
pub type fmi2ValueReference = c_uint;
/// 64-bit floating-point number.
pub type fmi2Real = c_double;
/// 32-bit signed integer; enumerations travel as this type too.
pub type fmi2Integer = c_int;
/// An `int`, not a `bool`.
pub type fmi2Boolean = c_int;
/// One character of a string.
pub type fmi2Char = c_char;
/// Zero-terminated UTF-8 string.
pub type fmi2String = *const fmi2Char;
/// One byte of a serialised state.
pub type fmi2Byte = c_char;

/// The true value of [`fmi2Boolean`].
pub const fmi2True: fmi2Boolean = 1;
/// The false value of [`fmi2Boolean`].
pub const fmi2False: fmi2Boolean = 0;

/// Result of a call.
pub type fmi2Status = c_int;
/// All well.
pub const fmi2OK: fmi2Status = 0;
/// Something is odd, the computation goes on.
pub const fmi2Warning: fmi2Status = 1;
/// The step was not taken (or only in part); the master may try another.
pub const fmi2Discard: fmi2Status = 2;
/// This instance cannot go on, others can.
pub const fmi2Error: fmi2Status = 3;
/// No instance of this FMU can go on.
pub const fmi2Fatal: fmi2Status = 4;
/// The step is under way asynchronously.
pub const fmi2Pending: fmi2Status = 5;

/// Interface that an instance offers.
pub type fmi2Type = c_int;
/// Model exchange.
pub const fmi2ModelExchange: fmi2Type = 0;
/// Co-simulation.
pub const fmi2CoSimulation: fmi2Type = 1;

/// What a status function is asked for.
pub type fmi2StatusKind = c_int;
/// Status of a pending `fmi2DoStep`.
pub const fmi2DoStepStatus: fmi2StatusKind = 0;
/// What a pending `fmi2DoStep` waits for.
pub const fmi2PendingStatus: fmi2StatusKind = 1;
/// Time up to which the last step was carried out.
pub const fmi2LastSuccessfulTime: fmi2StatusKind = 2;
/// Whether the slave asks to end the simulation.
pub const fmi2Terminated: fmi2StatusKind = 3;

/// Result of an event iteration (model exchange).
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fmi2EventInfo {
    /// Another event iteration is needed.
    pub newDiscreteStatesNeeded: fmi2Boolean,
    /// The model asks to end the simulation.
    pub terminateSimulation: fmi2Boolean,
    /// The nominal values of the continuous states have changed.
    pub nominalsOfContinuousStatesChanged: fmi2Boolean,
    /// The values of the continuous states have changed.
    pub valuesOfContinuousStatesChanged: fmi2Boolean,
    /// `nextEventTime` holds a time.
    pub nextEventTimeDefined: fmi2Boolean,
    /// Time of the next event, s.
    pub nextEventTime: fmi2Real,
}

/// `void logger(componentEnvironment, instanceName, status, category, message, ...)`.
pub type fmi2CallbackLogger =
    unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
/// `void* allocateMemory(nobj, size)`.
pub type fmi2CallbackAllocateMemory = unsafe extern "C" fn(usize, usize) -> *mut c_void;
/// `void freeMemory(obj)`.
pub type fmi2CallbackFreeMemory = unsafe extern "C" fn(*mut c_void);
/// `void stepFinished(componentEnvironment, status)`.
pub type fmi2StepFinished = unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2Status);

/// Callbacks that the environment hands to `fmi2Instantiate`. Each may be NULL in practice.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmi2CallbackFunctions {
    /// Takes the messages of the FMU.
    pub logger: Option<fmi2CallbackLogger>,
    /// Allocates zeroed memory.
    pub allocateMemory: Option<fmi2CallbackAllocateMemory>,
    /// Frees what `allocateMemory` gave.
    pub freeMemory: Option<fmi2CallbackFreeMemory>,
    /// Ends an asynchronous step.
    pub stepFinished: Option<fmi2StepFinished>,
    /// Handed back to `logger` and `stepFinished`.
    pub componentEnvironment: fmi2ComponentEnvironment,
}

macro_rules! signatures {
    ($($(#[$doc:meta])* $name:ident = ($($arg:ty),* $(,)?) $(-> $ret:ty)?;)*) => {
        $($(#[$doc])* pub type $name = unsafe extern "C" fn($($arg),*) $(-> $ret)?;)*
    };
}

signatures! {
    /// `fmi2GetTypesPlatform`
    fmi2GetTypesPlatformTYPE = () -> *const c_char;
    /// `fmi2GetVersion`
    fmi2GetVersionTYPE = () -> *const c_char;
    /// `fmi2SetDebugLogging(c, loggingOn, nCategories, categories)`
    fmi2SetDebugLoggingTYPE = (fmi2Component, fmi2Boolean, usize, *const fmi2String) -> fmi2Status;
    /// `fmi2Instantiate(instanceName, fmuType, fmuGUID, fmuResourceLocation, functions, visible, loggingOn)`
    fmi2InstantiateTYPE = (fmi2String, fmi2Type, fmi2String, fmi2String, *const fmi2CallbackFunctions, fmi2Boolean, fmi2Boolean) -> fmi2Component;
    /// `fmi2FreeInstance(c)`
    fmi2FreeInstanceTYPE = (fmi2Component);
    /// `fmi2SetupExperiment(c, toleranceDefined, tolerance, startTime, stopTimeDefined, stopTime)`
    fmi2SetupExperimentTYPE = (fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real) -> fmi2Status;
    /// `fmi2EnterInitializationMode(c)`
    fmi2EnterInitializationModeTYPE = (fmi2Component) -> fmi2Status;
    /// `fmi2ExitInitializationMode(c)`
    fmi2ExitInitializationModeTYPE = (fmi2Component) -> fmi2Status;
    /// `fmi2Terminate(c)`
    fmi2TerminateTYPE = (fmi2Component) -> fmi2Status;
    /// `fmi2Reset(c)`
    fmi2ResetTYPE = (fmi2Component) -> fmi2Status;
    /// `fmi2GetReal(c, vr, nvr, value)`
    fmi2GetRealTYPE = (fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Real) -> fmi2Status;
    /// `fmi2GetInteger(c, vr, nvr, value)`
    fmi2GetIntegerTYPE = (fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Integer) -> fmi2Status;
    /// `fmi2GetBoolean(c, vr, nvr, value)`
    fmi2GetBooleanTYPE = (fmi2Component, *const fmi2ValueReference, usize, *mut fmi2Boolean) -> fmi2Status;
    /// `fmi2GetString(c, vr, nvr, value)`
    fmi2GetStringTYPE = (fmi2Component, *const fmi2ValueReference, usize, *mut fmi2String) -> fmi2Status;
    /// `fmi2SetReal(c, vr, nvr, value)`
    fmi2SetRealTYPE = (fmi2Component, *const fmi2ValueReference, usize, *const fmi2Real) -> fmi2Status;
    /// `fmi2SetInteger(c, vr, nvr, value)`
    fmi2SetIntegerTYPE = (fmi2Component, *const fmi2ValueReference, usize, *const fmi2Integer) -> fmi2Status;
    /// `fmi2SetBoolean(c, vr, nvr, value)`
    fmi2SetBooleanTYPE = (fmi2Component, *const fmi2ValueReference, usize, *const fmi2Boolean) -> fmi2Status;
    /// `fmi2SetString(c, vr, nvr, value)`
    fmi2SetStringTYPE = (fmi2Component, *const fmi2ValueReference, usize, *const fmi2String) -> fmi2Status;
    /// `fmi2GetFMUstate(c, FMUstate)`
    fmi2GetFMUstateTYPE = (fmi2Component, *mut fmi2FMUstate) -> fmi2Status;
    /// `fmi2SetFMUstate(c, FMUstate)`
    fmi2SetFMUstateTYPE = (fmi2Component, fmi2FMUstate) -> fmi2Status;
    /// `fmi2FreeFMUstate(c, FMUstate)`
    fmi2FreeFMUstateTYPE = (fmi2Component, *mut fmi2FMUstate) -> fmi2Status;
    /// `fmi2SerializedFMUstateSize(c, FMUstate, size)`
    fmi2SerializedFMUstateSizeTYPE = (fmi2Component, fmi2FMUstate, *mut usize) -> fmi2Status;
    /// `fmi2SerializeFMUstate(c, FMUstate, serializedState, size)`
    fmi2SerializeFMUstateTYPE = (fmi2Component, fmi2FMUstate, *mut fmi2Byte, usize) -> fmi2Status;
    /// `fmi2DeSerializeFMUstate(c, serializedState, size, FMUstate)`
    fmi2DeSerializeFMUstateTYPE = (fmi2Component, *const fmi2Byte, usize, *mut fmi2FMUstate) -> fmi2Status;
    /// `fmi2GetDirectionalDerivative(c, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, dvUnknown)`
    fmi2GetDirectionalDerivativeTYPE = (fmi2Component, *const fmi2ValueReference, usize, *const fmi2ValueReference, usize, *const fmi2Real, *mut fmi2Real) -> fmi2Status;
    /// `fmi2SetRealInputDerivatives(c, vr, nvr, order, value)`
    fmi2SetRealInputDerivativesTYPE = (fmi2Component, *const fmi2ValueReference, usize, *const fmi2Integer, *const fmi2Real) -> fmi2Status;
    /// `fmi2GetRealOutputDerivatives(c, vr, nvr, order, value)`
    fmi2GetRealOutputDerivativesTYPE = (fmi2Component, *const fmi2ValueReference, usize, *const fmi2Integer, *mut fmi2Real) -> fmi2Status;
    /// `fmi2DoStep(c, currentCommunicationPoint, communicationStepSize, noSetFMUStatePriorToCurrentPoint)`
    fmi2DoStepTYPE = (fmi2Component, fmi2Real, fmi2Real, fmi2Boolean) -> fmi2Status;
    /// `fmi2CancelStep(c)`
    fmi2CancelStepTYPE = (fmi2Component) -> fmi2Status;
    /// `fmi2GetStatus(c, s, value)`
    fmi2GetStatusTYPE = (fmi2Component, fmi2StatusKind, *mut fmi2Status) -> fmi2Status;
    /// `fmi2GetRealStatus(c, s, value)`
    fmi2GetRealStatusTYPE = (fmi2Component, fmi2StatusKind, *mut fmi2Real) -> fmi2Status;
    /// `fmi2GetIntegerStatus(c, s, value)`
    fmi2GetIntegerStatusTYPE = (fmi2Component, fmi2StatusKind, *mut fmi2Integer) -> fmi2Status;
    /// `fmi2GetBooleanStatus(c, s, value)`
    fmi2GetBooleanStatusTYPE = (fmi2Component, fmi2StatusKind, *mut fmi2Boolean) -> fmi2Status;
    /// `fmi2GetStringStatus(c, s, value)`
    fmi2GetStringStatusTYPE = (fmi2Component, fmi2StatusKind, *mut fmi2String) -> fmi2Status;
    /// `fmi2EnterEventMode(c)` (model exchange)
    fmi2EnterEventModeTYPE = (fmi2Component) -> fmi2Status;
    /// `fmi2NewDiscreteStates(c, eventInfo)` (model exchange)
    fmi2NewDiscreteStatesTYPE = (fmi2Component, *mut fmi2EventInfo) -> fmi2Status;
    /// `fmi2EnterContinuousTimeMode(c)` (model exchange)
    fmi2EnterContinuousTimeModeTYPE = (fmi2Component) -> fmi2Status;
    /// `fmi2CompletedIntegratorStep(c, noSetFMUStatePriorToCurrentPoint, enterEventMode, terminateSimulation)` (model exchange)
    fmi2CompletedIntegratorStepTYPE = (fmi2Component, fmi2Boolean, *mut fmi2Boolean, *mut fmi2Boolean) -> fmi2Status;
    /// `fmi2SetTime(c, time)` (model exchange)
    fmi2SetTimeTYPE = (fmi2Component, fmi2Real) -> fmi2Status;
    /// `fmi2SetContinuousStates(c, x, nx)` (model exchange)
    fmi2SetContinuousStatesTYPE = (fmi2Component, *const fmi2Real, usize) -> fmi2Status;
    /// `fmi2GetDerivatives(c, derivatives, nx)` (model exchange)
    fmi2GetDerivativesTYPE = (fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
    /// `fmi2GetEventIndicators(c, eventIndicators, ni)` (model exchange)
    fmi2GetEventIndicatorsTYPE = (fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
    /// `fmi2GetContinuousStates(c, x, nx)` (model exchange)
    fmi2GetContinuousStatesTYPE = (fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
    /// `fmi2GetNominalsOfContinuousStates(c, x_nominal, nx)` (model exchange)
    fmi2GetNominalsOfContinuousStatesTYPE = (fmi2Component, *mut fmi2Real, usize) -> fmi2Status;
}
