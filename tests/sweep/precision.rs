//! Sweeps that take samples until means are precise.

use crate::command::{
    assert_same_results, cut_after, done, folder, json, rows, run_though_killed, size, stderr, sweep, videg,
};
use crate::sweep::statistics::{NOISE, statistics};

const WHAT: [&str; 4] = ["--vary", "membrane.restitution=0.3:0.9:4", "--until-precision", "0.005"];

#[test]
fn runs_are_those_of_the_full_sweep_up_to_where_each_mean_is_precise() {
    let (_guard, folder) = folder();
    let (some, all) = (folder.join("some"), folder.join("all"));
    let output = done(&mut sweep(&some, &[&WHAT[..], &NOISE, &["--samples", "80"]].concat()));
    done(&mut sweep(&all, &[&WHAT[..2], &NOISE, &["--samples", "80"]].concat()));
    let (some_rows, all_rows) = (rows(&some), rows(&all));
    assert!(some_rows.len() < all_rows.len());
    assert!(some_rows.iter().all(|row| all_rows.contains(row)));
    let mut unreached = 0;
    for (point, row) in statistics(&some).iter().enumerate() {
        let samples = some_rows.iter().filter(|it| it[1] == point.to_string()).count();
        let precision: f64 = row["precision"].parse().unwrap();
        let [mean, low, high] =
            ["mean", "low", "high"].map(|of| row[&format!("average_voltage_gain.{of}")].parse::<f64>().unwrap());
        assert_eq!(precision, 0.5 * (high - low) / mean);
        assert_eq!(row["reached"], (precision <= 0.005).to_string());
        // Decisions are made behind 50, 75 and 80 samples.
        assert!(samples == 80 || precision <= 0.005 && [50, 75].contains(&samples), "{samples} {precision}");
        unreached += u32::from(row["reached"] == "false");
    }
    let said = format!("warning: {unreached} of 4 points did not become as precise as --until-precision;");
    assert_eq!(stderr(&output).contains(&said), unreached > 0, "{}", stderr(&output));
}

#[test]
fn the_bytes_are_the_same_on_any_cores_in_shards_and_after_cuts() {
    let (_guard, folder) = folder();
    let [whole, many, shared, merged, cut] = ["whole", "many", "shared", "merged", "cut"].map(|name| folder.join(name));
    let what = [&WHAT[..], &NOISE, &["--samples", "200"]].concat();
    done(sweep(&whole, &what).args(["--jobs", "1"]));
    // With so many threads all points are under way at once.
    done(sweep(&many, &what).args(["--jobs", "40"]));
    assert_same_results(&whole, &many);
    let mut runs = 0;
    for shard in (1..=6).map(|number| format!("{number}/6")) {
        runs += json(sweep(&shared, &what).args(["--shard", &shard]))["runs"].as_u64().unwrap();
    }
    let said = json(videg(&["sweep", "merge", "--output"]).arg(&merged).arg(&shared));
    assert_eq!((&said["runs"], rows(&whole).len() as u64 - 1), (&runs.into(), runs));
    assert_same_results(&whole, &merged);
    let mut random = fastrand::Rng::with_seed(4);
    for _ in 0..6 {
        let length = random.usize(0..size(&whole));
        let complete = cut_after(length, &whole, &cut, b"");
        assert_eq!(json(&mut sweep(&cut, &what))["resumed_from"], complete, "cut at {length}");
        assert_same_results(&whole, &cut);
    }
    assert_eq!(json(&mut sweep(&whole, &what))["resumed_from"], runs);
}

#[test]
fn killed_again_and_again_it_comes_to_the_same_bytes() {
    let (_guard, folder) = folder();
    let [whole, killed] = ["whole", "killed"].map(|name| folder.join(name));
    let what = [&WHAT[..], &NOISE, &["--samples", "200"]].concat();
    done(&mut sweep(&whole, &what));
    run_though_killed(|| sweep(&killed, &what));
    assert_same_results(&whole, &killed);
}

/// Equal samples, failures and a mean that never gets precise.
#[test]
fn points_that_need_no_more_samples_or_never_have_enough_end() {
    let (_guard, folder) = folder();
    let equal = folder.join("equal");
    let said = json(&mut sweep(&equal, &["--vary", "membrane.restitution=0.5,1.5", "--until-precision", "0.01"]));
    assert_eq!((&said["runs"], &said["failed"], &said["samples"]), (&100.into(), &50.into(), &10_000.into()));
    let rows = statistics(&equal);
    assert_eq!((&*rows[0]["reached"], &*rows[0]["precision"], &*rows[1]["reached"]), ("true", "0.0", "false"));
    let position = folder.join("position");
    let what = [
        "--until-precision",
        "0.0001",
        "--precision-of",
        "ball.velocity",
        "--record",
        "ball.velocity",
        "--samples",
        "60",
    ];
    let output = done(&mut sweep(&position, &[&NOISE[..], &what].concat()));
    assert!(stderr(&output).contains("warning: 1 of 1 points did not become as precise"), "{}", stderr(&output));
    assert_eq!((&*statistics(&position)[0]["succeeded"], &*statistics(&position)[0]["reached"]), ("60", "false"));
}
