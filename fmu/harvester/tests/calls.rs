//! Calls of the FMU as it is exported: values and arguments that make no sense, one by one, and random sequences.

use VibroImpactHarvester::Harvester;
use fmu_export::abi::fmi3::*;
use fmu_export::{Logger, Severity, Slave};
use fmu_host::slave::{fresh, initialized, set, step};
use fmu_host::{Fmu, fmi3, hostile, linked_functions, linked_functions3, run};

fmu_host::linked_names3!();

/// Random sequences of up to 32 calls each; some seconds without optimisation.
const SEQUENCES: u64 = 50_000;

#[allow(clippy::unwrap_used)] // a helper fails a test, too
fn fmu() -> Fmu {
    Fmu::new(linked_functions!(model_exchange), include_str!("../../../modelDescription/VibroImpactHarvester.xml"))
        .unwrap()
}

#[test]
fn no_variable_takes_what_is_no_number_but_infinity_where_it_has_a_meaning() {
    assert_eq!(hostile::variables(&fmu()).unwrap(), 0);
}

#[test]
fn no_argument_takes_what_is_no_number() {
    hostile::arguments(&fmu()).unwrap();
}

/// Each of them would take minutes and more.
#[test]
fn a_step_of_more_work_than_anybody_waits_for_is_discarded() {
    let quiet: &[(&str, f64)] = &[("excitation.frequency", 5.0)];
    let noisy = &[quiet[0], ("excitation.phaseNoise", 0.1), ("excitation.noiseHold", 1.0 / 1024.0)];
    for (settings, h, bound) in [
        (quiet, 2.1e6, "communicationStepSize = 2100000 s: it must be at most 2000000 s, 10000000 periods"),
        (noisy, 2.1e6, "communicationStepSize = 2100000 s: it must be at most 2000000 s, 10000000 periods"),
        (
            noisy,
            1e5,
            "communicationStepSize = 100000 s: it must be at most 97656.25 s, 100000000 times excitation.noiseHold",
        ),
    ] {
        let mut slave: Harvester = initialized(settings);
        let error = slave.do_step(0.0, h, &Logger::silent()).unwrap_err();
        assert_eq!((error.severity(), error.to_string().as_str()), (Severity::Discard, bound));
        step(&mut slave, 0.0, 1e-3);
    }
    let mut compliant: Harvester = fresh(noisy);
    set(&mut compliant, "contact.law", 2.0);
    compliant.initialize(&Logger::silent()).unwrap();
    let error = compliant.do_step(0.0, 1e4, &Logger::silent()).unwrap_err().to_string();
    assert!(error.ends_with("at most 9765.625 s, 10000000 times excitation.noiseHold"), "{error}");
}

#[test]
fn model_exchange_is_refused_under_the_compliant_law() {
    let mut slave: Harvester = fresh(&[]);
    set(&mut slave, "contact.law", 2.0);
    slave.update();
    slave.initialize(&Logger::silent()).unwrap();
    let error = slave.place(0.0, None).unwrap_err().to_string();
    assert!(error.starts_with("contact.law = compliant cannot be run by model exchange"), "{error}");
}

#[test]
fn random_call_sequences_go_as_the_tables_say() {
    let census = run(&fmu(), 0..SEQUENCES).unwrap();
    let [ok, warning, discard, error, fatal] = census.statuses;
    assert!(ok > 1000 && warning > 0 && error > 1000 && fatal == 0 && discard > 0, "{:?}", census.statuses);
}

#[test]
fn random_call_sequences_of_fmi_3_go_as_the_table_says() {
    let description = include_str!("../../../modelDescription/fmi3/VibroImpactHarvester.xml");
    let fmu = fmi3::Fmu::new(linked_functions3!(), description).unwrap();
    let fmi3::Census { statuses: [ok, _, _, error, fatal], cells, restored } = fmi3::run(&fmu, 0..SEQUENCES);
    assert!(ok > 1000 && error > 1000 && fatal == 0 && restored > 1000, "{ok}, {error}, {fatal}, {restored}");
    assert_eq!(cells.len(), 70 * (6 + 5), "every function in every state but the fatal one");
}
