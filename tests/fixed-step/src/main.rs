//! Couples the harvester and the circuit, each an FMU, in the plainest way: steps of one size, and the capacitances at
//! the start of a step go into the circuit. The conformance matrix compares other importers with this one.
//!
//! `videg-fixed-step HARVESTER.fmu CIRCUIT.fmu FOLDER STEP STEPS [HARVESTER_VARIABLE=VALUE...]`
//!
//! writes every Real output at the end of each step into `FOLDER/MODEL.csv`.

use std::path::Path;

use anyhow::{Context, Result, bail};
use fmu_import::{Causality, Fmu, Instance, Kind, Logging};

/// Outputs of the harvester and inputs of the circuit.
const CONNECTED: [&str; 2] = ["left.capacitance", "right.capacitance"];

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [harvester, circuit, folder, step, steps, values @ ..] = arguments.as_slice() else {
        bail!("usage: videg-fixed-step HARVESTER CIRCUIT FOLDER STEP STEPS [HARVESTER_VARIABLE=VALUE...]");
    };
    let (harvester, circuit) = (Fmu::open(harvester)?, Fmu::open(circuit)?);
    let mut source = harvester.instantiate("harvester", Logging::default())?;
    for value in values {
        let (name, value) = value.split_once('=').with_context(|| format!("{value} is not VARIABLE=VALUE"))?;
        source.set_by_name(name, value)?;
    }
    let mut sink = circuit.instantiate("circuit", Logging::default())?;
    let connection = Connection::new(&source, &sink)?;
    for instance in [&mut source, &mut sink] {
        instance.setup_experiment(0.0, None, None)?;
        instance.enter_initialization_mode()?;
    }
    connection.pass(&source, &mut sink)?;
    source.exit_initialization_mode()?;
    sink.exit_initialization_mode()?;

    let folder = Path::new(folder);
    let mut records = [Record::new(folder, &source)?, Record::new(folder, &sink)?];
    let (step, steps): (f64, u32) = (step.parse()?, steps.parse()?);
    for index in 0..steps {
        connection.pass(&source, &mut sink)?;
        for (instance, record) in [&mut source, &mut sink].into_iter().zip(&mut records) {
            instance.do_step(f64::from(index) * step, step)?;
            record.write(instance)?;
        }
    }
    for (mut instance, record) in [source, sink].into_iter().zip(records) {
        instance.terminate()?;
        if let Some(message) = instance.messages().first() {
            bail!("{}: {}", instance.name(), message.message);
        }
        record.finish()?;
    }
    Ok(())
}

/// Value references of the capacitances.
struct Connection {
    from: Vec<u32>,
    to: Vec<u32>,
}

impl Connection {
    fn new(source: &Instance, sink: &Instance) -> Result<Self> {
        let references = |instance: &Instance| -> Result<Vec<u32>> {
            CONNECTED.iter().map(|name| Ok(instance.description().variable(name)?.value_reference)).collect()
        };
        Ok(Self { from: references(source)?, to: references(sink)? })
    }

    fn pass(&self, source: &Instance, sink: &mut Instance) -> Result<()> {
        let mut values = [0.0; CONNECTED.len()];
        source.get_real(&self.from, &mut values)?;
        Ok(sink.set_real(&self.to, &values)?)
    }
}

/// The Real outputs of an instance as a table.
struct Record {
    references: Vec<u32>,
    values: Vec<f64>,
    table: csv::Writer<std::fs::File>,
}

impl Record {
    fn new(folder: &Path, instance: &Instance) -> Result<Self> {
        let description = instance.description();
        let variables = description.variables.iter();
        let outputs = variables.filter(|it| it.causality == Causality::Output && matches!(it.kind, Kind::Real { .. }));
        let (names, references): (Vec<_>, Vec<_>) = outputs.map(|it| (it.name.as_str(), it.value_reference)).unzip();
        let mut table = csv::Writer::from_path(folder.join(&description.model_name).with_extension("csv"))?;
        table.write_record(names)?;
        Ok(Self { values: vec![0.0; references.len()], references, table })
    }

    fn write(&mut self, instance: &Instance) -> Result<()> {
        instance.get_real(&self.references, &mut self.values)?;
        Ok(self.table.write_record(self.values.iter().map(|value| format!("{value:e}")))?)
    }

    fn finish(mut self) -> Result<()> {
        Ok(self.table.flush()?)
    }
}
