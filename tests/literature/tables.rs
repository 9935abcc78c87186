//! The tables of the page.

use std::fmt::Write as _;

use videg_model::{ContactLaw, Membrane, Parameters, Side};

use crate::capsule::{Capsule, Orbit, root};
use crate::diagram::Diagram;
use crate::steady::Motion;
use crate::{INCLINATIONS, OF_IRREGULAR, TOLERANCE, case, check, length, of_length};

/// Periods after which a motion has settled.
const SETTLED: u32 = 500;

/// Length of `capsule-1-1`.
const LONG: f64 = 0.342_375;

/// The 1:1 orbit that attracts: of the two, the one with the faster impacts.
fn fastest(p: &Parameters) -> Orbit {
    Capsule::new(p).orbits().into_iter().max_by(|a, b| a.speeds[0].total_cmp(&b.speeds[0])).unwrap()
}

/// d at which a function of the 1:1 orbit, followed from `LONG`, has its zero.
fn zero(p: Parameters, function: fn(&Orbit) -> f64) -> f64 {
    root(|d| Capsule::new(&of_length(p, d)), fastest(&of_length(p, LONG)), function, [LONG, 0.1])
}

#[test]
fn the_closed_form_stands_beside_the_simulation() {
    let mut table = String::from(
        "| case | phase at the bottom, rad | flight up, s | bottom, m/s | simulated | top, m/s | simulated | multipliers |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let inclined = INCLINATIONS.map(|(shown, inclination)| {
        (format!("`capsule-1-1`, β = {shown}"), Parameters { inclination, ..case("capsule-1-1") })
    });
    for (name, p) in inclined.into_iter().chain([("`capsule-friction`".to_owned(), case("capsule-friction"))]) {
        let (orbit, motion) = (fastest(&p), Motion::of(&p, SETTLED));
        assert_eq!(motion.sequence(), "1:1", "{name}");
        let [bottom, top] = [Side::Left, Side::Right].map(|side| motion.speeds(side)[0]);
        for (found, expected) in [(bottom, orbit.speeds[0]), (top, orbit.speeds[1])] {
            assert!((found - expected).abs() < 1e-9, "{name}: {found} against {expected}");
        }
        let multipliers = match orbit.multipliers() {
            Ok([a, b]) => format!("{a:.4} and {b:.4}"),
            Err([real, imaginary]) => format!("{real:.4} ± {imaginary:.4} i"),
        };
        let (phase, flight, [low, high]) = (orbit.phase, orbit.flight, orbit.speeds);
        writeln!(
            table,
            "| {name} | {phase:.5} | {flight:.6} | {low:.6} | {bottom:.6} | {high:.6} | {top:.6} | {multipliers} |"
        )
        .unwrap();
    }
    check("closed form", &table, TOLERANCE);
}

/// How a stretch of lengths is printed.
fn shown(stretch: Option<[f64; 2]>) -> String {
    stretch.map_or_else(|| "none".to_owned(), |[from, to]| format!("{from:.3} to {to:.3}"))
}

#[test]
fn the_motions_follow_each_other_as_the_page_says() {
    const COUNT: u32 = 240;
    const STEP: f64 = (LONG - 0.1) / COUNT as f64;
    let mut table = String::from(
        "| β | period doubles | 1:1 would graze | 1:1 | 2:2 | 2:1 | 4:2 | 3:1 |\n|---|---|---|---|---|---|---|---|\n",
    );
    for (name, inclination) in INCLINATIONS {
        let p = Parameters { inclination, ..case("capsule-1-1") };
        let diagram = Diagram::new(&p, [LONG, 0.1], COUNT);
        let [doubled, grazed] =
            [Orbit::period_doubling, |orbit: &Orbit| orbit.clearance].map(|function| zero(p, function));
        let [single, double, two, four, three] = ["1:1", "2:2", "2:1", "4:2", "3:1"].map(|it| diagram.stretch(it));
        // The 1:1 motion ends at the first of both.
        let [_, last] = single.unwrap();
        assert!((last - doubled.max(grazed)).abs() < 4.0 * STEP, "{name}: {last} against {doubled} and {grazed}");
        assert!(doubled > grazed, "{name}");
        // A second graze leads from 2:1 straight to 3:1, or the period doubles before.
        match name {
            "π/6" => assert!(four.is_none() && two.unwrap()[1] - three.unwrap()[0] < 1.5 * STEP, "{two:?} {three:?}"),
            "π/4" | "π/3" => assert!(two.unwrap()[1] > four.unwrap()[0] && four.unwrap()[1] > three.unwrap()[0]),
            _ => assert!(two.is_some()),
        }
        let [single, double, two, four, three] = [single, double, two, four, three].map(shown);
        writeln!(table, "| {name} | {doubled:.4} | {grazed:.4} | {single} | {double} | {two} | {four} | {three} |")
            .unwrap();
    }
    check("sequences", &table, OF_IRREGULAR);
}

/// Speeds at the bottom and at the top until the motion comes back.
fn speeds(motion: &Motion) -> String {
    let list = |side| motion.speeds(side).iter().map(|speed| format!("{speed:.3}")).collect::<Vec<_>>().join(" ");
    format!("{} | {}", list(Side::Left), list(Side::Right))
}

