//! Random mounts, and how far apart two runs come.
#![allow(dead_code)] // each test file uses its part
#![allow(clippy::unwrap_used, reason = "a helper fails a test, too")]

use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};
use videg_model::{ContactLaw, ExcitationKind, Harvester, Parameters};

prop_compose! {
    pub fn any_mount()(
        amplitude in 0.0..2.0,
        frequency in 0.5..5.0,
        phase in 0.0..TAU,
        // Elastic bounces that gravity repeats have no end when a damper or the cylinder takes their energy.
        restitution in prop_oneof![Just(0.95), Just(0.0), 0.1..0.95],
        start in (-0.9..0.9, -0.5..0.5, any::<bool>()),
        inclination in prop_oneof![Just(0.0), -FRAC_PI_2..FRAC_PI_2, -0.3..0.3],
        gravity in prop_oneof![Just(9.80665), 0.0..3.0],
        friction in prop_oneof![Just(0.0), 0.0..0.3, 0.3..2.0],
        stiffness in prop_oneof![Just(0.0), 0.1..100.0, 100.0..1000.0],
        damping in prop_oneof![Just(0.0), 0.01..1.0, 1.0..10.0],
        reaction in any::<bool>(),
        ball_mass in 0.001..0.1,
        is_driven in prop::bool::weighted(0.2),
    ) -> Parameters {
        let (excitation_kind, hold) =
            if is_driven { (ExcitationKind::Motion, 0.0) } else { (ExcitationKind::Force, 1.0) };
        let p = Parameters {
            amplitude, frequency, phase, restitution, inclination, gravity, friction, reaction, ball_mass, excitation_kind,
            acceleration: 10.0 * amplitude,
            suspension_stiffness: hold * stiffness,
            suspension_damping: hold * damping,
            ..Parameters::default()
        };
        let (position, velocity, at_rest) = start;
        Parameters {
            ball_position: position * p.travel() / 2.0,
            ball_velocity: if at_rest { 0.0 } else { velocity },
            ..p
        }
    }
}

/// The same under the compliant law, without the one combination that is refused.
pub fn compliant(p: Parameters) -> Parameters {
    Parameters { contact_law: ContactLaw::Compliant, reaction: p.reaction && !p.is_suspended(), ..p }
}

pub fn positions(harvester: &Harvester) -> [f64; 4] {
    [harvester.cylinder_position(), harvester.ball_position(), harvester.cylinder_velocity(), harvester.ball_velocity()]
}

pub fn difference(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
}

/// Largest difference between two starts that differ by `nudge`, at `time`.
pub fn sensitivity(p: Parameters, nudge: f64, time: f64) -> f64 {
    sensitivity_of(p, &|p| Harvester::new(&p, 0.0).unwrap(), nudge, time)
}

/// The same of what `make` makes.
pub fn sensitivity_of(p: Parameters, make: &dyn Fn(Parameters) -> Harvester, nudge: f64, time: f64) -> f64 {
    let run = |p: Parameters| {
        let mut harvester = make(p);
        harvester.advance(time).unwrap();
        positions(&harvester)
    };
    let there = run(p);
    [1.0, -1.0].into_iter().fold(0.0, |largest: f64, sign| {
        let position = run(Parameters { ball_position: p.ball_position + sign * nudge, ..p });
        let velocity = run(Parameters { cylinder_velocity: p.cylinder_velocity + sign * nudge, ..p });
        largest.max(difference(position, there)).max(difference(velocity, there))
    })
}
