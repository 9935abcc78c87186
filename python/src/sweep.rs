//! `sweep`: many runs on all cores, into a folder.

use std::path::PathBuf;

use fmu_import::{Kind, ModelDescription};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use videg::cli::{SweepCommon, SweepOptions, Window};
use videg::scenario::CaseFile;
use videg::sweep::{Design, Engine, Numbers, Options, Report, Sampling, Sweep, SweepFile, system_description};

use crate::error::error;
use crate::scenario::item;
use crate::{background, fmus};

/// What is varied and how, as options of `videg sweep` are called and typed.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Asked {
    case: Option<String>,
    case_file: Option<PathBuf>,
    settings: Vec<String>,
    until: Option<f64>,
    step: Option<f64>,
    window: Option<[f64; 2]>,
    vary: Vec<String>,
    record: Vec<String>,
    design: Option<String>,
    points: Option<u64>,
    samples: Option<u64>,
    confidence: Option<f64>,
    until_precision: Option<f64>,
    precision_of: Option<String>,
    seed: Option<u64>,
    common_seeds: bool,
}

/// What a sweep has done.
#[derive(Serialize)]
struct Finished {
    runs: u64,
    done: u64,
    failed: u64,
    resumed_from: u64,
    files: Vec<PathBuf>,
}

impl Asked {
    fn options(self) -> PyResult<(SweepOptions, SweepFile)> {
        let design: Option<Design> = self.design.as_deref().map(|design| item("design", design)).transpose()?;
        let sampling = Sampling {
            design,
            points: self.points,
            samples: self.samples,
            confidence: self.confidence,
            until_precision: self.until_precision,
            precision_of: self.precision_of,
            seed: self.seed,
            common_seeds: self.common_seeds,
            seed_variable: None,
        };
        let case = self.case_file.as_deref().map(CaseFile::read).transpose().map_err(error)?.unwrap_or_default();
        let common = SweepCommon {
            case: self.case,
            settings: self.settings,
            until: self.until,
            window: self.window.map(Window),
        };
        let options =
            SweepOptions { files: Vec::new(), common, vary: self.vary, sampling, step: self.step, record: self.record };
        Ok((options, SweepFile { case, ..SweepFile::default() }))
    }
}

/// Runs the sweep into `folder`, going on where results in it end; what it has done, as JSON.
#[pyfunction]
pub fn sweep(
    py: Python<'_>,
    fmu: PathBuf,
    asked: Asked,
    folder: PathBuf,
    jobs: Option<usize>,
    fresh: bool,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let (options, file) = asked.options()?;
    let report = background::run(py, progress.as_ref(), |progress| {
        let run = || -> Result<Report, Box<dyn std::error::Error>> {
            let description = system_description()?;
            let sweep = Sweep::new(&options.request(file, &description, None, None)?)?;
            let open = || Ok::<_, Box<dyn std::error::Error>>(fmus::open(&fmu)?);
            let engine = Engine::of_harvester(&sweep, false, open)?;
            std::fs::create_dir_all(&folder)?;
            let options = Options::new(&sweep, &engine, &folder);
            let options = Options { jobs: jobs.unwrap_or(options.jobs), fresh, ..options };
            Ok(videg::sweep::run(&options, progress)?)
        };
        run().map_err(|error| format!("{error:#}"))
    })?;
    let Report { runs, done, failed, resumed_from, files, .. } = report;
    serde_json::to_string(&Finished { runs, done, failed, resumed_from, files }).map_err(error)
}

/// Points, samples at each, and columns of numbers.
type Evaluated<'py> = (Bound<'py, PyDict>, Vec<(usize, String)>);

/// The variable at its start value, as one that is varied: each point is checked by itself.
fn at_start(description: &ModelDescription, name: &str) -> Result<String, Box<dyn std::error::Error>> {
    match &description.variable(name)?.kind {
        Kind::Real { start, .. } => Ok(format!("{name}={:?}", start.unwrap_or(1.0))),
        other => {
            Err(format!("points: {name}: is of type {}; points are values of Real variables", other.name()).into())
        }
    }
}

/// Runs all samples at each of `points`, rows of values of what is varied: columns of numbers by name, NaN where a run failed, and the
/// failed runs with their reasons.
#[pyfunction]
pub fn evaluate<'py>(
    py: Python<'py>,
    fmu: PathBuf,
    asked: Asked,
    names: Vec<String>,
    points: Vec<Vec<f64>>,
    jobs: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Evaluated<'py>> {
    let (mut options, file) = asked.options()?;
    let (names, results) = background::run(py, progress.as_ref(), |progress| {
        let run = || -> Result<_, Box<dyn std::error::Error>> {
            let description = system_description()?;
            options.vary = names.iter().map(|name| at_start(&description, name)).collect::<Result<_, _>>()?;
            let sweep = Sweep::new(&options.request(file, &description, None, None)?)?;
            let open = || Ok::<_, Box<dyn std::error::Error>>(fmus::open(&fmu)?);
            let engine = Engine::of_harvester(&sweep, false, open)?;
            let jobs = jobs.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
            let names: Vec<String> = sweep.numbers().into_iter().map(str::to_owned).collect();
            Ok((names, sweep.evaluate(&engine, &points, jobs, progress)?))
        };
        run().map_err(|error| format!("{error:#}"))
    })?;
    let columns = PyDict::new(py);
    for (index, name) in names.iter().enumerate() {
        let value = |numbers: &Numbers| numbers.as_ref().map_or(f64::NAN, |numbers| numbers[index]);
        columns.set_item(name, PyArray1::from_vec(py, results.iter().map(value).collect()))?;
    }
    let failed = results.into_iter().enumerate().filter_map(|(index, it)| Some((index, it.err()?)));
    Ok((columns, failed.collect()))
}
