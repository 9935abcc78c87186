//! Random mounts, and how far apart two runs come.
#![allow(dead_code)] // each test file uses its part
#![allow(clippy::unwrap_used, reason = "a helper fails a test, too")]

use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};
use videg_model::{ContactLaw, Event, ExcitationKind, Harvester, Parameters};

use super::brute::{Brute, SmallSteps};

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

/// The same under the compliant law.
pub fn compliant(p: Parameters) -> Parameters {
    Parameters { contact_law: ContactLaw::Compliant, ..p }
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

/// A run of 2 s in one go, and in parts that end at the `cuts`, saved and restored at those after 1 s.
pub fn straight_and_split(p: &Parameters, mut cuts: Vec<f64>) -> [Harvester; 2] {
    let mut straight = Harvester::new(p, 0.0).unwrap();
    straight.advance(2.0).unwrap();
    let mut split = Harvester::new(p, 0.0).unwrap();
    cuts.sort_by(f64::total_cmp);
    for cut in cuts {
        split.advance(cut).unwrap();
        if cut > 1.0 {
            split = Harvester::restore(p, &split.snapshot()).unwrap();
        }
    }
    split.advance(2.0).unwrap();
    [straight, split]
}

/// Compares the motion with that by brute force, impact by impact, to a tolerance for cylinder and ball, m, while `sensitivity` at a
/// time, s, is below 1e-5: the distance, m, of two runs that began close to each other.
pub fn follow_brute_force(
    mut harvester: Harvester,
    mut brute: Brute,
    tolerance: [f64; 2],
    sensitivity: impl Fn(f64) -> f64,
) -> Result<(), TestCaseError> {
    let (mut impacts, mut checked) = (Vec::new(), 0);
    for k in 1..=20 {
        let time = 0.1 * f64::from(k);
        brute.run(time);
        let mut seen = Vec::new();
        let show = |event: &Event| {
            if let Event::Impact(impact) = event {
                seen.push((impact.time, impact.speed));
            }
        };
        harvester.advance_with(brute.time, show).unwrap();
        // The rule for a resting ball is right to a few steps.
        if sensitivity(brute.time) > 1e-5 {
            break;
        }
        impacts.extend(seen);
        checked = brute.impacts.len();
        let [z, v, b, w] = brute.state;
        let ours = positions(&harvester);
        let found = [(ours[0] - z).abs(), (ours[1] - b).abs()];
        prop_assert!(
            found[0] < tolerance[0] && found[1] < tolerance[1],
            "{found:?} m at {time} s, {} impacts\nours   {ours:?}\nbrute  {:?}\n{impacts:?} {:?}",
            impacts.len(),
            [z, b, v, w],
            brute.impacts
        );
    }
    // Those of a chattering end are cut off at different depths.
    let least = 200.0 * brute.dt;
    let resolved = |list: &[(f64, f64)]| list.iter().copied().filter(|(_, speed)| *speed > least).collect::<Vec<_>>();
    let (ours, theirs) = (resolved(&impacts), resolved(&brute.impacts[..checked]));
    prop_assert!(ours.len().abs_diff(theirs.len()) <= 1, "{} against {} impacts", ours.len(), theirs.len());
    for (a, b) in ours.iter().zip(&theirs) {
        prop_assert!((a.0 - b.0).abs() < 1e-3 && (a.1 - b.1).abs() < 1e-3, "{a:?} {b:?}");
    }
    Ok(())
}

/// Compares the motion up to `until`, s, with coarse and fine small steps, contact by contact.
pub fn follow_small_steps(
    mut harvester: Harvester,
    [coarse, fine]: &[SmallSteps; 2],
    until: f64,
) -> Result<(), TestCaseError> {
    let mut contacts = Vec::new();
    let show = |event: &Event| {
        if let Event::Impact(impact) = event {
            contacts.push((impact.time, impact.speed));
        }
    };
    harvester.advance_with(until, show).unwrap();
    // What the steps themselves leave open.
    let open = difference(coarse.positions, fine.positions);
    let (found, expected) = (positions(&harvester), fine.positions);
    for k in 0..2 {
        prop_assert!((found[k] - expected[k]).abs() < 1e-5 + 3.0 * open, "{found:?}, {expected:?}, {open:e}");
    }
    let resolved = |list: &[(f64, f64)]| list.iter().copied().filter(|(_, speed)| *speed > 1e-2).collect::<Vec<_>>();
    for (a, b) in resolved(&contacts).iter().zip(&resolved(&fine.contacts)) {
        prop_assert!((a.0 - b.0).abs() < 1e-3 && (a.1 - b.1).abs() < 1e-3 + 3.0 * open, "{a:?} {b:?}");
    }
    Ok(())
}

/// The energy books of the ball close over 4 s, under a `force`, N, from 1.3 s on.
pub fn close_books(mut harvester: Harvester, force: f64) -> Result<(), TestCaseError> {
    let start = harvester.energies();
    // A wall that accelerates presses the ball into the membrane deeper than its speed does.
    let mut deepest = 0.0_f64;
    let mut show = |event: &Event| {
        if let Event::Peak(peak) = event {
            deepest = deepest.max(peak.deflection);
        }
    };
    harvester.advance_with(1.3, &mut show).unwrap();
    harvester.set_external_force(force, -0.1).unwrap();
    harvester.advance_with(4.0, &mut show).unwrap();
    let end = harvester.energies();
    let of_ball = end.ball - start.ball + end.elastic + end.impact_loss + end.viscous + end.friction;
    let given = end.wall + end.electrical + end.gravity;
    let stored = deepest * harvester.membrane().force(deepest);
    let moved = [end.ball, start.ball, end.wall, end.gravity, stored, end.viscous, end.friction]
        .iter()
        .fold(1e-12, |sum: f64, value| sum + value.abs());
    // A contact is integrated to 1e-13 of the speeds, that of the wall included: a slow impact on a fast wall keeps fewer digits.
    let mixed = (moved * (end.excitation.abs() + end.damping)).sqrt();
    prop_assert!((of_ball - given).abs() < 1e-9 * moved + 1e-11 * mixed, "{:e} of {moved:e}: {end:?}", of_ball - given);
    prop_assert!(end.impact_loss >= 0.0 && end.viscous >= 0.0 && end.friction >= 0.0 && end.damping >= 0.0);
    Ok(())
}

/// In `steps`, s, each impact comes when it was predicted, and none before.
pub fn meet_predictions(mut harvester: Harvester, steps: &[f64]) -> Result<(), TestCaseError> {
    for step in steps {
        let (predicted, begin) = (harvester.next_impact(), harvester.time());
        let mut first = None;
        let until = predicted.map_or(begin + step, |time| time.min(begin + step));
        let show = |event: &Event| {
            if let Event::Impact(impact) = event {
                first = first.or(Some(impact.time));
            }
        };
        harvester.advance_with(until, show).unwrap();
        match predicted {
            Some(time) if time <= begin + step => prop_assert_eq!(first, Some(time)),
            Some(_) => prop_assert_eq!(first, None),
            // It may lie behind more turns than are looked at, all within this step.
            None => {}
        }
    }
    Ok(())
}
