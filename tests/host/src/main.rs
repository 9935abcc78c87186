//! Random calls on the shared library of an FMU, for tools that watch a program from outside, such as valgrind.
//!
//! `fmu-host LIBRARY MODEL_DESCRIPTION FIRST_SEED SEQUENCES [threads | leak | overrun | race]`; the version of FMI is that of the
//! description, and the words are for FMI 2.0.
//!
//! With `threads`, so many sequences run on each of several threads at once. The other words break a rule on purpose, to show
//! that the tool sees it: an instance that is never freed, an array shorter than the call says, or two instances that write
//! into one array at the same time.

use fmu_export::Interface;
use fmu_export::abi::{fmi2Component, fmi2ValueReference};
use fmu_host::{Fmu, Functions, Instance, fmi3, run};
use libloading::Library;
use std::mem::ManuallyDrop;

/// What may stand last.
const WORDS: &str = "threads | leak | overrun | race";
/// Threads of that word.
const THREADS: u64 = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [library, description, first, count, fault @ ..] = arguments.as_slice() else {
        return Err(format!("usage: fmu-host LIBRARY MODEL_DESCRIPTION FIRST_SEED SEQUENCES [{WORDS}]").into());
    };
    let (first, count): (u64, u64) = (first.parse()?, count.parse()?);
    // It stays loaded to the end, so that valgrind knows the names of its functions.
    // SAFETY: the library is one of this project, whose loading runs no code of its own.
    let loaded = ManuallyDrop::new(unsafe { Library::new(library)? });
    let description = std::fs::read_to_string(description)?;
    if description.contains(" fmiVersion=\"3.0\"") {
        // SAFETY: it exports the functions of FMI 3.0.
        let functions = unsafe { fmi3::Functions::load(&loaded)? };
        let census = fmi3::run(&fmi3::Fmu::new(functions, &description)?, first..first + count);
        println!("{library}: {count} sequences of FMI 3.0, statuses {:?}", census.statuses);
        return if fault.is_empty() { Ok(()) } else { Err("a fault is one of FMI 2.0".into()) };
    }
    // SAFETY: it exports the functions of FMI 2.0.
    let functions = unsafe { Functions::load(&loaded)? };
    let fmu = Fmu::new(functions, &description)?;
    if *fault == ["threads"] {
        return on_threads(&fmu, first, count);
    }
    let census = run(&fmu, first..first + count)?;
    println!("{library}: {count} sequences, statuses {:?}", census.statuses);
    match fault {
        [] => Ok(()),
        [fault] if fault == "leak" => leak(&fmu),
        [fault] if fault == "overrun" => overrun(&fmu),
        [fault] if fault == "race" => race(&fmu),
        _ => Err(format!("{fault:?}: allowed: {WORDS}").into()),
    }
}

/// `count` sequences on each of [`THREADS`], with instances of their own.
fn on_threads(fmu: &Fmu, first: u64, count: u64) -> Result<(), Box<dyn std::error::Error>> {
    // What is made once for all instances is made here: ThreadSanitizer does not see how the standard library, which is not
    // compiled for it, guards that.
    drop(Instance::new(fmu, Interface::CoSimulation)?);
    let outcomes: Vec<_> = std::thread::scope(|scope| {
        let seeds = (0..THREADS).map(|thread| first + thread * count..first + (thread + 1) * count);
        let threads: Vec<_> = seeds.map(|seeds| scope.spawn(move || run(fmu, seeds).map(|_| ()))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err("a panic".to_owned()))).collect()
    });
    println!("{count} sequences on each of {THREADS} threads");
    Ok(outcomes.into_iter().collect::<Result<(), _>>()?)
}

/// Forgets instances: so many, as the address of the last one may still be found on the stack or in a register.
fn leak(fmu: &Fmu) -> Result<(), Box<dyn std::error::Error>> {
    for _ in 0..10 {
        let mut instance = Instance::new(fmu, Interface::CoSimulation)?;
        let forgotten: fmi2Component = core::mem::replace(&mut instance.component, core::ptr::null_mut());
        core::hint::black_box(forgotten);
    }
    Ok(())
}

/// Has one value reference more read than there are.
fn overrun(fmu: &Fmu) -> Result<(), Box<dyn std::error::Error>> {
    let instance = Instance::new(fmu, Interface::CoSimulation)?;
    let references: Box<[fmi2ValueReference]> = vec![0; 2].into();
    let mut values = [0.0; 3];
    // SAFETY: none; that is the point.
    unsafe { (fmu.functions.fmi2GetReal)(instance.component, references.as_ptr(), 3, values.as_mut_ptr()) };
    Ok(())
}

/// Has two instances write into one array at the same time.
fn race(fmu: &Fmu) -> Result<(), Box<dyn std::error::Error>> {
    /// The address of the array, which nobody guards.
    #[derive(Clone, Copy)]
    struct Shared(*mut f64);
    // SAFETY: none; that is the point.
    unsafe impl Send for Shared {}

    let mut value = [0.0];
    let shared = Shared(value.as_mut_ptr());
    let read = move || -> Result<(), String> {
        let place = shared;
        let instance = Instance::new(fmu, Interface::CoSimulation)?;
        for _ in 0..1000 {
            // SAFETY: none; that is the point.
            unsafe { (fmu.functions.fmi2GetReal)(instance.component, &0, 1, place.0) };
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(read), scope.spawn(read)];
        threads.map(|thread| thread.join().unwrap_or_else(|_| Err("a panic".to_owned())))
    })
    .into_iter()
    .collect::<Result<(), _>>()?;
    Ok(())
}
