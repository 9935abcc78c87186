//! Inclination, suspension, friction, momentum-keeping impacts and prescribed motion, in any combination: against small steps of
//! Runge and Kutta with bisected events, and in the energy books.

#![allow(clippy::unwrap_used, clippy::panic, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};
use videg_model::{Case, ContactLaw, Event, ExcitationKind, Harvester, ModelError, NoiseModel, Parameters, Side};

/// What the ball does, in the brute-force integration.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Mode {
    /// It slides, with this sign of dz'.
    Slides(f64),
    /// The cylinder carries it; 0: by friction alone, else by the membrane at dz of this sign.
    Carried(f64),
}

/// Equations of motion, written down again.
#[derive(Clone)]
struct Brute {
    p: Parameters,
    dt: f64,
    time: f64,
    /// `z_M`, `z_M'`, `z_m`, `z_m'`.
    state: [f64; 4],
    mode: Mode,
    impacts: Vec<(f64, f64)>,
}

impl Brute {
    fn new(p: Parameters, dt: f64) -> Self {
        let state = [p.cylinder_position, p.cylinder_velocity, p.ball_position, p.ball_velocity];
        let mut brute = Self { p, dt, time: 0.0, state, mode: Mode::Slides(0.0), impacts: Vec::new() };
        brute.mode = brute.mode_of(state[1] - state[3]);
        brute
    }

    fn driven(&self) -> bool {
        self.p.excitation_kind == ExcitationKind::Motion
    }

    fn reacts(&self) -> bool {
        self.p.reaction && !self.driven()
    }

    /// Accelerations of cylinder and ball.
    fn accelerations(&self, time: f64, state: [f64; 4], mode: Mode) -> [f64; 2] {
        let p = &self.p;
        let (big, small) = (p.cylinder_mass, p.ball_mass);
        let cosine = (TAU * p.frequency * time + p.phase).cos();
        let weight = -small * p.gravity * p.inclination.sin();
        let force = p.amplitude * cosine - p.suspension_stiffness * state[0] - p.suspension_damping * state[1];
        match mode {
            Mode::Slides(slip) => {
                let friction = slip * p.friction * small * p.gravity * p.inclination.cos();
                let back = if self.reacts() { -friction } else { 0.0 };
                let of_cylinder = if self.driven() { p.acceleration * cosine } else { (force + back) / big };
                [of_cylinder, (weight + friction) / small]
            }
            Mode::Carried(_) => {
                let of_both = if self.driven() {
                    p.acceleration * cosine
                } else if p.reaction {
                    (force + weight) / (big + small)
                } else {
                    force / big
                };
                [of_both, of_both]
            }
        }
    }

