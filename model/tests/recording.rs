//! Recorded excitation in any combination with mounts, contact laws, noise and external force: against small steps, in the energy
//! books, and in how runs are split.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "common/brute.rs"]
mod brute;
#[path = "common/mounts.rs"]
mod mounts;

use std::f64::consts::TAU;

use brute::{Brute, Line, Recorded, small_steps};
use mounts::{
    any_mount, close_books, compliant, difference, follow_brute_force, follow_small_steps, meet_predictions, positions,
    sensitivity_of,
};
use proptest::prelude::*;
use videg_model::{
    Case, Direction, ExcitationKind, Harvester, ModelError, NoiseModel, Parameters, Quantity, Recording,
};

prop_compose! {
    /// Samples at irregular times, with jumps and stretches without a change.
    fn any_samples()(
        first in -0.5..0.5,
        steps in prop::collection::vec(
            (prop_oneof![1e-3..1e-1, Just(1e-2), Just(1e-6), 0.1..0.8], prop_oneof![4 => (-1.0..1.0).prop_map(Some), 1 => Just(None)]),
            1..40,
        ),
    ) -> (Vec<f64>, Vec<f64>) {
        // A shorter one would be repeated too often for small steps.
        let (mut times, mut values) = (vec![first, first + 0.05], vec![steps[0].1.unwrap_or(0.0); 2]);
        for (step, value) in steps {
            times.push(times.last().unwrap() + step);
            values.push(value.unwrap_or(*values.last().unwrap()));
        }
        (times, values)
    }
}

/// What excites a harvester, for the model and for small steps.
#[derive(Debug, Clone)]
struct Excitation {
    p: Parameters,
    recording: Recording,
    recorded: Recorded,
}

impl Excitation {
    fn harvester_with(&self, p: &Parameters) -> Harvester {
        Harvester::new(p.with_recording(Some(&self.recording)), 0.0).unwrap()
    }

    fn harvester(&self) -> Harvester {
        self.harvester_with(&self.p)
    }

    fn with(self, change: impl FnOnce(Parameters) -> Parameters) -> Self {
        Self { p: change(self.p), ..self }
    }

    fn sensitivity(&self, time: f64) -> f64 {
        sensitivity_of(self.p, &|p| self.harvester_with(&p), 1e-7, time)
    }
}

