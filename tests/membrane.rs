//! A measured membrane on the command line: a table of Eq. (2) gives what Eq. (2) gives, wherever the file is and whoever reads it.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// What the tool prints, in this folder.
fn videg(folder: &Path, arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(env!("CARGO_BIN_EXE_videg")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    if output.status.success() { Ok(text(output.stdout)) } else { Err(text(output.stderr)) }
}

fn number(folder: &Path, arguments: &[&str], key: &str) -> f64 {
    let result: Value = serde_json::from_str(&videg(folder, arguments).unwrap()).unwrap();
    result.pointer(key).unwrap().as_f64().unwrap()
}

fn gain(folder: &Path, arguments: &[&str]) -> f64 {
    number(folder, &[&["simulate", "--json", "--until", "20"], arguments].concat(), "/average_voltage_gain")
}

/// Writes Eq. (2), `factor` times as stiff, at 1000 points up to 8 mm.
fn write(path: &Path, factor: f64) {
    let mut text = "deflection,force\n".to_owned();
    for k in 0..1000 {
        let x = 0.008 * f64::from(k) / 999.0;
        writeln!(text, "{x:?},{:?}", factor * 4.0847e5 * x.powf(2.6)).unwrap();
    }
    std::fs::write(path, text).unwrap();
}

/// A folder with the membrane `film.csv`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("film.csv"), 1.0);
    folder
}

const MEASURED: [&str; 4] = ["--set", "membrane.law=table", "--set", "membrane.file=film.csv"];

#[test]
fn a_table_of_equation_2_gives_figure_14_and_its_energies() {
    let folder = folder();
    for law in ["impulsive", "compliant"] {
        let contact = ["--set".to_owned(), format!("contact.law={law}")];
        let contact = contact.each_ref().map(String::as_str);
        let [exact, found] = [&[][..], &MEASURED].map(|law| gain(folder.path(), &[&contact[..], law].concat()));
        assert!((found / exact - 1.0).abs() < 1e-6, "{law}: {found} for {exact}");
    }
    let cosim = ["cosim", "--json", "--until", "10"];
    let [exact, found] =
        [&[][..], &MEASURED].map(|law| number(folder.path(), &[&cosim[..], law].concat(), "/energy/load"));
    assert!((found / exact - 1.0).abs() < 1e-6 && exact != 0.0, "{found} for {exact}");
}

#[test]
fn a_file_is_found_beside_a_case_file_and_for_an_isolated_fmu_and_a_sweep_varies_it() {
    let folder = folder();
    let expected = gain(folder.path(), &MEASURED);
    assert_eq!(gain(folder.path(), &[&MEASURED[..], &["--isolate"]].concat()), expected);
    let elsewhere = tempfile::tempdir().unwrap();
    let case = folder.path().join("case.toml");
    std::fs::write(&case, "[set]\nmembrane.law = 'table'\nmembrane.file = 'film.csv'\n").unwrap();
    assert_eq!(gain(elsewhere.path(), &["--case-file", case.to_str().unwrap()]), expected);
    let error = videg(elsewhere.path(), &[&["simulate"], &MEASURED[..]].concat()).unwrap_err();
    assert!(error.contains("membrane.file = \"film.csv\": No such file"), "{error}");

    write(&folder.path().join("stiff.csv"), 2.0);
    let sweep = ["sweep", "--until", "5", "--output", "both", "--set", "membrane.law=table"];
    videg(folder.path(), &[&sweep[..], &["--vary", "membrane.file=film.csv,stiff.csv"]].concat()).unwrap();
    let results = std::fs::read_to_string(folder.path().join("both/sweep.csv")).unwrap();
    let rows: Vec<Vec<&str>> = results.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let [soft, stiff] = [0, 1].map(|k: usize| (rows[k][3], rows[k][4].parse::<f64>().unwrap()));
    assert_eq!((soft.0, stiff.0), ("film.csv", "stiff.csv"));
    // A stiff membrane is pressed in less.
    assert!(stiff.1 < 0.9 * soft.1, "{rows:?}");
}

#[test]
fn a_system_package_has_the_file_in_it() {
    let folder = folder();
    videg(folder.path(), &[&["ssp", "--output", "out"], &MEASURED[..]].concat()).unwrap();
    let package = std::fs::read_dir(folder.path().join("out")).unwrap().map(|entry| entry.unwrap().path());
    let package = package.into_iter().find(|path| path.extension().is_some_and(|it| it == "ssp")).unwrap();
    let mut archive = zip::ZipArchive::new(std::fs::File::open(package).unwrap()).unwrap();
    let name = archive.file_names().map(|name| name.unwrap().into_owned());
    let name = name.into_iter().find(|name| name.ends_with("VibroImpactHarvester.fmu")).unwrap();
    let mut harvester = Vec::new();
    std::io::Read::read_to_end(&mut archive.by_name(&name).unwrap(), &mut harvester).unwrap();
    let harvester = zip::ZipArchive::new(std::io::Cursor::new(harvester)).unwrap();
    let mut names = harvester.file_names().map(|name| name.unwrap());
    assert!(names.any(|name| name.starts_with("resources/") && name.ends_with("film.csv")));
}
