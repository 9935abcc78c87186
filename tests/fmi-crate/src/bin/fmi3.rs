//! As `main.rs`, of FMI 3.0, of which the crate has no FMU states: a fixed-step master.

use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use fmi::fmi3::import::Fmi3Import;
use fmi::fmi3::instance::InstanceCS;
use fmi::fmi3::{CoSimulation, Common, Fmi3Model, GetSet};
use fmi::schema::fmi3::{Causality, VariableType};
use fmi::traits::FmiImport;
use videg_fmi_crate::{CONNECTED, Rows, write};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [harvester, circuit, folder, step, steps, values @ ..] = arguments.as_slice() else {
        return Err(anyhow!("usage: videg-fmi3-crate HARVESTER CIRCUIT FOLDER STEP STEPS [VARIABLE=VALUE...]"));
    };
    let imports =
        [harvester, circuit].map(|path| fmi::import::from_path::<Fmi3Import>(path).with_context(|| path.clone()));
    let [harvester, circuit] = imports;
    let (harvester, circuit) = (harvester?, circuit?);
    let (step, steps): (f64, u32) = (step.parse()?, steps.parse()?);
    let mut slaves = [Slave::new(&harvester)?, Slave::new(&circuit)?];
    for value in values {
        let (name, value) = value.split_once('=').with_context(|| format!("{value} is not VARIABLE=VALUE"))?;
        slaves[0].set(&[name], &[value.parse()?])?;
    }
    for slave in &mut slaves {
        slave.instance.enter_initialization_mode(None, 0.0, Some(step * f64::from(steps)))?;
    }
    connect(&mut slaves)?;
    for slave in &mut slaves {
        slave.instance.exit_initialization_mode()?;
    }
    let rows = run(&mut slaves, steps, step)?;
    for (slave, rows) in slaves.iter_mut().zip(rows) {
        slave.write(Path::new(folder), &rows)?;
        slave.instance.terminate()?;
    }
    Ok(())
}

fn connect([harvester, circuit]: &mut [Slave<'_>; 2]) -> Result<()> {
    let capacitances = harvester.get(&CONNECTED)?;
    circuit.set(&CONNECTED, &capacitances)
}

/// Outputs of both after each step.
fn run(slaves: &mut [Slave<'_>; 2], steps: u32, size: f64) -> Result<[Rows; 2]> {
    let mut rows = [Rows::new(), Rows::new()];
    for index in 0..steps {
        connect(slaves)?;
        for (slave, rows) in slaves.iter_mut().zip(&mut rows) {
            slave.step(f64::from(index) * size, size)?;
            rows.push(slave.outputs()?);
        }
    }
    Ok(rows)
}

struct Slave<'a> {
    import: &'a Fmi3Import,
    instance: InstanceCS,
    /// Names and references of the outputs that are Float64 and belong to no clock.
    outputs: Vec<(String, u32)>,
}

impl<'a> Slave<'a> {
    fn new(import: &'a Fmi3Import) -> Result<Self> {
        let instance = import.instantiate_cs("slave", false, true, false, false, &[])?;
        let variables = import.model_description().model_variables.iter_abstract();
        let outputs = variables
            .filter(|it| it.causality() == Causality::Output && it.data_type() == VariableType::FmiFloat64)
            .filter(|it| it.clocks().is_none_or(<[u32]>::is_empty))
            .map(|it| (it.name().to_owned(), it.value_reference()))
            .collect();
        Ok(Self { import, instance, outputs })
    }

    fn references(&self, names: &[&str]) -> Result<Vec<u32>> {
        let variables = &self.import.model_description().model_variables;
        let reference = |name: &&str| {
            let found = variables.find_by_name(name).with_context(|| format!("no variable {name}"));
            Ok(found?.value_reference())
        };
        names.iter().map(reference).collect()
    }

    fn set(&mut self, names: &[&str], values: &[f64]) -> Result<()> {
        self.instance.set_float64(&self.references(names)?, values)?;
        Ok(())
    }

    fn get(&mut self, names: &[&str]) -> Result<Vec<f64>> {
        let mut values = vec![0.0; names.len()];
        self.instance.get_float64(&self.references(names)?, &mut values)?;
        Ok(values)
    }

    fn step(&mut self, time: f64, size: f64) -> Result<()> {
        let (mut event, mut terminate, mut early, mut last) = (true, true, true, f64::NAN);
        self.instance.do_step(time, size, true, &mut event, &mut terminate, &mut early, &mut last)?;
        ensure!(
            !event && !terminate && !early && last.to_bits() == (time + size).to_bits(),
            "the step from {time} s ended at {last} s"
        );
        Ok(())
    }

    fn outputs(&mut self) -> Result<Vec<f64>> {
        let references: Vec<u32> = self.outputs.iter().map(|(_, reference)| *reference).collect();
        let mut values = vec![0.0; references.len()];
        self.instance.get_float64(&references, &mut values)?;
        Ok(values)
    }

    fn write(&self, folder: &Path, rows: &Rows) -> Result<()> {
        write(folder, &self.import.model_description().model_name, &self.outputs, rows)
    }
}
