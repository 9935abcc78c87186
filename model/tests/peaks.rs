//! Largest deflections, as they are shown on the way.
#![allow(clippy::unwrap_used)] // helpers outside of #[test] functions fail a test, too

use approx::assert_relative_eq;
use videg_model::{Case, ContactLaw, Event, Harvester, Parameters, Peak};

/// The peaks of fig14 under `law` in its first 5 s, and the number of impacts.
fn peaks(law: ContactLaw) -> (Harvester, Vec<Peak>, usize) {
    let p = Parameters { contact_law: law, ..(Case::find("fig14").unwrap().parameters)() };
    let start = Harvester::new(&p, 0.0).unwrap();
    let (mut peaks, mut impacts) = (Vec::new(), 0);
    start
        .clone()
        .advance_with(5.0, |shown| match shown {
            Event::Impact(_) => impacts += 1,
            Event::Peak(peak) => peaks.push(*peak),
        })
        .unwrap();
    (start, peaks, impacts)
}

#[test]
fn a_peak_is_the_deflection_at_its_time_and_larger_than_those_around_it() {
    for law in [ContactLaw::Impulsive, ContactLaw::Compliant] {
        let (mut harvester, peaks, impacts) = peaks(law);
        assert!(impacts > 10 && peaks.len() >= impacts - 1, "{law:?}: {} peaks, {impacts} impacts", peaks.len());
        for Peak { time, side, deflection, voltage } in peaks {
            let mut at = |time: f64| {
                harvester.advance(time).unwrap();
                harvester.deflection(side).value
            };
            let [before, there, after] = [-1e-5, 0.0, 1e-5].map(|offset| at(time + offset));
            // The deflection is flat there: rounding of the time does not count, rounding of position does.
            assert_relative_eq!(there, deflection, max_relative = 1e-9);
            assert!(before < there && after < there, "{law:?}: {before}, {there}, {after} at {time} s");
            assert_eq!(voltage, 2000.0);
        }
    }
}
