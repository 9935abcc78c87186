//! The C types and function signatures of FMI 3.0 (3.0.2, files `fmi3PlatformTypes.h`, `fmi3FunctionTypes.h` and
//! `fmi3Functions.h`), spelled as the standard spells them.

use core::ffi::{c_char, c_int, c_void};

/// Pointer to the instance, opaque to the caller.
pub type fmi3Instance = *mut c_void;
/// Pointer to the environment of the instance, opaque to the FMU.
pub type fmi3InstanceEnvironment = *mut c_void;
/// Pointer to a saved state of the instance, opaque to the caller.
pub type fmi3FMUState = *mut c_void;
/// Handle of a variable.
pub type fmi3ValueReference = u32;
/// 32-bit floating-point number.
pub type fmi3Float32 = f32;
/// 64-bit floating-point number.
pub type fmi3Float64 = f64;
/// 8-bit signed integer.
pub type fmi3Int8 = i8;
/// 8-bit unsigned integer.
pub type fmi3UInt8 = u8;
/// 16-bit signed integer.
pub type fmi3Int16 = i16;
/// 16-bit unsigned integer.
pub type fmi3UInt16 = u16;
/// 32-bit signed integer.
pub type fmi3Int32 = i32;
/// 32-bit unsigned integer.
pub type fmi3UInt32 = u32;
/// 64-bit signed integer; enumerations travel as this type too.
pub type fmi3Int64 = i64;
/// 64-bit unsigned integer.
pub type fmi3UInt64 = u64;
/// The `bool` of C, as the byte that it is: foreign code may hold other values in it than 0 and 1.
pub type fmi3Boolean = u8;
/// One character of a string.
pub type fmi3Char = c_char;
/// Zero-terminated UTF-8 string.
pub type fmi3String = *const fmi3Char;
/// One byte of a serialised state.
pub type fmi3Byte = u8;
/// Bytes of a length that is told beside them.
pub type fmi3Binary = *const fmi3Byte;
/// Whether a clock ticks: a [`fmi3Boolean`].
pub type fmi3Clock = u8;

/// The true value of [`fmi3Boolean`].
pub const fmi3True: fmi3Boolean = 1;
/// The false value of [`fmi3Boolean`].
pub const fmi3False: fmi3Boolean = 0;
/// A clock that ticks.
pub const fmi3ClockActive: fmi3Clock = 1;
/// A clock that does not.
pub const fmi3ClockInactive: fmi3Clock = 0;

/// Result of a call; the numbers of [`fmi2Status`](crate::fmi2Status), without the pending one.
pub type fmi3Status = c_int;
/// All well.
pub const fmi3OK: fmi3Status = 0;
/// Something is odd, the computation goes on.
pub const fmi3Warning: fmi3Status = 1;
/// The call did nothing; the importer may try another.
pub const fmi3Discard: fmi3Status = 2;
/// This instance cannot go on.
pub const fmi3Error: fmi3Status = 3;
/// No instance of this FMU can go on.
pub const fmi3Fatal: fmi3Status = 4;

/// How an unknown depends on a known.
pub type fmi3DependencyKind = c_int;

/// What is known of the interval of a clock.
pub type fmi3IntervalQualifier = c_int;
/// No interval is known yet.
pub const fmi3IntervalNotYetKnown: fmi3IntervalQualifier = 0;
/// The interval is the one of the last call.
pub const fmi3IntervalUnchanged: fmi3IntervalQualifier = 1;
/// The interval has changed since the last call.
pub const fmi3IntervalChanged: fmi3IntervalQualifier = 2;

/// `void logMessage(instanceEnvironment, status, category, message)`, or NULL.
pub type fmi3LogMessageCallback =
    Option<unsafe extern "C" fn(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String)>;
/// `void intermediateUpdate(instanceEnvironment, intermediateUpdateTime, intermediateVariableSetRequested,
/// intermediateVariableGetAllowed, intermediateStepFinished, canReturnEarly, earlyReturnRequested, earlyReturnTime)`, or NULL.
pub type fmi3IntermediateUpdateCallback = Option<
    unsafe extern "C" fn(
        fmi3InstanceEnvironment,
        fmi3Float64,
        fmi3Boolean,
        fmi3Boolean,
        fmi3Boolean,
        fmi3Boolean,
        *mut fmi3Boolean,
        *mut fmi3Float64,
    ),
