//! Random circuits for `videg crosscheck`, and what one of its runs comes to.

use std::process::Output;

use fastrand::Rng;
use serde_json::Value;

/// The arguments of a random crosscheck of 5 s; the same for the same seed and index.
pub fn arguments(seed: u64, index: u64) -> Vec<String> {
    // Neighbours have nothing to do with each other.
    let mut rng = Rng::with_seed(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ index);
    let mut between = |from: f64, to: f64| from + (to - from) * rng.f64();
    let mut decades = |from: f64, to: f64| between(from.ln(), to.ln()).exp();
    let [stiffness, resistance] = [decades(5e4, 1e6), decades(1e6, 1e11)];
    let [amplitude, frequency, restitution] = [between(0.3, 3.0), between(1.0, 6.0), between(0.3, 1.0)];
    let [mass, voltage] = [between(0.002, 0.008), between(500.0, 4000.0)];
    let topology = rng.choice(["sharedNode", "isolated"]).unwrap_or("sharedNode");
    let release = rng.choice(["zener", "switch", "storage"]).unwrap_or("zener");
    let numbers = [
        ("excitation.amplitude", amplitude),
        ("excitation.frequency", frequency),
        ("membrane.stiffness", stiffness),
        ("membrane.restitution", restitution),
        ("ball.mass", mass),
        ("load.resistance", resistance),
        ("biasVoltage", voltage),
    ];
    let fixed = ["--until", "5", "--topology", topology, "--release", release].map(str::to_owned);
    let set = numbers.iter().flat_map(|(name, value)| ["--set".to_owned(), format!("{name}={value:.4e}")]);
    fixed.into_iter().chain(set).collect()
}

/// What a crosscheck comes to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// ngspice ran to the end, and all solvers agree.
    Agrees,
    /// ngspice ran to the end, and some do not.
    Disagrees(String),
    /// ngspice stopped, and the crosscheck says so with exit code 1.
    GaveUp(String),
    /// It ended in another way.
    Broke(String),
}

/// What a crosscheck with `--json` has come to.
pub fn outcome(output: &Output) -> Outcome {
    let Ok(found) = serde_json::from_slice::<Value>(&output.stdout) else {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Outcome::Broke(format!("{}: {said}", output.status));
    };
    let (stopped, disagree) = (texts(&found["stopped"], "reason"), failed(&found));
    match (output.status.code(), stopped.is_empty(), disagree.is_empty()) {
        (Some(0), true, true) => Outcome::Agrees,
        (Some(1), _, false) => Outcome::Disagrees(disagree.join("; ")),
        (Some(1), false, true) => Outcome::GaveUp(stopped.join("; ")),
        _ => Outcome::Broke(format!("{}, which its report does not explain", output.status)),
    }
}

/// The check that uses up most of its tolerance, as a part of that, and its name.
pub fn closest(output: &Output) -> Option<(f64, String)> {
    let found: Value = serde_json::from_slice(&output.stdout).ok()?;
    let part = |check: &Value| {
        let [deviation, tolerance] = ["deviation", "tolerance"].map(|key| check["agreement"][key].as_f64());
        Some((deviation?.abs() / tolerance?, format!("{}: {}", check["name"], check["agreement"]["between"])))
    };
    found["checks"].as_array()?.iter().filter_map(part).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// What was changed where ngspice did not run at once.
pub fn repeated(output: &Output) -> Vec<String> {
    let found: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    texts(&found["repeated"], "change")
}

/// The member `key` of each object of a list.
fn texts(list: &Value, key: &str) -> Vec<String> {
    list.as_array().into_iter().flatten().filter_map(|item| Some(item[key].as_str()?.to_owned())).collect()
}

/// The checks that fail, with how far the solvers are apart.
fn failed(found: &Value) -> Vec<String> {
    let checks = found["checks"].as_array().into_iter().flatten();
    let failed = checks.filter(|check| check["agreement"]["agree"] == false);
    failed
        .map(|check| {
            let [name, between] =
                [&check["name"], &check["agreement"]["between"]].map(|text| text.as_str().unwrap_or(""));
            format!("{name}: {between} {} of {}", check["agreement"]["deviation"], check["agreement"]["tolerance"])
        })
        .collect()
}
