//! Instantiation, experiment, reset and logging.

use crate::common::toy::*;
use crate::common::*;
use core::ffi::CStr;
use core::ptr::{null, null_mut};
use fmu_export::abi::*;
use fmu_export::ffi::{self, Fmu};
use fmu_export::{Guid, Logger, ModelInfo, Slave, SlaveError, Standard, Variable};

#[test]
fn version_and_platform_are_those_of_fmi_2() {
    let (version, platform) = unsafe { (CStr::from_ptr(fmi2GetVersion()), CStr::from_ptr(fmi2GetTypesPlatform())) };
    assert_eq!((version, platform), (c"2.0", c"default"));
}

#[test]
fn a_bad_argument_of_instantiate_gives_null_and_the_reason_even_with_logging_off() {
    let good = guid();
    let me = fmi2CoSimulation;
    let cases = [
        (Some(""), me, Some(good.as_str()), "instanceName is empty"),
        (Some(" \t"), me, Some(&good), "instanceName is empty"),
        (None, me, Some(&good), "instanceName is empty"),
        (Some("toy"), 17, Some(&good), "fmuType = 17; this FMU offers model exchange (0) and co-simulation (1) only"),
        (Some("toy"), me, Some("{other}"), "fmuGUID = \"{other}\"; this FMU has {"),
        (Some("toy"), me, None, "fmuGUID: it is NULL"),
    ];
    for (name, kind, guid, reason) in cases {
        let mut log = Log::default();
        let functions = Log::callbacks(&raw mut log);
        assert!(crate::common::instantiate(name, kind, guid, None, &raw const functions, false).is_null());
        let message = &log.lines[0].message;
        assert!(message.starts_with("fmi2Instantiate: ") && message.contains(reason), "{message}");
        assert_eq!((log.lines[0].status, log.lines.len()), (fmi2Error, 1));
    }
}

#[test]
fn callbacks_may_be_missing_in_part_or_altogether() {
    let nothing = fmi2CallbackFunctions {
        logger: None,
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: null_mut(),
    };
    for functions in [null(), &raw const nothing] {
        let c = crate::common::instantiate(Some("toy"), fmi2CoSimulation, Some(&guid()), None, functions, true);
        assert!(!c.is_null());
        unsafe {
            assert_eq!(fmi2DoStep(c, 0.0, 1.0, fmi2False), fmi2Error);
            fmi2FreeInstance(c);
        }
        assert!(crate::common::instantiate(None, fmi2CoSimulation, None, None, functions, true).is_null());
    }
}

#[test]
fn any_resource_location_is_accepted_an_odd_one_with_a_warning() {
    let long = format!("file:///{}", "a".repeat(1 << 20));
    let cases = [
        (None, 0),
        (Some(long.as_str()), 0),
        (Some("file:///tmp/a%20b/resources"), 0),
        (Some("file:/tmp/resources"), 0),
        (Some("http://example.org/resources"), 1),
        (Some("/tmp/resources"), 1),
        (Some("file:///tmp/%zz"), 1),
        (Some("file:///tmp/%FF"), 1),
        (Some(""), 1),
    ];
    for (location, warnings) in cases {
        let mut log = Log::default();
        let functions = Log::callbacks(&raw mut log);
        let c = crate::common::instantiate(
            Some("toy"),
            fmi2CoSimulation,
            Some(&guid()),
            location,
            &raw const functions,
            true,
        );
        assert!(!c.is_null(), "{location:?}");
        assert_eq!(log.lines.len(), warnings, "{location:?}");
        assert_eq!(unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) }, fmi2OK, "the warning is over");
        unsafe { fmi2FreeInstance(c) };
    }
}

#[test]
fn a_model_is_told_of_the_folder_of_its_resources_once_and_after_each_reset() {
    let mut log = Log::default();
    let (functions, location) = (Log::callbacks(&raw mut log), Some("file:///tmp/a%20b/resources"));
    let c =
        crate::common::instantiate(Some("toy"), fmi2CoSimulation, Some(&guid()), location, &raw const functions, true);
    let told = || crate::common::toy::RESOURCES.take();
    let folder = std::path::PathBuf::from(if cfg!(windows) { "tmp/a b/resources" } else { "/tmp/a b/resources" });
    assert_eq!(told(), core::slice::from_ref(&folder));
    assert_eq!(unsafe { fmi2Reset(c) }, fmi2OK);
    assert_eq!(told(), [folder]);
    unsafe { fmi2FreeInstance(c) };
    let c = crate::common::instantiate(Some("toy"), fmi2CoSimulation, Some(&guid()), None, &raw const functions, true);
    assert!(!c.is_null() && told().is_empty(), "there is none");
    unsafe { fmi2FreeInstance(c) };
}