>;
/// `void clockUpdate(instanceEnvironment)`, or NULL.
pub type fmi3ClockUpdateCallback = Option<unsafe extern "C" fn(fmi3InstanceEnvironment)>;
/// `void lockPreemption()`, or NULL.
pub type fmi3LockPreemptionCallback = Option<unsafe extern "C" fn()>;
/// `void unlockPreemption()`, or NULL.
pub type fmi3UnlockPreemptionCallback = Option<unsafe extern "C" fn()>;

/// Hands all functions of FMI 3.0 to a macro, as [`functions`](crate::functions) does those of 2.0:
/// `functions3!([callback] tokens)` is `callback! { tokens; create { ... } other { ... } status { ... } }`. Those in
/// `status` take an instance first and return a status.
#[macro_export]
macro_rules! functions3 {
    (@types [$($callback:tt)*] [$($tokens:tt)*]
     $($get:ident $get_type:ident $set:ident $set_type:ident $kind:ident;)*) => {
        $($callback)*! {
            $($tokens)*;
            create {
                fmi3InstantiateModelExchange fmi3InstantiateModelExchangeTYPE(
                    instanceName: fmi3String, instantiationToken: fmi3String, resourcePath: fmi3String,
                    visible: fmi3Boolean, loggingOn: fmi3Boolean, instanceEnvironment: fmi3InstanceEnvironment,
                    logMessage: fmi3LogMessageCallback
                ) -> fmi3Instance;
                fmi3InstantiateCoSimulation fmi3InstantiateCoSimulationTYPE(
                    instanceName: fmi3String, instantiationToken: fmi3String, resourcePath: fmi3String,
                    visible: fmi3Boolean, loggingOn: fmi3Boolean, eventModeUsed: fmi3Boolean,
                    earlyReturnAllowed: fmi3Boolean, requiredIntermediateVariables: *const fmi3ValueReference,
                    nRequiredIntermediateVariables: usize, instanceEnvironment: fmi3InstanceEnvironment,
                    logMessage: fmi3LogMessageCallback, intermediateUpdate: fmi3IntermediateUpdateCallback
                ) -> fmi3Instance;
                fmi3InstantiateScheduledExecution fmi3InstantiateScheduledExecutionTYPE(
                    instanceName: fmi3String, instantiationToken: fmi3String, resourcePath: fmi3String,
                    visible: fmi3Boolean, loggingOn: fmi3Boolean, instanceEnvironment: fmi3InstanceEnvironment,
                    logMessage: fmi3LogMessageCallback, clockUpdate: fmi3ClockUpdateCallback,
                    lockPreemption: fmi3LockPreemptionCallback, unlockPreemption: fmi3UnlockPreemptionCallback
                ) -> fmi3Instance;
            }
            other {
                fmi3GetVersion fmi3GetVersionTYPE() -> fmi3String;
                fmi3FreeInstance fmi3FreeInstanceTYPE(instance: fmi3Instance);
            }
            status {
                fmi3SetDebugLogging fmi3SetDebugLoggingTYPE(
                    loggingOn: fmi3Boolean, nCategories: usize, categories: *const fmi3String
                );
                fmi3EnterInitializationMode fmi3EnterInitializationModeTYPE(
                    toleranceDefined: fmi3Boolean, tolerance: fmi3Float64, startTime: fmi3Float64,
                    stopTimeDefined: fmi3Boolean, stopTime: fmi3Float64
                );
                fmi3ExitInitializationMode fmi3ExitInitializationModeTYPE();
                fmi3EnterEventMode fmi3EnterEventModeTYPE();
                fmi3Terminate fmi3TerminateTYPE();
                fmi3Reset fmi3ResetTYPE();
                $($get $get_type(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, values: *mut $kind, nValues: usize
                );)*
                fmi3GetBinary fmi3GetBinaryTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, valueSizes: *mut usize,
                    values: *mut fmi3Binary, nValues: usize
                );
                fmi3GetClock fmi3GetClockTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, values: *mut fmi3Clock
                );
                $($set $set_type(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, values: *const $kind, nValues: usize
                );)*
                fmi3SetBinary fmi3SetBinaryTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, valueSizes: *const usize,
                    values: *const fmi3Binary, nValues: usize
                );
                fmi3SetClock fmi3SetClockTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, values: *const fmi3Clock
                );
                fmi3GetNumberOfVariableDependencies fmi3GetNumberOfVariableDependenciesTYPE(
                    valueReference: fmi3ValueReference, nDependencies: *mut usize
                );
                fmi3GetVariableDependencies fmi3GetVariableDependenciesTYPE(
                    dependent: fmi3ValueReference, elementIndicesOfDependent: *mut usize,
                    independents: *mut fmi3ValueReference, elementIndicesOfIndependents: *mut usize,
                    dependencyKinds: *mut fmi3DependencyKind, nDependencies: usize
                );
                fmi3GetFMUState fmi3GetFMUStateTYPE(FMUState: *mut fmi3FMUState);
                fmi3SetFMUState fmi3SetFMUStateTYPE(FMUState: fmi3FMUState);
                fmi3FreeFMUState fmi3FreeFMUStateTYPE(FMUState: *mut fmi3FMUState);
                fmi3SerializedFMUStateSize fmi3SerializedFMUStateSizeTYPE(FMUState: fmi3FMUState, size: *mut usize);
                fmi3SerializeFMUState fmi3SerializeFMUStateTYPE(
                    FMUState: fmi3FMUState, serializedState: *mut fmi3Byte, size: usize
                );
                fmi3DeserializeFMUState fmi3DeserializeFMUStateTYPE(
                    serializedState: *const fmi3Byte, size: usize, FMUState: *mut fmi3FMUState
                );
                fmi3GetDirectionalDerivative fmi3GetDirectionalDerivativeTYPE(
                    unknowns: *const fmi3ValueReference, nUnknowns: usize, knowns: *const fmi3ValueReference,
                    nKnowns: usize, seed: *const fmi3Float64, nSeed: usize, sensitivity: *mut fmi3Float64,
                    nSensitivity: usize
                );
                fmi3GetAdjointDerivative fmi3GetAdjointDerivativeTYPE(
                    unknowns: *const fmi3ValueReference, nUnknowns: usize, knowns: *const fmi3ValueReference,
                    nKnowns: usize, seed: *const fmi3Float64, nSeed: usize, sensitivity: *mut fmi3Float64,
                    nSensitivity: usize
                );
                fmi3EnterConfigurationMode fmi3EnterConfigurationModeTYPE();
                fmi3ExitConfigurationMode fmi3ExitConfigurationModeTYPE();
                fmi3GetIntervalDecimal fmi3GetIntervalDecimalTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, intervals: *mut fmi3Float64,
                    qualifiers: *mut fmi3IntervalQualifier
                );
                fmi3GetIntervalFraction fmi3GetIntervalFractionTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, counters: *mut fmi3UInt64,
                    resolutions: *mut fmi3UInt64, qualifiers: *mut fmi3IntervalQualifier
                );
                fmi3GetShiftDecimal fmi3GetShiftDecimalTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, shifts: *mut fmi3Float64
                );
                fmi3GetShiftFraction fmi3GetShiftFractionTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, counters: *mut fmi3UInt64,
                    resolutions: *mut fmi3UInt64
                );
                fmi3SetIntervalDecimal fmi3SetIntervalDecimalTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, intervals: *const fmi3Float64
                );
                fmi3SetIntervalFraction fmi3SetIntervalFractionTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, counters: *const fmi3UInt64,
                    resolutions: *const fmi3UInt64
                );
                fmi3SetShiftDecimal fmi3SetShiftDecimalTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, shifts: *const fmi3Float64
                );
                fmi3SetShiftFraction fmi3SetShiftFractionTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, counters: *const fmi3UInt64,
                    resolutions: *const fmi3UInt64
                );
                fmi3EvaluateDiscreteStates fmi3EvaluateDiscreteStatesTYPE();
                fmi3UpdateDiscreteStates fmi3UpdateDiscreteStatesTYPE(
                    discreteStatesNeedUpdate: *mut fmi3Boolean, terminateSimulation: *mut fmi3Boolean,
                    nominalsOfContinuousStatesChanged: *mut fmi3Boolean,
                    valuesOfContinuousStatesChanged: *mut fmi3Boolean, nextEventTimeDefined: *mut fmi3Boolean,
                    nextEventTime: *mut fmi3Float64
                );
                fmi3EnterContinuousTimeMode fmi3EnterContinuousTimeModeTYPE();
                fmi3CompletedIntegratorStep fmi3CompletedIntegratorStepTYPE(
                    noSetFMUStatePriorToCurrentPoint: fmi3Boolean, enterEventMode: *mut fmi3Boolean,
                    terminateSimulation: *mut fmi3Boolean
                );
                fmi3SetTime fmi3SetTimeTYPE(time: fmi3Float64);
                fmi3SetContinuousStates fmi3SetContinuousStatesTYPE(
                    continuousStates: *const fmi3Float64, nContinuousStates: usize
                );
                fmi3GetContinuousStateDerivatives fmi3GetContinuousStateDerivativesTYPE(
                    derivatives: *mut fmi3Float64, nContinuousStates: usize
                );
                fmi3GetEventIndicators fmi3GetEventIndicatorsTYPE(
                    eventIndicators: *mut fmi3Float64, nEventIndicators: usize
                );
                fmi3GetContinuousStates fmi3GetContinuousStatesTYPE(
                    continuousStates: *mut fmi3Float64, nContinuousStates: usize
                );
                fmi3GetNominalsOfContinuousStates fmi3GetNominalsOfContinuousStatesTYPE(
                    nominals: *mut fmi3Float64, nContinuousStates: usize
                );
                fmi3GetNumberOfEventIndicators fmi3GetNumberOfEventIndicatorsTYPE(nEventIndicators: *mut usize);
                fmi3GetNumberOfContinuousStates fmi3GetNumberOfContinuousStatesTYPE(nContinuousStates: *mut usize);
                fmi3EnterStepMode fmi3EnterStepModeTYPE();
                fmi3GetOutputDerivatives fmi3GetOutputDerivativesTYPE(
                    valueReferences: *const fmi3ValueReference, nValueReferences: usize, orders: *const fmi3Int32,
                    values: *mut fmi3Float64, nValues: usize
                );
                fmi3DoStep fmi3DoStepTYPE(
                    currentCommunicationPoint: fmi3Float64, communicationStepSize: fmi3Float64,
                    noSetFMUStatePriorToCurrentPoint: fmi3Boolean, eventHandlingNeeded: *mut fmi3Boolean,
                    terminateSimulation: *mut fmi3Boolean, earlyReturn: *mut fmi3Boolean,
                    lastSuccessfulTime: *mut fmi3Float64
                );
                fmi3ActivateModelPartition fmi3ActivateModelPartitionTYPE(
                    clockReference: fmi3ValueReference, activationTime: fmi3Float64
                );
            }
        }
    };
    ([$($callback:tt)*] $($tokens:tt)*) => {
        $crate::functions3! {
            @types [$($callback)*] [$($tokens)*]
            fmi3GetFloat32 fmi3GetFloat32TYPE fmi3SetFloat32 fmi3SetFloat32TYPE fmi3Float32;
            fmi3GetFloat64 fmi3GetFloat64TYPE fmi3SetFloat64 fmi3SetFloat64TYPE fmi3Float64;
            fmi3GetInt8 fmi3GetInt8TYPE fmi3SetInt8 fmi3SetInt8TYPE fmi3Int8;
            fmi3GetUInt8 fmi3GetUInt8TYPE fmi3SetUInt8 fmi3SetUInt8TYPE fmi3UInt8;
            fmi3GetInt16 fmi3GetInt16TYPE fmi3SetInt16 fmi3SetInt16TYPE fmi3Int16;
            fmi3GetUInt16 fmi3GetUInt16TYPE fmi3SetUInt16 fmi3SetUInt16TYPE fmi3UInt16;
            fmi3GetInt32 fmi3GetInt32TYPE fmi3SetInt32 fmi3SetInt32TYPE fmi3Int32;
            fmi3GetUInt32 fmi3GetUInt32TYPE fmi3SetUInt32 fmi3SetUInt32TYPE fmi3UInt32;
            fmi3GetInt64 fmi3GetInt64TYPE fmi3SetInt64 fmi3SetInt64TYPE fmi3Int64;
            fmi3GetUInt64 fmi3GetUInt64TYPE fmi3SetUInt64 fmi3SetUInt64TYPE fmi3UInt64;
            fmi3GetBoolean fmi3GetBooleanTYPE fmi3SetBoolean fmi3SetBooleanTYPE fmi3Boolean;
            fmi3GetString fmi3GetStringTYPE fmi3SetString fmi3SetStringTYPE fmi3String;
        }
    };
}

functions3!([types] instance: fmi3Instance, fmi3Status);
