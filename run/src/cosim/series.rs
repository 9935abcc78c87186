//! The time series of a run as a file, written as the run goes on, so that memory does not grow with it.

use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use fmu_import::nearest_name;

use super::{CircuitSample, CosimError, HarvesterSample, Observer, RealColumns, Row};
use crate::scenario::Scenario;
use videg_system::atomic_file::{AtomicFile, partial};

/// A point of the grid is a product, and may lie this part of the distance before its time.
const HAIR: f64 = 1e-9;

/// Kind of file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum SeriesFormat {
    /// Table as text
    #[default]
    Csv,
    /// Table for pandas, Polars, Arrow
    Parquet,
    /// No time series
    None,
}

/// Which points of a run are rows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Sample {
    /// Some 10,000, and the impacts and peaks of C(t); of a run with no more communication points than that, all.
    #[default]
    Overview,
    /// One each so many seconds, and the impacts and peaks of C(t).
    Every(f64),
    /// Each communication point.
    Step,
}

/// What to write.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeriesOptions {
    /// Kind of file.
    pub format: SeriesFormat,
    /// Which points.
    pub sample: Sample,
    /// Columns beside the time; none: all.
    pub columns: Vec<String>,
}

impl SeriesOptions {
    /// Rows of an overview, without those at impacts and peaks.
    const OVERVIEW: f64 = 1e4;

    /// Distance of the rows of a run of `scenario`, s.
    ///
    /// # Errors
    /// A distance out of bounds.
    pub fn spacing(&self, scenario: &Scenario) -> Result<f64, CosimError> {
        let until = scenario.until;
        match self.sample {
            Sample::Step => Ok(0.0),
            Sample::Overview if until / scenario.step <= Self::OVERVIEW * (1.0 + HAIR) => Ok(0.0),
            Sample::Overview => Ok(until / Self::OVERVIEW),
            Sample::Every(sample) if sample > 0.0 && sample <= until => Ok(sample),
            Sample::Every(sample) => Err(CosimError::Sample { sample, until }),
        }
    }

    /// The file in `folder` of the series called `name`, unless none is written.
    pub fn path(&self, folder: &Path, name: &str) -> Option<PathBuf> {
        let ending = match self.format {
            SeriesFormat::Csv => "csv",
            SeriesFormat::Parquet => "parquet",
            SeriesFormat::None => return None,
        };
        Some(folder.join(name).with_extension(ending))
    }
}

/// Chooses the rows.
#[derive(Debug)]
struct Sampler {
    spacing: f64,
    until: f64,
    /// Number of the next row that is due.
    next: f64,
    /// Rows that impacts and peaks may have before that. A ball that comes to rest has endless ones.
    credit: u32,
}

impl Sampler {
    /// Rows for impacts and peaks at first, and for each row that is due.
    const CREDIT: u32 = 300;
    const EACH: u32 = 3;

    fn new(spacing: f64, until: f64) -> Self {
        Self { spacing, until, next: 0.0, credit: Self::CREDIT }
    }

    fn takes(&mut self, time: f64, is_knot: bool) -> bool {
        if self.spacing == 0.0 {
            return true;
        }
        let passed = time / self.spacing + HAIR;
        if passed >= self.next || time >= self.until {
            self.next = passed.floor() + 1.0;
            self.credit += Self::EACH;
            return true;
        }
        let taken = is_knot && self.credit > 0;
        self.credit -= u32::from(taken);
        taken
    }
}

enum Writer {
    Csv(Box<csv::Writer<BufWriter<AtomicFile>>>),
    Parquet(Box<RealColumns<AtomicFile>>),
    Memory(SeriesColumns),
}

/// A time series in memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeriesColumns {
    /// Names of the columns, the time first.
    pub names: Vec<String>,
    /// Their values.
    pub values: Vec<Vec<f64>>,
}

impl SeriesColumns {
    /// Most values: 160 MB.
    const MOST: usize = 20_000_000;

    fn of(names: &[&str]) -> Self {
        Self { names: names.iter().map(|&name| name.to_owned()).collect(), values: vec![Vec::new(); names.len()] }
    }

    fn push(&mut self, row: impl Iterator<Item = f64>) -> io::Result<()> {
        let rows = self.values.first().map_or(0, Vec::len);
        if rows * self.values.len() >= Self::MOST {
            let most = Self::MOST;
            return Err(io::Error::other(format!(
                "more than {most} values; a larger --sample, fewer columns or a smaller --until makes it smaller"
            )));
        }
        self.values.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        Ok(())
    }
}

/// Writes the rows of a run. Columns are called as the FMU variables are, units are SI. The file gets its name when it is complete; a
/// run that ends early leaves it under another one ([`videg_system::atomic_file::partial`]).
pub struct SeriesRecorder {
    path: PathBuf,
    /// None writes nothing.
    writer: Option<Writer>,
    sampler: Sampler,
    circuit: bool,
    /// Places of the columns among all values, if not all are written.
    chosen: Option<Vec<usize>>,
    values: Vec<f64>,
}

