//! The C functions of an FMU, of a shared library or linked into this program.

use fmu_export::abi;
use libloading::Library;

macro_rules! functions {
    ($($name:ident: $signature:ident,)* ; $($exchange:ident: $exchange_signature:ident,)*) => {
        /// The functions of both interfaces.
        #[derive(Clone, Copy)]
        #[allow(non_snake_case, missing_docs)] // names of the standard
        pub struct Functions {
            $(pub $name: abi::$signature,)*
            /// Those of model exchange, if the FMU has them.
            pub exchange: Option<Exchange>,
        }

        /// The functions of model exchange.
        #[derive(Clone, Copy)]
        #[allow(non_snake_case, missing_docs)]
        pub struct Exchange {
            $(pub $exchange: abi::$exchange_signature,)*
        }

        impl Functions {
            /// Names of all functions but those of model exchange.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($name),)*];

            /// The functions of a library.
            ///
            /// # Errors
            /// If one is missing; those of model exchange may be missing together.
            ///
            /// # Safety
            /// They must have the signatures of FMI 2.0, and are to be called only as long as the library is loaded.
            pub unsafe fn load(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: the caller vouches for the signatures.
                let exchange = unsafe { library.get::<abi::fmi2SetTimeTYPE>("fmi2SetTime") }.is_ok();
                let exchange = exchange.then(|| Ok::<_, libloading::Error>(Exchange {
                    // SAFETY: as above.
                    $($exchange: *unsafe { library.get::<abi::$exchange_signature>(stringify!($exchange)) }?,)*
                }));
                Ok(Self {
                    // SAFETY: as above.
                    $($name: *unsafe { library.get::<abi::$signature>(stringify!($name)) }?,)*
                    exchange: exchange.transpose()?,
                })
            }
        }

        /// The functions of the FMU that is linked into this program, with model exchange, under their own names.
        #[macro_export]
        macro_rules! linked_names {
            () => {
                mod symbols {
                    unsafe extern "C" { $(pub fn $name();)* $(pub fn $exchange();)* }
                }
                // SAFETY: `export_fmu!` has checked the signatures.
                $(pub static $name: $crate::abi::$signature = unsafe {
                    ::core::mem::transmute::<unsafe extern "C" fn(), $crate::abi::$signature>(symbols::$name)
                };)*
                // SAFETY: as above.
                $(pub static $exchange: $crate::abi::$exchange_signature = unsafe {
                    ::core::mem::transmute::<unsafe extern "C" fn(), $crate::abi::$exchange_signature>(symbols::$exchange)
                };)*
            };
        }

        /// The functions of the FMU that is linked into this program; `linked_functions!(model_exchange)` if it has those.
        #[macro_export]
        macro_rules! linked_functions {
            () => { $crate::linked_functions!(@ None) };
            (model_exchange) => {{
                unsafe extern "C" { $(fn $exchange();)* }
                $crate::linked_functions!(@ Some($crate::Exchange {
                    // SAFETY: `export_fmu!` has checked the signature.
                    $($exchange: unsafe {
                        ::core::mem::transmute::<*const (), $crate::abi::$exchange_signature>($exchange as *const ())
                    },)*
                }))
            }};
            (@ $of_exchange:expr) => {{
                unsafe extern "C" { $(fn $name();)* }
                $crate::Functions {
                    // SAFETY: `export_fmu!` has checked the signature.
                    $($name: unsafe {
                        ::core::mem::transmute::<*const (), $crate::abi::$signature>($name as *const ())
                    },)*
                    exchange: $of_exchange,
                }
            }};
        }
    };
}

functions! {
    fmi2GetTypesPlatform: fmi2GetTypesPlatformTYPE,
    fmi2GetVersion: fmi2GetVersionTYPE,
    fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE,
    fmi2Instantiate: fmi2InstantiateTYPE,
    fmi2FreeInstance: fmi2FreeInstanceTYPE,
    fmi2SetupExperiment: fmi2SetupExperimentTYPE,
    fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE,
    fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE,
    fmi2Terminate: fmi2TerminateTYPE,
    fmi2Reset: fmi2ResetTYPE,
    fmi2GetReal: fmi2GetRealTYPE,
    fmi2GetInteger: fmi2GetIntegerTYPE,
    fmi2GetBoolean: fmi2GetBooleanTYPE,
    fmi2GetString: fmi2GetStringTYPE,
    fmi2SetReal: fmi2SetRealTYPE,
    fmi2SetInteger: fmi2SetIntegerTYPE,
    fmi2SetBoolean: fmi2SetBooleanTYPE,
    fmi2SetString: fmi2SetStringTYPE,
    fmi2GetFMUstate: fmi2GetFMUstateTYPE,
    fmi2SetFMUstate: fmi2SetFMUstateTYPE,
    fmi2FreeFMUstate: fmi2FreeFMUstateTYPE,
    fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE,
    fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE,
    fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE,
    fmi2GetDirectionalDerivative: fmi2GetDirectionalDerivativeTYPE,
    fmi2SetRealInputDerivatives: fmi2SetRealInputDerivativesTYPE,
    fmi2GetRealOutputDerivatives: fmi2GetRealOutputDerivativesTYPE,
    fmi2DoStep: fmi2DoStepTYPE,
    fmi2CancelStep: fmi2CancelStepTYPE,
    fmi2GetStatus: fmi2GetStatusTYPE,
    fmi2GetRealStatus: fmi2GetRealStatusTYPE,
    fmi2GetIntegerStatus: fmi2GetIntegerStatusTYPE,
    fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE,
    fmi2GetStringStatus: fmi2GetStringStatusTYPE,
    ;
    fmi2EnterEventMode: fmi2EnterEventModeTYPE,
    fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE,
    fmi2EnterContinuousTimeMode: fmi2EnterContinuousTimeModeTYPE,
    fmi2CompletedIntegratorStep: fmi2CompletedIntegratorStepTYPE,
    fmi2SetTime: fmi2SetTimeTYPE,
    fmi2SetContinuousStates: fmi2SetContinuousStatesTYPE,
    fmi2GetDerivatives: fmi2GetDerivativesTYPE,
    fmi2GetEventIndicators: fmi2GetEventIndicatorsTYPE,
    fmi2GetContinuousStates: fmi2GetContinuousStatesTYPE,
    fmi2GetNominalsOfContinuousStates: fmi2GetNominalsOfContinuousStatesTYPE,
}
