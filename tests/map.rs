//! `videg map` through the binary: its best points against other solvers and against brute force, its files, and what it says to bad input.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

#[allow(dead_code, reason = "other tests use more of it")]
#[path = "support/command.rs"]
mod command;

use std::fs;
use std::path::Path;

use command::{column, done, folder, json, names, refused, videg};
use serde_json::Value;

/// The circuit with isolated membranes and a switch.
const BETTER: [&str; 4] = ["--set", "topology=isolated", "--set", "release=switch"];
const SHORT: [&str; 4] = ["--until", "8", "--window", "4,8"];
const SMALL: [&str; 2] = ["zener.voltage=2000:3500:4", "load.resistance=log:1e9:1e12:5"];

fn map(folder: &Path, arguments: &[&str]) -> Value {
    json(videg(&[&["map"], arguments, &["--output"]].concat()).arg(folder))
}

fn number(result: &Value, point: &str, name: &str) -> f64 {
    result[point][name].as_f64().unwrap_or_else(|| panic!("{point} has no {name}: {result}"))
}

fn set(result: &Value, name: &str) -> String {
    format!("{name}={:?}", number(result, "best", name))
}

#[test]
fn a_map_leaves_its_grid_figure_report_and_result_and_marks_what_is_best() {
    let (_guard, folder) = folder();
    let result = map(&folder, &[&SMALL[..], &BETTER, &SHORT].concat());
    let files = ["map.html", "map.png", "map.svg", "result.json", "sweep.csv", "sweep.json", "sweep.parquet"];
    assert_eq!(names(&folder), files);
    let kept: Value = serde_json::from_str(&fs::read_to_string(folder.join("result.json")).unwrap()).unwrap();
    assert_eq!(kept, result);
    let grid: Vec<f64> = column(&folder, "net_power").iter().map(|text| text.parse().unwrap()).collect();
    assert_eq!(grid.len(), 20);
    let top = grid.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(number(&result, "best_of_grid", "net_power"), top);
    assert!(number(&result, "best", "net_power") >= top && result["points_beyond_limits"] == 0);
    assert_eq!(result["best_within_limits"], result["best"]);
    let svg = fs::read_to_string(folder.join("map.svg")).unwrap();
    for part in ["zener.voltage (V)", "load.resistance (", "net_power (uW)", "best of the grid", "rotate("] {
        assert!(svg.contains(part), "{part}");
    }
    assert!(!svg.contains("a limit of the film"));
    let page = fs::read_to_string(folder.join("map.html")).unwrap();
    assert!(page.find("<svg").unwrap() < page.find("<table").unwrap(), "the figure comes first");
}

#[test]
fn two_maps_in_a_row_have_a_folder_each_and_the_same_one_again_goes_on() {
    let guard = tempfile::tempdir().unwrap();
    let run = |case: &str, axes: &[&str]| {
        let mut command = videg(&[&["map", "--json", "--case", case], axes, &BETTER, &SHORT].concat());
        let result: Value = serde_json::from_slice(&done(command.current_dir(guard.path())).stdout).unwrap();
        (result["files"][0].as_str().unwrap().to_owned(), result["resumed_from"].as_u64().unwrap())
    };
    let other = ["membrane.restitution=0.4:0.6:2", SMALL[1]];
    let ((first, _), (second, _), (third, _)) = (run("fig14", &SMALL), run("fig14", &other), run("fig15", &SMALL));
    assert_eq!([first.as_str(), third.as_str()], ["out/map-fig14/sweep.csv", "out/map-fig15/sweep.csv"]);
    assert!(second.starts_with("out/map-fig14-") && second.matches("fig14").count() == 1, "{second}");
    assert_eq!([run("fig14", &SMALL), run("fig14", &other)], [(first, 20), (second, 10)]);
}

#[test]
fn a_map_goes_on_after_shards_and_gives_the_same_bytes() {
    let (_guard, folder) = folder();
    let [whole, shared, merged] = ["whole", "shared", "merged"].map(|name| folder.join(name));
    let noisy = ["--set", "excitation.phaseNoise=0.5", "--set", "excitation.noiseHold=1e-3", "--samples", "2"];
    let what = [&SMALL[..], &BETTER, &SHORT, &noisy].concat();
    let first = map(&whole, &what);
    for shard in ["1/2", "2/2"] {
        done(videg(&[&["map"], &what[..], &["--shard", shard, "--output"]].concat()).arg(&shared));
        assert!(!shared.join("map.svg").exists());
    }
    done(videg(&["sweep", "merge", "--output"]).arg(&merged).arg(&shared));
    let second = map(&merged, &what);
    assert_eq!(second["resumed_from"], 40);
    for key in ["best", "best_of_grid", "closed_forms"] {
        assert_eq!(first[key], second[key]);
    }
    // Report and result have the command and its time.
    for name in ["sweep.csv", "sweep.json", "sweep.parquet", "map.svg", "map.png"] {
        let [one, other] = [&whole, &merged].map(|folder| fs::read(folder.join(name)).unwrap());
        assert!(one == other, "{name}");
    }
    // The same seeds at all points: the mechanics do not depend on the circuit.
    let gains = column(&whole, "average_voltage_gain");
    assert!(gains.chunks(2).all(|pair| pair == &gains[..2]) && gains[0] != gains[1]);
}