#[test]
fn the_energy_of_an_impact_falls_where_their_number_rises() {
    let mut table = String::from(
        "| case | sequence | bottom, m/s | top, m/s | W for each impact, mJ | W over time, mW |\n|---|---|---|---|---|---|\n",
    );
    let mut energies = Vec::new();
    for name in ["capsule-1-1", "capsule-2-1", "capsule-3-1", "capsule-friction", "capsule-soft"] {
        let (p, motion) = (case(name), Motion::of(&case(name), SETTLED));
        let energy = 1e3 * motion.energy_of_an_impact(&p);
        energies.push(energy);
        let deepest = motion.impacts().iter().fold(0.0_f64, |largest, impact| largest.max(impact.speed));
        assert!(Membrane::new(&p).deflection(deepest) > p.membrane_radius());
        let (sequence, power) = (motion.sequence(), 1e3 * motion.power);
        writeln!(table, "| `{name}` | {sequence} | {} | {energy:.3} | {power:.3} |", speeds(&motion)).unwrap();
    }
    assert!(energies[0] > energies[1] && energies[1] > energies[2], "{energies:?}");
    check("energy", &table, TOLERANCE);
}

#[test]
fn friction_slows_the_impacts_and_shifts_the_motions() {
    let mut table = String::from(
        "| β | μ | bottom, m/s | top, m/s | W over time, mW | period doubles | 1:1 down to d | 2:1 |\n|---|---|---|---|---|---|---|---|\n",
    );
    for (name, inclination) in [INCLINATIONS[1], INCLINATIONS[3]] {
        let (mut last, mut shifts) = (f64::INFINITY, Vec::new());
        for friction in [0.0, 0.1, 0.2, 0.3] {
            let p = Parameters { inclination, friction, ..case("capsule-1-1") };
            let motion = Motion::of(&p, SETTLED);
            assert_eq!(motion.sequence(), "1:1");
            assert!(motion.power < last, "{name}, {friction}");
            last = motion.power;
            let doubled = zero(p, Orbit::period_doubling);
            let orbit =
                Capsule::new(&of_length(p, doubled)).orbits().into_iter().find(|it| it.period_doubling().abs() < 1e-6);
            let diagram = Diagram::new(&p, [LONG, 0.1], 120);
            let ([_, end], two) = (diagram.stretch("1:1").unwrap(), diagram.stretch("2:1"));
            // The closed form ends where the ball turns within a flight, against friction.
            let doubles = orbit.map_or_else(|| "turns before".to_owned(), |_| format!("{doubled:.4}"));
            assert!(orbit.is_none() || (end - doubled).abs() < 0.008, "{name}, {friction}: {end} against {doubled}");
            shifts.push((end, two.unwrap()[0]));
            let (speeds, power, two) = (speeds(&motion), 1e3 * motion.power, shown(two));
            writeln!(table, "| {name} | {friction} | {speeds} | {power:.4} | {doubles} | {end:.3} | {two} |").unwrap();
        }
        let keeps = inclination < 0.5;
        assert!(shifts.is_sorted_by(|a, b| (a.0 > b.0) == keeps && a.1 > b.1), "{name}: {shifts:?}");
    }
    check("friction", &table, OF_IRREGULAR);
}

/// Friction costs energy, but may keep a motion that gives more.
#[test]
fn there_is_a_length_at_which_friction_gives_more_energy() {
    let [without, with] = [0.0, 0.1].map(|friction| {
        let p = of_length(Parameters { friction, ..case("capsule-1-1") }, 0.232);
        Motion::of(&p, 1000).power
    });
    assert!(with > 1.01 * without, "{with} against {without}");
}

#[test]
fn soft_membranes_keep_one_impact_at_each_end_longer() {
    let mut table = String::from(
        "| contacts | K over that of the paper | bottom, m/s | top, m/s | W over time, mW | 1:1 down to d | 2:1 |\n\
         |---|---|---|---|---|---|---|\n",
    );
    let (mut lowest, mut powers) = (Vec::new(), Vec::new());
    for (contact_law, name, factor) in [
        (ContactLaw::Impulsive, "hard", 1.0),
        (ContactLaw::Compliant, "soft", 1.0),
        (ContactLaw::Impulsive, "hard", 100.0),
        (ContactLaw::Compliant, "soft", 100.0),
        (ContactLaw::Compliant, "soft", 1e4),
    ] {
        let p = case("capsule-1-1");
        let p = Parameters { contact_law, stiffness: factor * p.stiffness, ..p };
        let (motion, diagram) = (Motion::of(&p, SETTLED), Diagram::new(&p, [LONG, 0.142], 50));
        let [_, last] = diagram.stretch("1:1").unwrap();
        lowest.push(last);
        powers.push(motion.power);
        writeln!(
            table,
            "| {name} | {factor} | {} | {:.4} | {last:.3} | {} |",
            speeds(&motion),
            1e3 * motion.power,
            shown(diagram.stretch("2:1"))
        )
        .unwrap();
    }
    assert!(powers[1] > powers[0] && powers[3] > powers[2], "{powers:?}");
    // Stiffer and stiffer membranes approach impacts that take no time.
    let [hard, soft, _, stiff, stiffest] = lowest[..] else { panic!("{lowest:?}") };
    assert!(soft < stiff && stiff < stiffest && (stiffest - hard).abs() < 0.009, "{lowest:?}");
    check("soft", &table, OF_IRREGULAR);
}

#[test]
fn the_long_capsule_is_the_case() {
    let p = case("capsule-1-1");
    assert!((length(p.travel(), &p) - LONG).abs() < 1e-12);
}

#[test]
fn one_and_two_impacts_at_the_bottom_coexist() {
    let p = of_length(Parameters { inclination: 0.1, ..case("capsule-1-1") }, 0.199);
    assert!(fastest(&p).is_stable());
    assert_eq!(Motion::of(&p, SETTLED).sequence(), "2:1");
}
