//! Every bad input is an error that names thing, value and bound.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use videg_circuit::{Circuit, DiodeParameters, Diodes, Error, Parameters, Release, Solver, Topology};

const C: [f64; 2] = [15e-12, 12e-12];

fn message(parameters: Parameters) -> String {
    Circuit::new(parameters, C).unwrap_err().to_string()
}

#[test]
fn a_zener_below_the_supply_is_named_with_both_values() {
    let parameters = Parameters { zener_voltage: 1500.0, ..Parameters::default() };
    assert_eq!(message(parameters), "zener.voltage = 1500 V is below supply.voltage = 2000 V");
}

#[test]
fn a_storage_below_the_supply_is_named_with_both_values() {
    let below = Parameters { storage_voltage: 1999.0, ..Parameters::default() };
    let storage = Parameters { release: Release::Storage, ..below };
    assert_eq!(
        message(storage),
        "storage.voltage = 1999 V is below supply.voltage = 2000 V: the supply would feed the storage without bound"
    );
    // Only the element that is there has to be above the supply.
    assert!(Circuit::new(below, C).is_ok());
    assert!(Circuit::new(Parameters { zener_voltage: 1500.0, storage_voltage: 2000.0, ..storage }, C).is_ok());
    let nan = Parameters { storage_voltage: f64::NAN, ..Parameters::default() };
    assert_eq!(message(nan), "storage.voltage = NaN V is not a finite number");
}

#[test]
fn a_supply_or_load_out_of_range_is_named() {
    let default = Parameters::default();
    let supply = |supply_voltage| message(Parameters { supply_voltage, ..default });
    assert_eq!(supply(0.0), "supply.voltage = 0 V is not above 0 V");
    assert_eq!(supply(f64::NAN), "supply.voltage = NaN V is not a finite number");
    let zener = |zener_voltage| message(Parameters { zener_voltage, ..default });
    assert_eq!(zener(f64::INFINITY), "zener.voltage = inf V is not a finite number");
    assert_eq!(zener(f64::NAN), "zener.voltage = NaN V is not a finite number");
    let load = |load_resistance| message(Parameters { load_resistance, ..default });
    assert_eq!(load(-1.0), "load.resistance = -1 ohm is below 0 ohm");
    assert_eq!(load(f64::NAN), "load.resistance = NaN ohm is not a finite number");
    assert_eq!(load(f64::NEG_INFINITY), "load.resistance = -inf ohm is not a finite number");
}

#[test]
fn a_stored_energy_beyond_all_numbers_is_refused() {
    let parameters = Parameters { supply_voltage: 1e200, zener_voltage: 1e200, ..Parameters::default() };
    let found = Circuit::new(parameters, [1.0, 1.0]).unwrap_err().to_string();
    assert_eq!(found, "stored energy at the start = inf J is not a finite number");
}

#[test]
fn every_diode_parameter_is_checked() {
    type Set = fn(&mut DiodeParameters, f64);
    let fields: [(&str, &str, Set); 7] = [
        ("diode.saturationCurrent", "A", |d, x| d.saturation_current = x),
        ("diode.emissionCoefficient", "1", |d, x| d.emission_coefficient = x),
        ("diode.temperature", "K", |d, x| d.temperature = x),
        ("zener.breakdownCurrent", "A", |d, x| d.breakdown_current = x),
        ("zener.emissionCoefficient", "1", |d, x| d.breakdown_emission = x),
        ("switch.band", "V", |d, x| d.switch_band = x),
        ("solver.relativeTolerance", "1", |d, x| d.solver.relative_tolerance = x),
    ];
    for (name, unit, set) in fields {
        let with = |value| {
            let mut diode = DiodeParameters { solver: Solver::default(), ..DiodeParameters::default() };
            set(&mut diode, value);
            message(Parameters { diodes: Diodes::Exponential(diode), ..Parameters::default() })
        };
        assert_eq!(with(0.0), format!("{name} = 0 {unit} is not above 0 {unit}"));
        assert_eq!(with(f64::NAN), format!("{name} = NaN {unit} is not a finite number"));
    }
}

#[test]
fn capacitances_and_steps_are_checked_and_change_nothing() {
    let parameters = Parameters::default();
    let bad = |c| Circuit::new(parameters, c).unwrap_err().to_string();
    assert_eq!(bad([0.0, 1e-12]), "left.capacitance = 0 F is not above 0 F");
    assert_eq!(bad([1e-12, f64::INFINITY]), "right.capacitance = inf F is not a finite number");
    let mut circuit = Circuit::new(parameters, C).unwrap();
    let before = circuit.clone();
    let error = circuit.advance(-1.0, C).unwrap_err();
    assert_eq!(error.to_string(), "step = -1 s is below 0 s");
    let error = circuit.advance(f64::NAN, C).unwrap_err();
    assert!(matches!(error, Error::NotFinite { name: "step", .. }));
    let error = circuit.advance(1.0, [1e-12, -1.0]).unwrap_err();
    assert_eq!(error.to_string(), "right.capacitance = -1 F is not above 0 F");
    assert_eq!(circuit, before);
}

#[test]
fn starting_voltages_are_checked() {
    let parameters = Parameters::default();
    let start = |v| Circuit::with_voltages(parameters, C, v).unwrap_err().to_string();
    assert_eq!(start([-1.0, 0.0]), "left.voltage = -1 V is below 0 V");
    assert_eq!(start([0.0, f64::NAN]), "right.voltage = NaN V is not a finite number");
    assert_eq!(start([2000.0, 2100.0]), "right.voltage = 2100 V differs from left.voltage = 2000 V on the shared node");
    let isolated = Parameters { topology: Topology::Isolated, ..parameters };
    let circuit = Circuit::with_voltages(isolated, C, [2000.0, 2100.0]).unwrap();
    assert_eq!(circuit.voltage()[1], 2100.0);
}
