//! Every bad input is an error that names thing, value and bound.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use videg_circuit::{Circuit, Parameters, Release, Settings, Topology};

const C: [f64; 2] = [15e-12, 12e-12];
const PAPER: fn() -> Parameters = Parameters::default;

/// The message of a circuit of these parameters, which names the variables of its error.
fn message(parameters: Parameters, names: &[&str]) -> String {
    let error = Circuit::new(parameters, C).unwrap_err();
    assert_eq!(error.variables(), names, "{error}");
    error.to_string()
}

#[test]
fn a_parameter_out_of_its_bounds_is_refused_by_name() {
    for quantity in Settings::QUANTITIES {
        let beyond = [quantity.min.next_down(), quantity.max.next_up(), f64::NAN, f64::NEG_INFINITY];
        // Infinity is within the bounds of the load and of the leakage.
        for value in beyond.into_iter().filter(|value| *value != f64::INFINITY) {
            let mut settings = Settings { exponential: true, ..Settings::default() };
            (quantity.set)(&mut settings, value);
            let (name, unit) = (quantity.name, quantity.unit);
            let bounds = format!("[{}, {}]", quantity.min, quantity.max);
            let expected = format!("{name} = {value} {unit} is outside its bounds {bounds} {unit}");
            assert_eq!(message(settings.parameters(), &[name]), expected);
        }
    }
}

#[test]
fn a_leakage_faster_than_any_film_is_refused_and_none_is_not() {
    let leaking = |leakage_time_constant| Parameters { leakage_time_constant, ..PAPER() };
    let expected = "leakage.timeConstant = 0.0000001 s is below 0.000001 s; 0 means no leakage";
    assert_eq!(message(leaking(1e-7), &["leakage.timeConstant"]), expected);
    for taken in [0.0, -0.0, Parameters::FASTEST_LEAKAGE, f64::MAX, f64::INFINITY] {
        assert!(Circuit::new(leaking(taken), C).is_ok(), "{taken}");
    }
}

#[test]
fn a_voltage_of_release_below_the_supply_is_named_with_both_values() {
    let zener = Parameters { zener_voltage: 1500.0, ..PAPER() };
    assert_eq!(
        message(zener, &["zener.voltage", "supply.voltage"]),
        "zener.voltage = 1500 V is below supply.voltage = 2000 V"
    );
    let below = Parameters { storage_voltage: 1999.0, ..PAPER() };
    let storage = Parameters { release: Release::Storage, ..below };
    let bound = "is below supply.voltage = 2000 V: the supply would feed the storage without bound";
    assert_eq!(message(storage, &["storage.voltage", "supply.voltage"]), format!("storage.voltage = 1999 V {bound}"));
    // Only the element that is there has to be above the supply.
    assert!(Circuit::new(below, C).is_ok());
    assert!(Circuit::new(Parameters { zener_voltage: 1500.0, storage_voltage: 2000.0, ..storage }, C).is_ok());
}

#[test]
fn capacitances_steps_and_starting_voltages_are_checked_and_change_nothing() {
    let new = |capacitance| Circuit::new(PAPER(), capacitance).unwrap_err().to_string();
    assert_eq!(new([0.0, 1e-12]), "left.capacitance = 0 F is not above 0 F");
    assert_eq!(new([1e-12, f64::INFINITY]), "right.capacitance = inf F is not a finite number");
    assert_eq!(new([1e303, 1.0]), "stored energy at the start = inf J is not a finite number");
    let start = |voltage| Circuit::with_voltages(PAPER(), C, voltage).unwrap_err().to_string();
    assert!(Circuit::with_voltages(PAPER(), C, [2000.0, 2100.0]).unwrap_err().variables().is_empty());
    assert_eq!(start([-1.0, 0.0]), "left.voltage = -1 V is below 0 V");
    assert_eq!(start([0.0, f64::NAN]), "right.voltage = NaN V is not a finite number");
    assert_eq!(start([2000.0, 2100.0]), "right.voltage = 2100 V differs from left.voltage = 2000 V on the shared node");
    let isolated = Parameters { topology: Topology::Isolated, ..PAPER() };
    assert_eq!(Circuit::with_voltages(isolated, C, [2000.0, 2100.0]).unwrap().voltage()[1], 2100.0);

    let mut circuit = Circuit::new(PAPER(), C).unwrap();
    let before = circuit.clone();
    for (dt, capacitance, expected) in [
        (-1.0, C, "step = -1 s is below 0 s"),
        (f64::NAN, C, "step = NaN s is not a finite number"),
        (1.0, [1e-12, -1.0], "right.capacitance = -1 F is not above 0 F"),
    ] {
        let error = circuit.advance(dt, capacitance).unwrap_err();
        assert_eq!(error.to_string(), expected);
        assert!(expected.starts_with(error.variables()[0]));
        assert_eq!(circuit, before);
    }
}
