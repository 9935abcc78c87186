//! Any function, with arguments that are right or random.

use super::{Fmu, Row};
use crate::Random;
use core::ptr::{null, null_mut};
use fmu_export::abi::fmi3::*;
use fmu_export::fmi3::Function;

impl Row {
    /// Whether this is a clock of this causality.
    fn is_clock(&self, causality: &str) -> bool {
        self.type_name == "Clock" && self.causality == causality
    }

    /// Whether it can be set in some state.
    fn is_settable(&self) -> bool {
        matches!(self.causality.as_str(), "parameter" | "input")
    }
}

impl Fmu {
    /// The first variable that `test` picks, or one that is none.
    fn first(&self, test: impl Fn(&Row) -> bool) -> u32 {
        self.references(test).first().copied().unwrap_or(u32::MAX)
    }
}

/// Calls a function with arguments that are right as such. `state` is an FMU state of the instance or NULL. Only
/// `fmi3DeserializeFMUState` calls others before, which make its bytes, unless `state` is NULL.
#[allow(clippy::too_many_lines)] // all functions
pub fn call(fmu: &Fmu, instance: fmi3Instance, function: Function, mut state: fmi3FMUState) -> fmi3Status {
    use Function as F;
    let i = instance;
    let (mut float, number, mut size, mut flags, mut long) = (0.0, 1, 0, [0_u8; 5], 0);
    let (mut qualifier, mut fresh, mut bytes) = (0, null_mut(), [0_u8; 4096]);
    let f = &fmu.functions;
    let (clock, tick) = (fmu.first(|row| row.is_clock("input")), fmi3ClockInactive);
    let output = fmu.first(|row| row.type_name == "Float64" && row.causality == "output");
    let [a, b, c, d, e] = &mut flags;
    macro_rules! none {
        ($function:ident) => {
            (f.$function)(i, null(), 0, null_mut(), 0)
        };
        (set $function:ident) => {
            (f.$function)(i, null(), 0, null(), 0)
        };
    }
    unsafe {
        match function {
            F::SetDebugLogging => (f.fmi3SetDebugLogging)(i, 1, 0, null()),
            F::FreeInstance => unreachable!("it has no status"),
            F::EnterInitializationMode => (f.fmi3EnterInitializationMode)(i, 0, 0.0, 0.0, 0, 0.0),
            F::ExitInitializationMode => (f.fmi3ExitInitializationMode)(i),
            F::EnterEventMode => (f.fmi3EnterEventMode)(i),
            F::Terminate => (f.fmi3Terminate)(i),
            F::Reset => (f.fmi3Reset)(i),
            F::GetFloat32 => none!(fmi3GetFloat32),
            F::GetFloat64 => none!(fmi3GetFloat64),
            F::GetInt8 => none!(fmi3GetInt8),
            F::GetUInt8 => none!(fmi3GetUInt8),
            F::GetInt16 => none!(fmi3GetInt16),
            F::GetUInt16 => none!(fmi3GetUInt16),
            F::GetInt32 => none!(fmi3GetInt32),
            F::GetUInt32 => none!(fmi3GetUInt32),
            F::GetInt64 => none!(fmi3GetInt64),
            F::GetUInt64 => none!(fmi3GetUInt64),
            F::GetBoolean => none!(fmi3GetBoolean),
            F::GetString => none!(fmi3GetString),
            F::GetBinary => (f.fmi3GetBinary)(i, null(), 0, null_mut(), null_mut(), 0),
            F::GetClock => (f.fmi3GetClock)(i, null(), 0, null_mut()),
            F::SetFloat32 => none!(set fmi3SetFloat32),
            F::SetFloat64 => none!(set fmi3SetFloat64),
            F::SetInt8 => none!(set fmi3SetInt8),
            F::SetUInt8 => none!(set fmi3SetUInt8),
            F::SetInt16 => none!(set fmi3SetInt16),
            F::SetUInt16 => none!(set fmi3SetUInt16),
            F::SetInt32 => none!(set fmi3SetInt32),
            F::SetUInt32 => none!(set fmi3SetUInt32),
            F::SetInt64 => none!(set fmi3SetInt64),
            F::SetUInt64 => none!(set fmi3SetUInt64),
            F::SetBoolean => none!(set fmi3SetBoolean),
            F::SetString => none!(set fmi3SetString),
            F::SetBinary => (f.fmi3SetBinary)(i, null(), 0, null(), null(), 0),
            F::SetClock => (f.fmi3SetClock)(i, &raw const clock, 1, &raw const tick),
            F::GetNumberOfVariableDependencies => (f.fmi3GetNumberOfVariableDependencies)(i, 0, &raw mut size),
            F::GetVariableDependencies => {
                (f.fmi3GetVariableDependencies)(i, 0, null_mut(), null_mut(), null_mut(), null_mut(), 0)
            }
            F::GetFmuState => (f.fmi3GetFMUState)(i, &raw mut fresh),
            F::SetFmuState => (f.fmi3SetFMUState)(i, state),
            F::FreeFmuState => (f.fmi3FreeFMUState)(i, &raw mut state),
            F::SerializedFmuStateSize => (f.fmi3SerializedFMUStateSize)(i, state, &raw mut size),
            F::SerializeFmuState => (f.fmi3SerializeFMUState)(i, state, bytes.as_mut_ptr(), bytes.len()),
            F::DeserializeFmuState => {
                if !state.is_null() {
                    (f.fmi3SerializedFMUStateSize)(i, state, &raw mut size);
                    (f.fmi3SerializeFMUState)(i, state, bytes.as_mut_ptr(), bytes.len());
                }
                (f.fmi3DeserializeFMUState)(i, bytes.as_ptr(), size, &raw mut fresh)
            }
            F::GetDirectionalDerivative => {
                (f.fmi3GetDirectionalDerivative)(i, null(), 0, null(), 0, null(), 0, null_mut(), 0)
            }
            F::GetAdjointDerivative => (f.fmi3GetAdjointDerivative)(i, null(), 0, null(), 0, null(), 0, null_mut(), 0),
            F::EnterConfigurationMode => (f.fmi3EnterConfigurationMode)(i),
            F::ExitConfigurationMode => (f.fmi3ExitConfigurationMode)(i),
            F::GetIntervalDecimal => {
                (f.fmi3GetIntervalDecimal)(i, &raw const clock, 1, &raw mut float, &raw mut qualifier)
            }
            F::GetIntervalFraction => {
                (f.fmi3GetIntervalFraction)(i, &raw const clock, 1, &raw mut long, &raw mut long, &raw mut qualifier)
            }
            F::GetShiftDecimal => (f.fmi3GetShiftDecimal)(i, &raw const clock, 1, &raw mut float),
            F::GetShiftFraction => (f.fmi3GetShiftFraction)(i, &raw const clock, 1, &raw mut long, &raw mut long),
            F::SetIntervalDecimal => (f.fmi3SetIntervalDecimal)(i, &raw const clock, 1, &raw const float),
            F::SetIntervalFraction => {
                (f.fmi3SetIntervalFraction)(i, &raw const clock, 1, &raw const long, &raw const long)
            }
            F::SetShiftDecimal => (f.fmi3SetShiftDecimal)(i, &raw const clock, 1, &raw const float),
            F::SetShiftFraction => (f.fmi3SetShiftFraction)(i, &raw const clock, 1, &raw const long, &raw const long),
            F::EvaluateDiscreteStates => (f.fmi3EvaluateDiscreteStates)(i),
            F::UpdateDiscreteStates => (f.fmi3UpdateDiscreteStates)(i, a, b, c, d, e, &raw mut float),
            F::EnterContinuousTimeMode => (f.fmi3EnterContinuousTimeMode)(i),
            F::CompletedIntegratorStep => (f.fmi3CompletedIntegratorStep)(i, 1, a, b),
            F::SetTime => (f.fmi3SetTime)(i, 0.25),
            F::SetContinuousStates => (f.fmi3SetContinuousStates)(i, &raw const float, 1),
            F::GetContinuousStateDerivatives => (f.fmi3GetContinuousStateDerivatives)(i, &raw mut float, 1),
            F::GetEventIndicators => (f.fmi3GetEventIndicators)(i, &raw mut float, 1),
            F::GetContinuousStates => (f.fmi3GetContinuousStates)(i, &raw mut float, 1),
            F::GetNominals => (f.fmi3GetNominalsOfContinuousStates)(i, &raw mut float, 1),
            F::GetNumberOfEventIndicators => (f.fmi3GetNumberOfEventIndicators)(i, &raw mut size),
            F::GetNumberOfContinuousStates => (f.fmi3GetNumberOfContinuousStates)(i, &raw mut size),
            F::EnterStepMode => (f.fmi3EnterStepMode)(i),
            F::GetOutputDerivatives => {
                (f.fmi3GetOutputDerivatives)(i, &raw const output, 1, &raw const number, &raw mut float, 1)
            }
            F::DoStep => (f.fmi3DoStep)(i, 0.0, 0.5, 1, a, b, c, &raw mut float),
            F::ActivateModelPartition => (f.fmi3ActivateModelPartition)(i, clock, 0.0),
        }
    }
}

