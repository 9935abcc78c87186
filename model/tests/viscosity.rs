//! Viscous films: against a stiff integration by another method, in the books, and in both limits of the relaxation time.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "common/brute.rs"]
mod brute;
#[path = "common/film.rs"]
mod film;
#[path = "common/mounts.rs"]
mod mounts;

use brute::{Recorded, small_steps_in};
use film::{Film, any_film};
use mounts::{any_mount, close_books, follow_small_steps, sensitivity, straight_and_split};
use proptest::prelude::*;
use videg_model::{ContactLaw, ExcitationKind, Harvester, MembraneLaw, ModelError, Parameters, Side};

/// The ball between two films at rest, written down again: dz, its rate and the creep of both films.
struct Reference {
    film: Film,
}

type State = [f64; 4];

impl Reference {
    /// Which films push, and which would be slack by themselves.
    fn phase(&self, [dz, _, left, right]: State) -> [bool; 4] {
        let half = self.film.p.travel() / 2.0;
        let pushes = [self.film.film(dz - half, left)[0] > 0.0, self.film.film(-dz - half, right)[0] > 0.0];
        [pushes[0], pushes[1], self.film.is_slack(left), self.film.is_slack(right)]
    }

    fn slope(&self, [dz, rate, left, right]: State) -> State {
        let half = self.film.p.travel() / 2.0;
        let [of_left, left] = self.film.film(dz - half, left);
        let [of_right, right] = self.film.film(-dz - half, right);
        [rate, (of_right - of_left) / self.film.p.ball_mass, left, right]
    }

    /// A step of Radau IIA of the fifth order; none if its equations are not solved.
    fn step(&self, state: State, h: f64) -> Option<State> {
        let s6 = 6.0_f64.sqrt();
        let a = [
            [(88.0 - 7.0 * s6) / 360.0, (296.0 - 169.0 * s6) / 1800.0, (-2.0 + 3.0 * s6) / 225.0],
            [(296.0 + 169.0 * s6) / 1800.0, (88.0 + 7.0 * s6) / 360.0, (-2.0 - 3.0 * s6) / 225.0],
            [(16.0 - s6) / 36.0, (16.0 + s6) / 36.0, 1.0 / 9.0],
        ];
        // The stages' increments by Newton's method with the Jacobian of the begin.
        let here = self.slope(state);
        let mut jacobian = [[0.0; 4]; 4];
        for k in 0..4 {
            let nudge = [1e-9, 1e-9, 1e-9, 1e-9][k];
            let mut moved = state;
            moved[k] += nudge;
            let there = self.slope(moved);
            for j in 0..4 {
                jacobian[j][k] = (there[j] - here[j]) / nudge;
            }
        }
        let matrix: [[f64; 12]; 12] = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let unit = if row == column { 1.0 } else { 0.0 };
                unit - h * a[row / 4][column / 4] * jacobian[row % 4][column % 4]
            })
        });
        let mut z = [0.0; 12];
        let mut last = f64::INFINITY;
        for _ in 0..30 {
            let slopes: [State; 3] =
                std::array::from_fn(|stage| self.slope(std::array::from_fn(|k| state[k] + z[4 * stage + k])));
            let missing: [f64; 12] = std::array::from_fn(|row| {
                let sum: f64 = (0..3).map(|stage| a[row / 4][stage] * slopes[stage][row % 4]).sum();
                h * sum - z[row]
            });
            let by = solve(matrix, missing);
            z.iter_mut().zip(by).for_each(|(z, by)| *z += by);
            let size = by.iter().map(|by| by.abs()).sum::<f64>();
            if !size.is_finite() || size < 1e-17 || (size < 1e-14 && size >= last) {
                return z.iter().all(|z| z.is_finite()).then(|| std::array::from_fn(|k| state[k] + z[8 + k]));
            }
            last = size;
        }
        None
    }

    /// The state after each of `times`; a step and two of half its length differ by less than `tolerance`.
    fn run(&self, times: &[f64], tolerance: f64) -> Vec<State> {
        let mut state = [-self.film.p.ball_position, -self.film.p.ball_velocity, 0.0, 0.0];
        let scale = [self.film.p.travel(), self.film.p.ball_velocity.abs(), 1e-2, 1e-2];
        let mut states = Vec::new();
        let (mut time, mut h) = (0.0, 1e-6);
        for end in times {
            while time < *end {
                let step = f64::min(h, end - time);
                let halves = self.step(state, 0.5 * step).and_then(|middle| self.step(middle, 0.5 * step));
                let (Some(whole), Some(halves)) = (self.step(state, step), halves) else {
                    h = 0.2 * step;
                    continue;
                };
                // A step that leaves a film behind would not see the rest of its force, and where a slack film is flat again its
                // recovery has a kink.
                if step > 1e-9 && self.phase(halves) != self.phase(state) {
                    h = 0.3 * step;
                    continue;
                }
                let error = (0..4).fold(0.0_f64, |most, k| most.max((whole[k] - halves[k]).abs() / scale[k]));
                if error <= tolerance || step < 1e-10 {
                    state = halves;
                    time = if step == end - time { *end } else { time + step };
                }
                h = step * (0.9 * (tolerance / error.max(1e-300)).powf(1.0 / 6.0)).clamp(0.2, 4.0);
            }
            states.push(state);
        }
        states
    }
}

