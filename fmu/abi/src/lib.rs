//! The C types and function signatures of FMI 2.0 and, in [`fmi3`], of FMI 3.0. Those here are of FMI 2.0 (2.0.4, files `fmi2TypesPlatform.h`, `fmi2FunctionTypes.h`
//! and `fmi2Functions.h`), spelled as the standard spells them.
//!
//! Nothing else lives here, but what a packager asks a library ([`describe`]): exporter, importer and packager meet on these types.
//! Enumerations arrive from foreign
//! code, so they are plain integers with named constants: an unexpected value must not be undefined behaviour.
#![no_std]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]

/// The types of all functions. Those outside of `create` and `other` take this instance first and return this status.
macro_rules! types {
    ($instance:ident: $instance_type:ty, $status:ty;
     create { $($create:tt)* } other { $($other:tt)* } $($group:ident { $($functions:tt)* })*) => {
        types! { $($create)* $($other)* }
        $(types! { @status $instance: $instance_type, $status; $($functions)* })*
    };
    (@status $instance:ident: $instance_type:ty, $status:ty;
     $($name:ident $signature:ident($($argument:ident: $kind:ty),*);)*) => {
        types! { $($name $signature($instance: $instance_type $(, $argument: $kind)*) -> $status;)* }
    };
    ($($name:ident $signature:ident($($argument:ident: $kind:ty),*) $(-> $ret:ty)?;)*) => {$(
        #[doc = concat!("`", stringify!($name), "`")]
        pub type $signature = unsafe extern "C" fn($($argument: $kind),*) $(-> $ret)?;
    )*};
}

pub mod describe;
pub mod fmi3;

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

