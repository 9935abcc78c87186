//! How users say what to sweep, and what they are told when that is wrong.

use std::fs;

use crate::command::{NOISY, done, folder, json, refused, sweep, videg};

#[test]
fn a_sweep_file_says_what_options_say_and_options_win() {
    let (guard, folder) = folder();
    let file = guard.path().join("r.toml");
    let text = "case = 'fig15'\nuntil = 2\nsamples = 2\nseed = 3\n[set]\nexcitation.phaseNoise = 0.5\n[vary]\n\
                membrane.restitution = { from = 0.2, to = 0.6, count = 3 }\nball.mass = [0.003, 0.004]\n";
    fs::write(&file, text).unwrap();
    done(videg(&["sweep"]).arg(&file).args(["--output"]).arg(&folder).args(["--vary", "ball.mass=0.005"]));
    let options = ["--vary", "membrane.restitution=0.2:0.6:3", "--vary", "ball.mass=0.005", "--samples", "2"];
    let options = [&options[..], &NOISY, &["--seed", "3", "--case", "fig15"]].concat();
    let other = guard.path().join("options");
    done(&mut sweep(&other, &options));
    let [a, b] = [&folder, &other].map(|folder| fs::read_to_string(folder.join("sweep.csv")).unwrap());
    assert_eq!(a, b);
}

#[test]
fn bad_input_is_one_line_with_the_thing_the_value_and_the_bound_before_anything_starts() {
    let (guard, folder) = folder();
    let file = guard.path().join("bad.toml");
    fs::write(&file, "pionts = 3\n").unwrap();
    let bad = file.to_str().unwrap();
    for (arguments, named) in [
        (&["--vary", "membrane.restitution"][..], "--vary membrane.restitution: allowed is name=from:to:count"),
        (&["--vary", "membrane.restitution=1.1:2:3"], "membrane.restitution = 1.1 is out of range: allowed is 0 .. 1"),
        (&["--set", "membrane.restitution=7"], "membrane.restitution = 7 is out of range: allowed is 0 .. 1"),
        (&["--set", "excitation.seed=7", "--samples", "2"], "--set excitation.seed"),
        (&["--samples", "0"], "--samples 0: with 1 points it must lie from 1 to 1000000000000"),
        (&["--samples", "4294967297"], "--samples 4294967297: with 1 points it must lie from 1 to 4294967296"),
        (&["--record", "nope"], "nope"),
        (
            &["--record", "ball.mass", "--record", "ball.mass"],
            "--record ball.mass: the results have a column of that name",
        ),
        (&["--shard", "3/2"], "1 <= i <= n"),
        (&["--jobs", "0"], "0"),
        (&["--window", "3,1"], "--window"),
        (&[bad], "pionts"),
        (&["missing.toml"], "missing.toml"),
        (&["--fmu", "missing.fmu"], "missing.fmu"),
        (&["--case", "fig8"], "--case fig8"),
    ] {
        let (code, message) = refused(&mut sweep(&folder, arguments));
        assert_eq!(code, Some(2), "{arguments:?}: {message}");
        assert!(message.starts_with("videg: ") && message.contains(named), "{arguments:?}: {message}");
        assert!(!folder.exists(), "{arguments:?}");
    }
}

/// A wrong value is that of the file and the key, or of the option, from which it came.
#[test]
fn an_error_about_a_value_names_the_file_and_key_or_the_option_that_said_it() {
    let (guard, folder) = folder();
    let file = guard.path().join("my.toml");
    let path = file.to_str().unwrap();
    let restitution = "[vary]\nmembrane.restitution = { from = 0.2, to = 0.9 }";
    let none: &[&str] = &[];
    for (text, options, said) in [
        (
            "set.membrane.restitution = 7",
            none,
            "FILE: set.membrane.restitution: membrane.restitution = 7 is out of range",
        ),
        ("set.ball.position = 1", none, "FILE: set.ball.position: it is an output, which cannot be set"),
        ("set.ball.weight = 1", none, "FILE: set.ball.weight: neither the harvester nor the circuit"),
        ("samples = 2\nset.excitation.seed = 1", none, "FILE: set.excitation.seed: the samples give it a value"),
        ("until = -1", none, "FILE: until = -1 s: must lie"),
        ("case = 'fig8'", none, "FILE: case = fig8: no such case"),
        (restitution, none, "FILE: vary.membrane.restitution: a grid needs a count"),
        ("vary.ball.weight = [1]", none, "FILE: vary.ball.weight: "),
        (&format!("design = 'lhs'\npoints = 0\n{restitution}"), none, "FILE: points = 0: must lie from 1 to"),
        ("samples = 0", none, "FILE: samples = 0: with 1 points it must lie"),
        ("record = ['nope']", none, "FILE: record = nope: "),
        ("seed_variable = 'ball.mass'", none, "FILE: seed_variable = ball.mass: a seed is an Integer"),
        ("samples = 1", &["--samples", "0"], "--samples 0: with 1 points"),
        ("record = ['impacts']", &["--record", "nope"], "--record nope: "),
        ("vary.ball.mass = [1]", &["--vary", "ball.mass=x"], "--vary ball.mass: "),
        ("set.ball.mass = 1", &["--set", "ball.mass=x"], "--set ball.mass: "),
    ] {
        fs::write(&file, text).unwrap();
        let (code, message) = refused(videg(&["sweep", path, "--output"]).arg(&folder).args(options));
        assert_eq!(code, Some(2), "{text} {options:?}: {message}");
        assert!(
            message.starts_with(&format!("videg: {}", said.replace("FILE", path))),
            "{text} {options:?}: {message}"
        );
    }
}

#[test]
fn a_check_counts_and_leaves_nothing_behind() {
    let (_guard, folder) = folder();
    let what = ["--vary", "membrane.restitution=0:1:2000000", "--samples", "3", "--check"];
    let said = json(&mut sweep(&folder, &what));
    assert_eq!((&said["points"], &said["samples"], &said["runs"]), (&2_000_000.into(), &3.into(), &6_000_000.into()));
    let (code, message) = refused(&mut sweep(&folder, &[&what[..], &["--record", "nope"]].concat()));
    assert!(code == Some(2) && message.contains("nope"), "{message}");
    assert!(!folder.exists());
}
