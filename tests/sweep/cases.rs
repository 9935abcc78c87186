//! Sweeps over cases.

use std::fs;
use std::path::Path;

use videg_model::Case;

use crate::command::{done, folder, json, refused, rows, sweep, videg};

/// A row of results without its first three columns and the values of `varied`.
fn results(folder: &Path, row: usize, varied: &[&str]) -> Vec<String> {
    let rows = rows(folder);
    let keeps = |index: &usize| *index > 2 && !varied.contains(&rows[0][*index].as_str());
    (0..rows[0].len()).filter(keeps).map(|index| rows[row][index].clone()).collect()
}

/// The same bits as sweeps of one case each.
#[test]
fn a_case_of_the_axis_is_the_case_alone() {
    let (guard, folder) = folder();
    let names: Vec<_> = Case::ALL.iter().map(|case| case.name).collect();
    let axis = format!("case={}", names.join(","));
    let others = ["--vary", "ball.mass=0.003,0.004", "--set", "membrane.stiffness=2e5"];
    done(&mut sweep(&folder, &[&["--vary", &axis][..], &others].concat()));
    assert_eq!(rows(&folder).len(), 1 + 2 * names.len());
    for (k, name) in names.iter().enumerate() {
        let alone = guard.path().join(name);
        done(&mut sweep(&alone, &[&["--case", name][..], &others].concat()));
        for mass in 0..2 {
            let together = results(&folder, 1 + 2 * k + mass, &["case", "excitation.seed"]);
            assert_eq!(together, results(&alone, 1 + mass, &["excitation.seed"]), "{name}");
        }
    }
}

/// With files beside the case files, in a design that draws the cases, with the circuit, in shards.
#[test]
fn case_files_are_an_axis_and_name_files_beside_them() {
    let (guard, folder) = folder();
    let at = |name: &str| guard.path().join(name);
    fs::create_dir(at("other")).unwrap();
    let film = fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/film.csv")).unwrap();
    fs::write(at("other/film.csv"), film).unwrap();
    fs::write(at("one.toml"), "case = 'fig15'\nset.zener.voltage = 2300\n").unwrap();
    let other = "name = 'film'\nset.membrane.law = 'table'\nset.membrane.file = 'film.csv'\nset.release = 'storage'\n";
    fs::write(at("other/two.toml"), other).unwrap();
    let files = [at("one.toml"), at("other/two.toml")];
    let files: Vec<_> = files.iter().map(|file| file.to_str().unwrap()).collect();
    let drawn =
        ["--design", "random", "--points", "7", "--vary", "ball.mass=0.003:0.004", "--set", "topology=isolated"];
    let recorded = ["--record", "net_power", "--record", "right.voltage", "--record", "ball.position"];
    let what = [&files[..], &drawn, &recorded].concat();
    done(&mut sweep(&folder, &what));
    let all = rows(&folder);
    assert_eq!(all[0][3..5], ["case", "ball.mass"]);
    for (k, row) in all.iter().enumerate().skip(1) {
        let file = if row[3] == "film" { files[1] } else { files[0] };
        let alone = at(&format!("alone-{k}"));
        let mass = format!("ball.mass={}", row[4]);
        let set = ["--set", "topology=isolated", "--vary", &mass];
        done(&mut sweep(&alone, &[&[file][..], &set, &recorded].concat()));
        assert_eq!(results(&folder, k, &["case"]), results(&alone, 1, &[]), "{}", row[3]);
    }
    let names: Vec<_> = all[1..].iter().map(|row| row[3].as_str()).collect();
    assert!(names.contains(&"one") && names.contains(&"film"), "{names:?}");
    for shard in ["1/2", "2/2"] {
        done(sweep(&at("shards"), &what).args(["--shard", shard]));
    }
    done(videg(&["sweep", "merge", "--output"]).arg(at("merged")).arg(at("shards")));
    assert_eq!(rows(&at("merged")), all);
    // A film in another case is another sweep.
    let less = "name = 'film'\nset.membrane.law = 'table'\nset.membrane.file = 'film.csv'\n";
    fs::write(at("other/two.toml"), less).unwrap();
    let (_, said) = refused(&mut sweep(&folder, &what));
    assert!(said.contains("it belongs to another sweep: the cases film was membrane.law=table,membrane.file=film.csv,release=storage, is membrane.law=table,membrane.file=film.csv;"), "{said}");
}

