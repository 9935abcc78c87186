//! Random calls on the shared library of an FMU, for tools that watch a program from outside, such as valgrind.
//!
//! `fmi2-host LIBRARY MODEL_DESCRIPTION FIRST_SEED SEQUENCES [leak | overrun]`
//!
//! The last argument breaks a rule on purpose, to show that the tool sees it: an instance that is never freed, or an array
//! shorter than the call says.

use fmi2_export::Interface;
use fmi2_export::abi::{fmi2Component, fmi2ValueReference};
use fmi2_host::{Fmu, Functions, Instance, run};
use libloading::Library;
use std::mem::ManuallyDrop;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [library, description, first, count, fault @ ..] = arguments.as_slice() else {
        return Err("usage: fmi2-host LIBRARY MODEL_DESCRIPTION FIRST_SEED SEQUENCES [leak | overrun]".into());
    };
    let (first, count): (u64, u64) = (first.parse()?, count.parse()?);
    // It stays loaded to the end, so that valgrind knows the names of its functions.
    // SAFETY: the library is one of this project, whose loading runs no code of its own.
    let loaded = ManuallyDrop::new(unsafe { Library::new(library)? });
    // SAFETY: it exports the functions of FMI 2.0.
    let functions = unsafe { Functions::load(&loaded)? };
    let fmu = Fmu::new(functions, &std::fs::read_to_string(description)?)?;
    let census = run(&fmu, first..first + count)?;
    println!("{library}: {count} sequences, statuses {:?}", census.statuses);
    match fault {
        [] => Ok(()),
        [fault] if fault == "leak" => leak(&fmu),
        [fault] if fault == "overrun" => overrun(&fmu),
        _ => Err(format!("{fault:?}: allowed: leak, overrun").into()),
    }
}

/// Forgets an instance.
fn leak(fmu: &Fmu) -> Result<(), Box<dyn std::error::Error>> {
    let mut instance = Instance::new(fmu, Interface::CoSimulation)?;
    let forgotten: fmi2Component = core::mem::replace(&mut instance.component, core::ptr::null_mut());
    core::hint::black_box(forgotten);
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
