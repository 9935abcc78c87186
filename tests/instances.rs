//! Many instances of the harvester FMU: at once on several threads, and one after the other.

#![allow(clippy::unwrap_used)]

use std::thread;

use fmu_import::{Fmu, Instance, Logging};
use videg::package::{Options, build_all};

fn harvester(folder: &std::path::Path) -> std::path::PathBuf {
    build_all(&Options { output: Some(folder.to_owned()), ..Options::default() }).unwrap().swap_remove(0)
}

fn initialise(instance: &mut Instance, restitution: f64) {
    instance.set_by_name("membrane.restitution", &restitution.to_string()).unwrap();
    instance.set_by_name("excitation.phaseNoise", "0.1").unwrap();
    instance.set_by_name("excitation.noiseHold", "1e-3").unwrap();
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
}

/// Sum of the voltage gains after 10 s in steps of 10 ms.
fn gain(fmu: &Fmu, restitution: f64) -> f64 {
    let mut instance = fmu.instantiate("one of many", Logging::default()).unwrap();
    initialise(&mut instance, restitution);
    (0..1000).for_each(|k| instance.do_step(0.01 * f64::from(k), 0.01).unwrap());
    let reference = fmu.description().variable("gain.voltage").unwrap().value_reference;
    let mut value = [0.0];
    instance.get_real(&[reference], &mut value).unwrap();
    value[0]
}

#[test]
fn sixty_four_instances_on_eight_threads_give_the_results_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Fmu::open(harvester(folder.path())).unwrap();
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

/// Resident memory of this process, bytes.
#[cfg(target_os = "linux")]
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/statm").unwrap();
    status.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() * 4096
}

/// Each cycle unpacks the archive, loads the library, instantiates, steps through an impact, frees and unloads.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "slow"]
fn load_run_and_unload_again_and_again_leave_memory_flat() {
    let folder = tempfile::tempdir().unwrap();
    let path = harvester(folder.path());
    let cycle = || {
        let fmu = Fmu::open(&path).unwrap();
        let mut instance = fmu.instantiate("cycle", Logging::default()).unwrap();
        initialise(&mut instance, 0.6);
        instance.do_step(0.0, 1.0).unwrap();
        let state = instance.save_state().unwrap();
        instance.restore_state(&state).unwrap();
    };
    (0..300).for_each(|_| cycle());
    let before = resident();
    (0..1200).for_each(|_| cycle());
    let grown = resident().saturating_sub(before);
    // A variable table on the heap of the library, which nobody frees at unloading, would be 12 MB.
    assert!(grown < 1 << 20, "{grown} bytes more after 1200 further cycles");
}
