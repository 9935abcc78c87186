//! Get and Set of FMI 3.0: the types, and which variables may be named in which state.

use crate::common::fmi3::*;
use crate::common::slave;
use crate::common::toy::{self, Toy};
use core::ffi::CStr;
use core::fmt::Debug;
use core::ptr::{null, null_mut};
use fmu_export::abi::fmi3::*;
use fmu_export::ffi::Fmu;
use fmu_export::fmi3 as of;
use fmu_export::{Causality, Guid, ModelInfo, Slave, SlaveError, Standard, Variable};

type Get<T> = unsafe extern "C" fn(fmi3Instance, *const u32, usize, *mut T, usize) -> fmi3Status;
type Set<T> = unsafe extern "C" fn(fmi3Instance, *const u32, usize, *const T, usize) -> fmi3Status;

/// Sets values of an integer that all fit, and reads each back; then asks for a variable of another type.
fn check<T: Copy + Debug + PartialEq + Default>(index: u32, get: Get<T>, set: Set<T>, values: &[T]) {
    let host = Host::started(Session::PLAIN);
    let reference = toy::WIDE + index;
    for value in values {
        let mut found = T::default();
        unsafe {
            assert_eq!(set(host.instance, &raw const reference, 1, value, 1), fmi3OK, "{value:?}: {:?}", host.lines());
            assert_eq!(get(host.instance, &raw const reference, 1, &raw mut found, 1), fmi3OK);
        }
        assert_eq!(found, *value);
    }
    let (other, mut value) = (toy::GAIN, T::default());
    assert_eq!(unsafe { get(host.instance, &raw const other, 1, &raw mut value, 1) }, fmi3Error);
    assert!(host.error().contains("variable toy.gain (value reference 0) is of type Float64, not "));
    // The wrong width is the wrong type.
    let host = Host::started(Session::PLAIN);
    let other = toy::WIDE + (index + 1) % 8;
    assert_eq!(unsafe { set(host.instance, &raw const other, 1, &raw const value, 1) }, fmi3Error);
    let message = host.error();
    assert!(message.contains(toy::WIDTHS[(index as usize + 1) % 8].type_name()), "{message}");
}

#[test]
fn integers_of_all_widths_keep_their_bounds() {
    check(0, fmi3GetInt8, fmi3SetInt8, &[i8::MIN, 0, i8::MAX]);
    check(1, fmi3GetUInt8, fmi3SetUInt8, &[0, u8::MAX]);
    check(2, fmi3GetInt16, fmi3SetInt16, &[i16::MIN, i16::MAX]);
    check(3, fmi3GetUInt16, fmi3SetUInt16, &[0, u16::MAX]);
    check(4, fmi3GetInt32, fmi3SetInt32, &[i32::MIN, i32::MAX]);
    check(5, fmi3GetUInt32, fmi3SetUInt32, &[0, u32::MAX]);
    check(6, fmi3GetInt64, fmi3SetInt64, &[i64::MIN, i64::MAX]);
    check(7, fmi3GetUInt64, fmi3SetUInt64, &[0, u64::MAX / 2]);
}

#[test]
fn what_is_beyond_a_bound_is_refused() {
    let host = Host::new(Session::PLAIN);
    let (reference, value) = (toy::WIDE + 7, u64::MAX);
    let status = unsafe { fmi3SetUInt64(host.instance, &raw const reference, 1, &raw const value, 1) };
    assert_eq!(status, fmi3Error);
    assert!(host.error().contains("variable wide[8] = 18446744073709551615: above its max 9223372036854775807"));
    let host = Host::new(Session::PLAIN);
    assert_eq!(unsafe { fmi3SetInt64(host.instance, &toy::LAW_VR, 1, &i64::MAX, 1) }, fmi3Error);
    let message = "variable law = 9223372036854775807: no item of Law; allowed: 1 (value), 2 (square)";
    assert!(host.error().contains(message));
}

