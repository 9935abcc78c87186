//! The sweep, resolved: everything that decides its results.

use std::collections::HashSet;
use std::path::PathBuf;

use super::axis::Axis;
use super::cases::{Cases, NamedCase};
use super::column::{self, Column, Type};
use super::document::Document;
use super::electrical::is_electrical;
use super::lines::LONGEST;
use super::named_files::NamedFiles;
use super::order::{Order, Rule};
use super::points::{MAX_RUNS, Points};
use super::seeds::{self, Seeds};
use super::setting::{as_setting, last_of_each, not_varied, typed};
use super::times::Times;
use super::{Sampling, Shard, SweepError, Vary};
use crate::cosim::Averages;
use crate::scenario::{Origin, Setting};
use crate::statistics::CONFIDENCE;
use fmu_import::{Bounds, Kind, ModelDescription, Value, ValueError, Variable};

/// Variables from which averages follow, and their types.
pub(super) const GAINS: [&str; 3] = ["gain.voltage", "gain.energyEq13", "impact.count"];

/// A sweep as a user asks for it.
pub struct Request<'a> {
    /// How the sweep is called.
    pub name: String,
    /// The model.
    pub description: &'a ModelDescription,
    /// SHA-256 of the FMU, if the model is not the harvester of this project.
    pub fmu: Option<String>,
    /// Limits of a run, if the FMU is isolated.
    pub isolation: Option<Bounds>,
    /// Variables that are the same in all runs; the last of a name wins.
    pub settings: Vec<Setting>,
    /// Cases to vary over, in the order of the values of the axis `case`; none without it.
    pub cases: Vec<NamedCase>,
    /// Times of a run.
    pub times: Times,
    /// Variables that are not; the last of a name wins.
    pub vary: Vec<Vary>,
    /// Points and samples.
    pub sampling: Sampling,
    /// Variables to record at the end of each run.
    pub record: Vec<String>,
    /// Options that come from a file, with its path.
    pub in_file: Vec<(&'static str, PathBuf)>,
}

impl<'a> Request<'a> {
    /// One run that varies and records nothing.
    pub fn new(name: String, description: &'a ModelDescription, settings: Vec<Setting>, times: Times) -> Self {
        Self {
            name,
            description,
            fmu: None,
            isolation: None,
            settings,
            cases: Vec::new(),
            times,
            vary: Vec::new(),
            sampling: Sampling::default(),
            record: Vec::new(),
            in_file: Vec::new(),
        }
    }

    /// Where `value` of `option` was said, or a value of the variable of that name.
    fn origin(&self, option: &str, value: &str) -> Origin {
        let said = match option {
            "set" => {
                let mut all = self.cases.iter().flat_map(|case| &case.settings).chain(&self.settings);
                all.rfind(|setting| setting.name == value).map(|setting| &setting.origin)
            }
            "vary" => self.vary.iter().rfind(|vary| vary.name == value).map(|vary| &vary.origin),
            _ => {
                let file = self.in_file.iter().find(|(name, _)| *name == option);
                return file.map_or(Origin::Option, |(_, path)| Origin::File(path.clone()));
            }
        };
        said.cloned().unwrap_or(Origin::Option)
    }
}

/// A sweep, checked.
pub struct Sweep {
    name: String,
    /// Variables that are the same in all runs.
    pub(super) settings: Vec<(Variable, Value)>,
    cases: Cases,
    /// Files among the values.
    pub(super) files: NamedFiles,
    /// Times of a run.
    pub(super) times: Times,
    pub(super) points: Points,
    samples: u64,
    pub(super) seeds: Option<Seeds>,
    /// Variables read at the end of each run.
    pub(super) record: Vec<Variable>,
    /// Whether averages are made.
    pub(super) averages: bool,
    columns: Vec<Column>,
    /// When a point has enough samples, if that depends on them.
    rule: Option<Rule>,
    document: String,
}

/// Inputs of one run.
pub(super) struct Run {
    pub number: u64,
    pub point: u64,
    pub sample: u64,
    /// By axis.
    pub values: Vec<Value>,
    pub seed: Option<Value>,
}

