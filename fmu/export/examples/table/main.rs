//! A table reader: `resources/table.csv` has a column of times and others, each of which is an output, linear between the rows and
//! constant outside. The outputs are known at run time only: another table makes another FMU of the same sources.
//! `cargo fmu build --example table`

use std::path::Path;
use std::sync::OnceLock;

use fmu_export::{Experiment, Logger, ModelInfo, Slave, SlaveError, Variable, export_fmu};

/// The file with the table: a line of names, with units in brackets, then numbers.
const FILE: &str = "table.csv";

/// A table, and the variables that it makes.
struct Table {
    times: Vec<f64>,
    columns: Vec<Vec<f64>>,
    variables: Vec<Variable<Reader>>,
}

/// The table of this FMU.
static TABLE: OnceLock<Table> = OnceLock::new();

impl Table {
    /// Reads the text of a table.
    fn parse(text: &str) -> Result<Self, String> {
        let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
        let (header, _) = lines.next().ok_or("it is empty")?;
        let names: Vec<_> = header.split(',').skip(1).map(name_and_unit).collect();
        let (mut times, mut columns) = (Vec::new(), vec![Vec::new(); names.len()]);
        for (line, number) in lines {
            let cells: Vec<_> = line.split(',').map(str::trim).collect();
            if cells.len() != names.len() + 1 {
                return Err(format!("line {number} has {} cells, the first line {}", cells.len(), names.len() + 1));
            }
            let mut values = Vec::new();
            for cell in cells {
                let value: Option<f64> = cell.parse().ok().filter(|value: &f64| value.is_finite());
                values.push(value.ok_or_else(|| format!("line {number}: {cell:?} is no finite number"))?);
            }
            if let Some(last) = times.last().filter(|last| **last >= values[0]) {
                return Err(format!("line {number}: time {} is not behind {last}", values[0]));
            }
            times.push(values[0]);
            columns.iter_mut().zip(&values[1..]).for_each(|(column, value): (&mut Vec<f64>, _)| column.push(*value));
        }
        if times.is_empty() {
            return Err("it has no rows".to_owned());
        }
        let row = |(number, (name, unit)): (usize, (String, String))| {
            // The table lives as long as the library.
            Variable::output(name.leak(), unit.leak(), "Column of the table")
                .depends_on(&[])
                .get_element(number, |reader: &Reader, number| reader.value(number))
        };
        Ok(Self { times, columns, variables: names.into_iter().enumerate().map(row).collect() })
    }

    /// A column at a time, s.
    fn value(&self, column: usize, time: f64) -> f64 {
        let (times, values) = (&self.times, &self.columns[column]);
        match times.partition_point(|known| *known <= time) {
            0 => values[0],
            next if next == times.len() => values[next - 1],
            next => {
                let part = (time - times[next - 1]) / (times[next] - times[next - 1]);
                values[next - 1] + part * (values[next] - values[next - 1])
            }
        }
    }
}

/// `speed [m/s]` is a name and a unit.
fn name_and_unit(cell: &str) -> (String, String) {
    let (name, unit) = cell.trim().split_once('[').unwrap_or((cell, "1]"));
    (name.trim().to_owned(), unit.trim_end().trim_end_matches(']').trim().to_owned())
}

/// The model: where in the table it is.
#[derive(Clone, Default)]
struct Reader {
    time: f64,
}

impl Reader {
    fn value(&self, column: usize) -> f64 {
        TABLE.get().map_or(f64::NAN, |table| table.value(column, self.time))
    }
}

impl Slave for Reader {
    const INFO: ModelInfo = ModelInfo::new("Table")
        .description("Columns of a table over time")
        .version(env!("CARGO_PKG_VERSION"))
        .license("MIT OR Apache-2.0")
        .default_experiment(0.0, 5.0, 0.1);

    fn load_variables(resources: Option<&Path>) -> Result<(), SlaveError> {
        if TABLE.get().is_some() {
            return Ok(());
        }
        let folder =
            resources.ok_or_else(|| SlaveError::error(format!("no folder of resources, in which {FILE} is")))?;
        let file = folder.join(FILE);
        let failed = |cause: String| SlaveError::error(format!("{}: {cause}", file.display()));
        let text = std::fs::read_to_string(&file).map_err(|error| failed(error.to_string()))?;
        let table = Table::parse(&text).map_err(failed)?;
        TABLE.get_or_init(|| table);
        Ok(())
    }

    fn variables() -> &'static [Variable<Self>] {
        TABLE.get().map_or(&[], |table| &table.variables)
    }

    fn new() -> Self {
        Self::default()
    }

    fn setup_experiment(&mut self, experiment: &Experiment, _log: &Logger) -> Result<(), SlaveError> {
        self.time = experiment.start_time;
        Ok(())
    }

    fn do_step(&mut self, t: f64, h: f64, _log: &Logger) -> Result<(), SlaveError> {
        self.time = t + h;
        Ok(())
    }
}

export_fmu!(Reader);