#[test]
fn an_experiment_that_makes_no_sense_is_refused() {
    for (start, stop) in [(f64::NAN, None), (f64::INFINITY, None), (1.0, Some(0.5)), (0.0, Some(f64::NAN))] {
        let host = Host::new();
        assert_eq!(host.setup(start, stop), fmi2Error, "{start} {stop:?}");
        host.error();
    }
    for tolerance in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let host = Host::new();
        let status = unsafe { fmi2SetupExperiment(host.component, fmi2True, tolerance, 0.0, fmi2False, 0.0) };
        assert_eq!(status, fmi2Error, "{tolerance}");
        let reason = format!("fmi2SetupExperiment: tolerance = {tolerance}: it must be finite and positive");
        assert_eq!(host.error(), reason);
    }
}

#[test]
fn a_missing_setup_experiment_is_tolerated() {
    let host = Host::new();
    assert_eq!(host.enter_initialization(), fmi2OK);
    let lines = host.lines();
    assert_eq!((lines[0].status, lines[0].category.as_str()), (fmi2OK, "logTolerated"));
    assert!(lines[0].message.contains("fmi2SetupExperiment was not called"));
    assert_eq!(host.exit_initialization(), fmi2OK);
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
}

#[test]
fn reset_leads_back_to_a_fresh_instance() {
    let host = Host::new();
    assert_eq!(host.set_real(GAIN, 4.0), fmi2OK);
    assert_eq!(host.set_string(LABEL, "other"), fmi2OK);
    host.start(3.0, Some(4.0));
    assert_eq!(host.step(3.0, 1.0), fmi2OK);
    assert_eq!(host.terminate(), fmi2OK);
    assert_eq!(host.reset(), fmi2OK);
    host.start(0.0, None);
    assert_eq!((host.real(GAIN), host.real(INTEGRAL), host.integer(COUNT)), (2.0, 0.0, 0));
    assert_eq!(host.string(LABEL), "toy");
    assert_eq!(host.step(0.0, 10.0), fmi2OK, "the old stop time is forgotten");
}

#[test]
fn instances_know_nothing_of_each_other() {
    let (one, two) = (Host::initializing(), Host::initializing());
    assert_eq!(one.set_real(GAIN, 8.0), fmi2OK);
    assert_eq!(two.real(GAIN), 2.0);
}

#[test]
fn an_error_of_the_model_during_initialisation_reaches_the_importer() {
    let host = Host::initializing();
    host.trouble("error initialize");
    host.refused(host.exit_initialization(), "fmi2ExitInitializationMode: asked for an error, 100 %s");
    let host = Host::initializing();
    host.trouble("discard initialize");
    assert_eq!(host.exit_initialization(), fmi2Error, "only steps can be discarded");
}

fn log_only(host: &Host, on: fmi2Boolean, categories: &[&CStr]) -> fmi2Status {
    let pointers: Vec<_> = categories.iter().map(|c| c.as_ptr()).collect();
    unsafe { fmi2SetDebugLogging(host.component, on, pointers.len(), pointers.as_ptr()) }
}

#[test]
fn categories_decide_what_is_logged() {
    let host = Host::initialized();
    let noise = |host: &Host| {
        for what in ["event step", "warning step"] {
            host.trouble(what);
            let t = host.real_status(fmi2LastSuccessfulTime).1;
            assert!(host.step(t, 1.0) <= fmi2Warning);
        }
        host.lines().into_iter().map(|line| line.category).collect::<Vec<_>>()
    };
    assert_eq!(noise(&host), ["logEvents", "logStatusWarning"]);
    assert_eq!(log_only(&host, fmi2True, &[c"logEvents"]), fmi2OK);
    assert_eq!(noise(&host), ["logEvents"]);
    assert_eq!(log_only(&host, fmi2True, &[c"logStatusWarning", c"logStatusError"]), fmi2OK);
    assert_eq!(noise(&host), ["logStatusWarning"]);
    assert_eq!(log_only(&host, fmi2False, &[]), fmi2OK);
    assert!(noise(&host).is_empty());
    assert_eq!(log_only(&host, fmi2True, &[c"logAll"]), fmi2OK);
    assert_eq!(noise(&host).len(), 2);
    assert_eq!(log_only(&host, fmi2True, &[]), fmi2OK);
    assert_eq!(noise(&host).len(), 2);
}

#[test]
fn errors_reach_the_logger_even_with_logging_off() {
    let host = Host::initialized();
    assert_eq!(log_only(&host, fmi2False, &[]), fmi2OK);
    host.trouble("event step");
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    assert_eq!(host.lines(), [], "events are debug logging");
    host.refused(host.step(7.0, 1.0), "currentCommunicationPoint = 7");
    assert_eq!(host.reset(), fmi2OK);
    assert_eq!(log_only(&host, fmi2True, &[c"logEvents"]), fmi2OK);
    host.refused(host.step(0.0, 1.0), "illegal in state instantiated");
}

