//! `videg cases`: all start values of a case, which other tools and videg itself start from.

use std::path::Path;

use serde_json::Value;

use crate::command::{done, refused, videg};

fn printed(arguments: &[&str]) -> String {
    String::from_utf8(done(&mut videg(&[&["cases"][..], arguments].concat())).stdout).unwrap()
}

/// The result of a short run.
fn run(folder: &Path, arguments: &[&str]) -> Value {
    let mut command = videg(&[&["simulate", "--until", "5", "--json"][..], arguments].concat());
    let output = done(command.current_dir(folder));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_printed_case_file_is_the_case_to_the_last_bit() {
    let guard = tempfile::tempdir().unwrap();
    for case in ["fig9", "fig14", "table3-2hz", "capsule-friction", "capsule-soft"] {
        let text = printed(&[case]);
        std::fs::write(guard.path().join("own.toml"), &text).unwrap();
        let (own, expected) =
            (run(guard.path(), &["--fresh", "--case-file", "own.toml"]), run(guard.path(), &["--case", case]));
        for key in ["average_voltage_gain", "average_power_eq13", "impacts", "events", "paper", "description"] {
            assert_eq!(own[key], expected[key], "{case}: {key}");
        }
        let series = |name: &str| std::fs::read(guard.path().join("out").join(name).join("timeseries.csv")).unwrap();
        assert!(series("simulate-own-until=5") == series(&format!("simulate-{case}-until=5")), "{case}");
        assert!(text.contains("cylinder.mass = ") && text.contains("# kg: "), "{text}");
    }
}

#[test]
fn every_parameter_of_the_harvester_is_printed_in_every_form() {
    let json: Value = serde_json::from_str(&printed(&["fig14", "--format", "json"])).unwrap();
    let (python, toml) = (printed(&["fig14", "--format", "python"]), printed(&["fig14", "--format", "toml"]));
    let description = videg::scenario::harvester_description().unwrap();
    let parameters = description.variables.iter().filter(|it| it.causality == fmu_import::Causality::Parameter);
    let names: Vec<_> = parameters.map(|variable| variable.name.as_str()).collect();
    assert!(names.len() > 40);
    let found: Vec<_> = json["start_values"].as_object().unwrap().keys().collect();
    assert_eq!(found.len(), names.len());
    for name in names {
        assert!(found.iter().any(|it| *it == name), "{name}");
        assert!(python.contains(&format!("    \"{name}\": ")) && toml.contains(&format!("\n{name} = ")), "{name}");
    }
    assert_eq!(json["units"]["ball.mass"], "kg");
    assert_eq!(json["start_values"]["contact.law"], "impulsive");
}

#[test]
fn all_cases_are_in_one_table_and_mistakes_are_told() {
    let table = printed(&[]);
    for case in videg_model::Case::ALL {
        // A long description goes on in the next line.
        let is_described = case.description.split(' ').all(|word| table.contains(word));
        assert!(table.contains(case.name) && is_described, "{}", case.name);
    }
    let listed: Value = serde_json::from_str(&printed(&["--format", "json"])).unwrap();
    assert_eq!(listed.as_array().unwrap().len(), videg_model::Case::ALL.len());
    let (_, said) = refused(&mut videg(&["cases", "fig41"]));
    assert!(said.contains("fig41: no such case; did you mean fig11? There are: fig9"), "{said}");
    let (_, said) = refused(&mut videg(&["cases", "--format", "python"]));
    assert!(said.contains("start values are those of one case"), "{said}");
}
