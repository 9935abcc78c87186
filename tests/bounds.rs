//! The tables of docs/bounds.md are those of the code, and what they say happens does. `UPDATE_BOUNDS=1 cargo test --test
//! bounds` writes them.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::fmt::Write as _;
use std::path::Path;

use videg_circuit::{Circuit, Settings};
use videg_model::{ContactLaw, Harvester, ModelError, Parameters};

/// How long a harvester runs with a parameter at its bound, s.
const UNTIL: f64 = 2.0;

/// What becomes of a harvester with the parameter at a bound.
fn of_harvester(parameters: &Parameters) -> String {
    let run = Harvester::new(parameters, 0.0).and_then(|mut harvester| harvester.advance(UNTIL));
    match run {
        Ok(()) => "runs".to_owned(),
        Err(ModelError::TooManyEvents { limit, .. }) => format!("ends: more than {limit:e} events in a second"),
        Err(ModelError::Order { name, bound_name, .. }) => format!("refused: {name} must exceed {bound_name}"),
        Err(error) => format!("refused: {error}"),
    }
}

fn of_circuit(settings: &Settings) -> String {
    let run = Circuit::new(settings.parameters(), [15e-12; 2]).and_then(|mut circuit| {
        circuit.advance(0.01, [25e-12, 15e-12])?;
        circuit.advance(0.01, [15e-12; 2])
    });
    run.map_or_else(|error| format!("refused: {error}"), |()| "runs".to_owned())
}

/// One word if both kinds do the same.
fn both(kinds: [&str; 2], [one, other]: [String; 2]) -> String {
    if one == other { one } else { format!("{}: {one}; {}: {other}", kinds[0], kinds[1]) }
}

const HEADING: &str =
    "| parameter | unit | smallest | largest | at the smallest | at the largest |\n|---|---|---|---|---|---|\n";

/// A bound as it is read most easily.
fn number(bound: f64) -> String {
    if bound == 0.0 || (1e-3..1e4).contains(&bound.abs()) { format!("{bound}") } else { format!("{bound:e}") }
}

fn harvester_table() -> String {
    let mut table = format!("\n{HEADING}");
    for quantity in Parameters::TABLE {
        let at = |value| {
            let laws = [ContactLaw::Impulsive, ContactLaw::Compliant].map(|contact_law| {
                let mut parameters = Parameters { contact_law, ..Parameters::default() };
                (quantity.set)(&mut parameters, value);
                of_harvester(&parameters)
            });
            both(["impulsive", "compliant"], laws)
        };
        let (name, unit, [min, max]) = (quantity.name, quantity.unit, [quantity.min, quantity.max].map(number));
        let (lowest, highest) = (at(quantity.min), at(quantity.max));
        writeln!(table, "| `{name}` | {unit} | {min} | {max} | {lowest} | {highest} |").unwrap();
    }
    table
}

fn circuit_table() -> String {
    let mut table = format!("\n{HEADING}");
    for quantity in Settings::QUANTITIES {
        let at = |value| {
            let diodes = [false, true].map(|exponential| {
                let mut settings = Settings { exponential, ..Settings::default() };
                (quantity.set)(&mut settings, value);
                of_circuit(&settings)
            });
            both(["ideal", "exponential"], diodes)
        };
        let (name, unit, [min, max]) = (quantity.name, quantity.unit, [quantity.min, quantity.max].map(number));
        let (lowest, highest) = (at(quantity.min), at(quantity.max));
        writeln!(table, "| `{name}` | {unit} | {min} | {max} | {lowest} | {highest} |").unwrap();
    }
    table
}

fn check(name: &str, table: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/bounds.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let begin = text.find(&format!("<!-- {name}: begin")).unwrap();
    let start = begin + text[begin..].find("-->").unwrap() + 4;
    let end = text.find(&format!("<!-- {name}: end")).unwrap();
    if std::env::var_os("UPDATE_BOUNDS").is_some() {
        std::fs::write(&path, format!("{}{table}\n{}", &text[..start], &text[end..])).unwrap();
        return;
    }
    assert_eq!(text[start..end].trim(), table.trim(), "UPDATE_BOUNDS=1 cargo test --test bounds writes the table");
}

#[test]
fn the_tables_of_bounds_are_those_of_the_code() {
    check("harvester", &harvester_table());
    check("circuit", &circuit_table());
}
