//! Reference pages that follow from the code: verbs, variables, cases.

use std::fmt::Write as _;

use fmu_import::{Causality, Kind, ModelDescription, Variable};
use videg::package::{FMUS, FmuPackage};
use videg_model::{Case, Parameters};

use crate::clone::Clone;
use crate::{GOLDEN, root};

const MADE: &str = "<!-- Made by `UPDATE_BOOK=1 cargo test --test book`; do not edit. -->\n";

/// Says what every verb takes, in the words of its help.
#[test]
fn the_page_of_verbs_is_their_help() {
    let mut page = format!("# Verbs and options\n\n{MADE}");
    describe(&mut page, &videg::cli::command(), "videg", &Clone::new(std::iter::empty()));
    GOLDEN.file(root().join("docs/reference/verbs.md"), &page);
}

fn describe(page: &mut String, command: &clap::Command, path: &str, clone: &Clone) {
    let (done, help) = clone.shell(&format!("{path} --help"));
    assert!(done, "{path}: {help}");
    writeln!(page, "\n## {path}\n\n```console\n$ {path} --help\n{}\n```", help.trim_end()).unwrap();
    for verb in command.get_subcommands().filter(|verb| !verb.is_hide_set() && verb.get_name() != "help") {
        describe(page, verb, &format!("{path} {}", verb.get_name()), clone);
    }
}

/// Start values that the command line does not use.
const CIRCUIT_DEFAULTS: &str = "\nThe start values are those of the FMU. `videg cosim`, `crosscheck` and `ssp` start from others, unless they are \
    set: `supply.voltage` is `biasVoltage` of the harvester, `zener.voltage` is `supply.voltage`, and \
    `storage.voltage` is the [best voltage](../theory/circuit.md#which-voltage) for the impacts of a run of the mechanics ahead. So `--set \
    supply.voltage=3000` alone runs with a Zener voltage of 3000 V. In other tools also set the release voltage, `zener.voltage` or with \
    `release = storage` `storage.voltage`: it must be at least `supply.voltage`.\n";

/// Lists every variable with all that its description says.
#[test]
fn the_page_of_variables_is_that_of_the_model_descriptions() {
    let mut page = format!(
        "# Variables\n\n{MADE}\nSymbols and equations are those of the [paper](../bibliography.md). An `enumeration` takes one of the names \
         in `videg` and in a case file, and in FMI its number, from 1: `\"contact.law\": 2`, compliant, in the `start_values` of FMPy. \
         Left is the end that the ball meets at $z_M - z_m = +s/2$ ([drawing](../theory/motion.md)).\n\n\
         All outputs are Reals, because many importers read every output as a Real and connect no other type. Integers and booleans are local \
         variables, which every tool can read; `impact.countReal` and `contact.restingReal` give them as Reals.\n"
    );
    for fmu in &FMUS {
        let description = description(fmu);
        writeln!(page, "\n## {}\n\n{}.", description.model_name, description.description.as_deref().unwrap()).unwrap();
        if description.model_name == "HarvestingCircuit" {
            page.push_str(CIRCUIT_DEFAULTS);
        }
        for (causality, heading) in [
            (Causality::Parameter, "parameters"),
            (Causality::CalculatedParameter, "calculated parameters"),
            (Causality::Input, "inputs"),
            (Causality::Output, "outputs"),
            (Causality::Local, "local variables"),
        ] {
            let variables: Vec<_> = description.variables.iter().filter(|it| it.causality == causality).collect();
            if variables.is_empty() {
                continue;
            }
            writeln!(
                page,
                "\n### {}: {heading}\n\n| variable | unit | start | bounds | meaning |\n|---|---|---|---|---|",
                description.model_name
            )
            .unwrap();
            for variable in variables {
                row(&mut page, &description, variable);
            }
        }
    }
    GOLDEN.file(root().join("docs/reference/variables.md"), &page);
}

