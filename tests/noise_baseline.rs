//! The plain program that the phase noise is timed against computes what it says.
#![cfg(unix)]
#![allow(clippy::unwrap_used)] // helpers outside of #[test] functions fail a test, too

#[path = "../benches/baseline/noise.rs"]
mod baseline;

use baseline::Plain;
use videg_model::{Harvester, Parameters};

#[test]
fn its_samples_have_the_moments_and_tails_of_a_standard_normal() {
    const COUNT: usize = 2_000_000;
    let samples = Plain::compile().unwrap().samples(1, COUNT).unwrap();
    let mean = |value: &dyn Fn(f64) -> f64| samples.iter().map(|xi| value(*xi)).sum::<f64>() / COUNT as f64;
    let beyond = |z: f64| mean(&|xi| f64::from(u8::from(xi > z)));
    // Expectations and variances.
    let expected = [
        (mean(&|xi| xi), 0.0, 1.0),
        (mean(&|xi| xi * xi), 1.0, 2.0),
        (mean(&|xi| xi.powi(3)), 0.0, 15.0),
        (mean(&|xi| xi.powi(4)), 3.0, 96.0),
        (beyond(0.5), 0.308_538, 0.21),
        (beyond(2.0), 0.022_750_1, 0.022_2),
        (beyond(3.8), 7.234_8e-5, 7.234_8e-5),
    ];
    for (k, (value, expectation, variance)) in expected.into_iter().enumerate() {
        assert!((value - expectation).abs() < 5.0 * (variance / COUNT as f64).sqrt(), "{k}: {value} for {expectation}");
    }
}

#[test]
fn without_noise_its_voltage_gain_is_that_of_the_exact_motion() {
    // Periodic, as Fig. 14, so that fixed steps stay with the exact motion.
    let p = (videg_model::Case::find("fig14").unwrap().parameters)();
    let p = Parameters { phase_noise: 0.0, ..p };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(20.0).unwrap();
    let (plain, exact) = (Plain::compile().unwrap(), harvester.totals().voltage_gain);
    for gain in [plain.runge_kutta(&p, 20.0).unwrap(), plain.closed_form(&p, 20.0).unwrap()] {
        assert!((gain / exact - 1.0).abs() < 1e-3, "{gain} for {exact}");
    }
}
