//! Snapshots: a restored harvester goes on as the original, to the last bit; what is no state is refused.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

use videg_model::{Case, Harvester, ModelError, NoiseModel, Parameters, Side, Snapshot};

fn fig14() -> Parameters {
    (Case::find("fig14").expect("a case").parameters)()
}

/// Chatters and rests, as Table 3 at 2 Hz.
fn resting() -> Parameters {
    (Case::find("table3-2hz").expect("a case").parameters)()
}

fn noisy(model: NoiseModel) -> Parameters {
    Parameters { phase_noise: 0.7, noise_hold: 1e-3, noise_model: model, ..fig14() }
}

fn run_to(parameters: &Parameters, time: f64) -> Harvester {
    let mut harvester = Harvester::new(parameters, 0.0).expect("parameters");
    harvester.advance(time).expect("a step");
    harvester
}

/// Restores at each time and goes on in odd steps, one harvester with and one without the detour.
fn assert_goes_on_alike(parameters: &Parameters, times: impl IntoIterator<Item = f64>) {
    for time in times {
        let mut original = run_to(parameters, time);
        let mut restored = Harvester::restore(parameters, &original.snapshot()).expect("a snapshot");
        assert_eq!(restored, original, "at {time} s");
        for k in 1..=40 {
            let later = time + 0.0371 * f64::from(k);
            if k == 20 {
                for harvester in [&mut original, &mut restored] {
                    harvester.set_external_force(0.01, 0.02).expect("a force");
                }
            }
            original.advance(later).expect("a step");
            restored.advance(later).expect("a step");
            assert_eq!(restored, original, "from {time} s to {later} s");
        }
    }
}

/// Parameters, the interval between the times to restore at, s, and their number.
fn runs() -> Vec<(Parameters, f64, u32)> {
    // With the noise of the paper in the middle of a block, too.
    let held = [0.5, 1.0, 4.0].map(|phase_noise| (Parameters { phase_noise, ..fig14() }, 0.100_371, 8));
    let mut runs = vec![
        (fig14(), 0.0533, 60),
        (noisy(NoiseModel::Held), 0.1234, 20),
        (noisy(NoiseModel::Wiener), 0.1234, 20),
        (Parameters { phase_noise: 0.1, ..resting() }, 0.037, 4),
    ];
    runs.extend(held);
    runs
}

#[test]
fn a_restored_harvester_goes_on_to_the_last_bit_and_sees_the_same_noise() {
    for (parameters, interval, count) in runs() {
        assert_goes_on_alike(&parameters, (0..count).map(|k| f64::from(k) * interval));
    }
}

#[test]
fn a_restored_harvester_goes_on_in_the_middle_of_a_pulse_and_at_an_impact() {
    let mut at_impact = run_to(&fig14(), 1.0);
    let impact = at_impact.next_impact().expect("an impact");
    at_impact.advance(impact).expect("a step");
    let knot = at_impact.next_knot().expect("a peak");
    let middle = 0.5 * (impact + knot);
    let pressed = run_to(&fig14(), middle);
    assert!(pressed.deflection(Side::Left).value.max(pressed.deflection(Side::Right).value) > 0.0);
    assert_goes_on_alike(&fig14(), [impact, middle, knot]);
}

#[test]
fn a_restored_ball_still_rests() {
    let parameters = resting();
    let times: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.005).collect();
    let at_rest = |time: &f64| run_to(&parameters, *time).resting().is_some();
    let at_rest: Vec<f64> = times.into_iter().filter(at_rest).collect();
    assert!(!at_rest.is_empty(), "the case is chosen because the ball rests");
    assert_goes_on_alike(&parameters, at_rest);
}

#[test]
fn a_snapshot_that_no_harvester_had_is_refused() {
    let parameters = noisy(NoiseModel::Wiener);
    let good = run_to(&parameters, 2.0).snapshot();
    assert!(Harvester::restore(&parameters, &good).is_ok());
    assert!(good.pulses.iter().any(|pulses| !pulses.is_empty()), "a pulse to damage");
    let damages: [fn(&mut Snapshot); 15] = [
        |s| s.time = f64::NAN,
        |s| s.time -= 1.0,
        |s| s.cylinder.position = f64::INFINITY,
        |s| s.ball.time = s.time + 1.0,
        |s| s.ball.velocity = f64::NAN,
        |s| s.relative.time = -1e300,
        |s| s.noise_sample = 1 << 60,
        |s| s.noise_walk = f64::NAN,
        |s| s.totals.energy = -1.0,
        |s| s.totals.impacts = u64::MAX,
        |s| s.totals.chatters = u64::MAX,
        |s| s.totals.releases = u64::MAX,
        |s| s.second_events = u64::MAX,
        |s| s.pulses.iter_mut().flatten().for_each(|pulse| pulse.peak = f64::NAN),
        |s| {
            let pulse = s.pulses.iter().flatten().next().copied();
            s.pulses[0] = pulse.into_iter().cycle().take(1000).collect();
        },
    ];
    for (k, damage) in damages.into_iter().enumerate() {
        let mut bad = good.clone();
        damage(&mut bad);
        let refused = Harvester::restore(&parameters, &bad);
        assert!(matches!(refused, Err(ModelError::Snapshot { .. })), "damage {k}: {refused:?}");
    }
    // The ball would have met a membrane since: how often, nobody can say beforehand.
    let mut late = run_to(&fig14(), 2.0).snapshot();
    late.time += 0.4;
    let refused = Harvester::restore(&fig14(), &late).unwrap_err().to_string();
    assert!(refused.contains("event before the present time"), "{refused}");
    let invalid = Parameters { restitution: 2.0, ..parameters };
    assert!(matches!(Harvester::restore(&invalid, &good), Err(ModelError::Bounds { .. })));
}