/// Results of one run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Results {
    pub averages: Option<Averages>,
    pub recorded: Vec<Value>,
}

impl Sweep {
    /// Resolves a request.
    ///
    /// # Errors
    /// An error in the request that concerns all runs.
    pub fn new(request: &Request<'_>) -> Result<Self, SweepError> {
        Self::resolve(request).map_err(|error| error.said(|option, value| request.origin(option, value)))
    }

    fn resolve(request: &Request<'_>) -> Result<Self, SweepError> {
        let Request { description, ref sampling, .. } = *request;
        let (design, samples, seed) = (sampling.design(), sampling.samples(), sampling.seed());
        let vary = last_of_each(&request.vary, |vary| &vary.name);
        let (cases, shared) = Cases::new(description, &request.cases, &vary)?;
        let settings = not_varied(&[&shared[..], &request.settings].concat(), &vary);
        let settings =
            settings.iter().map(|setting| typed(description, setting)).collect::<Result<Vec<_>, SweepError>>()?;
        let axis = |vary: &Vary| {
            if cases.is_axis(vary) { Ok(cases.axis(seed)) } else { Axis::new(description, vary, design, seed) }
        };
        let axes = vary.iter().map(axis).collect::<Result<Vec<_>, _>>()?;
        let points = Points::new(design, axes, sampling.points)?;
        let set = settings.iter().map(|(variable, value)| (variable.name.as_str(), Some(value)));
        let of_cases = cases.values().map(|(variable, value)| (variable.name.as_str(), Some(value)));
        let given: Vec<_> = set.chain(of_cases).chain(vary.iter().map(|vary| (vary.name.as_str(), None))).collect();
        let seeds = Seeds::new(description, sampling, &given)?;
        let runs = count_runs(&points, samples, seeds.as_ref())?;
        let record = request.record.iter().map(|name| {
            let found = description.variable(name).cloned();
            found.map_err(|error| SweepError::option("record", name, error.to_string()))
        });
        let record = record.collect::<Result<Vec<_>, _>>()?;
        let averages = has_gains(description);
        if record.is_empty() && !averages {
            let reason = format!("{} has no {}, so say what to record", description.model_name, GAINS[0]);
            return Err(SweepError::option("record", "", reason));
        }
        let columns = columns(points.axes(), seeds.as_ref(), averages, &record)?;
        check_lengths(&columns, points.axes())?;
        let precision_of = sampling.precision_of(&columns)?;
        let confidence = sampling.confidence()?;
        let rule = precision_of
            .zip(sampling.until_precision)
            .and_then(|(of, precision)| Rule::new(&columns, of, precision, confidence.unwrap_or(CONFIDENCE), samples));
        let document = Document {
            videg: env!("CARGO_PKG_VERSION"),
            case: &request.name,
            model: &description.model_name,
            guid: &description.guid,
            fmu: request.fmu.as_deref(),
            isolation: request.isolation.map(Into::into),
            settings: settings.iter().map(|(variable, value)| as_setting((variable, value))).collect(),
            cases: cases.documented(),
            times: request.times,
            design,
            vary: &vary,
            points: points.count(),
            samples,
            runs,
            seed,
            common_seeds: sampling.common_seeds,
            seed_variable: seeds.as_ref().map(|seeds| seeds.variable.name.as_str()),
            confidence,
            until_precision: sampling.until_precision,
            precision_of,
            columns: &columns,
            sha256: None,
        };
        let (document, name, times) = (document.sealed(), request.name.clone(), request.times);
        let of_cases = request.cases.iter().flat_map(|case| &case.settings);
        let files = NamedFiles::of(of_cases.chain(&request.settings), &vary)?;
        Ok(Self {
            name,
            settings,
            cases,
            files,
            times,
            points,
            samples,
            seeds,
            record,
            averages,
            columns,
            rule,
            document,
        })
    }

    /// How it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether runs need a circuit: a variable of it, or a power, is set, varied or recorded.
    pub fn is_coupled(&self) -> bool {
        self.variables().chain(&self.record).any(is_electrical)
    }

    /// Averaging window, s.
    pub fn window(&self) -> [f64; 2] {
        self.times.window
    }