/// Hands all functions of FMI 2.0 to a macro, each with the name of its type and its arguments, whose types the caller has in
/// scope: `functions!([callback] tokens)` is
/// `callback! { tokens; create { ... } other { ... } common { ... } exchange { ... } }`. Those in `common`, of both
/// interfaces or co-simulation, and in `exchange`, of model exchange, take a component first and return a status.
#[macro_export]
macro_rules! functions {
    ([$($callback:tt)*] $($tokens:tt)*) => {
        $($callback)*! {
            $($tokens)*;
            create {
                fmi2Instantiate fmi2InstantiateTYPE(
                    instanceName: fmi2String, fmuType: fmi2Type, fmuGUID: fmi2String, fmuResourceLocation: fmi2String,
                    functions: *const fmi2CallbackFunctions, visible: fmi2Boolean, loggingOn: fmi2Boolean
                ) -> fmi2Component;
            }
            other {
                fmi2GetTypesPlatform fmi2GetTypesPlatformTYPE() -> fmi2String;
                fmi2GetVersion fmi2GetVersionTYPE() -> fmi2String;
                fmi2FreeInstance fmi2FreeInstanceTYPE(c: fmi2Component);
            }
            common {
                fmi2SetDebugLogging fmi2SetDebugLoggingTYPE(
                    loggingOn: fmi2Boolean, nCategories: usize, categories: *const fmi2String
                );
                fmi2SetupExperiment fmi2SetupExperimentTYPE(
                    toleranceDefined: fmi2Boolean, tolerance: fmi2Real, startTime: fmi2Real,
                    stopTimeDefined: fmi2Boolean, stopTime: fmi2Real
                );
                fmi2EnterInitializationMode fmi2EnterInitializationModeTYPE();
                fmi2ExitInitializationMode fmi2ExitInitializationModeTYPE();
                fmi2Terminate fmi2TerminateTYPE();
                fmi2Reset fmi2ResetTYPE();
                fmi2GetReal fmi2GetRealTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Real);
                fmi2GetInteger fmi2GetIntegerTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Integer);
                fmi2GetBoolean fmi2GetBooleanTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Boolean);
                fmi2GetString fmi2GetStringTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2String);
                fmi2SetReal fmi2SetRealTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Real);
                fmi2SetInteger fmi2SetIntegerTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Integer);
                fmi2SetBoolean fmi2SetBooleanTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Boolean);
                fmi2SetString fmi2SetStringTYPE(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2String);
                fmi2GetFMUstate fmi2GetFMUstateTYPE(FMUstate: *mut fmi2FMUstate);
                fmi2SetFMUstate fmi2SetFMUstateTYPE(FMUstate: fmi2FMUstate);
                fmi2FreeFMUstate fmi2FreeFMUstateTYPE(FMUstate: *mut fmi2FMUstate);
                fmi2SerializedFMUstateSize fmi2SerializedFMUstateSizeTYPE(FMUstate: fmi2FMUstate, size: *mut usize);
                fmi2SerializeFMUstate fmi2SerializeFMUstateTYPE(
                    FMUstate: fmi2FMUstate, serializedState: *mut fmi2Byte, size: usize
                );
                fmi2DeSerializeFMUstate fmi2DeSerializeFMUstateTYPE(
                    serializedState: *const fmi2Byte, size: usize, FMUstate: *mut fmi2FMUstate
                );
                fmi2GetDirectionalDerivative fmi2GetDirectionalDerivativeTYPE(
                    vUnknown_ref: *const fmi2ValueReference, nUnknown: usize, vKnown_ref: *const fmi2ValueReference,
                    nKnown: usize, dvKnown: *const fmi2Real, dvUnknown: *mut fmi2Real
                );
                fmi2SetRealInputDerivatives fmi2SetRealInputDerivativesTYPE(
                    vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *const fmi2Real
                );
                fmi2GetRealOutputDerivatives fmi2GetRealOutputDerivativesTYPE(
                    vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *mut fmi2Real
                );
                fmi2DoStep fmi2DoStepTYPE(
                    currentCommunicationPoint: fmi2Real, communicationStepSize: fmi2Real,
                    noSetFMUStatePriorToCurrentPoint: fmi2Boolean
                );
                fmi2CancelStep fmi2CancelStepTYPE();
                fmi2GetStatus fmi2GetStatusTYPE(s: fmi2StatusKind, value: *mut fmi2Status);
                fmi2GetRealStatus fmi2GetRealStatusTYPE(s: fmi2StatusKind, value: *mut fmi2Real);
                fmi2GetIntegerStatus fmi2GetIntegerStatusTYPE(s: fmi2StatusKind, value: *mut fmi2Integer);
                fmi2GetBooleanStatus fmi2GetBooleanStatusTYPE(s: fmi2StatusKind, value: *mut fmi2Boolean);
                fmi2GetStringStatus fmi2GetStringStatusTYPE(s: fmi2StatusKind, value: *mut fmi2String);
            }
            exchange {
                fmi2EnterEventMode fmi2EnterEventModeTYPE();
                fmi2NewDiscreteStates fmi2NewDiscreteStatesTYPE(eventInfo: *mut fmi2EventInfo);
                fmi2EnterContinuousTimeMode fmi2EnterContinuousTimeModeTYPE();
                fmi2CompletedIntegratorStep fmi2CompletedIntegratorStepTYPE(
                    noSetFMUStatePriorToCurrentPoint: fmi2Boolean, enterEventMode: *mut fmi2Boolean,
                    terminateSimulation: *mut fmi2Boolean
                );
                fmi2SetTime fmi2SetTimeTYPE(time: fmi2Real);
                fmi2SetContinuousStates fmi2SetContinuousStatesTYPE(x: *const fmi2Real, nx: usize);
                fmi2GetDerivatives fmi2GetDerivativesTYPE(derivatives: *mut fmi2Real, nx: usize);
                fmi2GetEventIndicators fmi2GetEventIndicatorsTYPE(eventIndicators: *mut fmi2Real, ni: usize);
                fmi2GetContinuousStates fmi2GetContinuousStatesTYPE(x: *mut fmi2Real, nx: usize);
                fmi2GetNominalsOfContinuousStates fmi2GetNominalsOfContinuousStatesTYPE(
                    x_nominal: *mut fmi2Real, nx: usize
                );
            }
        }
    };
}

functions!([types] c: fmi2Component, fmi2Status);