impl SeriesRecorder {
    /// Begins the file called `name` in `folder` of a run of `scenario`; with a `circuit`, the columns of the first circuit are in
    /// it, too, and the waveforms called so.
    ///
    /// # Errors
    /// A column that there is not; a distance of rows out of bounds; a file that cannot be written.
    pub fn create(
        (folder, name): (&Path, &str),
        options: &SeriesOptions,
        scenario: &Scenario,
        circuit: Option<&[String]>,
    ) -> Result<Self, CosimError> {
        let path = options.path(folder, name).unwrap_or_default();
        Self::with(options, scenario, circuit, path.clone(), |columns| {
            Self::writer(&path, options.format, columns)
                .map_err(|cause| CosimError::Write { path: path.clone(), cause })
        })
    }

    /// The same in memory, whatever the kind of file; [`SeriesRecorder::into_columns`] hands it on.
    ///
    /// # Errors
    /// A column that there is not; a distance of rows out of bounds.
    pub fn in_memory(
        options: &SeriesOptions,
        scenario: &Scenario,
        circuit: Option<&[String]>,
    ) -> Result<Self, CosimError> {
        let begin = |columns: &[&str]| Ok(Some(Writer::Memory(SeriesColumns::of(columns))));
        Self::with(options, scenario, circuit, PathBuf::from("the time series in memory"), begin)
    }

    fn with(
        options: &SeriesOptions,
        scenario: &Scenario,
        circuit: Option<&[String]>,
        path: PathBuf,
        begin: impl FnOnce(&[&str]) -> Result<Option<Writer>, CosimError>,
    ) -> Result<Self, CosimError> {
        let all = names(circuit);
        let chosen = if options.columns.is_empty() { None } else { Some(places(&all, &options.columns)?) };
        let written: Vec<&str> = chosen.as_ref().map_or(all.clone(), |places| places.iter().map(|&k| all[k]).collect());
        let sampler = Sampler::new(options.spacing(scenario)?, scenario.until);
        let writer = begin(&written)?;
        Ok(Self { path, writer, sampler, circuit: circuit.is_some(), chosen, values: Vec::new() })
    }

    /// The time series in memory, if it is there.
    pub fn into_columns(self) -> SeriesColumns {
        if let Some(Writer::Memory(columns)) = self.writer { columns } else { SeriesColumns::default() }
    }

    fn writer(path: &Path, format: SeriesFormat, columns: &[&str]) -> io::Result<Option<Writer>> {
        Ok(match format {
            SeriesFormat::None => None,
            SeriesFormat::Csv => {
                let mut writer = csv::Writer::from_writer(BufWriter::new(AtomicFile::create(path)?));
                writer.write_record(columns)?;
                Some(Writer::Csv(Box::new(writer)))
            }
            SeriesFormat::Parquet => {
                let columns = RealColumns::new(AtomicFile::create(path)?, "timeseries", columns, &[]);
                Some(Writer::Parquet(Box::new(columns.map_err(io::Error::other)?)))
            }
        })
    }

    /// Writes the rest, and gives the file its name. Returns the path, if there is a file.
    ///
    /// # Errors
    /// A refusal of the file system.
    pub fn finish(self) -> Result<Option<PathBuf>, CosimError> {
        let Self { path, writer, .. } = self;
        let file = match writer {
            None | Some(Writer::Memory(_)) => return Ok(None),
            Some(Writer::Csv(writer)) => {
                let written = writer.into_inner().map_err(csv::IntoInnerError::into_error);
                written.and_then(|buffer| buffer.into_inner().map_err(io::IntoInnerError::into_error))
            }
            Some(Writer::Parquet(columns)) => columns.finish().map_err(io::Error::other),
        };
        // A file that could not be written does not stay.
        let finished = file.and_then(AtomicFile::finish).inspect_err(|_| drop(std::fs::remove_file(partial(&path))));
        finished.map_err(|cause| CosimError::Write { path: path.clone(), cause })?;
        Ok(Some(path))
    }

    /// Writes the rest of a run that ended early, under the other name. Returns it, if there is a file.
    ///
    /// # Errors
    /// A refusal of the file system.
    pub fn leave(self) -> Result<Option<PathBuf>, CosimError> {
        let Self { path, writer, .. } = self;
        let left = match writer {
            None | Some(Writer::Memory(_)) => return Ok(None),
            Some(Writer::Csv(mut writer)) => writer.flush(),
            Some(Writer::Parquet(columns)) => columns.finish().map(|_| ()).map_err(io::Error::other),
        };
        left.map_err(|cause| CosimError::Write { path: path.clone(), cause })?;
        Ok(Some(partial(&path)))
    }