    /// Number of points.
    pub fn points(&self) -> u64 {
        self.points.count()
    }

    /// Runs of each point, at most.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Whether the number of samples of a point depends on them.
    pub fn is_adaptive(&self) -> bool {
        self.rule.is_some()
    }

    /// The runs of `shard`, or of the whole.
    pub(super) fn order(&self, shard: Option<Shard>) -> Order {
        Order::new(self.points(), self.samples, self.rule.clone(), shard)
    }

    /// Number of runs, at most.
    pub fn runs(&self) -> u64 {
        self.points.count() * self.samples
    }

    /// The document `sweep.json`.
    pub fn document(&self) -> &str {
        &self.document
    }

    /// Columns of the results.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Names and values of what run number `number`, below [`Sweep::runs`], is given: the variables that are varied, and
    /// its seed if the samples have one.
    pub fn given(&self, number: u64) -> Vec<(&str, Value)> {
        let Run { values, seed, .. } = self.run(number);
        let varied = self.points.axes().iter().map(|axis| axis.variable.name.as_str()).zip(values);
        let seed = self.seeds.as_ref().map(|seeds| seeds.variable.name.as_str()).zip(seed);
        varied.chain(seed).collect()
    }

    /// Inputs of run number `number`.
    pub(super) fn run(&self, number: u64) -> Run {
        let (point, sample) = (number / self.samples, number % self.samples);
        let seed = self.seeds.as_ref().map(|seeds| Value::Integer(seeds.of(point, sample)));
        Run { number, point, sample, values: self.points.values(point), seed }
    }

    /// The axes but for that of the cases, each with its place.
    fn varied(&self) -> impl Iterator<Item = (usize, &Axis)> {
        self.points.axes().iter().enumerate().filter(|(_, axis)| !self.cases.are_of(axis))
    }

    /// Variables that the runs set.
    pub(super) fn variables(&self) -> impl Iterator<Item = &Variable> {
        let set = self.settings.iter().map(|(variable, _)| variable);
        let of_cases = self.cases.values().map(|(variable, _)| variable);
        let varied = self.varied().map(|(_, axis)| &axis.variable);
        set.chain(of_cases).chain(varied).chain(self.seeds.iter().map(|seeds| &seeds.variable))
    }

    /// Variables and values that the user wrote down one by one.
    pub(super) fn written(&self) -> impl Iterator<Item = (&Variable, &Value)> {
        let set = self.settings.iter().chain(self.cases.values()).map(|(variable, value)| (variable, value));
        set.chain(self.varied().flat_map(|(_, axis)| axis.listed().iter().map(|value| (&axis.variable, value))))
    }

    /// What `run` sets on top of the settings of all runs.
    pub(super) fn assigned<'a>(&'a self, run: &'a Run) -> impl Iterator<Item = (&'a Variable, &'a Value)> {
        let of_case = self.cases.settings(self.points.axes(), &run.values).iter();
        let varied = self.varied().map(|(place, axis)| (&axis.variable, &run.values[place]));
        let seed = self.seeds.iter().map(|seeds| &seeds.variable).zip(&run.seed);
        of_case.map(|(variable, value)| (variable, value)).chain(varied).chain(seed)
    }

    /// The first value of `run` that is out of its bounds.
    pub(super) fn check(&self, run: &Run) -> Result<(), ValueError> {
        self.points.axes().iter().zip(&run.values).try_for_each(|(axis, value)| value.check(&axis.variable))
    }

    /// The line of the results that belongs to `run`; an error is why it failed. A run whose line would be longer than can
    /// be read again has failed.
    pub(super) fn line(&self, run: &Run, outcome: &Result<Results, String>) -> Vec<u8> {
        let line = self.any_line(run, outcome);
        if line.len() <= LONGEST {
            return line;
        }
        let reason = format!("its results take {} bytes, and a line has at most {LONGEST}", line.len());
        self.any_line(run, &Err(reason))
    }

    fn any_line(&self, run: &Run, outcome: &Result<Results, String>) -> Vec<u8> {
        let mut cells: Vec<String> = [run.number, run.point, run.sample].map(|number| number.to_string()).into();
        cells.extend(run.values.iter().map(column::cell));
        cells.extend(run.seed.iter().map(column::cell));
        if let Ok(Results { averages, recorded }) = outcome {
            cells.extend(averages.iter().flat_map(|averages| {
                let Averages { voltage_gain, power, impacts } = averages;
                [column::real(*voltage_gain), column::real(*power), impacts.to_string()]
            }));
            cells.extend(recorded.iter().map(column::cell));
        }
        cells.resize(self.columns.len() - 1, String::new());
        cells.push(outcome.as_ref().err().map_or_else(String::new, |reason| column::reason(reason)));
        column::line(cells.iter().map(String::as_str))
    }
}

