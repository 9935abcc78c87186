//! Drives a library of the harvester FMU through the case of Fig. 14, as a slave and as differential equations, and prints
//! what comes out, so that the libraries of two platforms can be compared. Deliberately without the importer: nothing here but the C functions.
//!
//! `videg-fmu-client LIBRARY MODEL_DESCRIPTION`

use std::error::Error;
use std::ffi::{CString, c_int};
use std::mem::MaybeUninit;
use std::ptr;

use fmu_abi as abi;
use libloading::{Library, Symbol};
use videg_model::{Case, Parameters};

/// Simulated time, s.
const UNTIL: u32 = 10;
/// Communication steps in a second.
const STEPS_PER_SECOND: u32 = 1000;
/// Outputs that are printed at the end.
const OUTPUTS: [&str; 5] = ["gain.voltage", "gain.energyEq13", "cylinder.position", "ball.position", "ball.velocity"];
/// Outputs of which the sum over all steps is printed.
const SUMMED: [&str; 2] = ["left.capacitance", "right.capacitance"];

/// Time at which the differential equations are evaluated, s.
const LATER: f64 = 0.01;
/// Position and velocity of the cylinder, then of the ball, which is in flight; m and m/s.
const STATES: [f64; 5] = [0.02, 0.3, 0.001, -0.1, 2e-6];

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let (Some(library), Some(description)) = (arguments.next(), arguments.next()) else {
        return Err("usage: videg-fmu-client LIBRARY MODEL_DESCRIPTION".into());
    };
    let description = std::fs::read_to_string(description)?;
    // SAFETY: the library is one of this project, whose loading runs no code of its own.
    let library = unsafe { Library::new(library)? };
    let guid = attribute(&description, "guid=\"")?;
    let instance = Instance::new(&library, abi::fmi2CoSimulation, &guid)?;
    instance.set_up(&description)?;
    let sums = instance.run(&references(&description, &SUMMED)?)?;
    let values = instance.get(&references(&description, &OUTPUTS)?)?;
    for (name, value) in OUTPUTS.iter().zip(values) {
        println!("{name} {value:e}");
    }
    for (name, value) in SUMMED.iter().zip(sums) {
        println!("sum({name}) {value:e}");
    }
    let instance = Instance::new(&library, abi::fmi2ModelExchange, &guid)?;
    instance.set_up(&description)?;
    instance.evaluate(&description)
}

/// An instance; the functions are looked up at each call, which is as slow as it is short.
struct Instance<'a> {
    library: &'a Library,
    component: abi::fmi2Component,
}

impl<'a> Instance<'a> {
    fn new(library: &'a Library, kind: abi::fmi2Type, guid: &str) -> Outcome<Self> {
        let (name, guid) = (CString::new("client")?, CString::new(guid)?);
        let callbacks = abi::fmi2CallbackFunctions {
            logger: None,
            allocateMemory: None,
            freeMemory: None,
            stepFinished: None,
            componentEnvironment: ptr::null_mut(),
        };
        // The function table must outlive the instance, which lives to the end of the program.
        let callbacks = Box::leak(Box::new(callbacks));
        // SAFETY: the type is that of FMI 2.0, and all pointers are valid.
        let component = unsafe {
            let instantiate: Symbol<'_, abi::fmi2InstantiateTYPE> = library.get(b"fmi2Instantiate")?;
            let (name, guid) = (name.as_ptr(), guid.as_ptr());
            instantiate(name, kind, guid, ptr::null(), callbacks, abi::fmi2False, abi::fmi2False)
        };
        if component.is_null() {
            return Err("fmi2Instantiate gave NULL".into());
        }
        Ok(Self { library, component })
    }

    /// Sets the case and initialises.
    fn set_up(&self, description: &str) -> Outcome<()> {
        let case = Case::find("fig14").ok_or("there is no case fig14")?;
        let parameters = (case.parameters)();
        for quantity in Parameters::TABLE {
            let (reference, value) = (reference(description, quantity.name)?, (quantity.get)(&parameters));
            self.call::<abi::fmi2SetRealTYPE>("fmi2SetReal", |set, component| unsafe {
                // SAFETY: one reference and one value, as is said.
                set(component, &raw const reference, 1, &raw const value)
            })?;
        }
        // SAFETY: these functions take plain values.
        self.call::<abi::fmi2SetupExperimentTYPE>("fmi2SetupExperiment", |setup, component| unsafe {
            setup(component, abi::fmi2False, 0.0, 0.0, abi::fmi2False, 0.0)
        })?;
        self.call::<abi::fmi2TerminateTYPE>("fmi2EnterInitializationMode", |enter, component| unsafe {
            enter(component)
        })?;
        self.call::<abi::fmi2TerminateTYPE>("fmi2ExitInitializationMode", |exit, component| unsafe { exit(component) })
    }

