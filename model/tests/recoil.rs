//! Contacts that take time and act back on a suspended cylinder: against other integrations, and in the books of both bodies.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "common/brute.rs"]
mod brute;
#[path = "common/mounts.rs"]
mod mounts;

use brute::{Recorded, rk4, small_steps};
use mounts::{any_mount, compliant, follow_small_steps, positions, sensitivity};
use proptest::prelude::*;
use std::f64::consts::TAU;
use videg_model::{ExcitationKind, Harvester, Parameters};

prop_compose! {
    /// Any mount on a suspension that a ball of any weight acts back on.
    fn any_recoil()(
        p in any_mount(),
        stiffness in prop_oneof![Just(0.0), 0.1..1000.0_f64],
        damping in prop_oneof![Just(0.0), 0.01..10.0],
        heavier in prop_oneof![Just(1.0), 1.0..100.0],
        electrostatic_feedback in any::<bool>(),
    ) -> Parameters {
        compliant(Parameters {
            excitation_kind: ExcitationKind::Force,
            reaction: true,
            suspension_stiffness: if damping == 0.0 { stiffness.max(0.1) } else { stiffness },
            suspension_damping: damping,
            ball_mass: p.ball_mass * heavier,
            electrostatic_feedback,
            ..p
        })
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    #[test]
    fn contacts_on_a_suspended_cylinder_are_those_of_small_steps(p in any_recoil()) {
        let (p, until) = (Parameters { electrostatic_feedback: false, ..p }, 0.3);
        prop_assume!(sensitivity(p, 1e-7, until) < 1e-5);
        let steps = [2e-6, 1e-6].map(|dt| small_steps(&p, &Recorded::default(), until, dt));
        follow_small_steps(Harvester::new(&p, 0.0).unwrap(), &steps, until)?;
    }
}

/// Positions and velocities of cylinder and ball after steps of Runge and Kutta of the fourth order: elastic membranes, no friction.
fn elastic(p: &Parameters, until: f64, steps: u32) -> [f64; 4] {
    let slope = |time: f64, [z, b, v, w]: [f64; 4]| {
        let (dz, half) = (z - b, p.travel() / 2.0);
        let contact = p.stiffness * (dz.abs() - half).max(0.0).powf(p.stiffness_exponent) * dz.signum();
        let force = p.amplitude * (TAU * p.frequency * time + p.phase).cos()
            - p.suspension_stiffness * z
            - p.suspension_damping * v;
        [v, w, (force - contact) / p.cylinder_mass, contact / p.ball_mass - p.gravity * p.inclination.sin()]
    };
    let h = until / f64::from(steps);
    let start = [p.cylinder_position, p.ball_position, p.cylinder_velocity, p.ball_velocity];
    (0..steps).fold(start, |s, k| rk4(slope, h * f64::from(k), s, h))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(50))]

    #[test]
    fn elastic_contacts_are_those_of_runge_and_kutta(p in any_recoil()) {
        let p = Parameters { restitution: 1.0, friction: 0.0, electrostatic_feedback: false, ..p };
        let until = 0.5;
        // In metres at the end per metre at the begin.
        let growth = sensitivity(p, 1e-9, until) / 1e-9;
        prop_assume!(growth < 1e3);
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(until).unwrap();
        let [coarse, fine] = [50_000, 100_000].map(|steps| elastic(&p, until, steps));
        let found = positions(&harvester);
        for k in 0..4 {
            let open = (coarse[k] - fine[k]).abs();
            prop_assert!(
                (found[k] - fine[k]).abs() < 1e-11 * (1.0 + growth) + 3.0 * open,
                "{k}: {:e}, open {open:e}, growth {growth:e}", found[k] - fine[k]
            );
        }
    }

    #[test]
    fn the_books_of_both_bodies_close(p in any_recoil(), forces in prop::collection::vec((-0.5..0.5, -3e3..3e3_f64), 12)) {
        // Nothing but a force that is constant for a while excites the cylinder: its work is force times way.
        let p = Parameters { amplitude: 0.0, cylinder_velocity: 0.3, ..p };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        let start = harvester.energies();
        let (mut given, mut moved) = (0.0, start.ball + start.cylinder);
        for (force, voltage) in forces {
            harvester.set_external_force(force, 0.0).unwrap();
            harvester.set_voltages([voltage, -voltage], [0.0; 2]).unwrap();
            let from = harvester.cylinder_position();
            harvester.advance(harvester.time() + 0.173).unwrap();
            given += force * (harvester.cylinder_position() - from);
            let e = harvester.energies();
            moved += (force * (harvester.cylinder_position() - from)).abs() + e.gravity.abs() + e.electrical.abs();
            let of_ball = e.ball - start.ball + e.elastic + e.impact_loss + e.friction - e.wall - e.electrical - e.gravity;
            let of_both = e.ball + e.cylinder - start.ball - start.cylinder
                + (e.elastic + e.suspension + e.impact_loss + e.friction + e.damping)
                - (given + e.gravity + e.electrical);
            prop_assert!(of_ball.abs() < 1e-9 * moved, "{of_ball:e} of {moved:e}: {e:?}");
            prop_assert!(of_both.abs() < 1e-9 * moved, "{of_both:e} of {moved:e}: {e:?}");
            prop_assert!((e.excitation - given).abs() < 1e-9 * moved, "{} {given} of {moved:e}", e.excitation);
        }
    }

    #[test]
    fn accelerations_are_the_slopes_of_velocities(p in any_recoil(), time in 0.0..1.0) {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(time).unwrap();
        let begin = (harvester.next_knot(), harvester.totals().events());
        let accelerations = |h: &Harvester| [h.cylinder_acceleration(), h.ball_acceleration()];
        let velocities = |h: &Harvester| [h.cylinder_velocity(), h.ball_velocity()];
        let step = 1e-6;
        let [first, v0] = [accelerations(&harvester), velocities(&harvester)];
        harvester.advance(time + step).unwrap();
        let middle = accelerations(&harvester);
        harvester.advance(time + 2.0 * step).unwrap();
        let [last, v1] = [accelerations(&harvester), velocities(&harvester)];
        prop_assume!(begin == (harvester.next_knot(), harvester.totals().events())); // no corner between
        for k in 0..2 {
            let gained = step / 3.0 * (first[k] + 4.0 * middle[k] + last[k]);
            let size = first[k].abs() + last[k].abs();
            prop_assert!((v1[k] - v0[k] - gained).abs() < 1e-13 + 1e-3 * step * size, "{k}: {} {gained}", v1[k] - v0[k]);
        }
    }
}

#[test]
fn a_soft_suspension_tends_to_a_free_cylinder() {
    let free = compliant(Parameters { reaction: true, amplitude: 1.0, ball_mass: 0.02, ..Parameters::default() });
    let run = |p: &Parameters| {
        let mut harvester = Harvester::new(p, 0.0).unwrap();
        harvester.advance(0.8).unwrap();
        assert!(harvester.totals().impacts > 1);
        positions(&harvester)
    };
    let expected = run(&free);
    for (k, c) in [(1e-6, 0.0), (0.0, 1e-6), (1e-6, 1e-6)] {
        let found = run(&Parameters { suspension_stiffness: k, suspension_damping: c, ..free });
        assert!(mounts::difference(found, expected) < 1e-4, "{found:?} {expected:?}");
    }
}
