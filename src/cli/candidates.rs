//! What a shell offers for the values of options: cases, variables of harvester and circuit, and their choices. It is asked while the user
//! types, so no FMU is loaded and nothing is written.

use std::ffi::OsStr;
use std::path::Path;

use clap::{Arg, Command};
use clap_complete::engine::{ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter};
use fmu_import::{FmiError, Kind, ModelDescription, Variable};
use videg_model::{Case, Parameters};

use super::reproduce;
use crate::cosim::{CircuitSample, HarvesterSample};
use crate::scenario::is_file;
use crate::sweep::{CASE_AXIS, harvester_description, system_description};

type Candidates = Vec<CompletionCandidate>;

/// `command` with all its verbs, whose arguments know their values.
pub fn of_all(command: Command) -> Command {
    let verb = command.get_name().to_owned();
    command.mut_args(|argument| of_argument(&verb, argument)).mut_subcommands(of_all)
}

fn of_argument(verb: &str, argument: Arg) -> Arg {
    let has_circuit = ["cosim", "crosscheck", "ssp", "sweep", "map"].contains(&verb);
    let of = if has_circuit { Variables::SYSTEM } else { Variables::HARVESTER };
    let settable = of.only(Variable::is_settable);
    match (verb, argument.get_id().as_str()) {
        (_, "case") => completed(argument, |typed| matching(cases(), typed)),
        (_, "settings") => completed(argument, move |typed| settable.set(typed)),
        ("sweep", "vary") => completed(argument, move |typed| settable.vary(typed)),
        ("dynamics", "vary") => completed(argument, move |typed| of.only(is_quantity).set(typed)),
        ("map", "x" | "y") => completed(argument, move |typed| of.only(is_real_and_settable).set(typed)),
        ("sweep", "record") => completed(argument, move |typed| of.named(typed)),
        ("map", "of") | ("sweep", "precision_of") => completed(argument, move |typed| of.only(is_number).result(typed)),
        ("cosim", "columns") => completed(argument, move |typed| of.only(is_column_of_both).named(typed)),
        ("simulate", "columns") => completed(argument, move |typed| of.only(is_column).named(typed)),
        ("export", "columns") => completed(argument, move |typed| of.only(is_real).named(typed)),
        ("reproduce", "names") => completed(argument, |typed| matching(items(), typed)),
        _ => with_files(argument),
    }
}

fn completed(argument: Arg, candidates: impl Fn(&str) -> Candidates + Send + Sync + 'static) -> Arg {
    completed_by(argument, move |typed: &OsStr| typed.to_str().map(&candidates).unwrap_or_default())
}

/// Without what the scripts cannot hand on: they take a line for each candidate.
fn completed_by(argument: Arg, candidates: impl Fn(&OsStr) -> Candidates + Send + Sync + 'static) -> Arg {
    let is_plain =
        |it: &CompletionCandidate| it.get_value().to_str().is_some_and(|text| !text.chars().any(char::is_control));
    argument.add(ArgValueCompleter::new(move |typed: &OsStr| {
        let mut found = candidates(typed);
        found.retain(is_plain);
        found
    }))
}

/// The files that the name of a value asks for: `FILE.toml` those with this ending, `DIR` folders.
fn with_files(argument: Arg) -> Arg {
    let asked = argument.get_value_names().and_then(<[_]>::first).map(ToString::to_string).unwrap_or_default();
    match asked.strip_prefix("FILE.") {
        Some(ending) => {
            let files = files(ending);
            completed_by(argument, move |typed| files.complete(typed))
        }
        None if asked == "DIR" => completed_by(argument, |typed| PathCompleter::dir().complete(typed)),
        None => argument,
    }
}

fn files(ending: &str) -> PathCompleter {
    let ending = ending.to_owned();
    let has_it = move |path: &Path| path.extension().is_some_and(|it| *it == *ending);
    PathCompleter::file().filter(move |path| path.is_file() && has_it(path))
}

fn cases() -> impl Iterator<Item = CompletionCandidate> {
    Case::ALL.iter().map(|case| candidate(case.name, case.description))
}

fn items() -> impl Iterator<Item = CompletionCandidate> {
    let all = (reproduce::ALL, "Every item");
    reproduce::items().chain([all]).map(|(name, title)| candidate(name, title))
}

fn candidate(value: impl Into<String>, help: &str) -> CompletionCandidate {
    let help = Some(help.to_owned().into()).filter(|_| !help.is_empty());
    CompletionCandidate::new(value.into()).help(help)
}

/// Those that go on where `typed` ends.
fn matching(candidates: impl IntoIterator<Item = CompletionCandidate>, typed: &str) -> Candidates {
    let goes_on = |it: &CompletionCandidate| it.get_value().to_string_lossy().starts_with(typed);
    candidates.into_iter().filter(goes_on).collect()
}