prop_compose! {
    fn any_excitation()(
        p in any_mount(),
        samples in any_samples(),
        scale in prop_oneof![Just(1.0), -2.0..2.0],
        offset in prop_oneof![Just(0.0), -1.0..1.0],
        repeats in any::<bool>(),
        is_alone in any::<bool>(),
    ) -> Excitation {
        let size = if p.excitation_kind == ExcitationKind::Motion { 10.0 } else { 1.0 };
        let (times, values) = samples;
        let values: Vec<f64> = values.iter().map(|value| size * value).collect();
        let recording = Recording::new(p.excitation_kind, times.clone(), values.clone()).unwrap();
        let p = Parameters { file_scale: scale, file_offset: offset, file_repeat: repeats, ..p };
        let p = if is_alone { Parameters { amplitude: 0.0, acceleration: 0.0, ..p } } else { p };
        Excitation { p, recording, recorded: Recorded { times, values, scale, offset, repeats, ..Recorded::default() } }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn the_motion_is_that_of_brute_force_until_chaos_separates_them(
        excitation in any_excitation(), force in prop_oneof![Just([0.0; 2]), [-0.3..0.3, -0.1..0.1]],
    ) {
        let brute = Brute::excited(excitation.p, excitation.recorded.clone(), force, 2e-5);
        let mut harvester = excitation.harvester();
        harvester.set_external_force(force[0], force[1]).unwrap();
        follow_brute_force(harvester, brute, [3e-5; 2], |time| excitation.sensitivity(time))?;
    }

    #[test]
    fn the_energy_books_close(excitation in any_excitation(), force in -0.5..0.5_f64, is_compliant in any::<bool>()) {
        let excitation = if is_compliant { excitation.with(compliant) } else { excitation };
        close_books(excitation.harvester(), force)?;
    }

    #[test]
    fn splitting_a_run_changes_no_bit(
        excitation in any_excitation(),
        noise in prop_oneof![Just(0.0), Just(0.5)],
        wiener in any::<bool>(),
        cuts in prop::collection::vec(0.0..2.0, 0..60),
        force in prop_oneof![Just([0.0; 2]), [-0.3..0.3, -0.1..0.1]],
        is_compliant in any::<bool>(),
    ) {
        let excitation = if is_compliant { excitation.with(compliant) } else { excitation };
        let noise_model = if wiener { NoiseModel::Wiener } else { NoiseModel::Held };
        let excitation = excitation.with(|p| Parameters { phase_noise: noise, noise_hold: 1e-2, noise_model, ..p });
        let [mut straight, mut split] = [(); 2].map(|()| excitation.harvester());
        for harvester in [&mut straight, &mut split] {
            harvester.set_external_force(force[0], force[1]).unwrap();
        }
        straight.advance(2.0).unwrap();
        let mut cuts = cuts;
        cuts.sort_by(f64::total_cmp);
        for cut in cuts {
            split.advance(cut).unwrap();
            if cut > 1.0 {
                let setup = excitation.p.with_recording(Some(&excitation.recording));
                split = Harvester::restore(setup, &split.snapshot()).unwrap();
            }
        }
        split.advance(2.0).unwrap();
        // Saved states have no changes under a force that was set before.
        prop_assert_eq!(positions(&straight).map(f64::to_bits), positions(&split).map(f64::to_bits));
        prop_assert_eq!(straight.totals(), split.totals());
        prop_assert_eq!(straight.energies(), split.energies());
        prop_assert_eq!(straight.next_impact(), split.next_impact());
        prop_assert_eq!(straight.next_knot(), split.next_knot());
        if force == [0.0; 2] {
            prop_assert_eq!(straight.snapshot(), split.snapshot());
        }
    }

    #[test]
    fn an_impact_comes_when_it_was_predicted_and_none_before(
        excitation in any_excitation(), steps in prop::collection::vec(1e-3..0.05, 40),
    ) {
        meet_predictions(excitation.harvester(), &steps)?;
    }

    #[test]
    fn a_constant_recording_is_an_external_force(
        p in any_mount(), force in -0.5..0.5_f64, noise in prop_oneof![Just(0.0), Just(0.5)], is_compliant in any::<bool>(),
    ) {
        let p = if is_compliant { compliant(p) } else { p };
        let p = Parameters { phase_noise: noise, noise_hold: 1e-2, excitation_kind: ExcitationKind::Force, ..p };
        let recording = Recording::new(ExcitationKind::Force, vec![-1.0, 0.3, 3.0], vec![force; 3]).unwrap();
        let recorded = |p: Parameters| Harvester::new(p.with_recording(Some(&recording)), 0.0).unwrap();
        let (mut pushed, mut excited) = (Harvester::new(&p, 0.0).unwrap(), recorded(p));
        pushed.set_external_force(force, 0.0).unwrap();
        for time in [0.2, 0.5, 1.0, 2.0] {
            if sensitivity_of(p, &recorded, 1e-9, time) > 1e-5 {
                break;
            }
            pushed.advance(time).unwrap();
            excited.advance(time).unwrap();
            let found = difference(positions(&pushed), positions(&excited));
            prop_assert!(found < 1e-6, "{found:e} at {time} s: {:?} {:?}", positions(&pushed), positions(&excited));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    #[test]
    fn contacts_that_take_time_are_those_of_small_steps(excitation in any_excitation()) {
        prop_assume!(excitation.p.excitation_kind == ExcitationKind::Force);
        let excitation = excitation.with(compliant);
        let until = 0.3;
        prop_assume!(excitation.sensitivity(until) < 1e-5);
        let steps = [2e-6, 1e-6].map(|dt| small_steps(&excitation.p, &excitation.recorded, until, dt));
        follow_small_steps(excitation.harvester(), &steps, until)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Changes that are carried along, across samples, impacts and rests, against those of two runs.
    #[test]
    fn derivatives_are_the_limits_of_differences(
        excitation in any_excitation(), which in 0_usize..8, force in -0.3..0.3_f64, inclination in -0.3..0.3,
    ) {
        let plain = |p: Parameters| Parameters { friction: 0.0, suspension_stiffness: 0.0, suspension_damping: 0.0, reaction: false, inclination, ..p };
        let excitation = excitation.with(plain);
        let names = ["excitation.amplitude", "excitation.frequency", "membrane.restitution", "initial.ballVelocity", "gravity", "initial.cylinderPosition", "excitation.fileScale", "excitation.fileOffset"];
        let direction = Direction::of_parameter(names[which]).unwrap();
        let quantity: &Quantity = Parameters::TABLE.iter().find(|quantity| quantity.name == names[which]).unwrap();
        let run = |step: f64| {
            let mut p = excitation.p;
            (quantity.set)(&mut p, (quantity.get)(&excitation.p) + step);
            let mut harvester = Harvester::along(p.with_recording(Some(&excitation.recording)), 0.0, force, &direction).unwrap();
            harvester.advance(0.7).unwrap();
            harvester
        };
        let value = (quantity.get)(&excitation.p);
        prop_assume!(value > quantity.min + 1e-4 && value < quantity.max - 1e-4);
        let (here, h) = (run(0.0), 1e-7);
        let changes = here.sensitivities();
        let [below, above] = [-h, h].map(run);
        let far = [-4.0 * h, 4.0 * h].map(run);
        let slope = |a: &Harvester, b: &Harvester, h: f64| (b.relative_displacement() - a.relative_displacement()) / (2.0 * h);
        let (near, wide) = (slope(&below, &above, h), slope(&far[0], &far[1], 4.0 * h));
        // Where an impact, a rest or chaos lies between the runs, there is no derivative to compare with.
        let same = [&below, &above, &far[0], &far[1]].iter().all(|other| other.totals().events() == here.totals().events());
        prop_assume!(same && (near - wide).abs() < 1e-4 * (1.0 + near.abs()) && near.abs() < 1e3);
        prop_assert!((changes.relative_displacement - near).abs() < 1e-3 * (1.0 + near.abs()), "{} {near} {wide}", changes.relative_displacement);
    }
}

/// The harmonic force of Fig. 14 in samples: lines between them leave out what shrinks with the square of their distance.
#[test]
fn a_sampled_cosine_comes_close_to_the_cosine_with_the_square_of_the_number_of_samples() {
    let p = (Case::find("fig14").unwrap().parameters)();
    let error = |n: u32| {
        let until = 0.8;
        let times: Vec<f64> = (0..=n).map(|k| until * f64::from(k) / f64::from(n)).collect();
        let values = times.iter().map(|time| p.amplitude * (TAU * p.frequency * time + p.phase).cos()).collect();
        let recording = Recording::new(ExcitationKind::Force, times, values).unwrap();
        let silent = Parameters { amplitude: 0.0, ..p };
        let mut sampled = Harvester::new(silent.with_recording(Some(&recording)), 0.0).unwrap();
        let mut harmonic = Harvester::new(&p, 0.0).unwrap();
        sampled.advance(until).unwrap();
        harmonic.advance(until).unwrap();
        difference(positions(&sampled), positions(&harmonic))
    };
    let errors = [200, 400, 800, 1600].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.05, "{errors:?}: order {order}");
    }
}

#[test]
fn a_recording_that_is_none_or_not_the_one_is_refused_with_its_value_and_bound() {
    let force = |times: &[f64], values: &[f64]| Recording::new(ExcitationKind::Force, times.to_vec(), values.to_vec());
    let text = |times: &[f64], values: &[f64]| force(times, values).unwrap_err().to_string();
    assert_eq!(text(&[0.0], &[1.0]), "a recording has 1 samples: at least 2, at most 1000000");
    let many = vec![0.0; 1_000_001];
    assert_eq!(text(&many, &many), "a recording has 1000001 samples: at least 2, at most 1000000");
    assert_eq!(text(&[0.0, 1.0], &[1.0]), "a recording has 2 times and 1 values: each sample needs both");
    assert_eq!(
        text(&[0.0, 1.0, 0.5], &[0.0; 3]),
        "point 2 (from 0) of the recording: time = 0.5 s must exceed that of the point before, 1 s, by 1e-12 s"
    );
    assert_eq!(
        text(&[0.0, 1.0], &[0.0, f64::NAN]),
        "point 1 (from 0) of the recording: force = NaN N is outside [-1e12, 1e12] N"
    );
    assert_eq!(
        text(&[f64::NEG_INFINITY, 1.0], &[0.0, 2.0]),
        "point 0 (from 0) of the recording: time = -inf s is outside [-1e9, 1e9] s"
    );
    let fine = force(&[0.0, 1e-7, 2e-7], &[1.0, 2.0, 1.0]).unwrap();
    let p = Parameters::default();
    let driven = Parameters { excitation_kind: ExcitationKind::Motion, ..p };
    let error = Harvester::new(driven.with_recording(Some(&fine)), 0.0).unwrap_err();
    assert_eq!(error, ModelError::RecordingKind { is_motion: false });
    assert_eq!(error.to_string(), "the recording is one of force; allowed with it: excitation.kind = force");
    let repeated = Parameters { file_repeat: true, ..p };
    let error = Harvester::new(repeated.with_recording(Some(&fine)), 0.0).unwrap_err().to_string();
    assert!(error.ends_with("at least 1e-6 s from sample to sample on average; this one has 1e-7 s"), "{error}");
    let harvester = Harvester::new(p.with_recording(Some(&fine)), 0.0).unwrap();
    let other = force(&[0.0, 1e-7, 2e-7], &[1.0, 2.0, 1.5]).unwrap();
    let restored = |recording| Harvester::restore(p.with_recording(recording), &harvester.snapshot());
    assert_eq!(restored(Some(&fine)).unwrap(), harvester);
    assert_eq!(restored(Some(&other)).unwrap_err(), ModelError::OtherRecording);
    assert_eq!(restored(None).unwrap_err(), ModelError::OtherRecording);
}

/// A force that grows so fast that between two times as doubles have them it passes the limit of friction by far.
#[test]
fn a_steep_ramp_tears_a_stuck_ball_off_once() {
    let recording = Recording::new(ExcitationKind::Force, vec![0.0, 1e-6, 0.01], vec![0.0, -2.0, -2.0]).unwrap();
    for k in 0..300 {
        let offset = 1.4 + 0.013_7 * f64::from(k);
        for damping in [0.0, 9.0] {
            let p = Parameters {
                amplitude: 0.0,
                friction: 0.7,
                suspension_damping: damping,
                file_offset: offset,
                ..Parameters::default()
            };
            let mut harvester = Harvester::new(p.with_recording(Some(&recording)), 0.0).unwrap();
            harvester.advance(offset).unwrap();
            assert!(harvester.is_stuck());
            harvester.advance(offset + 0.005).unwrap();
            assert!(!harvester.is_stuck() && harvester.relative_displacement() < -1e-5);
        }
    }
}

proptest! {
    #[test]
    fn the_excitation_shown_is_the_harmonic_and_the_line_between_the_samples(
        (times, values) in any_samples(),
        (scale, offset, repeats) in (-3.0..3.0_f64, -0.3..0.3_f64, prop::bool::ANY),
        motion in prop::bool::ANY,
        places in prop::collection::vec(-1.0..3.0_f64, 1..20),
    ) {
        let kind = if motion { ExcitationKind::Motion } else { ExcitationKind::Force };
        let p = Parameters {
            excitation_kind: kind,
            acceleration: if motion { 0.7 } else { 0.0 },
            file_scale: scale,
            file_offset: offset,
            file_repeat: repeats,
            ..Parameters::default()
        };
        let recording = Recording::new(kind, times.clone(), values.clone()).unwrap();
        prop_assert_eq!(recording.values(), &values[..]);
        let said = format!("{recording:?}");
        prop_assert!(said.contains(&format!("samples: {}", times.len())), "{said}");
        let recorded = Recorded { times, values, scale, offset, repeats, line: Line::default() };
        let shown = p.with_recording(Some(&recording)).excitation(places.iter().copied());
        for (time, shown) in places.iter().zip(shown) {
            let line = recorded.line_from(*time);
            // Within rounding of a sample either line may hold.
            prop_assume!((time - line.start).abs() > 1e-9 && (time - line.end).abs() > 1e-9);
            let amplitude = if motion { p.acceleration } else { p.amplitude };
            let harmonic = amplitude * (TAU * p.frequency * time + p.phase).cos();
            let expected = harmonic + line.value + line.rate * (time - line.start);
            prop_assert!((shown - expected).abs() < 1e-9 * (1.0 + expected.abs() + line.rate.abs()), "{shown} at {time}, not {expected}");
        }
    }
}