    /// Steps to the end and returns the sums of some outputs over all steps.
    fn run(&self, summed: &[u32]) -> Outcome<Vec<f64>> {
        let mut sums = vec![0.0; summed.len()];
        for step in 0..UNTIL * STEPS_PER_SECOND {
            let (time, size) = (f64::from(step) / f64::from(STEPS_PER_SECOND), 1.0 / f64::from(STEPS_PER_SECOND));
            // SAFETY: the function takes plain values.
            self.call::<abi::fmi2DoStepTYPE>("fmi2DoStep", |do_step, component| unsafe {
                do_step(component, time, size, abi::fmi2True)
            })?;
            sums.iter_mut().zip(self.get(summed)?).for_each(|(sum, value)| *sum += value);
        }
        Ok(sums)
    }

    /// Enters continuous-time mode and prints derivatives and event indicators at [`LATER`] in [`STATES`].
    fn evaluate(&self, description: &str) -> Outcome<()> {
        let mut info = MaybeUninit::<abi::fmi2EventInfo>::uninit();
        self.call::<abi::fmi2NewDiscreteStatesTYPE>("fmi2NewDiscreteStates", |update, component| unsafe {
            // SAFETY: the function writes the information and does not read it.
            update(component, info.as_mut_ptr())
        })?;
        // SAFETY: these functions take plain values.
        self.call::<abi::fmi2TerminateTYPE>("fmi2EnterContinuousTimeMode", |enter, component| unsafe {
            enter(component)
        })?;
        self.call::<abi::fmi2SetTimeTYPE>("fmi2SetTime", |set, component| unsafe { set(component, LATER) })?;
        self.call::<abi::fmi2SetContinuousStatesTYPE>("fmi2SetContinuousStates", |set, component| unsafe {
            // SAFETY: the array is as long as is said.
            set(component, STATES.as_ptr(), STATES.len())
        })?;
        self.print("fmi2GetDerivatives", STATES.len())?;
        self.print("fmi2GetEventIndicators", attribute(description, "numberOfEventIndicators=\"")?.parse()?)
    }

    /// Prints what one of the functions that fill an array gives.
    fn print(&self, name: &str, count: usize) -> Outcome<()> {
        let mut values = vec![f64::NAN; count];
        self.call::<abi::fmi2GetDerivativesTYPE>(name, |get, component| unsafe {
            // SAFETY: the array is as long as is said.
            get(component, values.as_mut_ptr(), count)
        })?;
        for (index, value) in values.iter().enumerate() {
            println!("{name}[{index}] {value:e}");
        }
        Ok(())
    }

    fn get(&self, references: &[u32]) -> Outcome<Vec<f64>> {
        let mut values = vec![0.0; references.len()];
        self.call::<abi::fmi2GetRealTYPE>("fmi2GetReal", |get, component| unsafe {
            // SAFETY: both arrays are as long as is said.
            get(component, references.as_ptr(), references.len(), values.as_mut_ptr())
        })?;
        Ok(values)
    }

    /// Calls a function that returns a status.
    fn call<F>(&self, name: &str, call: impl FnOnce(&F, abi::fmi2Component) -> c_int) -> Outcome<()> {
        // SAFETY: the callers name the function and its type, which are those of FMI 2.0.
        let function: Symbol<'_, F> = unsafe { self.library.get(name.as_bytes())? };
        match call(&function, self.component) {
            abi::fmi2OK => Ok(()),
            status => Err(format!("{name} returned status {status}").into()),
        }
    }
}

/// What stands between `start` and the next quote.
fn attribute(text: &str, start: &str) -> Outcome<String> {
    let (_, rest) = text.split_once(start).ok_or_else(|| format!("the model description has no {start}"))?;
    Ok(rest.split('"').next().unwrap_or_default().to_owned())
}

fn reference(description: &str, name: &str) -> Outcome<u32> {
    Ok(attribute(description, &format!("name=\"{name}\" valueReference=\""))?.parse()?)
}

fn references(description: &str, names: &[&str]) -> Outcome<Vec<u32>> {
    names.iter().map(|name| reference(description, name)).collect()
}
