//! Variables of the harvester at chosen times of a run.

use std::iter;

use fmu_import::{Fmu, Kind, Value, Variable, nearest_name};
use serde::Serialize;
use thiserror::Error;

use crate::cosim::{Averages, CircuitRequest, CosimError, Gains, HarvesterFmu, TimeProgress};
use crate::ngspice::{CapacitanceTable, NgspiceError};
use crate::progress::Progress;
use crate::scenario::{Scenario, Setting};

/// The points of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// As few as straight lines between them need for this error, relative to the height of the largest pulse so far.
    Knots(f64),
    /// One each so many seconds, and the end.
    Sample(f64),
}

/// What a table is made of.
#[derive(Clone, Copy)]
pub struct TableOptions<'a> {
    /// The FMU `VibroImpactHarvester`.
    pub harvester: &'a Fmu,
    /// The case with its settings. Those of a circuit are left out.
    pub scenario: &'a Scenario,
    /// The points.
    pub points: Points,
    /// Variables after the time: numbers or truth values, which are 0 and 1.
    pub columns: &'a [String],
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name of the variable.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its values at the times of the table.
    pub values: Vec<f64>,
}

/// A run as a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The time, s, first.
    pub columns: Vec<Column>,
    /// Capacitance of a flat membrane, F.
    pub rest_capacitance: f64,
    /// Capacitances (left, right) at 0 s, F.
    pub initial_capacitance: [f64; 2],
    /// Over the averaging window.
    pub averages: Averages,
    /// Impacts of the run.
    pub impacts: i32,
    /// Warnings of the FMU, and settings left out.
    pub warnings: Vec<String>,
}

impl Table {
    /// Most values: 160 MB.
    const MOST_VALUES: usize = 20_000_000;

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |time| time.values.len())
    }
}

/// Why there is no table.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum TableError {
    #[error(transparent)]
    Run(#[from] CosimError),
    #[error(transparent)]
    Knots(#[from] NgspiceError),
    #[error("--columns {name}: {reason}")]
    Column { name: String, reason: String },
    #[error("--sample {sample} s: must lie from {least} s to {until} s, the end of the run")]
    Sample { sample: f64, least: f64, until: f64 },
    #[error(
        "{values} values: a table has {most} at most; a larger --sample or --knots, fewer columns or a smaller --until makes it smaller"
    )]
    Values { values: f64, most: usize },
}

/// Longest step in one piece, s.
const PIECE: f64 = 1000.0;

/// Reads the variables of a row.
struct Reader {
    /// Each variable: a place among the Real ones, or the name of another.
    variables: Vec<Result<usize, String>>,
    references: Vec<u32>,
    reals: Vec<f64>,
}

/// Runs the harvester and reads the variables.
///
/// # Errors
/// A setting or column that the harvester does not have; points out of bounds; errors of the FMU.
pub fn table(options: &TableOptions<'_>, progress: &dyn Progress) -> Result<Table, TableError> {
    let &TableOptions { harvester: fmu, scenario, columns: names, .. } = options;
    let (mechanical, circuit) = CircuitRequest::split(fmu.description(), &scenario.settings)?;
    let left_out = circuit.names().map(|names| format!("{names} left out: there is no circuit in this run"));
    let (mut reader, units) = Reader::of(fmu, names)?;
    let times = times(options, &mechanical, progress)?;
    let mut harvester = HarvesterFmu::new(fmu, scenario, &mechanical)?;
    let initial_capacitance = harvester.sample()?.capacitance();
    let mut rest = [0.0];
    harvester.read(&harvester.references(&["membrane.restCapacitance".to_owned()])?, &mut rest)?;
    let mut values = vec![Vec::with_capacity(times.len()); names.len()];
    let (mut now, mut gains, mut reached) = (0.0, [None; 2], TimeProgress::new(progress, scenario.until));
    for &time in &times {
        // Averages are those of the window only if its edges are met.
        let edges = scenario.window.into_iter().filter(|&edge| edge > now && edge < time).collect::<Vec<_>>();
        for stop in edges.into_iter().chain(iter::once(time)) {
            // A step has a largest length, and somebody may want to stop the run; its results do not depend on the steps.
            while now < stop {
                let next = if now + 1.5 * PIECE < stop { now + PIECE } else { stop };
                harvester.step(now, next - now)?;
                now = next;
                reached.tell(now)?;
            }
            for (gain, edge) in gains.iter_mut().zip(scenario.window) {
                if gain.is_none() && now >= edge {
                    *gain = Some(sums(&harvester)?);
                }
            }
        }
        reader.read(&harvester, &mut values)?;
    }
    let [before, after] = gains.map(Option::unwrap_or_default);
    let time = Column { name: "time".to_owned(), unit: "s".to_owned(), values: times };
    let columns = names.iter().zip(units).zip(values);
    let columns = columns.map(|((name, unit), values)| Column { name: name.clone(), unit, values });
    Ok(Table {
        columns: iter::once(time).chain(columns).collect(),
        rest_capacitance: rest[0],
        initial_capacitance,
        averages: Averages::over(scenario.window, &before, &after),
        impacts: harvester.counts()?[0],
        warnings: left_out.into_iter().chain(harvester.warnings()).collect(),
    })
}