fn row(page: &mut String, description: &ModelDescription, variable: &Variable) {
    let number = |value: Option<f64>| value.map_or_else(String::new, scientific);
    let own_bounds = variable.kind.bounds().map(number);
    let (start, bounds) = match &variable.kind {
        Kind::Real { start, .. } => (number(*start), own_bounds),
        Kind::Integer { start, .. } => {
            let start = start.and_then(|start| i32::try_from(start).ok());
            (number(start.map(f64::from)), own_bounds)
        }
        Kind::Other => Default::default(),
        Kind::Boolean { start } => (start.map_or_else(String::new, |start| start.to_string()), Default::default()),
        Kind::String { start } => (start.clone().unwrap_or_default(), Default::default()),
        Kind::Enumeration { start } => {
            let items = description.enumeration(variable).map_or(&[][..], |enumeration| &enumeration.items);
            let name = items.iter().find(|item| Some(item.value) == *start).map(|item| item.name.clone());
            let all: Vec<_> = items.iter().map(|item| format!("{} {}", item.value, item.name)).collect();
            (name.unwrap_or_default(), [all.join(", "), String::new()])
        }
    };
    let bounds = match bounds {
        [min, max] if max.is_empty() => min,
        [min, max] => format!("{min} to {max}"),
    };
    let unit = match variable.kind {
        Kind::Real { .. } => variable.unit().unwrap_or("1").to_owned(),
        ref other => other.name().to_lowercase(),
    };
    let about = variable.description.as_deref().unwrap().replace('|', "\\|");
    writeln!(page, "| `{}` | {unit} | {start} | {bounds} | {about} |", variable.name).unwrap();
}

/// A number with a power of ten where the digits would be zeros that nobody counts.
fn scientific(value: f64) -> String {
    if value == 0.0 || (1e-4..1e6).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// Lists the published cases with what they set.
#[test]
fn the_page_of_cases_is_that_of_the_model() {
    let mut page = format!(
        "# Cases\n\n{MADE}\nA case is a set of parameters. `--case NAME` starts from it, and so does `case = \"NAME\"` in a case \
         file. All other parameters have their start values. [Case files](files.md#case-files) define other cases. \
         `videg cases` lists the cases, and `videg cases NAME --format toml|json|python` prints every parameter of one with its unit: a case file to change, or the \
         `start_values` of [FMPy](../tutorial/fmpy.md#simulate).\n\n\
         ## The paper\n\n| case | description | paper | sets |\n|---|---|---|---|\n"
    );
    let is_paper = |case: &&Case| case.source == Case::PAPER;
    for case in Case::ALL.iter().filter(is_paper) {
        let printed = match (case.paper_voltage_gain, case.paper_power) {
            (Some(gain), _) => format!("{gain} V/s"),
            (_, Some(power)) => format!("{power} W"),
            _ => String::new(),
        };
        writeln!(page, "| `{}` | {} | {printed} | {} |", case.name, case.description, sets(case)).unwrap();
    }
    page.push_str(
        "\n[The paper and videg](../results/paper.md) has the results. The chaotic cases, `fig11` to `fig13`, agree with the paper in \
         the mean over nearby starts, not one by one.\n\n## The capsule of the literature\n\n| case | description | source | sets \
         |\n|---|---|---|---|\n",
    );
    for case in Case::ALL.iter().filter(|case| !is_paper(case)) {
        writeln!(page, "| `{}` | {} | {} | {} |", case.name, case.description, case.source, sets(case)).unwrap();
    }
    page.push_str("\n[The capsule in the literature](../results/literature.md) compares.\n");
    GOLDEN.file(root().join("docs/reference/cases.md"), &page);
}

/// What a case changes, by the names that `--set` takes.
fn sets(case: &Case) -> String {
    let parameters = (case.parameters)();
    let changed = Parameters::TABLE.iter().filter(|quantity| (quantity.get)(&parameters) != quantity.start);
    let numbers = changed.map(|quantity| format!("`{}={}`", quantity.name, (quantity.get)(&parameters)));
    let chosen = Parameters::CHOICES.iter().filter(|choice| (choice.get)(&parameters) != choice.start);
    let choices = chosen.map(|choice| format!("`{}={}`", choice.name, item(choice.name, (choice.get)(&parameters))));
    numbers.chain(choices).collect::<Vec<_>>().join("<br>")
}

/// Name of an item of one of the harvester's enumerations; the number itself if the variable is none.
fn item(variable: &str, value: i32) -> String {
    let description = description(&FMUS[0]);
    let variable = description.variables.iter().find(|it| it.name == variable).unwrap();
    let items = description.enumeration(variable).map_or(&[][..], |enumeration| &enumeration.items);
    items.iter().find(|item| item.value == value).map_or_else(|| value.to_string(), |item| item.name.clone())
}

fn description(fmu: &FmuPackage) -> ModelDescription {
    let path = root().join(format!("modelDescription/{}.xml", fmu.identifier));
    ModelDescription::parse(&std::fs::read(&path).unwrap(), fmu.identifier).unwrap()
}