    fn after(&self, h: f64) -> [f64; 4] {
        let slope = |time: f64, s: [f64; 4]| {
            let [a, b] = self.accelerations(time, s, self.mode);
            [s[1], a, s[3], b]
        };
        let plus = |s: [f64; 4], k: [f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|i| s[i] + h * k[i]) };
        let (t, s) = (self.time, self.state);
        let k1 = slope(t, s);
        let k2 = slope(t + 0.5 * h, plus(s, k1, 0.5 * h));
        let k3 = slope(t + 0.5 * h, plus(s, k2, 0.5 * h));
        let k4 = slope(t + h, plus(s, k3, h));
        std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }

    /// Force over m on a ball that moves with the cylinder.
    fn needed(&self) -> f64 {
        let [_, of_ball] = self.accelerations(self.time, self.state, Mode::Carried(0.0));
        of_ball + self.p.gravity * self.p.inclination.sin()
    }

    fn limit(&self) -> f64 {
        self.p.friction * self.p.gravity * self.p.inclination.cos()
    }

    /// Mode of a ball with this rate of dz, off the membranes.
    fn mode_of(&self, rate: f64) -> Mode {
        if self.p.friction == 0.0 {
            Mode::Slides(0.0)
        } else if rate != 0.0 {
            Mode::Slides(rate.signum())
        } else if self.needed().abs() <= self.limit() {
            Mode::Carried(0.0)
        } else {
            Mode::Slides(self.needed().signum())
        }
    }

    fn step(&mut self) {
        let half = self.p.travel() / 2.0;
        let mut rest = self.dt;
        for _ in 0..50 {
            if let Mode::Carried(side) = self.mode {
                let leaves =
                    if side == 0.0 { self.needed().abs() > self.limit() } else { side * self.needed() < -self.limit() };
                if leaves {
                    let slip = if side == 0.0 { self.needed().signum() } else { -side };
                    self.mode = Mode::Slides(if self.p.friction == 0.0 { 0.0 } else { slip });
                }
            }
            let dz = |s: &[f64; 4]| s[0] - s[2];
            let rate = |s: &[f64; 4]| s[1] - s[3];
            let over = |s: &Self, h: f64| -> f64 {
                // Positive: beyond a membrane, or sliding back.
                let there = s.after(h);
                let beyond = dz(&there).abs() - half;
                let outward = dz(&there) * rate(&there) > 0.0;
                let turned = match s.mode {
                    Mode::Slides(slip) if slip != 0.0 => -slip * rate(&there),
                    _ => -1.0,
                };
                (if outward { beyond } else { -1.0 }).max(turned)
            };
            if matches!(self.mode, Mode::Carried(_)) || over(self, rest) <= 0.0 {
                self.state = self.after(rest);
                self.time += rest;
                return;
            }
            let (mut a, mut b) = (0.0, rest);
            for _ in 0..60 {
                let middle = 0.5 * (a + b);
                if over(self, middle) > 0.0 { b = middle } else { a = middle }
            }
            (self.state, rest) = (self.after(b), rest - b);
            self.time += b;
            let side = dz(&self.state).signum();
            if dz(&self.state).abs() >= half - 1e-13 && side * rate(&self.state) > 0.0 {
                self.bounce(side);
            } else {
                self.state[3] = self.state[1];
                self.mode = self.mode_of(0.0);
            }
        }
    }

    fn bounce(&mut self, side: f64) {
        let (p, half) = (self.p, self.p.travel() / 2.0);
        let rate = self.state[1] - self.state[3];
        self.impacts.push((self.time, rate.abs()));
        let ratio = if self.reacts() { p.ball_mass / p.cylinder_mass } else { 0.0 };
        let change = (1.0 + p.restitution) * rate / (1.0 + ratio);
        self.state[1] -= ratio * change;
        self.state[3] += change;
        let rebound = (self.state[1] - self.state[3]).abs();
        let push = side * self.needed() * (1.0 + ratio);
        let friction = self.limit() * (1.0 + ratio);
        self.mode = self.mode_of(-side * rebound);
        let is_short = push > -friction && 2.0 * rebound / (push + friction) < 2.0 * self.dt;
        if is_short && push > friction {
            let both =
                (p.cylinder_mass * self.state[1] + p.ball_mass * self.state[3]) / (p.cylinder_mass + p.ball_mass);
            if self.reacts() {
                self.state[1] = both;
            }
            self.state[3] = self.state[1];
            self.state[2] = self.state[0] - side * half;
            self.mode = Mode::Carried(side);
        }
    }

    fn run(&mut self, until: f64) {
        while self.time < until - 0.5 * self.dt {
            self.step();
        }
    }
}