#[test]
fn beyond_a_limit_the_map_is_hatched_and_the_best_point_within_is_marked_beside_the_best() {
    let (_guard, folder) = folder();
    // The field of a film of 2 mm, stretched to 0.5 mm, under some 10 kV.
    let axes = ["biasVoltage=2000:12000:6", "load.resistance=log:1e9:1e11:5"];
    let result = map(&folder, &[&axes[..], &BETTER, &SHORT].concat());
    let [best, within] = ["best", "best_within_limits"].map(|point| number(&result, point, "net_power"));
    assert!(within < best && within > 0.0, "{within} {best}");
    assert!(number(&result, "best", "field_over_limit") > 1.0);
    let field = number(&result, "best_within_limits", "field_over_limit");
    assert!(field <= 1.0 && field > 0.97, "{field}: the best admissible point is at the limit");
    assert_eq!(result["best_exceeds"], serde_json::json!(["field_over_limit", "stress_over_limit"]));
    let beyond = column(&folder, "field_over_limit").iter().filter(|text| text.parse::<f64>().unwrap() > 1.0).count();
    assert_eq!(result["points_beyond_limits"], beyond);
    let svg = fs::read_to_string(folder.join("map.svg")).unwrap();
    assert!(svg.contains("a limit of the film is exceeded") && svg.contains("best within the limits"));
}

#[test]
fn a_map_all_of_whose_points_are_beyond_a_limit_says_so() {
    let (_guard, folder) = folder();
    let axes = ["biasVoltage=30000:40000:2", "load.resistance=log:1e9:1e11:2"];
    let result = map(&folder, &[&axes[..], &BETTER, &SHORT].concat());
    assert_eq!((&result["best_within_limits"], &result["points_beyond_limits"]), (&Value::Null, &Value::from(4)));
    let shown = done(videg(&[&["map"], &axes[..], &BETTER, &SHORT, &["--output"]].concat()).arg(&folder)).stdout;
    let shown = String::from_utf8(shown).unwrap();
    assert!(shown.contains("No point of the grid is within the limits of the film"), "{shown}");
}

#[test]
fn bad_maps_are_refused_with_what_is_wrong() {
    let (_guard, folder) = folder();
    let load = "load.resistance=log:1e9:1e12:5";
    for (x, y, more, told) in [
        (load, load, &[][..], "axis load.resistance: both axes of the map vary it"),
        (load, "zener.voltage=2000:3000:1", &[], "axis zener.voltage: a count of 1 makes no axis; at least 2"),
        (load, "zener.voltage=2000:3000", &[], "axis zener.voltage: it needs a count, as in 2000:3000:100"),
        (load, "zener.voltage=2000,3000", &[], "axis zener.voltage: a list of values makes no axis"),
        (load, "zener.voltage=3000:3000:4", &[], "axis zener.voltage: it goes from 3000 to 3000"),
        (load, "zener.voltage=NaN:3000:4", &[], "a range goes from one finite number to another"),
        (load, "zener.voltage=1:2:2000000", &[], "points are too many for a map; at most 1000000"),
        (load, "topology=0:1:2", &[], "axis topology: it is of type Enumeration"),
        (load, "case=fig14,fig15", &[], "case"),
        (load, "zener.voltge=2000:3000:4", &[], "zener.voltge"),
        (load, "log:2000:3000:4", &[], "--vary log:2000:3000:4"),
        (load, "zener.voltage=2000:3000:4", &["--of", "net_powr"], "--of net_powr: "),
        (load, "zener.voltage=2000:3000:4", &["--of", "topology"], "--of topology: it is no number"),
        (load, "zener.voltage=2000:3000:4", &["--of", "zener.voltage"], "--of zener.voltage: it is an axis"),
        (
            load,
            "zener.voltage=2000:3000:2",
            &["--set", "contact.electrostaticFeedback=true"],
            "all 10 runs of the map failed; the first one: contact.electrostaticFeedback = true",
        ),
    ] {
        let command = [&["map", x, y], more, &SHORT, &["--output"]].concat();
        let (code, message) = refused(videg(&command).arg(&folder));
        let expected = if told.starts_with("all 10 runs") { 1 } else { 2 };
        assert!(code == Some(expected) && message.contains(told), "{x} {y} {more:?}: {message}");
    }
}