fn solve(mut a: [[f64; 12]; 12], mut b: [f64; 12]) -> [f64; 12] {
    for k in 0..12 {
        let pivot = (k..12).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for j in k + 1..12 {
            let factor = a[j][k] / a[k][k];
            let above = a[k];
            a[j].iter_mut().zip(above).for_each(|(value, above)| *value -= factor * above);
            b[j] -= factor * b[k];
        }
    }
    for k in (0..12).rev() {
        b[k] = (b[k] - (k + 1..12).map(|m| a[k][m] * b[m]).sum::<f64>()) / a[k][k];
    }
    b
}

/// Creep of both films.
fn creeps(harvester: &Harvester) -> [f64; 2] {
    Side::BOTH.map(|side| harvester.creep(side))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn contacts_and_recovery_are_those_of_a_stiff_integration(film in any_film(), speed in 0.05..1.5_f64, mass in 1e-3..2e-2_f64) {
        let p = Parameters { amplitude: 0.0, ball_velocity: speed, ball_mass: mass, ..film };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        let begin = p.travel() / 2.0 / speed;
        // Through the first contact, and on to the second.
        let contact = 4.0 * (mass / 100.0).sqrt();
        let mut times: Vec<f64> = vec![begin];
        times.extend((1..=8).map(|k| begin + contact * f64::from(k) / 8.0));
        times.extend((1..=4).map(|k| begin + contact + 0.5 * begin * f64::from(k)));
        let reference = Reference { film: Film { p } };
        let [coarse, fine] = [1e-11, 1e-12].map(|tolerance| reference.run(&times, tolerance));
        for ((time, coarse), fine) in times.iter().zip(&coarse).zip(&fine) {
            harvester.advance(*time).unwrap();
            let rate = harvester.cylinder_velocity() - harvester.ball_velocity();
            let [left, right] = creeps(&harvester);
            let found = [harvester.relative_displacement(), rate, left, right];
            let scale = [p.travel(), speed, 1e-2, 1e-2];
            for k in 0..4 {
                // What the reference itself leaves open.
                let open = (coarse[k] - fine[k]).abs();
                prop_assert!(
                    (found[k] - fine[k]).abs() < 1e-8 * scale[k] + 3.0 * open && open < 1e-8 * scale[k],
                    "{k} at {time}: {} for {}, open {open:e}\n{p:?}", found[k], fine[k]
                );
            }
        }
    }
}

