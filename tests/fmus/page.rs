//! `modelDescription/README.md` is the table that the model descriptions give: symbol of the paper, variable, unit,
//! equation.

use std::fmt::Write as _;

use fmu_import::{Causality, Kind, ModelDescription, Variable};
use videg::package::FMUS;
use videg_golden::Golden;

const HEAD: &str = "\
# Model descriptions

`VibroImpactHarvester.xml` and `HarvestingCircuit.xml` are the `modelDescription.xml` of the two FMUs for FMI 2.0; `fmi3/` has those
for FMI 3.0. They follow from the variable tables in `fmu/*/src/variables.rs`, for parameters from those in `model/src/parameters.rs` and
`circuit/src/settings.rs`, and this page follows from them; tests compare all three.
After a change of a table run `UPDATE_MODEL_DESCRIPTION=1 cargo test --workspace` (twice: the descriptions first).

Symbols, equations, figures, tables and sections are those of the paper, \"Energy harvesting from a DE-based dynamic
vibro-impact system\". A variable without a symbol has none in the paper.
";

/// Run with `UPDATE_MODEL_DESCRIPTION=1` to write the page after a change of a description.
#[test]
fn the_page_is_that_of_the_model_descriptions() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/modelDescription");
    let mut expected = HEAD.to_owned();
    for fmu in FMUS {
        let path = format!("{folder}/{}.xml", fmu.identifier);
        let description = ModelDescription::parse(&std::fs::read(&path).unwrap(), &path).unwrap();
        write_table(&mut expected, &description);
    }
    let path = format!("{folder}/README.md");
    Golden::new("UPDATE_MODEL_DESCRIPTION", "cargo test --workspace").file(path, &expected);
}

fn write_table(text: &mut String, description: &ModelDescription) {
    use Causality::{CalculatedParameter, Input, Local, Output, Parameter};

    write!(text, "\n## {}\n\n{}.\n", description.model_name, description.description.as_deref().unwrap()).unwrap();
    for causality in [Parameter, CalculatedParameter, Input, Output, Local] {
        let variables: Vec<_> = description.variables.iter().filter(|it| it.causality == causality).collect();
        if variables.is_empty() {
            continue;
        }
        let heading = match causality {
            Parameter => "Parameters",
            CalculatedParameter => "Calculated parameters",
            Input => "Inputs",
            Local => "Local variables",
            _ => "Outputs",
        };
        write!(text, "\n### {heading}\n\n| paper symbol | variable | unit | equation |\n|---|---|---|---|\n").unwrap();
        for variable in variables {
            let about = variable.description.as_deref().unwrap();
            let symbol = symbol(about).map(|symbol| format!("`{symbol}`")).unwrap_or_default();
            writeln!(text, "| {symbol} | `{}` | {} | {} |", variable.name, unit(variable), equations(about)).unwrap();
        }
    }
}

fn unit(variable: &Variable) -> String {
    match variable.kind {
        Kind::Real { .. } => variable.unit().unwrap_or("1").to_owned(),
        ref other => other.name().to_lowercase(),
    }
}

/// The symbol that a description begins with, up to the colon: no words but Greek letters and functions.
fn symbol(about: &str) -> Option<&str> {
    let (symbol, _) = about.split_once(": ")?;
    // An index may be a word: U_out.
    let words = symbol.split(|c: char| !c.is_alphanumeric() && c != '_').filter_map(|word| word.split('_').next());
    let is_part = |word: &str| word.len() < 3 || ["lambda", "epsilon", "sigma", "delta", "abs", "sqrt"].contains(&word);
    words.into_iter().all(is_part).then_some(symbol)
}

/// Every place of the paper that a description names, in order.
fn equations(about: &str) -> String {
    let marks = ["Eq. ", "Eqs. ", "Fig. ", "Table ", "Section "];
    let mut found = Vec::new();
    let mut rest = about;
    while let Some((at, mark)) = marks.iter().filter_map(|mark| Some((rest.find(mark)?, *mark))).min() {
        let numbers: Vec<_> = rest[at + mark.len()..]
            .split(' ')
            .take_while(|word| *word == "and" || word.contains(|c: char| c.is_ascii_digit()))
            .collect();
        let numbers = numbers.join(" ");
        let place = format!("{mark}{}", numbers.trim_end_matches([',', ';', '.']));
        rest = &rest[at + mark.len()..];
        // "(10) and the rest": a number that ends its clause ends the place.
        found.push(place.split([',', ';']).next().unwrap().trim_end_matches(" and").to_owned());
    }
    found.join(", ")
}