prop_compose! {
    fn any_mount()(
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
fn compliant(p: Parameters) -> Parameters {
    Parameters { contact_law: ContactLaw::Compliant, reaction: p.reaction && !p.is_suspended(), ..p }
}

fn positions(harvester: &Harvester) -> [f64; 4] {
    [harvester.cylinder_position(), harvester.ball_position(), harvester.cylinder_velocity(), harvester.ball_velocity()]
}

fn difference(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
}

/// Largest difference between two starts that differ by `nudge`, at `time`.
fn sensitivity(p: Parameters, nudge: f64, time: f64) -> f64 {
    let run = |p: Parameters| {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn the_motion_is_that_of_brute_force_until_chaos_separates_them(p in any_mount()) {
        let mut brute = Brute::new(p, 2e-5);
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        let mut impacts = Vec::new();
        for k in 1..=20 {
            let time = 0.1 * f64::from(k);
            brute.run(time);
            let mut seen = Vec::new();
            harvester.advance_with(brute.time, |event| {
                if let Event::Impact(impact) = event { seen.push((impact.time, impact.speed)) }
            }).unwrap();
            // The rule for a resting ball is right to a few steps.
            if sensitivity(p, 1e-7, brute.time) > 1e-5 {
                break;
            }
            impacts.extend(seen);
            let [z, v, b, w] = brute.state;
            let found = difference(positions(&harvester)[..2].try_into().map(|[a, c]: [f64; 2]| [a, c, 0.0, 0.0]).unwrap(), [z, b, 0.0, 0.0]);
            prop_assert!(found < 3e-5, "{found:e} m at {time} s, {} impacts\nours   {:?}\nbrute  {:?}\n{:?} {:?}", impacts.len(), positions(&harvester), [z, b, v, w], impacts, brute.impacts);
        }
        let resolved = |list: &[(f64, f64)]| list.iter().copied().filter(|(_, speed)| *speed > 1e-2).collect::<Vec<_>>();
        let (ours, theirs) = (resolved(&impacts), resolved(&brute.impacts));
        for (a, b) in ours.iter().zip(&theirs) {
            prop_assert!((a.0 - b.0).abs() < 1e-3 && (a.1 - b.1).abs() < 1e-3, "{a:?} {b:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn the_energy_books_close(p in any_mount(), force in -0.5..0.5_f64, is_compliant in any::<bool>()) {
        let p = if is_compliant { compliant(p) } else { p };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        let start = harvester.energies();
        harvester.advance(1.3).unwrap();
        harvester.set_external_force(force, -0.1).unwrap();
        harvester.advance(4.0).unwrap();
        let end = harvester.energies();
        let of_ball = end.ball - start.ball + end.elastic + end.impact_loss + end.friction;
        let given = end.wall + end.electrical + end.gravity;
        let moved = [end.ball, start.ball, end.wall, end.gravity, end.impact_loss, end.friction]
            .iter()
            .fold(1e-12, |sum: f64, value| sum + value.abs());
        prop_assert!((of_ball - given).abs() < 1e-9 * moved, "{:e} of {moved:e}: {end:?}", of_ball - given);
        prop_assert!(end.impact_loss >= 0.0 && end.friction >= 0.0 && end.damping >= 0.0);
    }

    #[test]
    fn splitting_a_run_changes_no_bit(
        p in any_mount(),
        noise in prop_oneof![Just(0.0), Just(0.5)],
        wiener in any::<bool>(),
        cuts in prop::collection::vec(0.0..2.0, 0..40),
        is_compliant in any::<bool>(),
    ) {
        let p = if is_compliant { compliant(p) } else { p };
        let noise_model = if wiener { NoiseModel::Wiener } else { NoiseModel::Held };
        let p = Parameters { phase_noise: noise, noise_hold: 1e-2, noise_model, ..p };
        let mut straight = Harvester::new(&p, 0.0).unwrap();
        straight.advance(2.0).unwrap();
        let mut split = Harvester::new(&p, 0.0).unwrap();
        let mut cuts = cuts;
        cuts.sort_by(f64::total_cmp);
        for cut in cuts {
            split.advance(cut).unwrap();
            if cut > 1.0 {
                split = Harvester::restore(&p, &split.snapshot()).unwrap();
            }
        }
        split.advance(2.0).unwrap();
        prop_assert_eq!(straight, split);
    }

    #[test]
    fn an_impact_comes_when_it_was_predicted_and_none_before(p in any_mount(), steps in prop::collection::vec(1e-3..0.05, 40)) {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        for step in steps {
            let (predicted, begin) = (harvester.next_impact(), harvester.time());
            let mut first = None;
            let until = predicted.map_or(begin + step, |time| time.min(begin + step));
            harvester.advance_with(until, |event| {
                if let Event::Impact(impact) = event { first = first.or(Some(impact.time)) }
            }).unwrap();
            match predicted {
                Some(time) if time <= begin + step => prop_assert_eq!(first, Some(time)),
                Some(_) => prop_assert_eq!(first, None),
                // It may lie behind more turns than are looked at, all within this step.
                None => {}
            }
        }
    }

    #[test]
    fn the_ball_never_leaves_the_gap(p in any_mount(), steps in prop::collection::vec(1e-4..0.05, 100)) {
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        for step in steps {
            harvester.advance(harvester.time() + step).unwrap();
            let beyond = harvester.relative_displacement().abs() - p.travel() / 2.0;
            prop_assert!(beyond < 1e-12, "{beyond:e} m beyond a membrane at {} s", harvester.time());
        }
    }
}

/// Small steps through membranes that are pressed in, with friction: dz and its rate, and the largest depth of the contact.
fn small_steps(p: &Parameters, until: f64, dt: f64) -> [f64; 4] {
    let half = p.travel() / 2.0;
    let mut s = [p.cylinder_position, p.cylinder_velocity, p.ball_position, p.ball_velocity];
    let mut largest = 0.0_f64;
    let ratio = if p.reaction { p.ball_mass / p.cylinder_mass } else { 0.0 };
    let friction = p.friction * p.gravity * p.inclination.cos() * (1.0 + ratio);
    let steps = (until / dt).round() as u64;
    for k in 0..steps {
        let time = (k as f64 + 0.5) * dt;
        let (dz, rate) = (s[0] + 0.5 * dt * s[1] - s[2] - 0.5 * dt * s[3], s[1] - s[3]);
        let (side, x) = (dz.signum(), (dz.abs() - half).max(0.0));
        largest = if x == 0.0 { 0.0 } else { largest.max(x) };
        let upper = p.stiffness * x.powf(p.stiffness_exponent);
        let lower = p.restitution * p.restitution * upper;
        let excitation = p.amplitude * (TAU * p.frequency * time + p.phase).cos();
        let of_cylinder =
            (excitation - p.suspension_stiffness * (s[0] + 0.5 * dt * s[1]) - p.suspension_damping * s[1])
                / p.cylinder_mass;
        let push = side * (of_cylinder + p.gravity * p.inclination.sin());
        let v = side * rate;
        // Relative accelerations that the membrane can give; at the largest depth anything between both.
        let [low, high] = [lower, upper].map(|force| force / p.ball_mass * (1.0 + ratio));
        let membrane = if x == 0.0 {
            0.0
        } else if x >= largest && v > 0.0 {
            high
        } else if x >= largest && v == 0.0 {
            push.clamp(low, high)
        } else {
            low
        };
        let free = v + dt * (push - membrane);
        let next = if free > dt * friction {
            free - dt * friction
        } else if free < -dt * friction {
            free + dt * friction
        } else {
            0.0
        };
        // A ball that would turn within the step stops, so that the next one decides.
        let next = if v * next < 0.0 { 0.0 } else { next };
        let internal = (push - (next - v) / dt) / (1.0 + ratio);
        let before = s;
        s[1] += dt * (of_cylinder - ratio * side * internal);
        s[3] = s[1] - side * next;
        s[0] += 0.5 * dt * (before[1] + s[1]);
        s[2] += 0.5 * dt * (before[3] + s[3]);
    }
    s
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    #[test]
    fn contacts_that_take_time_are_those_of_small_steps(p in any_mount()) {
        let p = compliant(Parameters { excitation_kind: ExcitationKind::Force, ..p });
        let until = 0.3;
        prop_assume!(sensitivity(p, 1e-7, until) < 1e-5);
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(until).unwrap();
        let [coarse, fine] = [2e-6, 1e-6].map(|dt| small_steps(&p, until, dt));
        let found = positions(&harvester);
        let expected = [fine[0], fine[2], fine[1], fine[3]];
        // What the steps themselves leave open.
        let open = (0..4).fold(0.0, |largest: f64, k| largest.max((coarse[k] - fine[k]).abs()));
        prop_assert!((found[0] - expected[0]).abs() < 1e-5 + 3.0 * open);
        prop_assert!((found[1] - expected[1]).abs() < 1e-5 + 3.0 * open, "{found:?}, {expected:?}, {open:e}");
    }
}

#[test]
fn friction_lowers_the_voltage_gain_of_figure_14() {
    let p = Parameters {
        friction: 0.05,
        ball_velocity: 0.0,
        ball_position: 0.0,
        cylinder_position: 0.0,
        ..(Case::find("fig14").unwrap().parameters)()
    };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(30.0).unwrap();
    let gained = harvester.totals().voltage_gain;
    harvester.advance(60.0).unwrap();
    let gain = (harvester.totals().voltage_gain - gained) / 30.0;
    assert!((gain - 7112.094).abs() < 1e-3, "{gain}");
}

#[test]
fn gravity_makes_a_ball_rest_for_ever_on_the_lower_membrane() {
    let p = Parameters { inclination: 0.5, amplitude: 0.1, ..Parameters::default() };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(1e5).unwrap();
    assert_eq!(harvester.resting(), Some(Side::Left));
    assert!(harvester.totals().events() < 100, "{:?}", harvester.totals());
    assert_eq!(harvester.next_impact(), None);
}

/// Accelerations that friction just holds, or just does not: neither is left by rounding, again and again.
#[test]
fn a_ball_at_the_limit_of_friction_does_not_set_out_and_halt_for_ever() {
    let mu_g = 0.39 * 9.80665;
    for amplitude in
        [3.824_593_5, mu_g, f64::next_up(mu_g), f64::next_down(mu_g), mu_g * (1.0 + 1e-13), mu_g * (1.0 + 1e-9)]
    {
        let p = Parameters { cylinder_mass: 1.0, amplitude, friction: 0.39, ..Parameters::default() };
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(2.0).unwrap();
        assert!(harvester.relative_displacement().abs() < 1e-6, "{}", harvester.relative_displacement());
    }
    // As steep as friction holds, with the cylinder at rest: a push starts the ball, friction never stops it.
    for beta in [0.3_f64, FRAC_PI_4, 0.2] {
        let p = Parameters {
            inclination: beta,
            friction: beta.tan(),
            ball_velocity: -0.01,
            amplitude: 0.05,
            ..Parameters::default()
        };
        let mut brute = Brute::new(p, 1e-5);
        brute.run(4.0);
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(brute.time).unwrap();
        let expected = brute.state[0] - brute.state[2];
        assert!(
            (harvester.relative_displacement() - expected).abs() < 1e-5,
            "{beta}: {} {expected}",
            harvester.relative_displacement()
        );
    }
}

/// A force that jumps and is over before the piece of a suspended motion is.
#[test]
fn a_stuck_ball_is_torn_off_by_a_jump_of_force_that_a_damper_takes_back() {
    let p = Parameters {
        cylinder_mass: 1.0,
        suspension_damping: 1.0,
        amplitude: 0.0,
        frequency: 0.01,
        gravity: 10.0,
        friction: 0.1,
        ..Parameters::default()
    };
    let mut harvester = Harvester::new(&p, 0.0).unwrap();
    harvester.advance(0.5).unwrap();
    assert!(harvester.is_stuck());
    harvester.set_external_force(1.2, 0.0).unwrap();
    harvester.advance(3.0).unwrap();
    // The cylinder has the acceleration 1.2 e^-t, the ball 1: until both are as fast again.
    let velocity = |t: f64| 1.2 * (1.0 - (-t).exp()) - t;
    let (mut low, mut high) = (0.2, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if velocity(middle) > 0.0 { low = middle } else { high = middle }
    }
    let way = 1.2 * (low + (-low).exp() - 1.0) - 0.5 * low * low;
    assert!(
        way > 4e-3 && (harvester.relative_displacement() - way).abs() < 1e-12,
        "{}",
        harvester.relative_displacement()
    );
    assert!(harvester.is_stuck());
}

#[test]
fn an_external_force_moves_no_shaker_with_or_without_noise() {
    for noise in [0.0, 0.5] {
        let p = Parameters {
            excitation_kind: ExcitationKind::Motion,
            acceleration: 4.0,
            phase_noise: noise,
            noise_hold: 1e-3,
            ..Parameters::default()
        };
        let [mut pushed, mut alone] = [p, p].map(|p| Harvester::new(&p, 0.0).unwrap());
        pushed.set_external_force(1.0, 0.5).unwrap();
        for time in [0.1, 0.5, 2.0] {
            pushed.advance(time).unwrap();
            alone.advance(time).unwrap();
            assert_eq!(positions(&pushed), positions(&alone));
            let taken = pushed.mount_force() - alone.mount_force();
            assert!((taken + 1.0 + 0.5 * time).abs() < 1e-12, "{taken} N at {time} s");
        }
    }
}

#[test]
fn friction_without_weight_is_none() {
    let p = Parameters { friction: 0.1, gravity: 0.0, ..(Case::find("fig14").unwrap().parameters)() };
    let [mut with, mut without] = [p, Parameters { friction: 0.0, ..p }].map(|p| Harvester::new(&p, 0.0).unwrap());
    with.advance(5.0).unwrap();
    without.advance(5.0).unwrap();
    assert_eq!(positions(&with), positions(&without));
    assert_eq!(Harvester::restore(&p, &with.snapshot()).unwrap(), with);
}

#[test]
fn a_suspension_needs_a_force_and_a_mass_that_it_can_move() {
    let stiff = Parameters { suspension_stiffness: 10.0, ..Parameters::default() };
    let driven = Parameters { excitation_kind: ExcitationKind::Motion, ..stiff };
    assert!(matches!(driven.validate(), Err(ModelError::NeedsForce { name: "cylinder.suspensionStiffness", .. })));
    let too_stiff = Parameters { cylinder_mass: 1e-3, suspension_damping: 1e3, ..stiff };
    let error = too_stiff.validate().unwrap_err().to_string();
    assert!(error.starts_with("cylinder.suspensionDamping = 1e3 N.s/m is too large for cylinder.mass"), "{error}");
}
