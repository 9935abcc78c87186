//! The packaged FMUs give what the Rust packages behind them give: the harvester to the last bit, the circuit to
//! rounding.

use std::sync::{Arc, Mutex};

use fmu_import::Logging;
use videg::cosim::{CircuitSlave, EmbeddedCircuit, FmuCircuit, HarvesterFmu};
use videg::scenario::{Request, Scenario};

use videg_circuit::Settings;
use videg_model::{Case, Harvester, Membrane, Parameters, Side};

use super::fmus;
use super::instance::initialised;

fn scenario(case: &str, until: f64) -> Scenario {
    Request { case: Some(case.to_owned()), until: Some(until), ..Request::default() }.resolve().unwrap()
}

#[test]
fn the_harvester_fmu_gives_the_bits_of_the_model_whatever_the_step() {
    let [fmu, _] = fmus();
    // Chaotic, periodic and chattering cases; a single differing bit would grow beyond recognition in the first.
    for (case, until) in [("fig13", 60.0), ("fig14", 30.0), ("table3-2hz", 20.0)] {
        let mut model = Harvester::new(&(Case::find(case).unwrap().parameters)(), 0.0).unwrap();
        model.advance(until).unwrap();
        for steps in [1_u32, 7, 20_000] {
            let scenario = scenario(case, until);
            let mut harvester = HarvesterFmu::new(&fmu, &scenario, &scenario.settings).unwrap();
            let time = |k: u32| until * f64::from(k) / f64::from(steps);
            for k in 0..steps {
                harvester.step(time(k), time(k + 1) - time(k)).unwrap();
            }
            let sample = harvester.sample().unwrap();
            assert_eq!(sample.voltage_gain(), model.totals().voltage_gain, "{case} in {steps} steps");
            assert_eq!(sample.capacitance(), [Side::Left, Side::Right].map(|side| model.capacitance(side)));
            assert_eq!(i64::from(harvester.counts().unwrap()[0]), i64::try_from(model.totals().impacts).unwrap());
        }
    }
}

#[test]
fn the_circuit_fmu_gives_what_the_embedded_solver_gives() {
    let [_, fmu] = fmus();
    let rest = 15e-12;
    let mut embedded = EmbeddedCircuit::new("embedded", &Settings::default(), [rest; 2]).unwrap();
    let mut exported = FmuCircuit::new("fmu", &fmu, &[], [rest; 2], 10.0).unwrap();
    let capacitance = |k: u32| {
        let pulse = |phase: f64| rest * (1.0 + 0.8 * (f64::from(k) * 0.02 + phase).sin().max(0.0));
        [pulse(0.0), pulse(3.0)]
    };
    for k in 0..10_000 {
        let (time, start, end) = (f64::from(k) * 1e-3, capacitance(k), capacitance(k + 1));
        embedded.step(time, 1e-3, start, end).unwrap();
        exported.step(time, 1e-3, start, end).unwrap();
    }
    let (a, b) = (embedded.sample().unwrap().columns(), exported.sample().unwrap().columns());
    for (a, b) in a.iter().zip(b) {
        // The FMU gets a rate and multiplies it by the step: rounding, no more.
        assert!((a - b).abs() <= 1e-12 * a.abs(), "{a:e} against {b:e}");
    }
}

#[test]
fn the_circuit_starts_with_the_capacitance_of_the_harvesters_membranes() {
    let [harvester, circuit] = fmus();
    let started = circuit.instantiate("circuit", Logging::default()).unwrap().get_by_name("left.capacitance").unwrap();
    let calculated = harvester.instantiate("harvester", Logging::default()).unwrap();
    assert_eq!(started, calculated.get_by_name("membrane.restCapacitance").unwrap());
    assert_eq!(started.to_string(), Membrane::new(&Parameters::default()).rest_capacitance().to_string());
}

#[test]
fn every_impact_is_logged_with_rests_and_with_noise() {
    let [fmu, _] = fmus();
    for (case, noise) in [("table3-2hz", "0"), ("fig14", "0.5")] {
        let lines = Arc::new(Mutex::new(Vec::new()));
        let sink = Arc::clone(&lines);
        let logging =
            Logging { enabled: true, ..Logging::to(move |record| sink.lock().unwrap().push(record.message.clone())) };
        let settings = scenario(case, 5.0).settings;
        let settings = settings.iter().map(|setting| (&*setting.name, &*setting.value));
        let settings: Vec<_> = settings.chain([("excitation.phaseNoise", noise)]).collect();
        let mut instance = initialised(&fmu, "logged", logging, &settings);
        (0..5).for_each(|k| instance.do_step(f64::from(k), 1.0).unwrap());
        let impacts = instance.get_by_name("impact.count").unwrap().to_string();
        let logged = lines.lock().unwrap().iter().filter(|line| line.starts_with("impact ")).count();
        assert!(logged > 10 && logged.to_string() == impacts, "{case}: {logged} of {impacts}");
    }
}
