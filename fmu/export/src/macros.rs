//! The macro that gives a slave its exported C symbols.

/// Exports a [`Slave`](crate::Slave) as an FMU: defines every C function of FMI 2.0 for co-simulation and, with
/// `export_fmu!(MySlave, model_exchange)`, those for model exchange. Use it once in a `cdylib`. The functions exist as C symbols only; the macro leaves no Rust names behind.
///
/// Each function is checked at compile time against its signature in [`abi`](crate::abi).
#[macro_export]
macro_rules! export_fmu {
    ($slave:ty, model_exchange) => {
        $crate::export_fmu!($slave);
        const _: () = {
            use $crate::abi::*;

            $crate::__export_fmu_functions! { $slave;
                fmi2EnterEventMode: fmi2EnterEventModeTYPE = model_exchange::enter_event_mode ();
                fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE = model_exchange::new_discrete_states
                    (info: *mut fmi2EventInfo);
                fmi2EnterContinuousTimeMode: fmi2EnterContinuousTimeModeTYPE = model_exchange::enter_continuous_time_mode ();
                fmi2CompletedIntegratorStep: fmi2CompletedIntegratorStepTYPE = model_exchange::completed_integrator_step
                    (no_set_fmu_state_prior_to_current_point: fmi2Boolean, enter_event_mode: *mut fmi2Boolean,
                     terminate_simulation: *mut fmi2Boolean);
                fmi2SetTime: fmi2SetTimeTYPE = model_exchange::set_time (time: fmi2Real);
                fmi2SetContinuousStates: fmi2SetContinuousStatesTYPE = model_exchange::set_continuous_states
                    (x: *const fmi2Real, nx: usize);
                fmi2GetDerivatives: fmi2GetDerivativesTYPE = model_exchange::get_derivatives
                    (derivatives: *mut fmi2Real, nx: usize);
                fmi2GetEventIndicators: fmi2GetEventIndicatorsTYPE = model_exchange::get_event_indicators
                    (indicators: *mut fmi2Real, ni: usize);
                fmi2GetContinuousStates: fmi2GetContinuousStatesTYPE = model_exchange::get_continuous_states
                    (x: *mut fmi2Real, nx: usize);
                fmi2GetNominalsOfContinuousStates: fmi2GetNominalsOfContinuousStatesTYPE = model_exchange::get_nominals
                    (nominals: *mut fmi2Real, nx: usize);
            }
        };
    };
    ($slave:ty) => {
        const _: () = {
            use ::core::ffi::c_char;
            use $crate::abi::*;

            static FMU: $crate::ffi::Fmu = $crate::ffi::Fmu::new();

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi2Instantiate(
                name: fmi2String,
                kind: fmi2Type,
                guid: fmi2String,
                resources: fmi2String,
                functions: *const fmi2CallbackFunctions,
                visible: fmi2Boolean,
                logging: fmi2Boolean,
            ) -> fmi2Component {
                // SAFETY: the importer keeps the contract of the C function.
                unsafe {
                    $crate::ffi::instantiate::instantiate::<$slave>(
                        &FMU, name, kind, guid, resources, functions, visible, logging,
                    )
                }
            }
            const _: fmi2InstantiateTYPE = fmi2Instantiate;

            #[unsafe(no_mangle)]
            extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
                $crate::ffi::common::get_types_platform()
            }
            const _: fmi2GetTypesPlatformTYPE = fmi2GetTypesPlatform;

            #[unsafe(no_mangle)]
            extern "C" fn fmi2GetVersion() -> *const c_char {
                $crate::ffi::common::get_version()
            }
            const _: fmi2GetVersionTYPE = fmi2GetVersion;

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
                // SAFETY: the importer keeps the contract of the C function.
                unsafe { $crate::ffi::instantiate::free_instance::<$slave>(c) }
            }
            const _: fmi2FreeInstanceTYPE = fmi2FreeInstance;

            $crate::__export_fmu_functions! { $slave;
                fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE = common::set_debug_logging
                    (on: fmi2Boolean, count: usize, categories: *const fmi2String);
                fmi2SetupExperiment: fmi2SetupExperimentTYPE = common::setup_experiment
                    (tolerance_defined: fmi2Boolean, tolerance: fmi2Real, start_time: fmi2Real,
                     stop_time_defined: fmi2Boolean, stop_time: fmi2Real);
                fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE = common::enter_initialization_mode ();
                fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE = common::exit_initialization_mode ();
                fmi2Terminate: fmi2TerminateTYPE = common::terminate ();
                fmi2Reset: fmi2ResetTYPE = common::reset ();
                fmi2GetReal: fmi2GetRealTYPE = common::get_real
                    (vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Real);
                fmi2GetInteger: fmi2GetIntegerTYPE = common::get_integer
                    (vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Integer);
                fmi2GetBoolean: fmi2GetBooleanTYPE = common::get_boolean
                    (vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Boolean);
                fmi2GetString: fmi2GetStringTYPE = common::get_string
                    (vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2String);
                fmi2SetReal: fmi2SetRealTYPE = common::set_real
                    (vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Real);
                fmi2SetInteger: fmi2SetIntegerTYPE = common::set_integer
                    (vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Integer);
                fmi2SetBoolean: fmi2SetBooleanTYPE = common::set_boolean
                    (vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Boolean);
                fmi2SetString: fmi2SetStringTYPE = common::set_string
                    (vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2String);
                fmi2GetFMUstate: fmi2GetFMUstateTYPE = state::get_fmu_state (state: *mut fmi2FMUstate);
                fmi2SetFMUstate: fmi2SetFMUstateTYPE = state::set_fmu_state (state: fmi2FMUstate);
                fmi2FreeFMUstate: fmi2FreeFMUstateTYPE = state::free_fmu_state (state: *mut fmi2FMUstate);
                fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE = state::serialized_fmu_state_size
                    (state: fmi2FMUstate, size: *mut usize);
                fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE = state::serialize_fmu_state
                    (state: fmi2FMUstate, bytes: *mut fmi2Byte, size: usize);
                fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE = state::deserialize_fmu_state
                    (bytes: *const fmi2Byte, size: usize, state: *mut fmi2FMUstate);
                fmi2GetDirectionalDerivative: fmi2GetDirectionalDerivativeTYPE = state::get_directional_derivative
                    (unknown: *const fmi2ValueReference, unknown_count: usize, known: *const fmi2ValueReference,
                     known_count: usize, known_seed: *const fmi2Real, unknown_sensitivity: *mut fmi2Real);
                fmi2SetRealInputDerivatives: fmi2SetRealInputDerivativesTYPE = co_simulation::set_real_input_derivatives
                    (vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *const fmi2Real);
                fmi2GetRealOutputDerivatives: fmi2GetRealOutputDerivativesTYPE = co_simulation::get_real_output_derivatives
                    (vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *mut fmi2Real);
                fmi2DoStep: fmi2DoStepTYPE = co_simulation::do_step
                    (current_communication_point: fmi2Real, communication_step_size: fmi2Real,
                     no_set_fmu_state_prior_to_current_point: fmi2Boolean);
                fmi2CancelStep: fmi2CancelStepTYPE = co_simulation::cancel_step ();
                fmi2GetStatus: fmi2GetStatusTYPE = co_simulation::get_status
                    (kind: fmi2StatusKind, value: *mut fmi2Status);
                fmi2GetRealStatus: fmi2GetRealStatusTYPE = co_simulation::get_real_status
                    (kind: fmi2StatusKind, value: *mut fmi2Real);
                fmi2GetIntegerStatus: fmi2GetIntegerStatusTYPE = co_simulation::get_integer_status
                    (kind: fmi2StatusKind, value: *mut fmi2Integer);
                fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE = co_simulation::get_boolean_status
                    (kind: fmi2StatusKind, value: *mut fmi2Boolean);
                fmi2GetStringStatus: fmi2GetStringStatusTYPE = co_simulation::get_string_status
                    (kind: fmi2StatusKind, value: *mut fmi2String);
            }
        };
    };
}

/// Defines functions that take a component first and return a status. To be used where the ABI is in scope.
#[doc(hidden)]
#[macro_export]
macro_rules! __export_fmu_functions {
    ($slave:ty; $($name:ident: $signature:ident = $module:ident::$body:ident
        ($($argument:ident: $kind:ty),*);)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name(c: fmi2Component, $($argument: $kind),*) -> fmi2Status {
            // SAFETY: the importer keeps the contract of the C function.
            unsafe { $crate::ffi::$module::$body::<$slave>(c, $($argument),*) }
        }
        const _: $signature = $name;
    )*};
}
