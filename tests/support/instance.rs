//! Instances of an FMU, ready for the first step.

use fmu_import::{Fmu, Instance, Logging};

/// An instance called `name` with these variables set, initialised.
pub fn initialised(fmu: &Fmu, name: &str, logging: Logging, settings: &[(&str, &str)]) -> Instance {
    let mut instance = fmu.instantiate(name, logging).unwrap();
    for (name, value) in settings {
        instance.set_by_name(name, value).unwrap();
    }
    instance.setup_experiment(0.0, None, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance
}
