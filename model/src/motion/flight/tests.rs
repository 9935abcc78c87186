//! Contacts of random flights against a plain scan.

use super::*;
use crate::motion::cylinder::Drive;
use crate::motion::mount::Load;
use crate::recording::Segment;
use proptest::prelude::*;

const HALF_TRAVEL: f64 = 0.02;

/// Places in a window that are looked at.
const PLACES: u32 = 4000;

prop_compose! {
    /// Speeds from those of a chattering ball to those that cross the gap many times in a period.
    fn any_flight()(
        swing in prop_oneof![Just(0.0), 1e-4..0.1_f64],
        frequency in 0.5..5.0_f64,
        phase in -10.0..10.0_f64,
        start in 0.0..100.0_f64,
        place in prop_oneof![Just(1.0), Just(-1.0), -0.99..0.99_f64],
        velocity in prop_oneof![-1.0..1.0_f64, -1e-3..1e-3_f64],
        external in prop_oneof![Just(0.0), -2.0..2.0_f64],
        external_rate in prop_oneof![Just(0.0), -10.0..10.0_f64],
    ) -> Flight {
        let amplitude = swing * (TAU * frequency).powi(2);
        let drive = Drive { amplitude, frequency, phase, external, external_rate, recorded: Segment::NONE };
        let cylinder = CylinderMotion::new(start, 0.0, 0.0, drive, Load::NONE);
        Flight::new(&cylinder, &cylinder.at(start), [place * HALF_TRAVEL, -velocity], HALF_TRAVEL, 0.0)
    }
}

impl Flight {
    /// Derivative number `order` (0 to 7) of dz at `tau`, s.
    fn derivative(&self, order: usize, tau: f64) -> f64 {
        let of_start = if order == 0 { self.dz } else { 0.0 };
        of_start + self.derivatives(tau, &self.angle(tau))[order]
    }

    /// How large that may be.
    fn size(&self, order: i32) -> f64 {
        (self.swing + self.rate.abs() / self.omega() + 1.0) * self.omega().powi(order)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 4 } else { 4000 }))]

    #[test]
    fn a_contact_is_the_first_place_on_a_membrane(flight in any_flight(), window in 0..6_u64) {
        let (begin, end) = flight.window_bounds(window, f64::INFINITY);
        let contact = flight.contact_in_window(window, f64::INFINITY);
        let beyond = |tau: f64| flight.derivative(0, tau).abs() - HALF_TRAVEL;
        if beyond(begin) > flight.rounding(begin) {
            return Ok(()); // what begins outside of the gap is no contact
        }
        let rounding = 4.0 * flight.rounding(end);
        let first = contact.map_or(end, |contact| contact.elapsed);
        for k in 1..PLACES {
            let tau = begin + (first - begin) * f64::from(k) / f64::from(PLACES);
            prop_assert!(beyond(tau) <= rounding, "{:e} m beyond at {tau} s", beyond(tau));
        }
        if let Some(Crossing { elapsed, side, speed }) = contact {
            prop_assert!(begin < elapsed && elapsed <= end);
            prop_assert!((speed - side.sign() * flight.derivative(1, elapsed)).abs() <= 1e-13 * flight.size(1));
            prop_assert!(beyond(elapsed).abs() <= rounding, "{:e} m off", beyond(elapsed));
            prop_assert_eq!(side, if flight.derivative(0, elapsed) > 0.0 { Side::Left } else { Side::Right });
        }
    }

    #[test]
    fn the_contact_of_a_simple_flight_is_the_one_that_the_search_finds(flight in any_flight()) {
        let flight = Flight { external: [0.0; 2], ..flight };
        if let Some(simple) = flight.simple_contact() {
            prop_assert_eq!(flight.skip(0), Some(0));
            let found = flight.contact_in_window(0, f64::INFINITY).unwrap();
            prop_assert_eq!(simple.side, found.side);
            let rounding = flight.rounding(found.elapsed);
            prop_assert!((simple.elapsed - found.elapsed).abs() * found.speed <= rounding, "{simple:?} {found:?}");
            let allowed = 1e-13 * flight.size(1) + rounding * flight.size(2) / found.speed;
            prop_assert!((simple.speed - found.speed).abs() <= allowed, "{simple:?} {found:?}");
        }
    }

    #[test]
    fn a_ball_that_just_reaches_a_membrane_meets_it_on_the_way_and_not_past_the_turn(
        flight in any_flight(), depth in -19..-8_i32,
    ) {
        let end = flight.window_length();
        let Some(turn) = flight.zeros(1, 0.0, end).iter().next() else { return Ok(()) };
        let turn = flight.knot_at(0, turn);
        let depth = 10.0_f64.powi(depth);
        let flight = Flight { half_travel: (flight.dz + turn.value).abs() - depth, ..flight };
        if flight.dz.abs() >= flight.half_travel {
            return Ok(()); // what begins on a membrane or beyond
        }
        let rounding = 4.0 * flight.rounding(end);
        let Some(contact) = flight.contact_in_window(0, f64::INFINITY) else {
            prop_assert!(depth <= rounding, "missed by {depth:e} m");
            return Ok(());
        };
        prop_assert!(contact.elapsed <= end, "{} s", contact.elapsed);
        let beyond = flight.derivative(0, contact.elapsed).abs() - flight.half_travel;
        prop_assert!(beyond.abs() <= rounding, "{beyond:e} m off");
    }

    #[test]
    fn zeros_are_zeros_and_carry_the_lower_derivative(flight in any_flight(), order in 1..3_usize) {
        let (begin, end) = flight.window_bounds(0, f64::INFINITY);
        let omega = flight.omega();
        for zero in flight.zeros(order, begin, end).iter() {
            let knot = flight.knot_at(order - 1, zero);
            let [lower, value, curvature] = [order - 1, order, order + 1].map(|order| flight.derivative(order, knot.tau));
            let size = |order: i32| flight.size(order);
            let here = i32::try_from(order).unwrap();
            prop_assert!(value.abs() <= 1e-12 * size(here) + 1e-7 * curvature.abs() / omega, "{value:e}");
            let lower = if order == 1 { lower - flight.dz } else { lower };
            prop_assert!((lower - knot.value).abs() <= 1e-12 * size(here - 1), "{lower:e} {:e}", knot.value);
        }
    }
}

#[test]
fn most_flights_from_one_membrane_to_the_other_are_simple() {
    let (swing, frequency) = (1.25 * HALF_TRAVEL, 2.0);
    let amplitude = swing * (TAU * frequency).powi(2);
    let flights = (0..400_u32).map(|number| {
        let (phase, rebound) = (TAU * f64::from(number % 20) / 20.0, 0.02 * f64::from(number / 20));
        let drive = Drive { amplitude, frequency, phase, external: 0.0, external_rate: 0.0, recorded: Segment::NONE };
        let cylinder = CylinderMotion::new(0.0, 0.0, 0.0, drive, Load::NONE);
        Flight::new(&cylinder, &cylinder.at(0.0), [HALF_TRAVEL, -rebound], HALF_TRAVEL, 0.0)
    });
    let [simple, found] = flights.fold([0, 0], |[simple, found], flight| {
        let finds = flight.contact_in_window(0, f64::INFINITY).is_some();
        [simple + u32::from(flight.simple_contact().is_some()), found + u32::from(finds)]
    });
    assert!(2 * simple > found && simple < found, "{simple} of {found}");
}