#[test]
fn a_float_in_single_precision_has_its_own_functions() {
    let host = Host::new(Session::PLAIN);
    let (value, mut found) = (0.1_f32, 0.0);
    unsafe {
        assert_eq!(fmi3SetFloat32(host.instance, &toy::SINGLE, 1, &raw const value, 1), fmi3OK);
        assert_eq!(fmi3GetFloat32(host.instance, &toy::SINGLE, 1, &raw mut found, 1), fmi3OK);
    }
    assert_eq!(found, value);
    for value in [f32::NAN, f32::INFINITY] {
        let host = Host::new(Session::PLAIN);
        assert_eq!(unsafe { fmi3SetFloat32(host.instance, &toy::SINGLE, 1, &raw const value, 1) }, fmi3Error);
        assert!(host.error().contains("it must be finite"));
    }
    assert_eq!(host.try_float(toy::SINGLE).0, fmi3Error);
    assert!(host.error().contains("variable single (value reference 19) is of type Float32, not Float64"));
    let host = Host::new(Session::PLAIN);
    assert_eq!(unsafe { fmi3GetFloat32(host.instance, &toy::GAIN, 1, &raw mut found, 1) }, fmi3Error);
}

#[test]
fn booleans_texts_and_items_travel_as_what_they_are() {
    let host = Host::new(Session::PLAIN);
    let i = host.instance;
    let (on, mut found) = (2, 7); // whatever is not zero
    let (text, mut read) = (c"another".as_ptr(), null());
    let (item, mut chosen) = (2_i64, 0);
    unsafe {
        assert_eq!(fmi3SetBoolean(i, &toy::ON, 1, &raw const on, 1), fmi3OK);
        assert_eq!(fmi3GetBoolean(i, &toy::IS_ON, 1, &raw mut found, 1), fmi3OK);
        assert_eq!(fmi3SetString(i, &toy::LABEL, 1, &raw const text, 1), fmi3OK);
        assert_eq!(fmi3GetString(i, &toy::LABEL, 1, &raw mut read, 1), fmi3OK);
        assert_eq!(fmi3SetInt64(i, &toy::LAW_VR, 1, &raw const item, 1), fmi3OK);
        assert_eq!(fmi3GetInt64(i, &toy::CHOSEN, 1, &raw mut chosen, 1), fmi3OK);
        assert_eq!((found, CStr::from_ptr(read), chosen), (fmi3True, c"another", 2));
    }
}

#[test]
fn there_is_no_binary_variable() {
    let host = Host::new(Session::PLAIN);
    let (mut size, mut bytes) = (0, null());
    let status = unsafe { fmi3GetBinary(host.instance, &toy::GAIN, 1, &raw mut size, &raw mut bytes, 1) };
    assert_eq!(status, fmi3Error);
    assert!(host.error().contains("variable toy.gain (value reference 0) is of type Float64, not Binary"));
    let host = Host::new(Session::PLAIN);
    let status = unsafe { fmi3SetBinary(host.instance, &toy::LABEL, 1, &raw const size, &raw const bytes, 1) };
    assert_eq!(status, fmi3Error);
    assert!(host.error().contains("variable label (value reference 9) is of type String, not Binary"));
}

#[test]
fn every_type_refuses_a_variable_of_another() {
    let refused = |call: &dyn Fn(fmi3Instance) -> fmi3Status, message: &str| {
        let host = Host::started(Session::EVENTS);
        assert_eq!(host.enter_event_mode(), fmi3OK);
        host.lines();
        assert_eq!(call(host.instance), fmi3Error, "{message}");
        let error = host.error();
        assert!(error.contains(message), "{error}");
    };
    let gain = &toy::GAIN;
    refused(&|i| unsafe { fmi3GetBoolean(i, gain, 1, &mut 0, 1) }, "is of type Float64, not Boolean");
    refused(&|i| unsafe { fmi3SetBoolean(i, &toy::LAW_VR, 1, &1, 1) }, "is of type Enumeration, not Boolean");
    refused(&|i| unsafe { fmi3GetString(i, gain, 1, &mut null(), 1) }, "is of type Float64, not String");
    refused(&|i| unsafe { fmi3SetString(i, &toy::ON, 1, &c"".as_ptr(), 1) }, "is of type Boolean, not String");
    refused(&|i| unsafe { fmi3GetClock(i, &toy::ON, 1, &mut 0) }, "is of type Boolean, not Clock");
    refused(&|i| unsafe { fmi3GetBoolean(i, &toy::TICK, 1, &mut 0, 1) }, "is of type Clock, not Boolean");
    refused(&|i| unsafe { fmi3GetInt32(i, &toy::LAW_VR, 1, &mut 0, 1) }, "is of type Enumeration, not Int32");
    refused(&|i| unsafe { fmi3GetInt64(i, &toy::SEED, 1, &mut 0, 1) }, "is of type Int32, not Int64");
}

