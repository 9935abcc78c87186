//! The functions of FMI 2.0 on an instance, as values: this process calls them, or a worker is asked to.

use std::borrow::Cow;
use std::ffi::CString;

use serde::{Deserialize, Serialize};

/// An array: the caller's, or in a worker its own.
type Array<'a, T> = Cow<'a, [T]>;

/// A function with its arguments; the first three are for workers alone. States are addresses, or in messages to a worker numbers;
/// 0 is none.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Request<'a> {
    Instantiate { name: CString, guid: CString, resources: CString, debug: bool },
    Free,
    Unload, // the library
    SetDebugLogging { on: bool, categories: Array<'a, CString> },
    SetupExperiment { tolerance: Option<f64>, start: f64, stop: Option<f64> },
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    DoStep { time: f64, step: f64 },
    GetReal { references: Array<'a, u32> },
    GetInteger { references: Array<'a, u32> },
    GetBoolean { references: Array<'a, u32> },
    GetString { references: Array<'a, u32> },
    SetReal { references: Array<'a, u32>, values: Array<'a, f64> },
    SetInteger { references: Array<'a, u32>, values: Array<'a, i32> },
    SetBoolean { references: Array<'a, u32>, values: Array<'a, i32> },
    SetString { references: Array<'a, u32>, values: Array<'a, CString> },
    SetInputDerivatives { references: Array<'a, u32>, orders: Array<'a, i32>, values: Array<'a, f64> },
    GetOutputDerivatives { references: Array<'a, u32>, orders: Array<'a, i32> },
    DirectionalDerivative { unknowns: Array<'a, u32>, knowns: Array<'a, u32>, seed: Array<'a, f64> },
    GetState { state: u64 },
    SetState { state: u64 },
    FreeState { state: u64 },
    StateSize { state: u64 },
    SerializeState { state: u64, size: u64 },
    DeserializeState { bytes: Array<'a, u8> },
    LastSuccessfulTime,
    Terminated,
}

impl Request<'_> {
    /// Name of the function.
    pub fn function(&self) -> &'static str {
        match self {
            Self::Instantiate { .. } => "fmi2Instantiate",
            Self::Free => "fmi2FreeInstance",
            Self::Unload => "unloading the library",
            Self::SetDebugLogging { .. } => "fmi2SetDebugLogging",
            Self::SetupExperiment { .. } => "fmi2SetupExperiment",
            Self::EnterInitializationMode => "fmi2EnterInitializationMode",
            Self::ExitInitializationMode => "fmi2ExitInitializationMode",
            Self::Terminate => "fmi2Terminate",
            Self::Reset => "fmi2Reset",
            Self::DoStep { .. } => "fmi2DoStep",
            Self::GetReal { .. } => "fmi2GetReal",
            Self::GetInteger { .. } => "fmi2GetInteger",
            Self::GetBoolean { .. } => "fmi2GetBoolean",
            Self::GetString { .. } => "fmi2GetString",
            Self::SetReal { .. } => "fmi2SetReal",
            Self::SetInteger { .. } => "fmi2SetInteger",
            Self::SetBoolean { .. } => "fmi2SetBoolean",
            Self::SetString { .. } => "fmi2SetString",
            Self::SetInputDerivatives { .. } => "fmi2SetRealInputDerivatives",
            Self::GetOutputDerivatives { .. } => "fmi2GetRealOutputDerivatives",
            Self::DirectionalDerivative { .. } => "fmi2GetDirectionalDerivative",
            Self::GetState { .. } => "fmi2GetFMUstate",
            Self::SetState { .. } => "fmi2SetFMUstate",
            Self::FreeState { .. } => "fmi2FreeFMUstate",
            Self::StateSize { .. } => "fmi2SerializedFMUstateSize",
            Self::SerializeState { .. } => "fmi2SerializeFMUstate",
            Self::DeserializeState { .. } => "fmi2DeSerializeFMUstate",
            Self::LastSuccessfulTime => "fmi2GetRealStatus",
            Self::Terminated => "fmi2GetBooleanStatus",
        }
    }

    /// The state that it is about.
    pub fn state(&mut self) -> Option<&mut u64> {
        match self {
            Self::GetState { state }
            | Self::SetState { state }
            | Self::FreeState { state }
            | Self::StateSize { state }
            | Self::SerializeState { state, .. } => Some(state),
            _ => None,
        }
    }
}

/// Where a function puts what it gives besides its status. Booleans are integers, as in C; states and sizes are numbers.
#[derive(Debug)]
pub(super) enum Results<'a> {
    None,
    Reals(&'a mut [f64]),
    Integers(&'a mut [i32]),
    Texts(&'a mut [CString]),
    Bytes(&'a mut [u8]),
    Number(&'a mut u64),
}
