//! Many instances of the harvester FMU at once, on several threads.

use std::thread;

use fmu_import::{Fmu, Logging, Value};
use videg::scenario::{Request, Setting};
use videg::simulate;

use super::fmus;
use super::instance::initialised;

/// Sum of the voltage gains after 10 s in steps of 10 ms.
fn gain(fmu: &Fmu, restitution: f64) -> f64 {
    let restitution = restitution.to_string();
    let settings =
        [("membrane.restitution", &*restitution), ("excitation.phaseNoise", "0.1"), ("excitation.noiseHold", "1e-3")];
    let mut instance = initialised(fmu, "one of many", Logging::default(), &settings);
    (0..1000).for_each(|k| instance.do_step(0.01 * f64::from(k), 0.01).unwrap());
    match instance.get_by_name("gain.voltage").unwrap() {
        Value::Real(gain) => gain,
        other => panic!("{other} is no real number"),
    }
}

#[test]
fn sixty_four_instances_on_eight_threads_give_the_results_of_one() {
    let [fmu, _] = fmus();
    let restitution = |index: u32| 0.3 + 0.01 * f64::from(index);
    let alone: Vec<f64> = (0..64).map(|index| gain(&fmu, restitution(index))).collect();
    let threads: Vec<_> = (0..8_u32)
        .map(|thread| {
            let fmu = fmu.clone();
            thread::spawn(move || (0..8).map(|k| gain(&fmu, restitution(8 * thread + k))).collect::<Vec<_>>())
        })
        .collect();
    let together: Vec<f64> = threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect();
    assert_eq!(alone, together);
    assert!(alone.iter().all(|gain| *gain > 0.0) && alone.windows(2).any(|pair| pair[0] != pair[1]));
}

#[test]
fn membranes_begin_at_the_voltage_of_the_supply_unless_theirs_is_set() {
    let [fmu, _] = fmus();
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..20 {
        let [bias, left] = [(); 2].map(|()| 1e4 * random.f64());
        let mut settings = vec![Setting::new("biasVoltage", bias.to_string())];
        let is_set = random.bool();
        if is_set {
            settings.insert(0, Setting::new("left.voltage", left.to_string()));
        }
        let scenario = Request { settings, ..Request::default() }.resolve().unwrap();
        let instance = simulate::instance(&fmu, &scenario).unwrap();
        let voltages = ["left.voltage", "right.voltage"].map(|name| instance.get_by_name(name).unwrap());
        assert_eq!(voltages, [if is_set { left } else { bias }, bias].map(Value::Real));
    }
}
