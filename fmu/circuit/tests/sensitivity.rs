//! Directional derivatives of the initial values, against central differences.
#![allow(clippy::unwrap_used)] // helpers outside of #[test] functions fail a test, too

use HarvestingCircuit::Harvesting;
use fmi2_export::{Causality, Kind, RealSpec, Slave, Variable};

type Real = (&'static Variable<Harvesting>, &'static RealSpec<Harvesting>);

fn reals(causality: Causality) -> impl Iterator<Item = Real> {
    let rows = Harvesting::variables().iter().filter(move |v| v.causality() == causality);
    rows.filter_map(|v| if let Kind::Real(spec) = v.kind() { Some((v, spec)) } else { None })
}

/// A Zener voltage above the supply's, so that both can be varied.
fn fresh(release: i32, known: &RealSpec<Harvesting>, value: Option<f64>) -> Harvesting {
    let mut slave = Harvesting::new();
    choose(&mut slave, release);
    for (row, spec) in reals(Causality::Parameter).chain(reals(Causality::Input)) {
        let start = if row.name() == "zener.voltage" { Some(2100.0) } else { spec.start };
        spec.set.unwrap()(&mut slave, start.unwrap());
    }
    if let Some(value) = value {
        known.set.unwrap()(&mut slave, value);
    }
    slave.update();
    slave
}

fn choose(slave: &mut Harvesting, release: i32) {
    let row = Harvesting::variables().iter().find(|row| row.name() == "release").unwrap();
    let Kind::Enumeration(spec) = row.kind() else { unreachable!() };
    spec.set.unwrap()(slave, release);
}

#[test]
fn derivatives_of_the_initial_outputs_agree_with_central_differences() {
    for release in 1..=3 {
        agree(release);
    }
}

fn agree(release: i32) {
    for (known_row, known) in reals(Causality::Parameter).chain(reals(Causality::Input)) {
        let slave = fresh(release, known, None);
        let present = (known.get)(&slave);
        let h = 1e-5 * present;
        for (unknown_row, unknown) in reals(Causality::Output) {
            let with = |value| (unknown.get)(&fresh(release, known, Some(value)));
            let difference = (with(present + h) - with(present - h)) / (2.0 * h);
            let derivative = slave.partial_derivative(unknown_row, known_row);
            // Rounding of 2 kV over the step, where the derivative is zero.
            let allowed = 1e-6 * derivative.abs() + 8.0 * f64::EPSILON * (unknown.get)(&slave).abs() / h;
            let names = (release, unknown_row.name(), known_row.name());
            assert!((derivative - difference).abs() <= allowed, "{names:?}: {derivative}, {difference}");
        }
    }
}
