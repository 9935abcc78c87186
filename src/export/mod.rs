//! C(t) of a run for other programs: subcircuits for simulators of circuits, tables for everything else.

mod data;
mod mat;
mod spice;

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use fmu_import::Fmu;
use serde::Serialize;
use thiserror::Error;
use videg_system::atomic_file::{self, AtomicFile};

use crate::cosim::{CircuitRequest, CosimError};
use crate::progress::Progress;
use crate::scenario::{Scenario, Setting};
use crate::simulate::{Column, Points, TableError, TableOptions, table};

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
    Table(#[from] TableError),
    #[error("--columns: a netlist has the capacitances only; allowed with csv, parquet and mat")]
    Columns,
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
    let names: Vec<_> = if columns.is_empty() { CAPACITANCES.map(str::to_owned).to_vec() } else { columns.to_vec() };
    let run = table(&TableOptions { harvester: fmu, scenario, points, columns: &names }, progress)?;
    let (rest_capacitance, initial_capacitance, warnings) =
        (run.rest_capacitance, run.initial_capacitance, run.warnings);
    let (mechanical, _) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
    let header = header(scenario, &mechanical, points, rest_capacitance, initial_capacitance);
    let table = Table { header, columns: run.columns, rest: rest_capacitance };
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
    Ok(Exported { format, files, points, rows, columns: names, until, rest_capacitance, initial_capacitance, warnings })
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