    /// Removes the file of a run that ended early.
    pub fn discard(self) {
        if matches!(self.writer, Some(Writer::Csv(_) | Writer::Parquet(_))) {
            // The user is told why the run ended.
            let _ = std::fs::remove_file(partial(&self.path));
        }
    }

    fn write(&mut self) -> io::Result<()> {
        let values = &self.values;
        let row: &mut dyn Iterator<Item = f64> = match &self.chosen {
            None => &mut values.iter().copied(),
            Some(places) => &mut places.iter().map(|&k| values[k]),
        };
        match &mut self.writer {
            None => Ok(()),
            Some(Writer::Csv(writer)) => {
                let row: Vec<f64> = row.collect();
                writer.serialize(row).map_err(Into::into)
            }
            Some(Writer::Parquet(columns)) => columns.push(row).map_err(io::Error::other),
            Some(Writer::Memory(columns)) => columns.push(row),
        }
    }
}

impl Observer for SeriesRecorder {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        if self.writer.is_none() || !self.sampler.takes(row.time, row.is_knot) {
            return Ok(());
        }
        self.values.clear();
        self.values.push(row.time);
        self.values.extend_from_slice(row.harvester.columns());
        if self.circuit
            && let Some(circuit) = row.circuits.first()
        {
            self.values.extend_from_slice(&circuit.columns());
            self.values.extend_from_slice(row.probes);
        }
        self.write().map_err(|cause| CosimError::Write { path: self.path.clone(), cause })
    }
}

/// Names of all columns, the time first.
fn names(circuit: Option<&[String]>) -> Vec<&str> {
    let circuit = circuit.map(|probes| CircuitSample::NAMES.into_iter().chain(probes.iter().map(String::as_str)));
    ["time"].into_iter().chain(HarvesterSample::names().iter().copied()).chain(circuit.into_iter().flatten()).collect()
}

/// Places of the `columns`, after the time, among `all`.
fn places(all: &[&str], columns: &[String]) -> Result<Vec<usize>, CosimError> {
    let place = |name: &String| {
        all.iter().position(|other| other == name).ok_or_else(|| {
            let nearest = nearest_name(name, all.iter().copied());
            let hint = nearest.map_or_else(String::new, |nearest| format!("did you mean {nearest}? "));
            let reason = format!("no such column; {hint}There are: {}", all[1..].join(", "));
            CosimError::Element { option: "--columns".to_owned(), name: name.clone(), reason }
        })
    };
    let places = columns.iter().filter(|name| *name != "time").map(place);
    let mut found = vec![0];
    for place in places {
        let place = place?;
        if !found.contains(&place) {
            found.push(place);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times that a sampler takes of the multiples of `step`, and of `knots`.
    fn taken(spacing: f64, until: f64, step: f64, knots: &[f64]) -> Vec<f64> {
        let mut points: Vec<(f64, bool)> = knots.iter().map(|&knot| (knot, true)).collect();
        points.extend((0..).map(|k| f64::from(k) * step).take_while(|&time| time <= until).map(|time| (time, false)));
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut sampler = Sampler::new(spacing, until);
        points.into_iter().filter(|&(time, is_knot)| sampler.takes(time, is_knot)).map(|(time, _)| time).collect()
    }

    #[test]
    fn rows_have_their_distance_and_knots_and_the_end_are_among_them() {
        assert_eq!(taken(0.5, 1.25, 0.25, &[0.3, 0.6]), [0.0, 0.3, 0.5, 0.6, 1.0, 1.25]);
        assert_eq!(taken(0.0, 1.0, 0.25, &[0.3]), [0.0, 0.25, 0.3, 0.5, 0.75, 1.0]);
        // Products are a hair beside their sums.
        assert_eq!(taken(0.02, 100.0, 1e-3, &[]).len(), 5001);
    }

    #[test]
    fn endless_knots_make_no_endless_rows() {
        let knots: Vec<f64> = (0..100_000).map(|k| 0.5 + 1e-6 * f64::from(k)).collect();
        let found = taken(0.1, 1.0, 0.1, &knots);
        assert_eq!(found.len(), 11 + 300 + 3 * 6, "{found:?}");
    }

    #[test]
    fn columns_are_found_by_name_and_once() {
        let all = names(Some(&[]));
        assert_eq!((all.len(), names(None).len()), (29, 15));
        let asked = |names: &[&str]| places(&all, &names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!(asked(&["left.voltage", "time", "left.capacitance", "left.voltage"]).unwrap(), [0, 15, 1]);
        let said = asked(&["left.voltag"]).unwrap_err().to_string();
        assert!(said.starts_with("--columns left.voltag: no such column; did you mean left.voltage? There are: left."));
    }
}
