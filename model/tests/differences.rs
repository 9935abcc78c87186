//! Changes by differences against those in closed form, and against longer differences, at random.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use videg_model::{Direction, Harvester, Parameters, Sensitivities};

prop_compose! {
    fn any_capsule()(
        (restitution, amplitude, frequency, phase) in (0.2..0.95_f64, 0.2..2.0_f64, 1.0..5.0_f64, 0.0..6.3_f64),
        (ball_velocity, ball_mass) in (-0.3..0.3_f64, 1e-3..0.05_f64),
        (inclination, is_inclined) in (-1.5..1.5_f64, any::<bool>()),
    ) -> Parameters {
        let inclination = if is_inclined { inclination } else { 0.0 };
        Parameters { restitution, amplitude, frequency, phase, ball_velocity, ball_mass, inclination, ..Parameters::default() }
    }
}

/// What a user looks at, with the size it has.
fn list(it: &Sensitivities) -> [f64; 14] {
    [
        it.cylinder[0],
        it.cylinder[1],
        it.cylinder[2],
        it.ball[0],
        it.ball[1],
        it.relative_displacement,
        it.capacitance[0],
        it.capacitance[1],
        it.last_speed,
        it.voltage_gain,
        it.energy,
        it.energies.ball,
        it.energies.wall,
        it.energies.impact_loss,
    ]
}

/// What these typically are, in SI units.
const SIZES: [f64; 14] = [1e-2, 0.1, 4.0, 1e-2, 0.1, 1e-2, 1e-11, 1e-11, 0.1, 100.0, 1e-5, 1e-4, 1e-4, 1e-4];

fn counts(harvester: &Harvester) -> [u64; 3] {
    let totals = harvester.totals();
    [totals.impacts, totals.chatters, totals.releases]
}

fn agree(a: &Harvester, b: &Harvester) -> Result<(), TestCaseError> {
    // Of the bounces before a rest a double resolves some digits only, and how many are summed in closed form varies.
    let bounces = a.totals().chatters > 0;
    let tolerance = if bounces { 1e-4 } else { 3e-6 };
    let lists = [a, b].map(|it| list(&it.sensitivities()));
    for (k, ((a, b), size)) in
        lists[0].iter().zip(lists[1]).zip(SIZES).enumerate().filter(|(k, _)| !bounces || !(6..9).contains(k))
    {
        prop_assert!((a - b).abs() <= tolerance * (a.abs() + b.abs() + size), "number {k}: {a} {b}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A friction that moves nothing, but that the closed form does not know.
    #[test]
    fn differences_are_the_closed_form_where_that_exists(p in any_capsule(), step in 1e-3..0.6_f64, force in -0.1..0.1_f64) {
        let rubbing = Parameters { friction: 1e-250, ..p };
        let [closed, by_differences] = [p, rubbing].map(|p| {
            let mut harvester = Harvester::new(&p, 0.0).unwrap();
            harvester.advance(1.3).unwrap();
            harvester.set_external_force(force, 0.05).unwrap();
            harvester.advance(1.3 + step).unwrap();
            harvester
        });
        prop_assume!(counts(&closed) == counts(&by_differences));
        prop_assert!(closed.has_closed_changes() && !by_differences.has_closed_changes());
        agree(&closed, &by_differences)?;
    }

    #[test]
    fn so_they_are_along_parameters(p in any_capsule(), until in 0.0..0.8_f64, which in 0_usize..5) {
        let name = ["excitation.amplitude", "initial.ballVelocity", "initial.cylinderVelocity", "membrane.restitution", "excitation.frequency"][which];
        let direction = Direction::of_parameter(name).unwrap();
        let rubbing = Parameters { friction: 1e-250, ..p };
        let [closed, by_differences] = [p, rubbing].map(|p| {
            let mut harvester = Harvester::along(&p, 0.0, 0.01, &direction).unwrap();
            harvester.advance(until).unwrap();
            harvester
        });
        prop_assume!(counts(&closed) == counts(&by_differences));
        agree(&closed, &by_differences)?;
    }
}
