//! Loading and unloading the libraries of the FMUs leaves nothing behind. Alone in its file: the memory of the process is
//! measured, and other tests would use some meanwhile.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

#[path = "support/instance.rs"]
mod instance;

use std::path::{Path, PathBuf};

use fmu_host::{Fmu, Functions, Instance, abi};
use fmu_import::{Archive, Logging};
use videg::package::{Options, build_all};

/// The libraries of both FMUs with their model descriptions, unpacked into `folder`.
fn libraries(folder: &Path) -> Vec<(PathBuf, String)> {
    let unpack = |archive: PathBuf| {
        let name = archive.file_stem().unwrap().to_str().unwrap().to_owned();
        let unpacked = Archive::open(&archive).unwrap().unpack().unwrap();
        let library = folder.join(format!("{name}.so"));
        std::fs::copy(unpacked.path().join(format!("binaries/linux64/{name}.so")), &library).unwrap();
        (library, std::fs::read_to_string(unpacked.path().join("modelDescription.xml")).unwrap())
    };
    let options = Options { output: Some(folder.to_owned()), ..Options::default() };
    build_all(&options).unwrap().into_iter().map(unpack).collect()
}

/// Loads the library, runs an instance through a step, a saved state and an error, and unloads the library.
fn cycle(library: &Path, description: &str) {
    // SAFETY: the library exports the functions of FMI 2.0, which are called while it is loaded.
    unsafe {
        let library = libloading::Library::new(library).unwrap();
        let fmu = Fmu::new(Functions::load(&library).unwrap(), description).unwrap();
        let f = &fmu.functions;
        let instance = Instance::new(&fmu, fmu_host::Interface::CoSimulation).unwrap();
        let (c, mut state) = (instance.component, std::ptr::null_mut());
        assert_eq!((f.fmi2SetupExperiment)(c, 0, 0.0, 0.0, 0, 0.0), abi::fmi2OK);
        assert_eq!((f.fmi2EnterInitializationMode)(c), abi::fmi2OK);
        assert_eq!((f.fmi2ExitInitializationMode)(c), abi::fmi2OK);
        assert_eq!((f.fmi2DoStep)(c, 0.0, 1.0, abi::fmi2True), abi::fmi2OK);
        assert_eq!((f.fmi2GetFMUstate)(c, &raw mut state), abi::fmi2OK);
        assert_eq!((f.fmi2DoStep)(c, 0.0, f64::NAN, abi::fmi2True), abi::fmi2Error);
        assert_eq!(instance.log().take().last().unwrap().status, abi::fmi2Error);
        drop(instance);
        library.close().unwrap();
    }
}

/// Resident memory of this process, bytes.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/statm").unwrap();
    status.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() * 4096
}

/// Bytes of memory that `cycles` repetitions of `cycle` take, after some others.
fn grown(cycle: impl Fn(), before: u32, cycles: u32) -> u64 {
    (0..before).for_each(|_| cycle());
    let before = resident();
    (0..cycles).for_each(|_| cycle());
    resident().saturating_sub(before)
}

#[test]
#[ignore = "slow"]
fn cycles_of_loading_running_and_unloading_leave_memory_flat() {
    let folder = tempfile::tempdir().unwrap();
    for (library, description) in libraries(folder.path()) {
        let grown = grown(|| cycle(&library, &description), 1000, 9000);
        let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
        assert!(!maps.contains(library.to_str().unwrap()), "{} is still loaded", library.display());
        println!("{}: {grown} bytes more after 9000 further cycles", library.display());
        // 16 pages, which the allocator may keep for itself: whatever is left behind by each cycle, be it as small as the
        // smallest block of malloc (32 bytes), would come to 288 kB.
        assert!(grown <= 1 << 16, "{grown} bytes more after 9000 further cycles of {}", library.display());
    }
    // Through the importer, which unpacks the archive each time.
    let imported = || {
        let fmu = fmu_import::Fmu::open(folder.path().join("VibroImpactHarvester.fmu")).unwrap();
        let mut instance = instance::initialised(&fmu, "harvester", Logging::default(), &[]);
        instance.do_step(0.0, 1.0).unwrap();
        let state = instance.save_state().unwrap();
        instance.restore_state(&state).unwrap();
    };
    let grown = grown(imported, 300, 1200);
    // A variable table on the heap of the library, which nobody frees at unloading, would be 12 MB.
    assert!(grown < 1 << 20, "{grown} bytes more after 1200 further cycles");
}