#[test]
fn an_unknown_category_is_tolerated_and_null_is_an_error() {
    let host = Host::new();
    assert_eq!(log_only(&host, fmi2True, &[c"logStatusWarning", c"logNonsense"]), fmi2OK);
    assert!(host.lines()[0].message.contains("there is no log category \"logNonsense\""));
    assert_eq!(unsafe { fmi2SetDebugLogging(host.component, fmi2True, 1, null()) }, fmi2Error);
    let host = Host::new();
    let name = null();
    host.refused(unsafe { fmi2SetDebugLogging(host.component, fmi2True, 1, &raw const name) }, "categories");
}

#[test]
fn messages_keep_percent_signs_and_lose_nuls() {
    let host = Host::initialized();
    host.trouble("event step");
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    let line = host.lines().remove(0);
    assert_eq!((line.status, line.message.as_str()), (fmi2OK, "an event with a NUL \u{fffd} at 0 s"));
    host.trouble("error step");
    host.refused(host.step(1.0, 1.0), "fmi2DoStep: asked for an error, 100 %s");
}

#[test]
fn a_call_from_inside_the_logger_is_refused() {
    let host = Host::initialized();
    host.trouble("event step");
    host.log().reenter = Some((fmi2Reset, host.component));
    assert_eq!(host.step(0.0, 1.0), fmi2OK);
    assert_eq!(host.log().reentered, Some(fmi2Error));
    host.log().reenter = None;
    assert_eq!(host.integer(COUNT), 1, "the call that was under way is not disturbed");
}

/// A slave without any extras; `MIN` is the smallest value of its only parameter, whose start value is 1.
#[derive(Clone)]
struct Bare<const MIN: i64>(i64);

impl<const MIN: i64> Bare<MIN> {
    const TABLE: [Variable<Self>; 1] =
        [Variable::<Self>::integer_parameter("a", 1, "").min(MIN).access(|m| m.0, |m, v| m.0 = v)];
}

impl<const MIN: i64> Slave for Bare<MIN> {
    const INFO: ModelInfo = ModelInfo::new("Bare");

    fn variables() -> &'static [Variable<Self>] {
        const { &Self::TABLE }
    }

    fn new() -> Self {
        Self(0)
    }

    fn do_step(&mut self, _: f64, _: f64, _: &Logger) -> Result<(), SlaveError> {
        Ok(())
    }
}

fn bare<const MIN: i64>(kind: fmi2Type, log: &mut Log) -> fmi2Component {
    static FMU: Fmu = Fmu::new();
    let (name, guid) = (c"bare", c(&Guid::of::<Bare<MIN>>(Standard::Fmi2).to_string()));
    let functions = Log::callbacks(log);
    let fmu = if MIN == 0 { &FMU } else { &Fmu::new() };
    let functions = &raw const functions;
    unsafe {
        ffi::fmi2Instantiate::<Bare<MIN>>(fmu, name.as_ptr(), kind, guid.as_ptr(), null(), functions, 0, fmi2True)
    }
}

#[test]
fn an_fmu_with_a_mistake_in_its_table_cannot_be_instantiated() {
    let mut log = Log::default();
    assert!(bare::<2>(fmi2CoSimulation, &mut log).is_null());
    assert_eq!(log.lines[0].message, "fmi2Instantiate: the FMU is faulty: a: start 1: below its min 2");
}

#[test]
fn a_slave_that_cannot_be_serialised_says_so() {
    let mut log = Log::default();
    let component = bare::<0>(fmi2CoSimulation, &mut log);
    let (mut fmu_state, mut size) = (null_mut(), 0);
    unsafe {
        assert_eq!(ffi::fmi2GetFMUstate::<Bare<0>>(component, &raw mut fmu_state), fmi2OK);
        let status = ffi::fmi2SerializedFMUstateSize::<Bare<0>>(component, fmu_state, &raw mut size);
        assert_eq!(status, fmi2Error);
        ffi::fmi2FreeInstance::<Bare<0>>(component);
    }
    let message = &log.lines[0].message;
    assert_eq!(message, "fmi2SerializedFMUstateSize: not supported by this FMU: serialised FMU states");
}

#[test]
fn a_slave_without_model_exchange_is_not_instantiated_for_it() {
    let mut log = Log::default();
    assert!(bare::<0>(fmi2ModelExchange, &mut log).is_null());
    let message = &log.lines[0].message;
    assert_eq!(message, "fmi2Instantiate: fmuType = 0; this FMU offers co-simulation (1) only");
}