/// Variables that an option takes.
#[derive(Clone, Copy)]
struct Variables {
    /// The table in which they are.
    of: fn() -> Result<ModelDescription, FmiError>,
    /// Which of it.
    wanted: fn(&Variable) -> bool,
}

impl Variables {
    const HARVESTER: Self = Self { of: harvester_description, wanted: |_| true };
    const SYSTEM: Self = Self { of: system_description, wanted: |_| true };

    fn only(self, wanted: fn(&Variable) -> bool) -> Self {
        Self { wanted, ..self }
    }

    /// `NAME`
    fn named(self, typed: &str) -> Candidates {
        self.ending(typed, "")
    }

    /// The same, or an average that runs have beside the variables.
    fn result(self, typed: &str) -> Candidates {
        const AVERAGES: [&str; 3] = ["average_voltage_gain", "average_power_eq13", "impacts"];
        let averages = AVERAGES.map(|name| candidate(name, "Over the averaging window"));
        matching(averages, typed).into_iter().chain(self.named(typed)).collect()
    }

    /// `NAME=VALUE`, as far as there are values to choose from.
    fn set(self, typed: &str) -> Candidates {
        match typed.split_once('=') {
            None => self.ending(typed, "="),
            Some((name, value)) if is_file(name) => {
                within(typed, value, PathCompleter::file().complete(value.as_ref()))
            }
            Some((name, value)) => within(typed, value, matching(self.choices(name), value)),
        }
    }

    /// `NAME=VALUE,VALUE`, `case` among the names.
    fn vary(self, typed: &str) -> Candidates {
        let Some((name, values)) = typed.split_once('=') else {
            let of_cases = candidate(format!("{CASE_AXIS}="), "Published cases and case files");
            return matching([of_cases], typed).into_iter().chain(self.ending(typed, "=")).collect();
        };
        let last = values.rsplit(',').next().unwrap_or_default();
        let choices = if name == CASE_AXIS { cases().collect() } else { self.choices(name) };
        let mut found = matching(choices, last);
        if name == CASE_AXIS {
            found.extend(files("toml").complete(last.as_ref()));
        }
        within(typed, last, found)
    }

    /// Their names with `end`.
    fn ending(self, typed: &str, end: &str) -> Candidates {
        let Ok(description) = (self.of)() else { return Candidates::new() };
        // Parentheses mean something to a shell.
        let variables = description.variables.iter().filter(|it| (self.wanted)(it) && !it.name.contains('('));
        matching(variables.map(|it| candidate(format!("{}{end}", it.name), &help(it))), typed)
    }

    /// The values of the variable called `name`, if they can be counted.
    fn choices(self, name: &str) -> Candidates {
        let Ok(description) = (self.of)() else { return Candidates::new() };
        let Ok(variable) = description.variable(name) else { return Candidates::new() };
        let items = description.enumeration(variable).into_iter().flat_map(|it| &it.items);
        let items = items.map(|item| candidate(item.name.as_str(), item.description.as_deref().unwrap_or_default()));
        let is_boolean = matches!(variable.kind, Kind::Boolean { .. });
        items.chain(["true", "false"].into_iter().filter(|_| is_boolean).map(CompletionCandidate::new)).collect()
    }
}

/// `candidates` for the `last` part of what is `typed`, with the part before it.
fn within(typed: &str, last: &str, candidates: Candidates) -> Candidates {
    let before = &typed[..typed.len() - last.len()];
    candidates.into_iter().map(|it| it.add_prefix(before)).collect()
}

/// Unit and description.
fn help(variable: &Variable) -> String {
    let unit = variable.unit().filter(|unit| *unit != "1").map_or_else(String::new, |unit| format!("{unit}: "));
    unit + variable.description.as_deref().unwrap_or_default()
}

fn is_real(variable: &Variable) -> bool {
    matches!(variable.kind, Kind::Real { .. })
}

fn is_real_and_settable(variable: &Variable) -> bool {
    is_real(variable) && variable.is_settable()
}

fn is_number(variable: &Variable) -> bool {
    is_real(variable) || matches!(variable.kind, Kind::Integer { .. })
}

/// A real parameter of the model, over which `dynamics` draws its diagram.
fn is_quantity(variable: &Variable) -> bool {
    Parameters::TABLE.iter().any(|quantity| quantity.name == variable.name)
}

/// A column of a time series.
fn is_column(variable: &Variable) -> bool {
    HarvesterSample::names().contains(&variable.name.as_str())
}

fn is_column_of_both(variable: &Variable) -> bool {
    is_column(variable) || CircuitSample::NAMES.contains(&variable.name.as_str())
}
