//! `videg export`: what other programs get is C(t), to the error that is stated.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use std::path::Path;
use std::process::{Command, Output};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::RowAccessor as _;
use proptest::prelude::*;
use serde_json::Value;

#[path = "support/tool.rs"]
mod tool;

fn export(folder: &Path, arguments: &[&str]) -> Output {
    tool::tool([&["export", "--json"][..], arguments].concat()).current_dir(folder).output().unwrap()
}

fn exported(folder: &Path, arguments: &[&str]) -> Value {
    tool::json(&export(folder, arguments), 0)
}

/// Rows of an exported CSV file.
fn rows(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
    (names, lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect())
}

/// C(t) of a fine table at `time`, s: linear between its rows.
fn at(table: &[Vec<f64>], time: f64, column: usize) -> f64 {
    let end = table.partition_point(|row| row[0] < time).clamp(1, table.len() - 1);
    let (a, b) = (&table[end - 1], &table[end]);
    let part = ((time - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
    a[column] + part * (b[column] - a[column])
}

/// What ngspice prints of `vectors` in a run of `netlist` over `until` seconds: rows of time and values.
fn ngspice(folder: &Path, netlist: &str, vectors: &str, until: f64) -> Option<Vec<Vec<f64>>> {
    let control = format!(
        ".options gmin=1e-20 abstol=1e-12 vntol=1e-7 chgtol=1e-9 reltol=1e-8 trtol=1 method=gear\n.control\n\
         set wr_singlescale\nset wr_vecnames\ntran 1e-4 {until} 0 1e-4 uic\nwrdata found.txt {vectors}\nquit\n.endc\n.end\n"
    );
    std::fs::write(folder.join("run.cir"), format!("* test\n{netlist}\n{control}")).unwrap();
    let run = Command::new("ngspice").args(["-n", "-b", "run.cir"]).current_dir(folder).output();
    let Ok(output) = run else {
        assert!(std::env::var_os("VIDEG_ALL_TOOLS").is_none(), "no ngspice");
        return None;
    };
    let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    let text = std::fs::read_to_string(folder.join("found.txt")).unwrap_or_else(|_| panic!("{said}"));
    let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let found: Vec<Vec<f64>> = text.lines().skip(1).map(numbers).collect();
    assert!(found.last().unwrap()[0] > 0.999 * until, "{said}");
    Some(found)
}

/// A membrane that holds its charge, and another at constant voltage behind a source; the first one a second time, which
/// must not disturb it.
const CIRCUIT: &str = "Xl a 0 deg_left\nXl2 b 0 deg_left\nRa a 0 1e18\nRb b 0 1e18\nVr in 0 2000\nXr in 0 deg_right\n\
                       .ic v(a)=1000 v(b)=500 v(in)=2000";

proptest! {
    #![proptest_config(ProptestConfig { cases: 1, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "slow"]
    fn simulators_give_back_voltages_and_charges_to_the_stated_error(
        restitution in 0.4..0.9_f64, error in -3.0..-2.5_f64, case in 0..2_usize
    ) {
        const UNTIL: f64 = 0.25;
        let folder = tempfile::tempdir().unwrap();
        let (setting, error) = (format!("membrane.restitution={restitution}"), 10_f64.powf(error));
        let common = ["--case", ["fig14", "table3-5hz"][case], "--set", &setting, "--until", "0.25"];
        exported(folder.path(), &[&common[..], &["--format", "csv", "--sample", "1e-5", "--output", "fine.csv"]].concat());
        let (_, fine) = rows(&folder.path().join("fine.csv"));
        let height = |column: usize| fine.iter().map(|row| row[column] - fine[0][column]).fold(0.0, |a: f64, b| a.max(b.abs()));
        for format in ["ngspice", "kicad", "qspice"] {
            let error_text = error.to_string();
            let arguments = ["--format", format, "--knots", &error_text, "--output", "c.lib"];
            exported(folder.path(), &[&common[..], &arguments].concat());
            let netlist = format!(".include c.lib\n{CIRCUIT}");
            let Some(found) = ngspice(folder.path(), &netlist, "v(a) v(b) i(vr)", UNTIL) else { return Ok(()) };
            let (start_left, start_right) = (fine[0][1], fine[0][2]);
            let (mut charge, mut last) = (0.0, &found[0]);
            // The source has charged the second membrane by so much: by the trapezoidal rule over ngspice's points, which is coarser.
            for row in &found {
                charge -= 0.5 * (row[0] - last[0]) * (row[3] + last[3]);
                last = row;
                let [left, right] = [1, 2].map(|column| at(&fine, row[0], column));
                let [tolerance_left, tolerance_right] = [1, 2].map(|column| 1.2 * error * height(column) + 2e-6 * start_left);
                prop_assert!((1000.0 * start_left / row[1] - left).abs() < tolerance_left, "{format} at {} s: {} {left}", row[0], row[1]);
                prop_assert!((row[1] / row[2] - 2.0).abs() < 1e-6, "{format}: two of one membrane");
                let found = start_right + charge / 2000.0;
                prop_assert!((found - right).abs() < tolerance_right + 2e-3 * height(2), "{format} at {} s: {found} {right}", row[0]);
            }
        }
    }
}

#[test]
fn tables_hold_the_values_of_each_other_whatever_their_format() {
    let folder = tempfile::tempdir().unwrap();
    let common = ["--until", "1", "--sample", "1e-3", "--columns", "left.capacitance,ball.velocity,time.of"];
    let unknown = export(folder.path(), &[&["--format", "csv"], &common[..]].concat());
    tool::assert_refused(&unknown, &["--columns time.of: the harvester has no such variable"]);
    let common = ["--until", "1", "--sample", "1e-3", "--columns", "left.capacitance,ball.velocity"];
    for format in ["csv", "parquet", "mat"] {
        let file = format!("t.{format}");
        let told = exported(folder.path(), &[&["--format", format, "--output", &file], &common[..]].concat());
        assert_eq!((told["rows"].as_u64(), told["files"][0].as_str()), (Some(1001), Some(file.as_str())));
        assert!((told["rest_capacitance"].as_f64().unwrap() - 15.01e-12).abs() < 0.01e-12, "{told}");
    }
    let (names, csv) = rows(&folder.path().join("t.csv"));
    assert_eq!(names, ["time", "left.capacitance", "ball.velocity"]);
    let reader = SerializedFileReader::new(std::fs::File::open(folder.path().join("t.parquet")).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap();
    assert!(metadata.iter().any(|pair| pair.key == "videg" && pair.value.as_ref().unwrap().contains("case fig14")));
    for (row, expected) in reader.get_row_iter(None).unwrap().zip(&csv) {
        let row = row.unwrap();
        assert_eq!((0..3).map(|k| row.get_double(k).unwrap()).collect::<Vec<_>>(), *expected);
    }
    // MATLAB's format, level 5: 128 bytes, then each matrix with its type and length.
    let bytes = std::fs::read(folder.path().join("t.mat")).unwrap();
    let mut at = 128;
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    for column in 0..3 {
        assert_eq!(number(at), 14, "a matrix");
        let name = at + 8 + 16 + 16;
        let length = number(name + 4);
        let expected = ["time", "left_capacitance", "ball_velocity"][column];
        assert_eq!(&bytes[name + 8..name + 8 + length], expected.as_bytes());
        let data = name + 8 + length.next_multiple_of(8);
        assert_eq!((number(data), number(data + 4)), (9, 8 * csv.len()));
        for (index, row) in csv.iter().enumerate() {
            let place = data + 8 + 8 * index;
            assert_eq!(f64::from_le_bytes(bytes[place..place + 8].try_into().unwrap()), row[column]);
        }
        at += 8 + number(at + 4);
    }
}

/// The forms that the help of `LTspice` describes: comments, subcircuits, a PWL source over continued lines, capacitors
/// with a value or a charge.
#[test]
fn the_netlist_for_ltspice_has_the_forms_of_its_help_only() {
    let folder = tempfile::tempdir().unwrap();
    let told = exported(folder.path(), &["--format", "ltspice", "--until", "1", "--output", "c.lib"]);
    let text = std::fs::read_to_string(folder.path().join("c.lib")).unwrap();
    let joined = text.replace("\n+", " ");
    let is_number = |word: &str| word.parse::<f64>().is_ok_and(f64::is_finite);
    let mut subcircuits = 0;
    for line in joined.lines().filter(|line| !line.is_empty() && !line.starts_with('*')) {
        let words: Vec<_> = line.split_whitespace().collect();
        match words[0] {
            ".subckt" => assert_eq!((words[1].starts_with("deg_"), &words[2..]), (true, &["p", "n"][..])),
            ".ends" => subcircuits += 1,
            "Cfix" => assert!(words.len() == 4 && is_number(words[3]), "{line}"),
            "Cvar" => {
                let rest = line.strip_prefix("Cvar p n Q=(V(c)-").unwrap().strip_suffix(")*1e-12*x").unwrap();
                assert!(is_number(rest), "{line}");
            }
            "Vc" => {
                let points = line.strip_prefix("Vc c 0 PWL(").unwrap().strip_suffix(')').unwrap();
                let points: Vec<f64> = points.split_whitespace().map(|word| word.parse().unwrap()).collect();
                assert_eq!(points.len() as u64, 2 * told["rows"].as_u64().unwrap());
                assert!(points.chunks(2).zip(points.chunks(2).skip(1)).all(|(a, b)| a[0] < b[0]), "times rise");
            }
            other => panic!("{other}"),
        }
    }
    assert_eq!(subcircuits, 2);
    assert!(text.lines().all(|line| line.len() < 200), "lines of a length that every program reads");
}

#[test]
fn options_that_do_not_go_together_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        (&["--columns", "ball.velocity"][..], "--columns: a netlist has the capacitances only"),
        (&["--sample", "1e-3", "--knots", "1e-3"], "cannot be used with"),
        (&["--format", "csv", "--sample", "0"], "--sample 0 s: must lie from 0.0000001 s to 1 s"),
        (&["--format", "csv", "--sample", "NaN"], "--sample NaN s"),
        (&["--format", "csv", "--sample", "1e-7"], "30000003 values: a table has 20000000 at most"),
        (&["--knots", "1"], "error of C(t) = 1: must lie from 1e-9 to 0.1"),
        (&["--format", "csv", "--columns", "excitation.file"], "--columns excitation.file: is a text, not a number"),
        (&["--format", "csv", "--columns", "bal.velocity"], "did you mean ball.velocity?"),
        (&["--set", "membrane.restitution=2"], "membrane.restitution"),
    ] {
        tool::assert_refused(&export(folder.path(), &[&["--until", "1"], arguments].concat()), &[expected]);
    }
    std::fs::write(folder.path().join("file"), "").unwrap();
    tool::assert_refused(
        &export(folder.path(), &["--until", "0.1", "--output", "file/x.lib"]),
        &["cannot make the folder file"],
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1, ..ProptestConfig::default() })]

    /// With noise, a slow ball or a suspension of short pieces the next impact is not always known.
    #[test]
    fn straight_lines_between_knots_stay_as_close_to_c_as_they_say(
        hold in -5.0..-1.0_f64, noise in 0.1..3.0_f64, compliant in any::<[bool; 6]>(), seed in 1..1000_u32, error in -4.0..-2.5_f64,
    ) {
        for (kind, compliant) in compliant.into_iter().enumerate() {
            let (folder, error) = (tempfile::tempdir().unwrap(), 10_f64.powf(error));
            let mut settings = vec![format!("contact.law={}", if compliant { "compliant" } else { "impulsive" })];
            let noisy = [format!("excitation.phaseNoise={noise}"), format!("excitation.seed={seed}")];
            let of_kind: &[String] = match kind {
                0 => &[],
                1 => &["initial.ballVelocity=0.02".to_owned(), "excitation.amplitude=0.02".to_owned()],
                2 => &["excitation.noiseModel=wiener".to_owned(), noisy[0].clone(), noisy[1].clone()],
                3 => &["cylinder.suspensionDamping=1e4".to_owned(), "excitation.frequency=0.01".to_owned()],
                4 => &noisy,
                _ => &[format!("excitation.noiseHold={}", 10_f64.powf(hold)), noisy[0].clone(), noisy[1].clone()],
            };
            settings.extend_from_slice(of_kind);
            let settings: Vec<_> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
            let until = ["2", "12"][usize::from(kind == 3)];
            let error_text = error.to_string();
            let table = |how: &[&str], name: &str| {
                let common = ["--until", until, "--format", "csv", "--output", name];
                exported(folder.path(), &[&common[..], &settings, how].concat());
                rows(&folder.path().join(name)).1
            };
            let (lines, samples) = (table(&["--knots", &error_text], "lines.csv"), table(&["--sample", "2e-4"], "samples.csv"));
            for column in [1, 2] {
                let height = lines.iter().map(|row| (row[column] - lines[0][column]).abs()).fold(0.0, f64::max);
                let off = samples.iter().map(|row| (row[column] - at(&lines, row[0], column)).abs()).fold(0.0, f64::max);
                prop_assert!(off <= error * height + 1e-18, "{settings:?}: {off:e} F of {height:e} F with {error:e}");
            }
        }
    }
}
