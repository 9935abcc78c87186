//! Many instances of the harvester FMU at once, on several threads.

use std::thread;

use fmu_import::{Fmu, Logging, Value};

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
