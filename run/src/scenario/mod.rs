//! Scenario of a run: a published case or a case file, settings on top of it, duration and averaging window.

mod characters;
mod distinct;
mod file;
mod harvester;
mod origin;
mod preset;
mod start_values;
mod times;
mod user_file;

pub use characters::{check as check_characters, with_plain_ends};
pub use file::CaseFile;
pub use file::{dotted, read_file, toml_error, value_text};
pub use harvester::harvester_description;
pub use origin::Origin;
pub use start_values::{StartValue, start_values};
pub use times::check_proposed_step;
pub use user_file::{absolute as absolute_file, find as find_file, is_file};

use serde::Serialize;
use thiserror::Error;

/// Case unless something else is asked for.
const DEFAULT_CASE: &str = "fig14";

/// Error of a scenario. Each message names the thing, its value and the bound.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the message of each variant names its fields")]
pub enum ScenarioError {
    /// No case has this name.
    #[error("{given}: no such case; {known}")]
    UnknownCase { given: String, known: String },
    /// A setting lacks its equals sign or one of its sides.
    #[error("--set {text}: not of the form variable.name=VALUE")]
    BadSetting { text: String },
    /// A duration, step or window is out of range.
    #[error("{name} = {value} s: {bound}")]
    Time { name: String, value: f64, bound: String },
    /// The case or sweep file cannot be read.
    #[error("cannot read {path}: {cause}")]
    Unreadable { path: String, cause: std::io::Error },
    /// The case or sweep file has a mistake.
    #[error("{path}: {reason}")]
    BadFile { path: String, reason: String },
}

/// One setting: an FMU variable by name, and its value as text, as a user writes it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// Name of the variable.
    pub name: String,
    /// Its value.
    pub value: String,
    /// Where the user gave it.
    #[serde(skip)]
    pub origin: Origin,
}

impl Setting {
    /// A setting that no user asked for.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into(), origin: Origin::Program }
    }

    /// Where the user gave it, for an error about it.
    #[must_use]
    pub fn place(&self) -> String {
        match self.origin {
            Origin::Program => self.name.clone(),
            Origin::Option | Origin::File(_) => self.origin.entry("set", &self.name),
        }
    }

    /// Reads `name=value`.
    ///
    /// # Errors
    /// If there is no equals sign, or nothing before or after it.
    pub fn parse(text: &str) -> Result<Self, ScenarioError> {
        match text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
            Some((name, value)) if !name.is_empty() && !value.is_empty() => {
                Ok(Self { origin: Origin::Option, ..Self::new(name, value) })
            }
            _ => Err(ScenarioError::BadSetting { text: text.to_owned() }),
        }
    }
}

/// Values that the paper prints for a case.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PaperValues {
    /// `<U>`, V/s (Table 2).
    #[serde(rename = "average_voltage_gain")]
    pub voltage_gain: Option<f64>,
    /// P, W (Table 3).
    #[serde(rename = "average_power")]
    pub power: Option<f64>,
}

/// A user's request. Values left out come from the case file, the case or the defaults.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Published case.
    pub case: Option<String>,
    /// Case file.
    pub file: Option<CaseFile>,
    /// Settings on top, the last of a name wins.
    pub settings: Vec<Setting>,
    /// End of the run, s.
    pub until: Option<f64>,
    /// Communication step, s.
    pub step: Option<f64>,
    /// Averaging window, s.
    pub window: Option<[f64; 2]>,
    /// Name of the end in errors, if neither option nor file gives it.
    pub until_place: Option<String>,
}

/// A complete, checked description of a run.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// Name: that of the case, or of the case file.
    pub name: String,
    /// The published case that it starts from.
    pub case: &'static str,
    /// One line on what it shows.
    pub description: String,
    /// Variables to set, in order.
    pub settings: Vec<Setting>,
    /// End of the run, s.
    pub until: f64,
    /// Communication step, s.
    pub step: f64,
    /// Averaging window, s.
    pub window: [f64; 2],
    /// Values that the paper prints, if the case is unchanged.
    pub paper: PaperValues,
    /// How many of the settings are those of the case.
    of_case: usize,
    /// What the options say other than case and case file: names and values.
    pub distinct: Vec<(String, String)>,
    /// Variables whose value is not the start value, each once, in the order of their names.
    pub effective: Vec<Setting>,
    /// Name of the end where the user gave it, for an error about it.
    pub until_place: String,
}

impl Scenario {
    /// The settings of the user, without those of the case.
    pub fn changes(&self) -> &[Setting] {
        &self.settings[self.of_case..]
    }
}

