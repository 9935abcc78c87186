//! C(t) of a run for other programs: subcircuits for simulators of circuits, tables for everything else.

mod data;
mod mat;
mod spice;

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use fmu_import::{Fmu, Kind, nearest_name};
use serde::Serialize;
use thiserror::Error;
use videg_system::atomic_file::{self, AtomicFile};

use crate::cosim::{CircuitRequest, CosimError, HarvesterFmu};
use crate::ngspice::{CapacitanceTable, NgspiceError};
use crate::progress::Progress;
use crate::scenario::{Scenario, Setting};

/// What reads the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Subcircuits for ngspice, with a table beside them
    Ngspice,
    /// Subcircuits for `LTspice`
    Ltspice,
    /// Subcircuits for QSPICE, and for any SPICE with B, F and PWL sources
    Qspice,
    /// Subcircuits for `KiCad`, whose simulator is ngspice
    Kicad,
    /// Table as text
    Csv,
    /// Table for pandas, Polars, Arrow
    Parquet,
    /// Table for MATLAB, Octave, scipy (level 5)
    Mat,
}

impl Format {
    /// Whether it is a netlist with the two membranes.
    pub fn is_netlist(self) -> bool {
        matches!(self, Self::Ngspice | Self::Ltspice | Self::Qspice | Self::Kicad)
    }

    /// Ending of the file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Ngspice | Self::Ltspice | Self::Qspice | Self::Kicad => "lib",
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Mat => "mat",
        }
    }
}

/// The points of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// As few as straight lines between them need for this error, relative to the height of the largest pulse so far.
    Knots(f64),
    /// One each so many seconds, and the end.
    Sample(f64),
}

/// What to export.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// The FMU `VibroImpactHarvester`.
    pub harvester: &'a Fmu,
    /// The case with its settings. Those of a circuit are left out.
    pub scenario: &'a Scenario,
    /// What reads the file.
    pub format: Format,
    /// The points of the table.
    pub points: Points,
    /// Variables of the harvester that a table has after the time; none: both capacitances.
    pub columns: &'a [String],
    /// Where it goes.
    pub path: &'a Path,
}

/// What was exported. Field names are the keys of `--json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Exported {
    /// What reads it.
    pub format: Format,
    /// The files.
    pub files: Vec<PathBuf>,
    /// The points of the table.
    pub points: Points,
    /// How many there are.
    pub rows: usize,
    /// Columns of the table after the time.
    pub columns: Vec<String>,
    /// End of the run, s.
    pub until: f64,
    /// Capacitance of a flat membrane, F.
    pub rest_capacitance: f64,
    /// Capacitances (left, right) at 0 s, F.
    pub initial_capacitance: [f64; 2],
    /// What to know of it.
    pub warnings: Vec<String>,
}

/// Why nothing was exported.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ExportError {
    #[error(transparent)]
    Run(#[from] CosimError),
    #[error(transparent)]
    Table(#[from] NgspiceError),
    #[error("--columns: a netlist has the capacitances only; allowed with csv, parquet and mat")]
    Columns,
    #[error("--columns {name}: {reason}")]
    Column { name: String, reason: String },
    #[error("--sample {sample} s: must lie from {least} s to {until} s, the end of the run")]
    Sample { sample: f64, least: f64, until: f64 },
    #[error(
        "{values} values: a table has {most} at most; a larger --sample or --knots, fewer columns or a smaller --until makes it smaller"
    )]
    Values { values: f64, most: usize },
    #[error("the run was stopped at {time} s")]
    Stopped { time: f64 },
    #[error("cannot write {}: {cause}", path.display())]
    Write { path: PathBuf, cause: std::io::Error },
}

/// A table with what it says of itself.
struct Table {
    /// Lines of the header, without comment signs.
    header: Vec<String>,
    /// The column of times first.
    columns: Vec<Column>,
    rest: f64,
}

struct Column {
    name: String,
    unit: String,
    values: Vec<f64>,
}

impl Table {
    fn rows(&self) -> usize {
        self.columns.first().map_or(0, |time| time.values.len())
    }

    /// Names of the columns with their units.
    fn units(&self) -> String {
        let units: Vec<_> = self.columns.iter().map(|column| format!("{} [{}]", column.name, column.unit)).collect();
        units.join(", ")
    }
}

/// Writes the file at `path`.
fn fill(path: &Path, write: impl FnOnce(&mut BufWriter<&mut AtomicFile>) -> io::Result<()>) -> Result<(), ExportError> {
    let filled = atomic_file::fill(path, |file| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        out.flush()
    });
    filled.map_err(|cause| ExportError::Write { path: path.to_owned(), cause })
}

/// Most values of a table: 160 MB.
const MOST_VALUES: usize = 20_000_000;
/// The columns of a table without others.
const CAPACITANCES: [&str; 2] = ["left.capacitance", "right.capacitance"];

