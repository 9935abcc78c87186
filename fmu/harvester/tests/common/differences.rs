//! Derivatives by differences that know their own error.

/// Steps of the differences, in units of the natural size of the known: from where terms of high order count to where
/// rounding does.
const STEPS: [f64; 8] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6];

/// Largest error that a difference may have, by its own estimate, to decide about a derivative.
const DECISIVE: f64 = 2e-7;

/// Largest deviation of a derivative, like [`DECISIVE`] in units of natural size plus derivative. Worst are the pulses of the
/// last bounces of a chattering sequence: a double resolves 1e-6 of the time between two of them.
const ALLOWED: f64 = 3e-6;

/// Size that a variable typically has.
pub fn natural_size(name: &str) -> f64 {
    let name = name.rsplit('.').next().unwrap_or(name);
    match name {
        "deflection" => 1e-3,
        "capacitance" | "restCapacitance" => 1e-11,
        "voltage" => 100.0,
        "energyEq13" | "energy" => 1e-6,
        "kinetic" | "cylinderKinetic" | "excitation" | "elastic" | "impactLoss" | "electrical" | "wall" => 1e-4,
        "electricField" => 1e7,
        "areaRatio" | "stretch" | "nextTime" | "nextKnot" => 1.0,
        "velocity" | "lastVelocity" | "speed" | "position)" => 0.1,
        "velocity)" => 4.0,
        _ => 1e-2,
    }
}

/// Compares `derivatives` with central differences (five points) of `values`, a function of the distance by which a known
/// of size `unit` is moved. It gives none where something else happens than at distance 0. Returns, for each value, whether
/// it was decided: not so where a difference does not converge, at a kink or where the motion is too sensitive.
pub fn compare(
    names: &[&str],
    derivatives: &[f64],
    unit: f64,
    values: impl Fn(f64) -> Option<Vec<f64>>,
    what: &str,
) -> Vec<bool> {
    let slopes = |step: f64| {
        let h = step * unit;
        let [far, near, back, far_back] = [2.0 * h, h, -h, -2.0 * h].map(&values);
        let (far, near, back, far_back) = (far?, near?, back?, far_back?);
        let slope = |k: usize| (8.0 * (near[k] - back[k]) - (far[k] - far_back[k])) / (12.0 * h);
        Some((0..names.len()).map(slope).collect::<Vec<f64>>())
    };
    let table: Vec<_> = STEPS.iter().filter_map(|step| slopes(*step)).collect();
    let check = |(k, name): (usize, &&str)| {
        let derivative = derivatives[k];
        assert!(derivative.is_finite(), "d {name}: {derivative}, {what}");
        // Two may agree by chance where rounding counts; three hardly do.
        let spread = |from: f64, to: f64| (from - to).abs();
        let errors = table.windows(3).map(|d| (spread(d[0][k], d[1][k]).max(spread(d[1][k], d[2][k])), d[1][k]));
        let Some((error, slope)) = errors.min_by(|a, b| a.0.total_cmp(&b.0)) else { return false };
        let size = natural_size(name) / unit + derivative.abs().max(slope.abs());
        if error.is_nan() || error > DECISIVE * size {
            return false;
        }
        assert!((derivative - slope).abs() <= ALLOWED * size, "d {name}: {derivative}, difference {slope}, {what}");
        true
    };
    names.iter().enumerate().map(check).collect()
}