/// The best value of a grid three times as fine, by a sweep of its own.
fn brute_force(folder: &Path, axes: [&str; 2], arguments: &[&str]) -> f64 {
    let command =
        [&["sweep", "--vary", axes[1], "--vary", axes[0], "--common-seeds", "--record", "net_power"], arguments];
    done(videg(&[&command.concat()[..], &["--output"]].concat()).arg(folder));
    let values: Vec<f64> = column(folder, "net_power").iter().map(|text| text.parse().unwrap()).collect();
    let points: Vec<u64> = column(folder, "point").iter().map(|text| text.parse().unwrap()).collect();
    let samples = points.iter().filter(|point| **point == 0).count();
    let means = values.chunks(samples).map(|samples| samples.iter().sum::<f64>() / samples.len() as f64);
    means.fold(f64::NEG_INFINITY, f64::max)
}

/// The search ends within 1/128 of a distance of the grid from the top; what that costs is far below this.
const TOLERANCE: f64 = 1e-3;

#[test]
#[ignore = "slow"]
fn the_best_point_is_that_of_a_grid_three_times_as_fine() {
    let (_guard, folder) = folder();
    let film = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/film.csv");
    let film = format!("membrane.file={film}");
    let noise = ["excitation.phaseNoise=0.5", "excitation.noiseHold=1e-3"];
    let loads = ["load.resistance=log:1e9:1e12:10", "load.resistance=log:1e9:1e12:28"];
    for (round, [coarse, fine], settings, more) in [
        (0, ["zener.voltage=2000:3500:9", "zener.voltage=2000:3500:25"], &noise[..], &["--samples", "3"][..]),
        (1, ["cylinder.inclination=0.6:0.9:7", "cylinder.inclination=0.6:0.9:19"], &[], &["--case", "capsule-1-1"]),
        (2, ["biasVoltage=1000:4000:7", "biasVoltage=1000:4000:19"], &["membrane.law=table", &film], &[]),
    ] {
        let set: Vec<&str> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
        let arguments = [&BETTER[..], &set, more, &["--until", "30", "--window", "15,30"]].concat();
        let result = map(&folder.join(format!("map-{round}")), &[&[coarse, loads[0]], &arguments[..]].concat());
        let [best, of_grid] = ["best", "best_of_grid"].map(|point| number(&result, point, "net_power"));
        let fine = brute_force(&folder.join(format!("fine-{round}")), [fine, loads[1]], &arguments);
        println!("{round}: grid {of_grid:e} W, best {best:e} W, fine grid {fine:e} W");
        assert!(best >= of_grid && best >= fine * (1.0 - TOLERANCE), "{round}: {best:e} W, fine grid {fine:e} W");
    }
}

#[test]
#[ignore = "slow"]
fn net_power_of_the_best_pair_is_that_of_co_simulation_and_of_ngspice() {
    let (_guard, folder) = folder();
    let axes = ["zener.voltage=2000:3500:7", "load.resistance=log:1e9:1e12:10"];
    // Periodic by then.
    let times = ["--until", "30", "--window", "20,30"];
    let result = map(&folder.join("map"), &[&axes[..], &BETTER, &times].concat());
    let best = number(&result, "best", "net_power");
    let [voltage, load] = ["zener.voltage", "load.resistance"].map(|name| set(&result, name));
    let pair = [&BETTER[..], &["--set", &voltage, "--set", &load]].concat();
    let run = |name: &str, more: &[&str]| {
        let command = [&["cosim"], &pair[..], more, &["--output"]].concat();
        json(videg(&command).arg(folder.join(name)))["net_power"].as_f64().unwrap()
    };
    let fine = run("fine", &[&times[..], &["--step", "1e-5"]].concat());
    assert!((best / fine - 1.0).abs() < 1e-4, "{best:e} W against {fine:e} W");
    // The engine of the map, and ngspice in step with the harvester.
    let short = ["--until", "10", "--window", "5,10"];
    let swept = folder.join("swept");
    let command =
        [&["sweep", "--record", "net_power", "--vary", &voltage, "--vary", &load], &BETTER[..], &short].concat();
    done(videg(&[&command[..], &["--output"]].concat()).arg(&swept));
    let own: f64 = column(&swept, "net_power")[0].parse().unwrap();
    let of_ngspice = run("ngspice", &[&short[..], &["--step", "1e-4", "--circuit", "ngspice"]].concat());
    assert!((own / of_ngspice - 1.0).abs() < 1e-3, "{own:e} W against {of_ngspice:e} W");
}