#[test]
fn a_text_that_is_null_or_no_utf8_is_refused() {
    for (text, message) in [(null(), "it is NULL"), (c"\xff".as_ptr(), "it is not UTF-8")] {
        let host = Host::new(Session::PLAIN);
        assert_eq!(unsafe { fmi3SetString(host.instance, &toy::LABEL, 1, &raw const text, 1) }, fmi3Error);
        let error = host.error();
        assert!(error.contains("label") && error.contains(message), "{error}");
    }
}

#[test]
fn counts_and_places_that_do_not_fit_are_refused_and_nothing_is_set() {
    let references = [toy::LIMIT, toy::GAIN];
    for (values, count, message) in [
        (&[3.0, 99.0][..], 2, "variable toy.gain = 99: above its max 8 N/m"),
        (&[3.0, 3.0, 3.0], 3, "nValues = 3: 2 value references have as many values, no variable is an array"),
    ] {
        let host = Host::new(Session::PLAIN);
        let status = unsafe { fmi3SetFloat64(host.instance, references.as_ptr(), 2, values.as_ptr(), count) };
        assert_eq!(status, fmi3Error);
        assert!(host.error().contains(message));
        assert_eq!(host.float(toy::LIMIT), f64::INFINITY);
    }
    let host = Host::new(Session::PLAIN);
    assert_eq!(unsafe { fmi3GetFloat64(host.instance, references.as_ptr(), 2, null_mut(), 2) }, fmi3Error);
    assert!(host.error().contains("argument values is NULL"));
    let host = Host::new(Session::PLAIN);
    assert_eq!(host.try_float(99).0, fmi3Error);
    assert!(host.error().contains("no variable has value reference 99"));
}

/// The toy has its own independent variable; the variable of its event indicator follows the table.
#[test]
fn the_variables_that_the_exporter_adds_follow_the_table() {
    let host = Host::started(Session::PLAIN);
    assert_eq!(host.set_float(toy::LIMIT, 3.0), fmi3OK);
    assert_eq!(host.stepped(0.0, 1.0), (false, false, 1.0));
    assert_eq!(host.float(toy::COUNT_OF_VARIABLES), 1.0);
    assert_eq!(host.set_float(toy::COUNT_OF_VARIABLES, 1.0), fmi3Error);
}

/// Neither a time of its own nor a state that jumps.
#[derive(Clone, Default)]
struct Bare(f64);

slave! {
    Bare,
    ModelInfo::new("Bare").model_exchange(2),
    {
        type V = Variable<Bare>;
        static TABLE: [V; 2] = [
            V::output("x", "1", "A state").get(|m| m.0),
            V::output("v", "1/s", "Its rate").derivative_of("x").get(|_| 3.0),
        ];
        &TABLE
    },
    fn place(&mut self, _: f64, states: Option<&[f64]>) -> Result<(), SlaveError> {
        self.0 = states.map_or(self.0, |states| states[0]);
        Ok(())
    }

    fn event_indicators(&self) -> Vec<f64> {
        vec![self.0, -self.0]
    }
}