/// Runs the harvester and writes the file.
///
/// # Errors
/// A setting or column that the harvester does not have; points out of bounds; a file that cannot be written.
pub fn run(options: &Options<'_>, progress: &dyn Progress) -> Result<Exported, ExportError> {
    let &Options { harvester: fmu, scenario, format, points, columns, path } = options;
    if format.is_netlist() && !columns.is_empty() {
        return Err(ExportError::Columns);
    }
    let (mechanical, circuit) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
    let warnings = circuit.names().map(|names| format!("{names} left out: export runs no circuit"));
    let names: Vec<_> = if columns.is_empty() { CAPACITANCES.map(str::to_owned).to_vec() } else { columns.to_vec() };
    let units = names.iter().map(|name| unit(fmu, name)).collect::<Result<Vec<_>, _>>()?;
    let times = times(options, &mechanical, names.len(), progress)?;
    let mut harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
    let initial = harvester.sample()?.capacitance();
    let mut rest = [0.0];
    harvester.read(&harvester.references(&["membrane.restCapacitance".to_owned()])?, &mut rest)?;
    let [rest] = rest;
    let mut values = vec![Vec::with_capacity(times.len()); names.len()];
    let references = harvester.references(&names)?;
    let (mut last, mut row) = (0.0, vec![0.0; names.len()]);
    for (index, &time) in times.iter().enumerate() {
        if time > last {
            harvester.step(last, time - last)?;
            last = time;
        }
        harvester.read(&references, &mut row)?;
        values.iter_mut().zip(&row).for_each(|(column, &value)| column.push(value));
        progress.advance(times.len() as u64 + index as u64 + 1, 2 * times.len() as u64, &[]);
        if progress.is_stopped() {
            return Err(ExportError::Stopped { time });
        }
    }
    let time = Column { name: "time".to_owned(), unit: "s".to_owned(), values: times };
    let columns = names.iter().zip(units).zip(values);
    let columns = columns.map(|((name, unit), values)| Column { name: name.clone(), unit, values });
    let table = Table {
        header: header(scenario, &mechanical, points, rest, initial),
        columns: std::iter::once(time).chain(columns).collect(),
        rest,
    };
    let mut files = vec![path.to_owned()];
    match format {
        Format::Csv => fill(path, |out| data::csv(out, &table)),
        Format::Parquet => fill(path, |out| data::parquet(out, &table).map_err(io::Error::other)),
        Format::Mat => fill(path, |out| mat::write(out, &table)),
        Format::Ngspice | Format::Ltspice | Format::Qspice | Format::Kicad => {
            spice::write(path, format, &table).map(|beside| files.extend(beside))
        }
    }?;
    let (rows, until) = (table.rows(), scenario.until);
    let warnings = warnings.into_iter().chain(harvester.warnings()).collect();
    let (rest_capacitance, initial_capacitance) = (rest, initial);
    Ok(Exported { format, files, points, rows, columns: names, until, rest_capacitance, initial_capacitance, warnings })
}

/// The times of the points, s: 0 first, the end last.
fn times(
    options: &Options<'_>,
    mechanical: &[Setting],
    columns: usize,
    progress: &dyn Progress,
) -> Result<Vec<f64>, ExportError> {
    /// Shortest distance of samples, s.
    const LEAST: f64 = 1e-7;
    let &Options { harvester: fmu, scenario, points, .. } = options;
    let until = scenario.until;
    let check = |rows: f64| {
        let values = rows * (1 + columns) as f64;
        if values > MOST_VALUES as f64 { Err(ExportError::Values { values, most: MOST_VALUES }) } else { Ok(()) }
    };
    match points {
        Points::Knots(error) => {
            let mut harvester = HarvesterFmu::new(fmu, scenario, mechanical)?;
            let table = CapacitanceTable::from_harvester(&mut harvester, until, error)?;
            check(table.len() as f64)?;
            progress.advance(1, 2, &[]);
            Ok(table.times().to_vec())
        }
        Points::Sample(sample) => {
            if !(LEAST..=until).contains(&sample) {
                return Err(ExportError::Sample { sample, least: LEAST, until });
            }
            let steps = (until / sample - 1e-9).ceil();
            check(steps + 1.0)?;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // bounded by MOST_VALUES
            let steps = steps as u32;
            Ok((0..steps).map(|k| f64::from(k) * sample).chain([until]).collect())
        }
    }
}

/// The unit of a Real variable.
fn unit(fmu: &Fmu, name: &str) -> Result<String, ExportError> {
    let fail = |reason: String| ExportError::Column { name: name.to_owned(), reason };
    let variables = &fmu.description().variables;
    let Some(variable) = variables.iter().find(|variable| variable.name == name) else {
        let nearest = nearest_name(name, variables.iter().map(|variable| variable.name.as_str()));
        let hint = nearest.map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"));
        return Err(fail(format!("the harvester has no such variable{hint}")));
    };
    match &variable.kind {
        Kind::Real { unit, .. } => Ok(unit.as_deref().unwrap_or("1").to_owned()),
        _ => Err(fail("is no Real variable".to_owned())),
    }
}

/// What the file says of itself.
fn header(
    scenario: &Scenario,
    settings: &[Setting],
    points: Points,
    rest: f64,
    [left, right]: [f64; 2],
) -> Vec<String> {
    let points = match points {
        Points::Knots(error) => {
            format!("fewest points, straight lines between them, error {error} of the largest pulse")
        }
        Points::Sample(sample) => format!("a point each {sample} s"),
    };
    let settings = settings.iter().map(|setting| format!("setting {} = {}", setting.name, setting.value));
    let mut lines = vec![
        format!("C(t) of videg {}, case {}: {}", env!("CARGO_PKG_VERSION"), scenario.name, scenario.description),
        format!("0 to {} s; {points}; SI units", scenario.until),
        format!("membrane at rest {rest:e} F; at 0 s left {left:e} F, right {right:e} F"),
    ];
    lines.extend(settings);
    // A case file may say anything.
    lines.iter().map(|line| line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()).collect()
}
