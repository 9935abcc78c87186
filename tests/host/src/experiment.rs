//! Reference results of an experiment, as importers get them that set inputs at each communication point and hold them.

use crate::slave::{get, set};
use core::fmt::Write as _;
use fmu_export::{Experiment, Kind, Logger, Slave};

/// Inputs against time: a table as the rules of the FMI cross-check have it, linear between its rows.
pub struct Inputs {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Inputs {
    /// No inputs.
    pub const NONE: Self = Self { names: Vec::new(), rows: Vec::new() };

    /// Reads a table: names in double quotes, time first, then numbers.
    ///
    /// # Errors
    /// What is no number.
    pub fn read(text: &str) -> Result<Self, core::num::ParseFloatError> {
        let mut lines = text.lines();
        let names = lines.next().unwrap_or_default().split(',').skip(1).map(|name| name.trim_matches('"').to_owned());
        let rows = lines.map(|line| line.split(',').map(str::parse).collect()).collect::<Result<_, _>>()?;
        Ok(Self { names: names.collect(), rows })
    }

    /// Names and values at a time, s.
    fn at(&self, time: f64) -> impl Iterator<Item = (&str, f64)> {
        let after = self.rows.iter().position(|row| row[0] > time).unwrap_or(self.rows.len());
        let value = move |column: usize| match (after.checked_sub(1).map(|k| &self.rows[k]), self.rows.get(after)) {
            (Some(from), Some(to)) => from[column] + (to[column] - from[column]) * (time - from[0]) / (to[0] - from[0]),
            (Some(row), None) | (None, Some(row)) => row[column],
            (None, None) => f64::NAN,
        };
        self.names.iter().zip(1..).map(move |(name, column)| (name.as_str(), value(column)))
    }
}

fn set_inputs<S: Slave>(slave: &mut S, inputs: &Inputs, time: f64) {
    for (name, value) in inputs.at(time) {
        set(slave, name, value);
    }
}

/// The table of `outputs` at the start and after each of so many `steps` of `size`, s, with nine digits.
///
/// # Errors
/// What the slave says.
pub fn reference<S: Slave>(
    inputs: &Inputs,
    outputs: &[&str],
    (steps, size): (u32, f64),
) -> Result<String, fmu_export::SlaveError> {
    let (mut slave, log) = (S::new(), Logger::silent());
    for row in S::variables() {
        if let Kind::Real(fmu_export::RealSpec { start: Some(start), set: Some(set), .. }) = row.kind() {
            set.set(&mut slave, *start);
        }
    }
    slave.setup_experiment(&Experiment { start_time: 0.0, stop_time: None, tolerance: None }, &log)?;
    set_inputs(&mut slave, inputs, 0.0);
    slave.update();
    slave.initialize(&log)?;
    let mut text = outputs.iter().fold("\"time\"".to_owned(), |line, name| line + ",\"" + name + "\"");
    for step in 0..=steps {
        let time = f64::from(step) * size;
        let values = outputs.iter().map(|name| get(&slave, name));
        let cells: Vec<_> = core::iter::once(time).chain(values).map(rounded).collect();
        let _ = write!(text, "\n{}", cells.join(","));
        if step < steps {
            set_inputs(&mut slave, inputs, time);
            slave.do_step(time, size, &log)?;
        }
    }
    Ok(text + "\n")
}

/// A number with nine digits, as C reads it.
fn rounded(value: f64) -> String {
    let digits = format!("{value:.8e}");
    digits.parse::<f64>().map_or(digits, |value| format!("{value:?}"))
}