/// A call with random arguments. `token` is an FMU state of the instance or anything else.
#[allow(clippy::too_many_lines)] // all functions that have arguments
pub fn wild(fmu: &Fmu, i: fmi3Instance, function: Function, random: &mut Random, token: fmi3FMUState) -> fmi3Status {
    use Function as F;
    let f = &fmu.functions;
    let mut vr = [(); 4].map(|()| u32::try_from(random.below(fmu.rows.len() + 6)).unwrap_or_default());
    let count = random.pick(&[1, 1, 1, 1, 0, 2, 4]);
    let values = if random.once_in(30) { random.pick(&[0, 3, usize::MAX]) } else { count };
    let nulls: Vec<_> = (0..6).map(|_| random.once_in(60)).collect();
    // Most calls name a variable of the type.
    macro_rules! own {
        ($test:expr) => {
            let own = fmu.references($test);
            if !random.once_in(8) && !own.is_empty() {
                vr = [(); 4].map(|()| random.pick(&own));
            }
        };
    }
    macro_rules! place {
        ($k:literal, $pointer:expr) => {
            if nulls[$k] { null_mut() } else { $pointer }
        };
    }
    macro_rules! get {
        ($function:ident, $start:expr, $type_name:expr) => {{
            own!(|row| row.type_name == $type_name);
            let mut found = [$start; 4];
            (f.$function)(i, place!(0, vr.as_mut_ptr()), count, place!(1, found.as_mut_ptr()), values)
        }};
    }
    macro_rules! set {
        ($function:ident, [$($value:expr),*], $type_name:expr) => {{
            own!(|row| row.type_name == $type_name && row.is_settable());
            let mut given = [(); 4].map(|()| random.pick(&[$($value),*]));
            (f.$function)(i, place!(0, vr.as_mut_ptr()), count, place!(1, given.as_mut_ptr()), values)
        }};
    }
    macro_rules! whole {
        ($get:ident $set:ident $integer:ident $type_name:literal) => {
            if function.name().starts_with("fmi3Get") {
                get!($get, 0, $type_name)
            } else {
                set!($set, [$integer::MIN, 0, 1, 2, $integer::MAX], $type_name)
            }
        };
    }
    let (mut floats, mut sizes, mut flags, mut longs) = ([0.5; 4], [1; 4], [0_u8; 6], [1_u64; 4]);
    let (mut orders, mut qualifiers) = ([1, random.pick(&[1, 0, 2, -1]), 1, 1], [0; 4]);
    let (mut binaries, mut bytes, mut state) = ([null(); 4], [0_u8; 64], token);
    floats[0] = random.pick(&[0.0, 0.25, 2.0, -1.0, f64::NAN, f64::INFINITY]);
    let word = |random: &mut Random| fmu.words[random.below(fmu.words.len())].as_ptr();
    let mut references = || place!(0, vr.as_mut_ptr());
    unsafe {
        match function {
            F::SetDebugLogging => {
                let mut names = [word(random), c"logEvents".as_ptr()];
                (f.fmi3SetDebugLogging)(i, flags[0], count.min(2), place!(1, names.as_mut_ptr()))
            }
            F::EnterInitializationMode => {
                let (defined, stop) = (random.once_in(4).into(), random.pick(&[2.0, 5.0, -1.0]));
                (f.fmi3EnterInitializationMode)(i, 0, 0.0, if nulls[0] { f64::NAN } else { 0.0 }, defined, stop)
            }
            F::GetFloat32 => get!(fmi3GetFloat32, 0.0, "Float32"),
            F::SetFloat32 => set!(fmi3SetFloat32, [0.0, 1.5, f32::NAN], "Float32"),
            F::GetFloat64 => get!(fmi3GetFloat64, 0.0, "Float64"),
            F::SetFloat64 => {
                set!(fmi3SetFloat64, [0.5, 2.0, 1e-3, -1.0, f64::NAN, f64::INFINITY], "Float64")
            }
            F::GetInt8 | F::SetInt8 => whole!(fmi3GetInt8 fmi3SetInt8 i8 "Int8"),
            F::GetUInt8 | F::SetUInt8 => whole!(fmi3GetUInt8 fmi3SetUInt8 u8 "UInt8"),
            F::GetInt16 | F::SetInt16 => whole!(fmi3GetInt16 fmi3SetInt16 i16 "Int16"),
            F::GetUInt16 | F::SetUInt16 => whole!(fmi3GetUInt16 fmi3SetUInt16 u16 "UInt16"),
            F::GetInt32 | F::SetInt32 => whole!(fmi3GetInt32 fmi3SetInt32 i32 "Int32"),
            F::GetUInt32 | F::SetUInt32 => whole!(fmi3GetUInt32 fmi3SetUInt32 u32 "UInt32"),
            F::GetInt64 | F::SetInt64 => whole!(fmi3GetInt64 fmi3SetInt64 i64 "Int64"),
            F::GetUInt64 | F::SetUInt64 => whole!(fmi3GetUInt64 fmi3SetUInt64 u64 "UInt64"),
            F::GetBoolean => get!(fmi3GetBoolean, 0, "Boolean"),
            F::SetBoolean => set!(fmi3SetBoolean, [0, 1, 2], "Boolean"),
            F::GetString => get!(fmi3GetString, null(), "String"),
            F::SetString => {
                own!(|row| row.type_name == "String" && row.is_settable());
                if !fmu.favourites.is_empty() && !random.once_in(3) {
                    vr = [(); 4].map(|()| random.pick(&fmu.favourites));
                }
                let mut words = [(); 4].map(|()| word(random));
                (f.fmi3SetString)(i, place!(0, vr.as_mut_ptr()), count, place!(1, words.as_mut_ptr()), values)
            }
            F::GetBinary => {
                (f.fmi3GetBinary)(i, references(), count, sizes.as_mut_ptr(), binaries.as_mut_ptr(), values)
            }
            F::SetBinary => (f.fmi3SetBinary)(i, references(), count, sizes.as_ptr(), binaries.as_ptr(), values),
            F::GetClock => {
                own!(|row| row.type_name == "Clock");
                (f.fmi3GetClock)(i, place!(0, vr.as_mut_ptr()), count, place!(1, flags.as_mut_ptr()))
            }
            F::SetClock => {
                own!(|row| row.is_clock("input"));
                flags = [(); 6].map(|()| random.pick(&[1, 1, 1, 0]));
                (f.fmi3SetClock)(i, place!(0, vr.as_mut_ptr()), count, place!(1, flags.as_mut_ptr()))
            }
            F::GetIntervalDecimal => {
                own!(|row| row.is_clock("input"));
                let (vr, qualifiers) = (place!(0, vr.as_mut_ptr()), place!(2, qualifiers.as_mut_ptr()));
                (f.fmi3GetIntervalDecimal)(i, vr, count, place!(1, floats.as_mut_ptr()), qualifiers)
            }
            F::GetShiftDecimal => {
                own!(|row| row.is_clock("input"));
                (f.fmi3GetShiftDecimal)(i, place!(0, vr.as_mut_ptr()), count, place!(1, floats.as_mut_ptr()))
            }
            F::SetShiftFraction => (f.fmi3SetShiftFraction)(i, references(), count, longs.as_ptr(), longs.as_ptr()),
            F::GetShiftFraction => {
                (f.fmi3GetShiftFraction)(i, references(), count, longs.as_mut_ptr(), longs.as_mut_ptr())
            }
            F::GetFmuState => (f.fmi3GetFMUState)(i, null_mut()),
            F::SerializedFmuStateSize => (f.fmi3SerializedFMUStateSize)(i, token, place!(0, sizes.as_mut_ptr())),
            F::SerializeFmuState => (f.fmi3SerializeFMUState)(i, token, place!(0, bytes.as_mut_ptr()), bytes.len()),
            F::DeserializeFmuState => {
                let size = random.below(bytes.len());
                (f.fmi3DeserializeFMUState)(i, place!(0, bytes.as_mut_ptr()), size, place!(1, &raw mut state))
            }
            F::GetDirectionalDerivative | F::GetAdjointDerivative => {
                let inputs = fmu.references(|row| row.type_name == "Float64");
                let knowns = [(); 4].map(|()| random.pick(&inputs));
                own!(|row| row.type_name == "Float64" && row.causality == "output");
                let forward = function == F::GetDirectionalDerivative;
                let call = if forward { f.fmi3GetDirectionalDerivative } else { f.fmi3GetAdjointDerivative };
                let (seed, mut out) = (place!(1, floats.as_mut_ptr()), [0.0; 4]);
                let out = place!(2, out.as_mut_ptr());
                call(i, place!(0, vr.as_mut_ptr()), count, knowns.as_ptr(), count, seed, values, out, count)
            }
            F::UpdateDiscreteStates => {
                let [a, b, c, d, e, _] = &mut flags;
                let (a, b, c, d) = (place!(0, a), place!(1, b), place!(2, c), place!(3, d));
                (f.fmi3UpdateDiscreteStates)(i, a, b, c, d, place!(4, e), place!(5, floats.as_mut_ptr()))
            }
            F::CompletedIntegratorStep => {
                let [a, b, ..] = &mut flags;
                (f.fmi3CompletedIntegratorStep)(i, 0, place!(0, a), place!(1, b))
            }
            F::SetTime => (f.fmi3SetTime)(i, floats[0]),
            F::SetContinuousStates => (f.fmi3SetContinuousStates)(i, place!(0, floats.as_mut_ptr()), count),
            F::GetContinuousStateDerivatives => {
                (f.fmi3GetContinuousStateDerivatives)(i, place!(0, floats.as_mut_ptr()), count)
            }
            F::GetEventIndicators => (f.fmi3GetEventIndicators)(i, place!(0, floats.as_mut_ptr()), count),
            F::GetContinuousStates => (f.fmi3GetContinuousStates)(i, place!(0, floats.as_mut_ptr()), count),
            F::GetNominals => (f.fmi3GetNominalsOfContinuousStates)(i, place!(0, floats.as_mut_ptr()), count),
            F::GetNumberOfEventIndicators => (f.fmi3GetNumberOfEventIndicators)(i, place!(0, sizes.as_mut_ptr())),
            F::GetNumberOfContinuousStates => (f.fmi3GetNumberOfContinuousStates)(i, place!(0, sizes.as_mut_ptr())),
            F::GetOutputDerivatives => {
                own!(|row| row.type_name == "Float64" && row.causality == "output");
                let (vr, orders) = (place!(0, vr.as_mut_ptr()), place!(1, orders.as_mut_ptr()));
                (f.fmi3GetOutputDerivatives)(i, vr, count, orders, place!(2, floats.as_mut_ptr()), values)
            }
            F::DoStep => {
                let [a, b, c, ..] = &mut flags;
                (f.fmi3DoStep)(i, f64::NAN, 1.0, 1, place!(0, a), place!(1, b), place!(2, c), floats.as_mut_ptr())
            }
            _ => call(fmu, i, function, token),
        }
    }
}
