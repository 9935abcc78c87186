//! `videg cases`: the published cases, and all start values of one.

use clap::{Args, ValueEnum};
use indexmap::IndexMap;
use serde::Serialize;
use serde_json::Value as Json;

use super::format::{Sheet, significant};
use super::{Exit, output};
use crate::scenario::{Request, Scenario, StartValue, start_values};
use fmu_import::Value;
use videg_model::Case;

/// Arguments of the verb.
#[derive(Args)]
pub struct Arguments {
    /// Case whose start values are printed; none: all cases in a table
    #[arg(value_name = "NAME")]
    case: Option<String>,
    /// How the start values are printed [default: toml; for all cases a table]
    #[arg(long, value_enum)]
    format: Option<Format>,
}

/// Widest table of all cases, columns.
const WIDTH: usize = 100;

/// Form of the start values.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// A case file for --case-file
    Toml,
    /// One JSON object
    Json,
    /// A dict for `start_values` of FMPy
    Python,
}

/// A case in the JSON list of all.
#[derive(Serialize)]
struct Listed {
    case: &'static str,
    description: &'static str,
    source: &'static str,
    /// V/s.
    paper_voltage_gain: Option<f64>,
    /// W.
    paper_power: Option<f64>,
}

/// Start values as JSON.
#[derive(Serialize)]
struct Output<'a> {
    case: &'a str,
    description: &'a str,
    until: f64,
    step: f64,
    window: [f64; 2],
    start_values: IndexMap<&'a str, Json>,
    units: IndexMap<&'a str, &'a str>,
}

/// Prints the table of all cases, or the start values of one.
pub fn run(arguments: &Arguments) -> anyhow::Result<Exit> {
    let Some(case) = &arguments.case else {
        return all(arguments.format);
    };
    let scenario = Request { case: Some(case.clone()), ..Request::default() }.resolve()?;
    let values = start_values(&scenario)?;
    match arguments.format.unwrap_or(Format::Toml) {
        Format::Toml => output::print_as_is(&toml(&scenario, &values)),
        Format::Python => output::print_as_is(&python(&scenario, &values)),
        Format::Json => output::print_json(&serde_json::to_string_pretty(&json(&scenario, &values))?),
    }?;
    Ok(Exit::Passed)
}

fn all(format: Option<Format>) -> anyhow::Result<Exit> {
    anyhow::ensure!(
        !matches!(format, Some(Format::Toml | Format::Python)),
        "--format: start values are those of one case, as in videg cases fig14; allowed for all cases is json"
    );
    let listed = Case::ALL.iter().map(|case| {
        let &Case { name, description, source, paper_voltage_gain, paper_power, .. } = case;
        Listed { case: name, description, source, paper_voltage_gain, paper_power }
    });
    let listed: Vec<_> = listed.collect();
    output::show(format == Some(Format::Json), &listed, || table(&listed).within(WIDTH))?;
    Ok(Exit::Passed)
}

fn table(listed: &[Listed]) -> Sheet {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| significant(value, 4));
    let row = |it: &Listed| {
        let power = it.paper_power.map(|power| 1e3 * power);
        vec![it.case.to_owned(), it.description.to_owned(), number(it.paper_voltage_gain), number(power)]
    };
    Sheet::new(["case", "what it shows", "<U> of the paper, V/s", "P, mW"], &[1], listed.iter().map(row).collect())
}

/// Unit and description, behind a value.
fn remark(value: &StartValue) -> String {
    let unit = value.unit.as_ref().map_or_else(String::new, |unit| format!("{unit}: "));
    format!("# {unit}{}", value.description)
}

/// A text as TOML, JSON and Python read it: files of users have any name.
fn quoted(text: &str) -> String {
    Json::from(text).to_string()
}

fn toml(scenario: &Scenario, values: &[StartValue]) -> String {
    let Scenario { name, description, until, step, window: [from, to], .. } = scenario;
    // The second half follows from the end, also of a run with another --until.
    let is_plain = [*from, *to] == [0.5 * until, *until];
    let window = if is_plain { String::new() } else { format!("window = [{from:?}, {to:?}]  # s\n") };
    let head = format!(
        "# {description}\n# videg simulate --case-file FILE.toml\ncase = {}\nuntil = {until:?}  # s\nstep = {step:?}  # s\n\
         {window}\n[set]\n",
        quoted(name)
    );
    let line = |value: &StartValue| {
        let shown = match &value.value {
            Value::Real(number) => format!("{number:?}"),
            Value::Integer(number) => number.to_string(),
            Value::Boolean(flag) => flag.to_string(),
            Value::String(text) => quoted(text),
            Value::Enumeration { name, .. } => quoted(name),
        };
        format!("{} = {shown}  {}\n", value.name, remark(value))
    };
    head + &values.iter().map(line).collect::<String>()
}

fn python(scenario: &Scenario, values: &[StartValue]) -> String {
    let Scenario { description, until, step, .. } = scenario;
    let head = format!(
        "# {description}\n# fmpy.simulate_fmu(\"VibroImpactHarvester.fmu\", stop_time={until:?}, output_interval={step:?}, \
         start_values=start_values)\nstart_values = {{\n"
    );
    let line = |value: &StartValue| {
        let (shown, item) = match &value.value {
            Value::Real(number) if number.is_infinite() => (format!("float(\"{number}\")"), None),
            Value::Real(number) => (format!("{number:?}"), None),
            Value::Integer(number) => (number.to_string(), None),
            Value::Boolean(flag) => (if *flag { "True" } else { "False" }.to_owned(), None),
            Value::String(text) => (quoted(text), None),
            Value::Enumeration { value, name } => (value.to_string(), Some(name)),
        };
        let item = item.map_or_else(String::new, |item| format!("  # {item}"));
        let rest =
            if item.is_empty() { format!("  {}", remark(value)) } else { format!("{item}: {}", value.description) };
        format!("    \"{}\": {shown},{rest}\n", value.name)
    };
    head + &values.iter().map(line).collect::<String>() + "}\n"
}

fn json<'a>(scenario: &'a Scenario, values: &'a [StartValue]) -> Output<'a> {
    let Scenario { name, description, until, step, window, .. } = scenario;
    let value = |value: &StartValue| match &value.value {
        Value::Real(number) => Json::from(*number),
        Value::Integer(number) => Json::from(*number),
        Value::Boolean(flag) => Json::from(*flag),
        Value::String(text) => Json::from(text.as_str()),
        Value::Enumeration { name, .. } => Json::from(name.as_str()),
    };
    Output {
        case: name,
        description,
        until: *until,
        step: *step,
        window: *window,
        start_values: values.iter().map(|it| (it.name.as_str(), value(it))).collect(),
        units: values.iter().filter_map(|it| Some((it.name.as_str(), it.unit.as_deref()?))).collect(),
    }
}
