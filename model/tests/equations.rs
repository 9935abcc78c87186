//! The table of equations in the README, against the code and the variables of the FMU.
#![allow(clippy::unwrap_used)] // helpers outside of #[test] functions fail a test, too

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// Rows of the table: equation, function, file and variable.
fn rows() -> Vec<[String; 4]> {
    let readme = read("README.md");
    let rows = readme.lines().skip_while(|line| !line.starts_with("| equation |")).skip(2);
    let cells =
        |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().replace('`', "")).collect::<Vec<_>>();
    rows.take_while(|line| line.starts_with('|')).map(|line| cells(line).try_into().unwrap()).collect()
}

/// Equation and name of each function of a text whose comment begins with an equation or a section.
fn functions(text: &str) -> Vec<(String, String)> {
    let function = |item: &str| {
        let tag = item.lines().next()?.strip_prefix("/// ")?.split_once(':')?.0;
        let tag = tag.strip_prefix("Eqs. ").or(tag.strip_prefix("Eq. ")).unwrap_or(tag);
        let name = item.split("\npub fn ").nth(1)?.split('(').next()?;
        let is_tag = tag.starts_with('(') || tag.starts_with("Section");
        is_tag.then(|| (tag.replace(" and ", ", "), name.to_owned()))
    };
    text.split("\n\n").filter_map(function).collect()
}

fn sources(folder: PathBuf) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { sources(path) } else { vec![path] }).collect()
}

#[test]
fn the_table_of_equations_is_that_of_the_code_which_calls_each_function() {
    let xml = read("../modelDescription/VibroImpactHarvester.xml");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let others = sources(source).into_iter().filter(|path| !path.components().any(|part| part.as_os_str() == "paper"));
    let code: String = others.map(|path| fs::read_to_string(path).unwrap()).collect();
    let mut expected = BTreeSet::new();
    for [equation, function, file, variable] in rows() {
        assert!(xml.contains(&format!("name=\"{variable}\"")), "the FMU has no {variable}");
        let module = Path::new(&file).file_stem().unwrap().to_str().unwrap().to_owned();
        let calls = [format!("{module}::{function}("), format!(" {function}("), format!("({function}(")];
        assert!(calls.iter().any(|call| code.contains(call)), "nobody calls {module}::{function}");
        expected.insert((file, equation, function));
    }
    let tagged = ["membrane", "force", "excitation", "gap", "impact"].into_iter().flat_map(|module| {
        let file = format!("src/paper/{module}.rs");
        functions(&read(&file)).into_iter().map(move |(equation, function)| (file.clone(), equation, function))
    });
    assert_eq!(tagged.collect::<BTreeSet<_>>(), expected);
}