prop_compose! {
    /// Such a film on any mount.
    fn any_mounted_film()(mount in any_mount(), film in any_film(), electrostatic_feedback in prop::bool::weighted(0.2)) -> Parameters {
        Parameters {
            amplitude: 0.2 * mount.amplitude, // a film takes up the energy of a slow ball
            frequency: mount.frequency,
            phase: mount.phase,
            inclination: mount.inclination,
            gravity: mount.gravity,
            friction: mount.friction,
            reaction: mount.reaction,
            ball_mass: 0.2 * mount.ball_mass,
            excitation_kind: mount.excitation_kind,
            acceleration: 0.2 * mount.acceleration,
            suspension_stiffness: mount.suspension_stiffness,
            suspension_damping: mount.suspension_damping,
            ball_position: mount.ball_position,
            ball_velocity: mount.ball_velocity,
            electrostatic_feedback,
            bias_voltage: 500.0, // far from pull-in
            ..film
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn the_energy_books_close_with_the_viscous_loss(p in any_mounted_film(), force in -0.5..0.5_f64) {
        close_books(Harvester::new(&p, 0.0).unwrap(), force)?;
    }

    #[test]
    fn splitting_a_run_changes_no_bit(p in any_mounted_film(), cuts in prop::collection::vec(0.0..2.0, 0..40)) {
        let [straight, split] = straight_and_split(&p, cuts);
        prop_assert_eq!(straight.snapshot(), split.snapshot());
        prop_assert_eq!(straight.energies(), split.energies());
        prop_assert_eq!(straight.next_knot(), split.next_knot());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    #[test]
    fn contacts_with_friction_on_any_mount_are_those_of_small_steps(p in any_mounted_film(), time in -3.0..1.0_f64) {
        let p = Parameters {
            excitation_kind: ExcitationKind::Force,
            electrostatic_feedback: false,
            relaxation_time: 10_f64.powf(time),
            ..p
        };
        let until = 0.3;
        prop_assume!(sensitivity(p, 1e-7, until) < 1e-5);
        let steps = [2e-6, 1e-6].map(|dt| {
            let (film, mut creeps) = (Film { p }, [0.0; 2]);
            // The creep of both sides, of which at most one is pressed.
            let membrane = |side: f64, x: f64, _: f64| {
                let [force, flow] = film.film(x, creeps[usize::from(side > 0.0)]);
                creeps[usize::from(side > 0.0)] += dt * flow;
                let other = usize::from(side <= 0.0);
                creeps[other] += dt * film.film(0.0, creeps[other])[1];
                [force; 2]
            };
            small_steps_in(&p, &Recorded::default(), until, dt, membrane)
        });
        follow_small_steps(Harvester::new(&p, 0.0).unwrap(), &steps, until)?;
    }
}

fn film(viscous_modulus: f64, relaxation_time: f64) -> Parameters {
    Parameters {
        contact_law: ContactLaw::Compliant,
        membrane_law: MembraneLaw::Gent,
        restitution: 0.3, // not used
        amplitude: 0.0,
        ball_velocity: 0.4,
        viscous_modulus,
        relaxation_time,
        ..Parameters::default()
    }
}

/// The same film without a pre-stretch: a film that has given way is slack, whatever little.
fn unstretched(p: Parameters) -> Parameters {
    Parameters { prestretch: 1.0, initial_radius: 0.0063, initial_thickness: 0.00025, ..p }
}

/// Rebound speed over impact speed of the first impact.
fn rebound(p: &Parameters) -> f64 {
    let mut harvester = Harvester::new(p, 0.0).unwrap();
    harvester.advance(0.054).unwrap();
    assert_eq!(harvester.effective_restitution(), 0.0, "no impact is over");
    harvester.advance(0.13).unwrap();
    let expected = -harvester.ball_velocity() / p.ball_velocity;
    assert!((harvester.effective_restitution() / expected - 1.0).abs() < 1e-12);
    harvester.effective_restitution()
}

#[test]
fn both_limits_of_the_relaxation_time_are_elastic() {
    let loss = |time: f64| 1.0 - rebound(&film(90e3, time));
    for [far, near] in [[1e-6, 1e-5], [1e4, 1e3]] {
        let [far, near] = [far, near].map(loss);
        assert!(far < 1e-3 && far > 0.0, "{far}");
        assert!((near / far - 10.0).abs() < 0.5, "{near} {far}");
    }
    assert!(loss(1e-2) > 100.0 * loss(1e-6) && loss(1e-2) > 100.0 * loss(1e4));
}

#[test]
fn without_modulus_or_time_there_is_no_branch() {
    for [modulus, time] in [[0.0, 1.0], [1e5, 0.0]] {
        let p = film(modulus, time);
        assert!((rebound(&p) - p.restitution).abs() < 1e-8);
    }
    let impulsive = Parameters { contact_law: ContactLaw::Impulsive, ..film(0.0, 0.0) };
    let mut harvester = Harvester::new(&impulsive, 0.0).unwrap();
    assert_eq!(harvester.effective_restitution(), 0.0);
    harvester.advance(1.0).unwrap();
    assert_eq!(harvester.effective_restitution(), 0.3);
}

#[test]
fn a_pushed_ball_comes_to_rest_where_the_elastic_film_carries_it() {
    for time in [1e-3, 1e-2, 0.1] {
        let p = unstretched(film(2e6, time));
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.set_external_force(-2.0 * p.cylinder_mass, 0.0).unwrap();
        harvester.advance(100.0).unwrap();
        let impacts = harvester.totals().impacts;
        harvester.advance(101.0).unwrap();
        assert_eq!(harvester.totals().impacts, impacts, "still bouncing");
        let deflection = harvester.deflection(Side::Right);
        let carried = harvester.membrane().force(deflection.value) / (2.0 * p.ball_mass);
        assert!((carried - 1.0).abs() < 1e-3, "{carried} of the push at tau = {time} s, {deflection:?}");
    }
}

#[test]
fn a_film_of_which_the_ball_is_gone_recovers() {
    // Much stiffer than the film: it goes slack, and the ball leaves it there.
    let p = unstretched(film(2e6, 0.02));
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    let mut over = None;
    while over.is_none() {
        harvester.advance(harvester.time() + 1e-4).unwrap();
        over = (harvester.effective_restitution() > 0.0).then_some(harvester.time());
    }
    let mut before = harvester.deflection(Side::Right);
    assert!(before.value > 1e-4 && before.rate < 0.0, "{before:?}");
    let first = before.value;
    loop {
        let (time, energies) = (harvester.time(), harvester.energies());
        harvester.advance(time + 1e-3).unwrap();
        if harvester.totals().impacts > 1 {
            break;
        }
        let (now, after) = (harvester.deflection(Side::Right), harvester.energies());
        let fallen = 0.5e-3 * (before.rate + now.rate);
        assert!(
            now.value < before.value && ((now.value - before.value) / fallen - 1.0).abs() < 0.1,
            "{before:?} {now:?}"
        );
        let lost = after.viscous - energies.viscous;
        assert!(
            lost >= 0.0 && (energies.elastic - after.elastic - lost).abs() < 1e-12 * energies.viscous,
            "{lost:e} {energies:?}"
        );
        before = now;
    }
    assert!(before.value < 0.95 * first, "{} of {first}", before.value);
}

#[test]
fn what_has_no_viscosity_is_refused() {
    let branch = film(9e4, 0.1);
    for p in [
        Parameters { contact_law: ContactLaw::Impulsive, ..branch },
        Parameters { membrane_law: MembraneLaw::Power, ..branch },
    ] {
        assert!(matches!(p.validate(), Err(ModelError::NeedsFilm { .. })));
    }
    let heavy = Parameters { ball_mass: 5.0, stretch_limit: 6.0, ..branch };
    let error = Harvester::new(&heavy, 0.0).unwrap().advance(1.0).unwrap_err();
    assert!(matches!(error, ModelError::HitsLimit { .. }), "{error}");
    let error = Parameters { relaxation_time: 1e-7, ..branch }.validate().unwrap_err().to_string();
    assert_eq!(error, "membrane.relaxationTime = 1e-7 s must be 0 (no viscosity) or at least 1e-6 s");
}
