//! The page of results lists the keys that the verbs print, and no others.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use crate::chapter::Chapter;
use crate::clone::Clone;
use crate::has_ngspice;

/// Sections of the page, those whose keys they have as well, and runs that print all of them.
const RUNS: [(&str, &[&str], &str); 8] = [
    ("simulate", &[], "simulate --until 1"),
    ("cosim", &["simulate"], "cosim --until 1 --set contact.law=compliant --set contact.electrostaticFeedback=true"),
    ("sweep", &[], "sweep --vary membrane.restitution=0.3,0.6 --until 1 --samples 2"),
    ("map", &[], "map membrane.restitution=0.3:0.6:2 excitation.amplitude=0.4:0.5:2 --until 1"),
    (
        "dynamics",
        &[],
        "dynamics --case capsule-1-1 --orbits --periods 1 --basins 3 --samples 20 --vary cylinder.length=0.4:0.6:5",
    ),
    ("reproduce", &[], "reproduce fig7 --quick"),
    ("fmu info", &[], "fmu info target/fmu/HarvestingCircuit.fmu"),
    ("fmu check", &[], "fmu check target/fmu/HarvestingCircuit.fmu"),
];

/// Keys down to the leaves, with `[]` for items of a list.
fn keys(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                keys(value, &if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, found);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            for item in items {
                keys(item, &format!("{path}[]"), found);
            }
        }
        _ => {
            found.insert(path.to_owned());
        }
    }
}

/// The keys in the first cells of the tables below a heading.
fn listed(page: &str, section: &str) -> BTreeSet<String> {
    let (_, from) = page.split_once(&format!("\n## {section}\n")).unwrap_or_else(|| panic!("no section {section}"));
    let rows = from.split("\n## ").next().unwrap().lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    cells.flat_map(|cell| cell.split(',').map(|key| key.trim().trim_matches('`').to_owned())).collect()
}

/// Whether a listed key stands for one that was printed.
fn covers(listed: &str, printed: &str) -> bool {
    printed.strip_prefix(listed).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

fn check(page: &str, section: &str, also: &[&str], command: &str) {
    let (done, printed) = Clone::new(std::iter::empty()).shell(&format!("videg {command} --json 2>/dev/null"));
    assert!(done, "{command}: {printed}");
    let mut found = BTreeSet::new();
    keys(&serde_json::from_str(&printed).unwrap(), "", &mut found);
    let own = listed(page, section);
    let all: BTreeSet<_> = also.iter().flat_map(|other| listed(page, other)).chain(own.clone()).collect();
    let missing: Vec<_> = found.iter().filter(|key| !all.iter().any(|listed| covers(listed, key))).collect();
    assert!(missing.is_empty(), "docs/reference/results.md does not list {missing:?} of {section}");
    let stale: Vec<_> = own.iter().filter(|listed| !found.iter().any(|key| covers(listed, key))).collect();
    assert!(stale.is_empty(), "docs/reference/results.md lists {stale:?}, which {section} does not print");
}

#[test]
fn the_page_of_results_lists_the_keys_that_the_verbs_print() {
    let page = Chapter::read(Path::new("docs/reference/results.md")).text;
    let (built, printed) = Clone::new(std::iter::empty()).shell("videg fmu build");
    assert!(built, "{printed}");
    for (section, also, command) in RUNS {
        check(&page, section, also, command);
    }
    if has_ngspice() {
        check(&page, "crosscheck", &["simulate", "cosim"], "crosscheck --until 1");
    }
}

#[test]
fn a_key_stands_for_what_is_below_it() {
    assert!(covers("energy", "energy.load") && covers("comparison[]", "comparison[].energy.load") && covers("a", "a"));
    assert!(!covers("energy", "energy_by") && !covers("energy.load", "energy"));
}