/// That the heading can be read again, and the line of any run whose results do not get into it.
fn check_lengths(columns: &[Column], axes: &[Axis]) -> Result<(), SweepError> {
    let heading = column::heading(columns).len();
    if heading > LONGEST {
        let reason = format!("the heading of {} columns takes {heading} bytes; at most {LONGEST}", columns.len());
        return Err(SweepError::option("record", "", reason));
    }
    let widest = |axis: &Axis| axis.longest().saturating_add(1);
    let given = axes.iter().map(widest).fold(columns.len() + column::MOST_REASON + 100, usize::saturating_add);
    match axes.iter().max_by_key(|axis| axis.longest()) {
        Some(axis) if given > LONGEST => {
            let reason = format!("the values of a run take up to {given} bytes of its line; at most {LONGEST}");
            Err(SweepError::option("vary", &axis.variable.name, reason))
        }
        _ => Ok(()),
    }
}

fn count_runs(points: &Points, samples: u64, seeds: Option<&Seeds>) -> Result<u64, SweepError> {
    let (is_grid, points) = (points.is_grid(), points.count());
    let most = if seeds.is_some_and(|seeds| !seeds.common) { seeds::MOST } else { MAX_RUNS };
    if points > most {
        let reason = format!("{points} points have no seeds of their own: at most {most}, or --common-seeds");
        let option = if is_grid { ("vary", String::new()) } else { ("points", points.to_string()) };
        return Err(SweepError::option(option.0, option.1, reason));
    }
    let runs = points.checked_mul(samples).filter(|runs| (1..=most).contains(runs));
    let bound = || format!("with {points} points it must lie from 1 to {}", most / points);
    runs.ok_or_else(|| SweepError::option("samples", samples.to_string(), bound()))
}

fn has_gains(description: &ModelDescription) -> bool {
    let kinds = GAINS.map(|name| description.variable(name).map(|variable| &variable.kind));
    matches!(kinds, [Ok(Kind::Real { .. }), Ok(Kind::Real { .. }), Ok(Kind::Integer { .. })])
}

fn columns(
    axes: &[Axis],
    seeds: Option<&Seeds>,
    averages: bool,
    record: &[Variable],
) -> Result<Vec<Column>, SweepError> {
    let mut columns: Vec<_> = ["run", "point", "sample"].map(|name| Column::always(name, Type::Integer)).into();
    columns.extend(axes.iter().map(|axis| Column::always(&axis.variable.name, Type::of(&axis.variable))));
    columns.extend(seeds.map(|seeds| Column::always(&seeds.variable.name, Type::Integer)));
    if averages {
        columns.push(Column::optional("average_voltage_gain", Type::Real));
        columns.push(Column::optional("average_power_eq13", Type::Real));
        columns.push(Column::optional("impacts", Type::Integer));
    }
    columns.extend(record.iter().map(|variable| Column::optional(&variable.name, Type::of(variable))));
    columns.push(Column::optional("error", Type::Text));
    let mut names = HashSet::new();
    match columns.iter().find(|column| !names.insert(column.name.as_str())) {
        Some(twice) => {
            let is_recorded = record.iter().any(|variable| column::one_line(&variable.name) == twice.name);
            let option = if is_recorded { "record" } else { "vary" };
            Err(SweepError::option(option, &twice.name, "the results have a column of that name already"))
        }
        None => Ok(columns),
    }
}