#[test]
fn noise_of_one_case_gives_every_run_a_seed() {
    let (guard, folder) = folder();
    let file = guard.path().join("noisy.toml");
    fs::write(&file, "set.excitation.phaseNoise = 0.5\n").unwrap();
    let axis = format!("case=fig14,{}", file.display());
    done(&mut sweep(&folder, &["--vary", &axis]));
    assert_eq!(rows(&folder)[0][4], "excitation.seed");
}

/// The voltages that the harvester takes come from the circuit.
#[test]
fn voltages_recorded_beside_a_circuit_are_those_of_the_circuit() {
    let (guard, folder) = folder();
    let set = ["--set", "topology=isolated", "--set", "zener.voltage=2400", "--set", "load.resistance=1e10"];
    let record = ["--record", "left.voltage", "--record", "right.voltage", "--record", "ball.position"];
    done(&mut sweep(&folder, &[&set[..], &record].concat()));
    let run = guard.path().join("cosim");
    json(videg(&[&["cosim", "--until", "2", "--step", "1e-4"][..], &set].concat()).arg("--output").arg(&run));
    let mut series = csv::Reader::from_path(run.join("timeseries.csv")).unwrap();
    let headings = series.headers().unwrap().clone();
    let last = series.records().last().unwrap().unwrap();
    let swept = rows(&folder);
    for name in ["left.voltage", "right.voltage", "ball.position"] {
        let expected: f64 = last[headings.iter().position(|it| it == name).unwrap()].parse().unwrap();
        let found: f64 = swept[1][swept[0].iter().position(|it| it == name).unwrap()].parse().unwrap();
        assert!((found - expected).abs() <= 1e-3 * expected.abs(), "{name}: {found} against {expected}");
    }
}

#[test]
fn cases_that_make_no_axis_are_refused() {
    let (guard, folder) = folder();
    let at = |name: &str| guard.path().join(name).to_str().unwrap().to_owned();
    for (name, text) in [
        ("one.toml", "case = 'fig10'\n"),
        ("long.toml", "until = 60\n"),
        ("bad.toml", "set.ball.mass = -1\n"),
        ("sweep.toml", "samples = 2\n"),
        ("named.toml", "name = 'one'\n"),
        ("axis.toml", "vary.case = ['one.toml', 'fig8']\n"),
        ("none.toml", "vary.case = []\n"),
    ] {
        fs::write(guard.path().join(name), text).unwrap();
    }
    let two = |other: &str| vec![at("one.toml"), at(other)];
    let vary = |values: &str| vec!["--vary".to_owned(), format!("case={values}")];
    for (arguments, said) in [
        (vary("fig10,fig8"), "--vary case: fig8: no such case; did you mean fig9? There are: fig9,"),
        (vary("fig10,none.toml"), "cannot read none.toml: "),
        (vary("1:2:3"), "--vary case: names of cases or case files are expected"),
        (vary("fig10,fig10"), "--vary case: two cases are called fig10"),
        ([vary("fig10,fig11"), vec!["--case".to_owned(), "fig14".to_owned()]].concat(), "--case: the sweep goes over"),
        (two("sweep.toml"), "sweep.toml: TOML parse error at line 1"),
        (two("named.toml"), "two cases are called one"),
        (two("bad.toml"), "bad.toml: set.ball.mass: ball.mass = -1 kg is out of range"),
        (vec![at("axis.toml")], "axis.toml: vary.case: fig8: no such case"),
        (vec![at("none.toml")], "none.toml: vary.case: names of cases"),
        ([vary("fig10,fig11"), vec!["--set".to_owned(), "ball.weight=1".to_owned()]].concat(), "ball.weight"),
    ] {
        let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
        let (code, message) = refused(&mut sweep(&folder, &arguments));
        assert!(code == Some(2) && message.contains(said), "{arguments:?}: {message}");
        assert!(!folder.exists());
    }
    // Without --until, the times of the files stand.
    let times = two("long.toml");
    let (code, message) = refused(videg(&["sweep", "--output"]).arg(&folder).args(&times));
    let expected = "one runs until 100 s with the window 50,100 s, long runs until 60 s with the window 30,60 s";
    assert!(code == Some(2) && message.contains(expected), "{message}");
}
