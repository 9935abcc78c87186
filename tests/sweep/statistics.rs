//! Statistics over the samples of each point.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::command::{
    assert_same_results, cut_after, done, folder, json, names, refused, rows, size, stderr, sweep, videg,
};

/// Phase noise that costs little.
pub const NOISE: [&str; 4] = ["--set", "excitation.phaseNoise=0.5", "--set", "excitation.noiseHold=1e-3"];

const POINTS: [&str; 2] = ["--vary", "membrane.restitution=0.3:0.9:3"];

/// The rows of `statistics.csv` by their headings.
pub fn statistics(folder: &Path) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(folder.join("statistics.csv")).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

fn number(row: &HashMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap()
}

#[test]
fn samples_have_a_table_and_a_figure_that_shards_and_cuts_do_not_change() {
    let (_guard, folder) = folder();
    let [whole, shared, merged, cut] = ["whole", "shared", "merged", "cut"].map(|name| folder.join(name));
    let what = [&POINTS[..], &NOISE, &["--samples", "9"]].concat();
    done(&mut sweep(&whole, &what));
    let files = ["statistics.csv", "statistics.svg", "sweep.csv", "sweep.json", "sweep.parquet"];
    assert_eq!(names(&whole), files);
    let document: Value = serde_json::from_slice(&fs::read(whole.join("sweep.json")).unwrap()).unwrap();
    assert!(["statistics.csv", "statistics.svg"].iter().all(|name| document["results"][name].is_object()));
    for shard in ["1/4", "2/4", "3/4", "4/4"] {
        done(sweep(&shared, &what).args(["--shard", shard]));
    }
    assert!(!shared.join("statistics.csv").exists(), "a shard has parts of points");
    done(videg(&["sweep", "merge", "--output"]).arg(&merged).arg(&shared));
    assert_same_results(&whole, &merged);
    cut_after(size(&whole) / 2, &whole, &cut, b"");
    done(&mut sweep(&cut, &what));
    assert_same_results(&whole, &cut);
    // Missing ones are made again, changed ones are told, and another sweep does not keep them.
    fs::remove_file(cut.join("statistics.svg")).unwrap();
    done(&mut sweep(&cut, &what));
    assert_same_results(&whole, &cut);
    fs::write(cut.join("statistics.csv"), "point\n").unwrap();
    let (code, message) = refused(&mut sweep(&cut, &what));
    assert!(code == Some(2) && message.contains("statistics.csv: it has 6 bytes, and sweep.json expects"), "{message}");
    assert!(message.contains("removed, it is made again"), "{message}");
    done(sweep(&cut, &POINTS).arg("--fresh"));
    assert_eq!(names(&cut), ["sweep.csv", "sweep.json", "sweep.parquet"]);
}

#[test]
fn failed_runs_are_counted_and_leave_no_numbers() {
    let (_guard, folder) = folder();
    // The second point is refused by the model.
    done(&mut sweep(&folder, &[&["--vary", "membrane.restitution=0.5,1.5", "--samples", "4"][..], &NOISE].concat()));
    let [good, bad] = &statistics(&folder)[..] else { panic!("two points") };
    assert_eq!((&*good["succeeded"], &*good["failed"], &*bad["succeeded"], &*bad["failed"]), ("4", "0", "0", "4"));
    assert!(number(good, "average_voltage_gain.low") < number(good, "average_voltage_gain.high"));
    let cells = ["mean", "low", "high", "deviation", "q05", "q50", "q95"].map(|of| &*bad[&format!("impacts.{of}")]);
    assert_eq!(cells, [""; 7]);
}

#[test]
fn few_points_are_shown_with_their_means() {
    let (_guard, folder) = folder();
    let what = [&POINTS[..], &NOISE, &["--samples", "5", "--confidence", "0.8"]].concat();
    let said = json(&mut sweep(&folder, &what));
    let row = &statistics(&folder)[1];
    let shown = &said["statistics"]["points"][1];
    assert_eq!(
        (&shown["given"]["membrane.restitution"], &said["statistics"]["confidence"]),
        (&row["membrane.restitution"].parse::<f64>().unwrap().into(), &0.8.into())
    );
    for of in ["mean", "low", "high"] {
        let found = shown["means"]["average_voltage_gain"][of].as_f64().unwrap();
        assert_eq!(found, number(row, &format!("average_voltage_gain.{of}")));
    }
    let again = done(&mut sweep(&folder, &what));
    let text = String::from_utf8(again.stdout).unwrap();
    assert!(
        text.contains("average_voltage_gain: mean and its 80 % interval\n")
            && text.contains("\n 0.6 ")
            && text.contains("statistics.svg"),
        "{text}"
    );
    let many = json(&mut sweep(&folder.join("many"), &["--vary", "ball.mass=3e-3:4e-3:11", "--samples", "2"]));
    assert!(many.get("statistics").is_none());
    // Without noise samples are equal, and so are the ends of their interval.
    let equal = &statistics(&folder.join("many"))[3];
    assert_eq!(equal["impacts.low"], equal["impacts.high"]);
}

