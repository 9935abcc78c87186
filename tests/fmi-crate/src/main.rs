//! Runs the harvester and the circuit with the `fmi` crate: a fixed-step master that goes back half-way and repeats the
//! rest, once from a saved state and once from a serialised one, which must change no bit.
//!
//! `videg-fmi-crate HARVESTER.fmu CIRCUIT.fmu FOLDER STEP STEPS [HARVESTER_VARIABLE=VALUE...]`
//!
//! writes every Real output at the end of each step into a CSV file for each FMU. What the FMUs warn of goes to stderr.

use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation, Common, InstanceCS};
use fmi::fmi2::schema::{Causality, ScalarVariableElement};
use fmi::traits::{FmiImport, FmiStatus};
use videg_fmi_crate::{CONNECTED, Rows, write};

fn main() -> Result<()> {
    log::set_logger(&Complaints)?;
    log::set_max_level(log::LevelFilter::Warn);
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [harvester, circuit, folder, step, steps, values @ ..] = arguments.as_slice() else {
        return Err(anyhow!("usage: videg-fmi-crate HARVESTER CIRCUIT FOLDER STEP STEPS [VARIABLE=VALUE...]"));
    };
    let mut pair = Pair { harvester: Slave::new(harvester)?, circuit: Slave::new(circuit)?, step: step.parse()? };
    for value in values {
        let (name, value) = value.split_once('=').with_context(|| format!("{value} is not VARIABLE=VALUE"))?;
        pair.harvester.set(&[name], &[value.parse()?])?;
    }
    pair.initialize()?;
    let steps: u32 = steps.parse()?;
    let mut rows = pair.run(0, steps / 2)?;
    let later = pair.run_three_times(steps / 2, steps)?;
    for (rows, later) in rows.iter_mut().zip(later) {
        rows.extend(later);
    }
    for (slave, rows) in [&pair.harvester, &pair.circuit].into_iter().zip(rows) {
        slave.write(Path::new(folder), &rows)?;
    }
    pair.harvester.instance.terminate()?;
    pair.circuit.instance.terminate()?;
    Ok(())
}

/// Shows the warnings and errors of the crate and of the FMUs.
struct Complaints;

impl log::Log for Complaints {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        metadata.level() <= log::Level::Warn
    }

    fn log(&self, record: &log::Record<'_>) {
        if self.enabled(record.metadata()) {
            eprintln!("{}: {}", record.level(), record.args());
        }
    }

    fn flush(&self) {}
}

/// The harvester, whose capacitances are those of the circuit from the start of each step on.
struct Pair {
    harvester: Slave,
    circuit: Slave,
    step: f64,
}

impl Pair {
    fn initialize(&mut self) -> Result<()> {
        for slave in [&mut self.harvester, &mut self.circuit] {
            slave.instance.setup_experiment(None, 0.0, None)?;
            slave.instance.enter_initialization_mode()?;
        }
        self.connect()?;
        self.harvester.instance.exit_initialization_mode()?;
        self.circuit.instance.exit_initialization_mode()?;
        Ok(())
    }

    fn connect(&mut self) -> Result<()> {
        let capacitances = self.harvester.get(&CONNECTED)?;
        self.circuit.set(&CONNECTED, &capacitances)
    }

    /// Outputs of both after each step.
    fn run(&mut self, first: u32, end: u32) -> Result<[Rows; 2]> {
        let mut rows = [Rows::new(), Rows::new()];
        for index in first..end {
            self.connect()?;
            for (slave, rows) in [&mut self.harvester, &mut self.circuit].into_iter().zip(&mut rows) {
                slave.instance.do_step(f64::from(index) * self.step, self.step, true)?;
                rows.push(slave.outputs()?);
            }
        }
        Ok(rows)
    }

    /// As [`Pair::run`], and again from the state saved at the beginning, and from its bytes.
    fn run_three_times(&mut self, first: u32, end: u32) -> Result<[Rows; 2]> {
        let saved = [self.harvester.instance.get_fmu_state()?, self.circuit.instance.get_fmu_state()?];
        let rows = self.run(first, end)?;
        for serialised in [false, true] {
            for (slave, state) in [&mut self.harvester, &mut self.circuit].into_iter().zip(&saved) {
                if serialised {
                    let bytes = slave.instance.serialize_fmu_state(state)?;
                    let state = slave.instance.deserialize_fmu_state(&bytes)?;
                    slave.instance.set_fmu_state(&state).ok()?;
                } else {
                    slave.instance.set_fmu_state(state).ok()?;
                }
            }
            let again = self.run(first, end)?;
            ensure!(bits(&again) == bits(&rows), "the outputs change after rollback (serialised: {serialised})");
        }
        Ok(rows)
    }
}

fn bits(rows: &[Rows; 2]) -> Vec<u64> {
    rows.iter().flatten().flatten().map(|value| value.to_bits()).collect()
}

struct Slave {
    import: Fmi2Import,
    instance: InstanceCS,
    /// Names and references of the Real outputs.
    outputs: Vec<(String, u32)>,
}

impl Slave {
    fn new(path: &str) -> Result<Self> {
        let import: Fmi2Import = fmi::import::from_path(path).with_context(|| path.to_owned())?;
        let instance = import.instantiate_cs("slave", false, true).with_context(|| path.to_owned())?;
        let variables = import.model_description().get_model_variables();
        let outputs = variables
            .filter(|it| it.causality == Causality::Output && matches!(it.elem, ScalarVariableElement::Real(_)))
            .map(|it| (it.name.clone(), it.value_reference))
            .collect();
        Ok(Self { import, instance, outputs })
    }

    fn references(&self, names: &[&str]) -> Result<Vec<u32>> {
        let description = self.import.model_description();
        names.iter().map(|name| Ok(description.model_variable_by_name(name)?.value_reference)).collect()
    }

    fn set(&mut self, names: &[&str], values: &[f64]) -> Result<()> {
        self.instance.set_real(&self.references(names)?, values)?;
        Ok(())
    }

    fn get(&mut self, names: &[&str]) -> Result<Vec<f64>> {
        let mut values = vec![0.0; names.len()];
        self.instance.get_real(&self.references(names)?, &mut values)?;
        Ok(values)
    }

    fn outputs(&mut self) -> Result<Vec<f64>> {
        let references: Vec<u32> = self.outputs.iter().map(|(_, reference)| *reference).collect();
        let mut values = vec![0.0; references.len()];
        self.instance.get_real(&references, &mut values)?;
        Ok(values)
    }

    fn write(&self, folder: &Path, rows: &Rows) -> Result<()> {
        write(folder, &self.import.model_description().model_name, &self.outputs, rows)
    }
}