impl Request {
    /// Resolves the request.
    ///
    /// # Errors
    /// An unknown case; a duration, step or window that makes no sense.
    pub fn resolve(mut self) -> Result<Scenario, ScenarioError> {
        let file = self.file.take().unwrap_or_default();
        let named = self.case.as_deref().or(file.case.as_deref()).unwrap_or(DEFAULT_CASE);
        let case = preset::find(named).map_err(|known| {
            let given = file.origin(self.case.is_some()).value("case", named);
            ScenarioError::UnknownCase { given, known }
        })?;
        let times = times::resolve(&self, &file)?;
        let distinct = distinct::options(&self, &file, case, &times);
        let mut changes = file.settings;
        changes.extend(self.settings);
        let mut description = file.description.unwrap_or_else(|| case.description.to_owned());
        let others = distinct::last_of_each(&changes).filter(|change| !preset::has(case, change));
        let shown: Vec<_> = others.map(|change| format!("{} = {}", change.name, change.value)).collect();
        let as_printed = shown.is_empty();
        if !as_printed {
            description = format!("{description}; changed: {}", shown.join(", "));
        }
        let mut settings = preset::settings(case);
        let of_case = settings.len();
        settings.extend(changes);
        let effective = distinct::effective(&settings, case);
        let paper = PaperValues { voltage_gain: case.paper_voltage_gain, power: case.paper_power };
        Ok(Scenario {
            name: file.name.unwrap_or_else(|| case.name.to_owned()),
            case: case.name,
            description,
            settings,
            until: times.until,
            step: times.step,
            window: times.window,
            paper: if as_printed { paper } else { PaperValues::default() },
            of_case,
            distinct,
            effective,
            until_place: times.until_place,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(request: Request) -> String {
        request.resolve().unwrap_err().to_string()
    }

    #[test]
    fn nothing_asked_for_is_fig14_as_in_the_paper() {
        let scenario = Request::default().resolve().unwrap();
        assert_eq!((scenario.name.as_str(), scenario.until, scenario.window), ("fig14", 100.0, [50.0, 100.0]));
    }

    #[test]
    fn a_case_is_compared_with_the_paper_unless_a_value_has_changed() {
        for (settings, changed) in [
            (&[][..], None),
            (&["membrane.restitution = 0.7"], Some("membrane.restitution = 0.7")),
            (&["membrane.restitution=0.60"], None),
            (&["excitation.phase=0"], None),
            (&["membrane.restitution=0.7", "membrane.restitution=0.6"], None),
        ] {
            let settings: Vec<_> = settings.iter().map(|text| Setting::parse(text).unwrap()).collect();
            let scenario = Request { settings: settings.clone(), ..Request::default() }.resolve().unwrap();
            assert_eq!(scenario.changes(), settings, "each is set");
            let gain = changed.is_none().then_some(8079.0);
            assert_eq!(scenario.paper.voltage_gain, gain, "{settings:?}");
            let told = scenario.description.split_once("periodic; changed: ").map(|(_, told)| told);
            assert_eq!(told, changed);
        }
    }

    #[test]
    fn a_short_run_is_averaged_over_its_second_half() {
        let scenario = Request { until: Some(10.0), ..Request::default() }.resolve().unwrap();
        assert_eq!(scenario.window, [5.0, 10.0]);
        assert_eq!(Request { until: Some(1e-4), ..Request::default() }.resolve().unwrap().step, 1e-4);
    }

    #[test]
    fn times_that_make_no_sense_are_named_with_value_and_bound() {
        let request = |until, step, window| Request { until, step, window, ..Request::default() };
        for (until, step, window, expected) in [
            (Some(-1.0), None, None, "--until = -1 s"),
            (Some(f64::NAN), None, None, "--until = NaN s"),
            (Some(f64::INFINITY), None, None, "--until = inf s"),
            (None, Some(0.0), None, "--step = 0 s"),
            (None, Some(f64::NAN), None, "--step = NaN s"),
            (None, Some(200.0), None, "--step = 200 s: must lie above 0 and not above --until = 100 s"),
            (None, Some(1e-12), None, "--step = 0.000000000001 s: must be at least"),
            (None, None, Some([60.0, 50.0]), "--window end = 50 s: must lie above its start 60 s"),
            (None, None, Some([-1.0, 50.0]), "--window start = -1 s"),
            (None, None, Some([50.0, 101.0]), "--window end = 101 s"),
            (None, None, Some([f64::NAN, 50.0]), "--window start = NaN s"),
        ] {
            let found = message(request(until, step, window));
            assert!(found.starts_with(expected), "{found}");
        }
        let found = message(Request { case: Some("fig8".to_owned()), ..Request::default() });
        assert!(found.contains("fig8") && found.contains("fig9, fig10"), "{found}");
        for text in ["restitution", "=1", "a=", ""] {
            assert!(Setting::parse(text).is_err(), "{text}");
        }
    }
}