fn sums(harvester: &HarvesterFmu) -> Result<Gains, CosimError> {
    let sample = harvester.sample()?;
    Ok(Gains { voltage: sample.voltage_gain(), energy: sample.energy_eq13(), impacts: harvester.counts()?[0] })
}

impl Reader {
    /// A reader of the variables called `names`, and their units.
    fn of(fmu: &Fmu, names: &[String]) -> Result<(Self, Vec<String>), TableError> {
        let mut reader = Self { variables: Vec::new(), references: Vec::new(), reals: Vec::new() };
        let mut units = Vec::new();
        for name in names {
            let variable = find(fmu, name)?;
            if let Kind::Real { unit, .. } = &variable.kind {
                reader.variables.push(Ok(reader.references.len()));
                reader.references.push(variable.value_reference);
                units.push(unit.as_deref().unwrap_or("1").to_owned());
            } else {
                reader.variables.push(Err(name.clone()));
                units.push("1".to_owned());
            }
        }
        reader.reals = vec![0.0; reader.references.len()];
        Ok((reader, units))
    }

    /// Adds the present values to `columns`.
    fn read(&mut self, harvester: &HarvesterFmu, columns: &mut [Vec<f64>]) -> Result<(), CosimError> {
        harvester.read(&self.references, &mut self.reals)?;
        for (variable, column) in self.variables.iter().zip(columns) {
            column.push(match variable {
                Ok(index) => self.reals[*index],
                Err(name) => match harvester.value(name)? {
                    Value::Real(value) => value,
                    Value::Integer(value) | Value::Enumeration { value, .. } => value.into(),
                    Value::Boolean(on) => f64::from(u8::from(on)),
                    Value::String(_) => f64::NAN,
                },
            });
        }
        Ok(())
    }
}

/// The times of the points, s: 0 first, the end last.
fn times(options: &TableOptions<'_>, mechanical: &[Setting], progress: &dyn Progress) -> Result<Vec<f64>, TableError> {
    /// Shortest distance of samples, s.
    const LEAST: f64 = 1e-7;
    let &TableOptions { harvester: fmu, scenario, points, columns } = options;
    let until = scenario.until;
    let check = |rows: f64| {
        let (values, most) = (rows * (1 + columns.len()) as f64, Table::MOST_VALUES);
        if values > most as f64 { Err(TableError::Values { values, most }) } else { Ok(()) }
    };
    match points {
        Points::Knots(error) => {
            let mut harvester = HarvesterFmu::new(fmu, scenario, mechanical)?;
            let table = CapacitanceTable::from_harvester(&mut harvester, until, error, progress)?;
            check(table.len() as f64)?;
            Ok(table.times().to_vec())
        }
        Points::Sample(sample) => {
            if !(LEAST..=until).contains(&sample) {
                return Err(TableError::Sample { sample, least: LEAST, until });
            }
            let steps = (until / sample - 1e-9).ceil();
            check(steps + 1.0)?;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // bounded by MOST_VALUES
            let steps = steps as u32;
            Ok((0..steps).map(|k| f64::from(k) * sample).chain([until]).collect())
        }
    }
}

/// The variable called `name`, which must be a number.
fn find<'a>(fmu: &'a Fmu, name: &str) -> Result<&'a Variable, TableError> {
    let fail = |reason: String| TableError::Column { name: name.to_owned(), reason };
    let variables = &fmu.description().variables;
    let Some(variable) = variables.iter().find(|variable| variable.name == name) else {
        let nearest = nearest_name(name, variables.iter().map(|variable| variable.name.as_str()));
        let hint = nearest.map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"));
        return Err(fail(format!("the harvester has no such variable{hint}")));
    };
    match variable.kind {
        Kind::String { .. } => Err(fail("is a text, not a number".to_owned())),
        _ => Ok(variable),
    }
}
