//! The tables of docs/bounds.md are those of the code, and what they say happens does. `UPDATE_BOUNDS=1 cargo test --test
//! bounds` writes them.

use videg_circuit::{Circuit, Settings};
use videg_golden::Golden;
use videg_model::{ContactLaw, ExcitationKind, Harvester, MembraneLaw, ModelError, Parameters};

const GOLDEN: Golden = Golden::new("UPDATE_BOUNDS", "cargo test --test bounds");
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/bounds.md");

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

fn table(rows: impl Iterator<Item = String>) -> String {
    let heading =
        "| parameter | unit | smallest | largest | at the smallest | at the largest |\n|---|---|---|---|---|---|\n";
    heading.to_owned() + &rows.collect::<String>()
}

/// A bound as it is read most easily.
fn number(bound: f64) -> String {
    if bound == 0.0 || (1e-3..1e4).contains(&bound.abs()) { format!("{bound}") } else { format!("{bound:e}") }
}

/// What becomes of a run with a parameter at either bound.
fn row(name: &str, unit: &str, [min, max]: [f64; 2], at: impl Fn(f64) -> String) -> String {
    format!("| `{name}` | {unit} | {} | {} | {} | {} |\n", number(min), number(max), at(min), at(max))
}

/// Parameters under which the one of this `name` counts.
fn with_use_of(name: &str) -> Parameters {
    let p = Parameters::default();
    match name {
        "excitation.acceleration" => Parameters { excitation_kind: ExcitationKind::Motion, ..p },
        "membrane.shearModulus" | "membrane.stretchLimit" => Parameters { membrane_law: MembraneLaw::Gent, ..p },
        "membrane.viscousModulus" | "membrane.relaxationTime" => {
            Parameters { membrane_law: MembraneLaw::Gent, viscous_modulus: 1e4, relaxation_time: 0.01, ..p }
        }
        _ if name.starts_with("membrane.ogden") => Parameters { membrane_law: MembraneLaw::Ogden, ..p },
        _ => p,
    }
}

fn harvester_row(quantity: &videg_model::Quantity) -> String {
    row(quantity.name, quantity.unit, [quantity.min, quantity.max], |value| {
        let laws = [ContactLaw::Impulsive, ContactLaw::Compliant].map(|contact_law| {
            let mut parameters = Parameters { contact_law, ..with_use_of(quantity.name) };
            (quantity.set)(&mut parameters, value);
            of_harvester(&parameters)
        });
        both(["impulsive", "compliant"], laws)
    })
}

fn circuit_row(quantity: &videg_circuit::Quantity) -> String {
    row(quantity.name, quantity.unit, [quantity.min, quantity.max], |value| {
        let diodes = [false, true].map(|exponential| {
            let mut settings = Settings { exponential, ..Settings::default() };
            (quantity.set)(&mut settings, value);
            of_circuit(&settings)
        });
        both(["ideal", "exponential"], diodes)
    })
}

#[test]
fn the_tables_of_bounds_are_those_of_the_code() {
    GOLDEN.section(PAGE, "harvester", &table(Parameters::TABLE.iter().map(harvester_row)));
    GOLDEN.section(PAGE, "circuit", &table(Settings::QUANTITIES.iter().map(circuit_row)));
}