#[test]
fn a_table_without_a_time_is_given_one_ahead_of_its_indicators() {
    static FMU: Fmu = Fmu::new();
    let (token, pointer) = (Guid::of::<Bare>(Standard::Fmi3).to_string(), null_mut());
    let token = std::ffi::CString::new(token).expect("no NUL");
    let (name, token) = (c"bare".as_ptr(), token.as_ptr());
    let get = |i, reference: u32| {
        let mut value = f64::NAN;
        (unsafe { of::fmi3GetFloat64::<Bare>(i, &raw const reference, 1, &raw mut value, 1) }, value)
    };
    unsafe {
        let i = of::fmi3InstantiateModelExchange::<Bare>(&FMU, name, token, null(), 0, 0, pointer, None);
        assert!(!i.is_null());
        assert_eq!(of::fmi3EnterInitializationMode::<Bare>(i, 0, 0.0, 2.0, 0, 0.0), fmi3OK);
        assert_eq!(of::fmi3ExitInitializationMode::<Bare>(i), fmi3OK);
        // A state that does not jump is the importer's at events.
        assert_eq!(of::fmi3SetFloat64::<Bare>(i, &0, 1, &0.25, 1), fmi3OK);
        assert_eq!([0, 1, 2, 3, 4].map(|k| get(i, k).1), [0.25, 3.0, 2.0, 0.25, -0.25]);
        assert_eq!(of::fmi3EnterContinuousTimeMode::<Bare>(i), fmi3OK);
        assert_eq!(of::fmi3SetTime::<Bare>(i, 7.0), fmi3OK);
        assert_eq!(get(i, 2), (fmi3OK, 7.0));
        assert_eq!(get(i, 5).0, fmi3Error, "there are two indicators");
        assert_eq!(of::fmi3Reset::<Bare>(i), fmi3OK);
        assert_eq!(of::fmi3SetFloat64::<Bare>(i, &2, 1, &1.0, 1), fmi3Error, "time is not set as a variable");
        of::fmi3FreeInstance::<Bare>(i);
        // It has no events, and so no event mode.
        let made = |events| {
            of::fmi3InstantiateCoSimulation::<Bare>(
                &FMU,
                name,
                token,
                null(),
                0,
                0,
                events,
                1,
                null(),
                0,
                pointer,
                None,
                None,
            )
        };
        assert!(made(1).is_null());
        let i = made(0);
        assert!(!i.is_null());
        of::fmi3FreeInstance::<Bare>(i);
    }
}

/// They are in modelDescription.xml, so that a wrong type is what is wrong with the call.
#[test]
fn an_added_variable_is_no_unknown_one() {
    let host = Host::started(Session::EXCHANGE);
    let mut value = 0.0;
    let status = unsafe { fmi3GetFloat32(host.instance, &toy::COUNT_OF_VARIABLES, 1, &raw mut value, 1) };
    assert_eq!(status, fmi3Error);
    assert!(host.error().contains("is of type Float64, not Float32"));
}

#[test]
fn what_may_be_set_is_as_the_states_have_it() {
    use fmu_export::CallState as S;
    for row in Toy::variables() {
        let (input, parameter) = (row.causality() == Causality::Input, row.causality() == Causality::Parameter);
        let tunable = parameter && row.variability() == fmu_export::Variability::Tunable;
        let continuous = row.variability() == fmu_export::Variability::Continuous;
        for state in S::ALL {
            let legal = match state {
                S::Instantiated | S::InitializationMode => input || parameter,
                S::EventMode => input || tunable,
                S::StepMode => input && row.clocks().is_empty() || tunable,
                S::ContinuousTimeMode => input && continuous || row.name() == "integral",
                S::StepComplete => continue, // of FMI 2.0
                _ => false,
            };
            let found = row.may_be_set(Toy::variables(), state, Standard::Fmi3);
            assert_eq!(found == fmu_export::Legality::Legal, legal, "{} in {state}", row.name());
        }
    }
    let host = Host::started(Session::EVENTS);
    assert_eq!(host.set_float(toy::SAMPLED, 1.0), fmi3Error);
    assert!(host.error().contains("variable sampled (discrete input) cannot be set in state stepMode"));
}

#[test]
fn debug_logging_switches_the_categories_that_are_named() {
    let host = Host::started(Session::EVENTS);
    let names = [c"logTolerated".as_ptr(), c"logStatusWarning".as_ptr()];
    let switch = |on: u8, names: &[fmi3String]| {
        let pointer = if names.is_empty() { null() } else { names.as_ptr() };
        assert_eq!(unsafe { fmi3SetDebugLogging(host.instance, on, names.len(), pointer) }, fmi3OK);
    };
    let read_clocked = || {
        let mut value = 0;
        assert_eq!(unsafe { fmi3GetUInt64(host.instance, &toy::TICKS, 1, &raw mut value, 1) }, fmi3OK);
        host.lines().len()
    };
    assert_eq!(read_clocked(), 1);
    switch(0, &names[1..]);
    assert_eq!(read_clocked(), 1, "others stay on");
    switch(1, &names[1..]);
    assert_eq!(read_clocked(), 1);
    switch(0, &names);
    assert_eq!(read_clocked(), 0);
    switch(1, &names[..1]);
    assert_eq!(read_clocked(), 1);
    switch(0, &[]);
    assert_eq!(read_clocked(), 0);
}
