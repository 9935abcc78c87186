//! C(t) that is kept gives the runs that C(t) worked out on the way gives.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use videg_circuit::{Release, Settings, Topology};
use videg_coupled::{Film, Times, Track, run, run_watched};
use videg_model::{Case, ContactLaw, MembraneLaw, Parameters};

fn circuit() -> impl Strategy<Value = Settings> {
    let topology = prop_oneof![Just(Topology::SharedNode), Just(Topology::Isolated)];
    let release = prop_oneof![Just(Release::Zener), Just(Release::Switch), Just(Release::Storage)];
    let load = prop_oneof![Just(0.0), Just(f64::INFINITY), (7.0..12.0_f64).prop_map(|d| 10.0_f64.powf(d))];
    let leakage = prop_oneof![2 => Just(0.0), 1 => 0.1..100.0_f64];
    (topology, release, 2000.0..4500.0_f64, load, leakage).prop_map(|(topology, release, voltage, load, leakage)| {
        let mut settings = Settings::default();
        settings.circuit.topology = topology;
        settings.circuit.release = release;
        settings.circuit.zener_voltage = voltage;
        settings.circuit.storage_voltage = voltage;
        settings.circuit.load_resistance = load;
        settings.circuit.leakage_time_constant = leakage;
        settings
    })
}

fn harvester() -> impl Strategy<Value = Parameters> {
    let law = prop_oneof![3 => Just(ContactLaw::Impulsive), 1 => Just(ContactLaw::Compliant)];
    let film = prop_oneof![2 => Just(MembraneLaw::Power), 1 => Just(MembraneLaw::Gent)];
    // A soft film has pulses that overlap.
    (0..Case::ALL.len(), 0.1..0.95_f64, -2.0..1.0_f64, law, film, any::<u16>()).prop_map(
        |(case, restitution, softer, contact_law, membrane_law, seed)| {
            let p = (Case::ALL[case].parameters)();
            let stiffness = p.stiffness * 10.0_f64.powf(softer);
            Parameters { restitution, stiffness, contact_law, membrane_law, seed: i32::from(seed), ..p }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn circuits_that_follow_a_track_have_the_results_of_runs_to_the_last_bit(
        p in harvester(),
        circuits in prop::collection::vec(circuit(), 1..4),
        window in prop_oneof![Just([0.0, 2.0]), Just([0.5, 1.7]), Just([1.0, 2.0])],
    ) {
        let times = Times { until: 2.0, window, tolerance: 1e-3 };
        let track = match Track::of(&p, &times) {
            Ok(track) => track.unwrap(),
            Err(refused) => {
                prop_assert_eq!(refused.to_string(), run(&p, &circuits[0], &times).unwrap_err().to_string());
                return Ok(());
            }
        };
        for settings in &circuits {
            let mut films = [Film::default(), Film::default()];
            let expected = run_watched(&p, settings, &times, &mut films[0]).unwrap();
            let found = track.run(settings, &mut films[1]).unwrap();
            prop_assert_eq!(&found, &expected);
            prop_assert_eq!(films[0].over_limits(), films[1].over_limits());
            prop_assert_eq!(&run(&p, settings, &times).unwrap(), &expected);
        }
    }
}

#[test]
fn a_run_of_more_knots_than_memory_is_given_has_no_track() {
    let p = (Case::find("fig14").unwrap().parameters)();
    let times = |until: f64| Times { until, window: [0.0, until], tolerance: 1e-4 };
    assert!(Track::of(&p, &times(100.0)).unwrap().is_some());
    assert!(Track::of(&p, &times(10_000.0)).unwrap().is_none());
}

#[test]
fn times_that_are_none_are_refused_and_nothing_hangs() {
    let p = Parameters::default();
    let good = Times { until: 2.0, window: [1.0, 2.0], tolerance: 1e-3 };
    for (times, said) in [
        (Times { tolerance: 0.0, ..good }, "tolerance = 0: allowed: above 0"),
        (Times { tolerance: -1.0, ..good }, "tolerance = -1"),
        (Times { tolerance: f64::NAN, ..good }, "tolerance = NaN"),
        (Times { until: f64::INFINITY, ..good }, "window = 1,2 s and until = inf s"),
        (Times { until: f64::NAN, ..good }, "window = 1,2 s and until = NaN s"),
        (Times { until: 1.5, ..good }, "window = 1,2 s and until = 1.5 s: allowed: 0 <= from < to <= until, finite"),
        (Times { window: [2.0, 1.0], ..good }, "window = 2,1 s"),
        (Times { window: [-1.0, 1.0], ..good }, "window = -1,1 s"),
        (Times { window: [f64::NAN, 1.0], ..good }, "window = NaN,1 s"),
    ] {
        let errors = [run(&p, &Settings::default(), &times).err(), Track::of(&p, &times).err()];
        for error in errors {
            let error = error.unwrap().to_string();
            assert!(error.starts_with(said), "{error}");
        }
    }
}
