use std::sync::mpsc;

use crate::fake::{self, TROUBLE};
use crate::{FmiError, Instance, Logging, Status, Value};

fn instance() -> Instance {
    let mut instance = fake::fmu().instantiate("toy", Logging::default()).unwrap();
    instance.setup_experiment(0.0, Some(10.0), None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance
}

#[test]
fn steps_and_values_go_through() {
    let mut toy = instance();
    toy.do_step(1.0, 0.5).unwrap();
    toy.set_real(&[0, 2], &[3.0, 4.0]).unwrap();
    let mut values = [0.0; 3];
    toy.get_real(&[2, 1, 0], &mut values).unwrap();
    assert_eq!(values, [4.0, 1.5, 3.0]);
    assert_eq!(toy.last_successful_time().unwrap(), 1.5);
    toy.set_real_input_derivatives(&[2], &[2], &[3.0]).unwrap();
    let mut derivative = [0.0];
    toy.get_real_output_derivatives(&[1], &[1], &mut derivative).unwrap();
    assert_eq!(derivative, [6.0]);
    toy.reset().unwrap();
    toy.get_real(&[1], &mut derivative).unwrap();
    assert_eq!(derivative, [0.0]);
    toy.terminate().unwrap();
}

#[test]
fn variables_go_by_name_and_text() {
    let mut toy = instance();
    for (name, text) in [
        ("mass", "2.5"),
        ("seed", "42"),
        ("enabled", "false"),
        ("label", "gr\u{fc}n"),
        ("law", "compliant"),
        ("force", "-1"),
    ] {
        toy.set_by_name(name, text).unwrap();
        assert_eq!(toy.get_by_name(name).unwrap().to_string(), text);
    }
    assert_eq!(toy.get_by_name("law").unwrap(), Value::Enumeration { value: 2, name: "compliant".to_owned() });
}

#[test]
fn wrong_names_and_outputs_are_refused_before_the_fmu_is_asked() {
    let mut toy = instance();
    let error = toy.set_by_name("fource", "1").unwrap_err().to_string();
    assert!(error.ends_with("did you mean \"force\"?"), "{error}");
    let error = toy.set_by_name("position", "1").unwrap_err().to_string();
    assert_eq!(error, "position cannot be set: it is continuous output; inputs and parameters can be set");
    let error = toy.set_by_name("mass", "-1").unwrap_err().to_string();
    assert_eq!(error, "mass = -1 kg is out of range: allowed is 0 .. 10 kg");
}

#[test]
fn slices_must_have_the_same_length() {
    let mut toy = instance();
    let error = toy.set_real(&[0, 1], &[1.0]).unwrap_err().to_string();
    assert_eq!(error, "fmi2SetReal of 'toy': 2 value references but 1 values");
}

#[test]
fn a_failed_step_tells_function_instance_status_and_messages() {
    let mut toy = instance();
    for (status, wanted) in [(2, Status::Discard), (3, Status::Error), (5, Status::Pending), (9, Status::Unknown(9))] {
        let error = toy.do_step(0.0, TROUBLE + f64::from(status)).unwrap_err();
        assert_eq!(error.status(), Some(wanted));
        let text = error.to_string();
        assert!(text.ends_with(&format!("(fmi2DoStep of 'toy' returned {wanted})")), "{text}");
        assert!(!crate::logging::READS_FIRST_ARGUMENT || text.contains("trouble in the step"), "{text}");
    }
    toy.do_step(0.0, TROUBLE + 1.0).unwrap();
}

#[test]
fn after_a_fatal_error_no_function_is_called() {
    let fmu = fake::fmu();
    let mut toy = fmu.instantiate("toy", Logging::default()).unwrap();
    let other = fmu.instantiate("other", Logging::default()).unwrap();
    let state = toy.save_state().unwrap();
    assert_eq!(toy.do_step(0.0, TROUBLE + 4.0).unwrap_err().status(), Some(Status::Fatal));
    for error in [toy.do_step(0.0, 1.0).unwrap_err(), other.get_by_name("mass").unwrap_err()] {
        assert!(matches!(error, FmiError::Dead { .. }), "{error}");
    }
    assert!(matches!(fmu.instantiate("third", Logging::default()).unwrap_err(), FmiError::Dead { .. }));
    drop((toy, state)); // must not free anything in the FMU
}

#[test]
fn a_refused_instantiation_tells_what_the_fmu_said() {
    let error = fake::stranger().instantiate("toy", Logging::default()).unwrap_err().to_string();
    assert!(error.starts_with("fmi2Instantiate of 'toy' (model Toy, guid {other}) failed"), "{error}");
    assert!(!crate::logging::READS_FIRST_ARGUMENT || error.contains("wrong guid"), "{error}");
    assert!(matches!(fake::fmu().instantiate("", Logging::default()), Err(FmiError::Text { .. })));
    assert!(matches!(fake::fmu().instantiate("a\0", Logging::default()), Err(FmiError::Text { .. })));
}

#[test]
fn a_state_brings_the_values_back_even_through_bytes() {
    let mut toy = instance();
    let read = |toy: &Instance| toy.get_by_name("mass").unwrap();
    toy.set_by_name("mass", "1").unwrap();
    let mut first = toy.save_state().unwrap();
    let bytes = toy.serialize_state(&first).unwrap();
    toy.set_by_name("mass", "2").unwrap();
    toy.restore_state(&first).unwrap();
    assert_eq!(read(&toy), Value::Real(1.0));
    toy.set_by_name("mass", "3").unwrap();
    toy.save_state_into(&mut first).unwrap();
    let second = toy.deserialize_state(&bytes).unwrap();
    toy.restore_state(&second).unwrap();
    assert_eq!(read(&toy), Value::Real(1.0));
    toy.restore_state(&first).unwrap();
    assert_eq!(read(&toy), Value::Real(3.0));
    assert!(toy.deserialize_state(&bytes[1..]).is_err());
    drop(toy); // before its states
}

#[test]
fn a_foreign_state_is_refused() {
    let (mut toy, other) = (instance(), instance());
    let error = toy.restore_state(&other.save_state().unwrap()).unwrap_err().to_string();
    assert_eq!(error, "fmi2SetFMUstate of 'toy': the state belongs to another instance, 'toy'");
}

#[test]
fn what_the_fmu_does_not_offer_is_not_called() {
    let error = instance().directional_derivative(&[1], &[2], &[1.0], &mut [0.0]).unwrap_err().to_string();
    assert!(error.ends_with("the FMU does not declare providesDirectionalDerivative"), "{error}");
}

#[test]
fn the_sink_and_the_memory_get_the_messages() {
    let (sender, receiver) = mpsc::channel();
    let logging = Logging::to(move |record| sender.send(record.clone()).unwrap());
    let mut toy = fake::fmu().instantiate("toy", logging).unwrap();
    toy.do_step(0.0, TROUBLE + 1.0).unwrap();
    let record = receiver.try_recv().unwrap();
    assert_eq!((record.instance.as_str(), record.status), ("toy", Status::Warning));
    assert_eq!(toy.messages(), [record]);
}

#[test]
fn without_debug_messages_the_reserved_categories_are_asked_for() {
    let quiet = fake::fmu().instantiate("toy", Logging::default()).unwrap();
    assert_eq!(quiet.get_by_name("label").unwrap().to_string(), "logStatusError");
    let loud = fake::fmu().instantiate("toy", Logging::to(|_| ())).unwrap();
    assert_eq!(loud.get_by_name("label").unwrap().to_string(), "a & b");
}