/// Each form of the figure is drawn: one point, names, curves, maps, points without order.
#[test]
fn every_sweep_has_a_figure() {
    let (_guard, folder) = folder();
    for (round, (what, shown)) in [
        (&["--set", "ball.mass=4e-3"][..], "Samples and their mean"),
        (&["--vary", "contact.law=impulsive,compliant"], "mean, with its 95 % interval"),
        (&["--vary", "excitation.amplitude=log:0.4:0.6:3"], "5 % to 95 % of the samples"),
        (&["--vary", "membrane.restitution=0.3,0.6", "--vary", "ball.mass=3e-3,4e-3"], "ball.mass = 0.004"),
        (
            &["--vary", "membrane.restitution=0.9:0.3:3", "--vary", "ball.mass=3e-3:4e-3:6"],
            "half 95 % interval / mean (%)",
        ),
        (&["--vary", "membrane.restitution=0.3:0.9", "--design", "random", "--points", "4"], "shaded"),
        (
            &[
                "--vary",
                "membrane.restitution=0.3:0.9",
                "--vary",
                "ball.mass=3e-3:4e-3",
                "--design",
                "lhs",
                "--points",
                "7",
            ],
            "95 % intervals<",
        ),
        (&["--vary", "ball.radius=0.02,0.03"], "average_voltage_gain (V/s)"),
    ]
    .into_iter()
    .enumerate()
    {
        let folder = folder.join(round.to_string());
        // Of the last one all runs fail.
        let output = sweep(&folder, &[what, &NOISE, &["--samples", "3"]].concat()).output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 1)), "{}", stderr(&output));
        let figure = fs::read_to_string(folder.join("statistics.svg")).unwrap();
        assert!(figure.contains(shown), "{what:?}");
    }
}

#[test]
fn statistics_that_make_no_sense_are_refused() {
    let (_guard, folder) = folder();
    for (what, said) in [
        (&["--samples", "3", "--confidence", "0.4"][..], "--confidence 0.4: must lie from 0.5 to 0.999"),
        (&["--samples", "3", "--confidence", "NaN"], "--confidence NaN: must lie from 0.5 to 0.999"),
        (&["--confidence", "0.9"], "--confidence 0.9: a point has one sample"),
        (&["--until-precision", "0"], "--until-precision 0: must lie from 1e-6 to 1"),
        (&["--until-precision", "0.1", "--samples", "49"], "--samples 49: with --until-precision it is at least 50"),
        (
            &["--until-precision", "0.1", "--precision-of", "x"],
            "--precision-of x: no such column of numbers; there are: average_",
        ),
        (&["--precision-of", "impacts"], "--precision-of impacts: it says of which mean; give --until-precision"),
        (&["--until-precision", "0.1", "--set", "excitation.seed=3"], "--set excitation.seed: the samples give it"),
    ] {
        let (code, message) = refused(&mut sweep(&folder, what));
        assert!(code == Some(2) && message.contains(said), "{what:?}: {message}");
    }
    assert!(!folder.exists());
}

#[test]
fn a_run_of_several_samples_is_in_the_table_as_it_is_in_the_results() {
    let (_guard, folder) = folder();
    done(&mut sweep(&folder, &[&NOISE[..], &["--samples", "4"]].concat()));
    let rows = rows(&folder);
    let place = rows[0].iter().position(|name| name == "impacts").unwrap();
    let impacts: Vec<f64> = rows[1..].iter().map(|row| row[place].parse().unwrap()).collect();
    assert_eq!(number(&statistics(&folder)[0], "impacts.mean"), impacts.iter().sum::<f64>() / 4.0);
}
