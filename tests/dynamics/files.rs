//! The dynamics of cases with files: a recording that repeats, and a measured membrane.

use approx::assert_relative_eq;
use videg::dynamics::orbits::{self, Search};
use videg::dynamics::{Basins, Files, Motion, Periods, Problem, Varied, exponent};
use videg_model::{Case, ContactLaw, ExcitationKind, ForceTable, MembraneLaw, OutsideGap, Parameters, Recording};

fn fig14() -> Parameters {
    (Case::find("fig14").unwrap().parameters)()
}

/// One period of the force of Fig. 14 in `count` pieces.
fn cosine(p: &Parameters, count: u32) -> Recording {
    let times: Vec<f64> = (0..=count).map(|k| f64::from(k) / f64::from(count) / p.frequency).collect();
    let force = |time: &f64| p.amplitude * (std::f64::consts::TAU * p.frequency * time).cos();
    let forces = times.iter().map(force).collect();
    Recording::new(ExcitationKind::Force, times, forces).unwrap()
}

#[test]
fn a_repeated_recording_of_the_harmonic_force_has_its_section_exponent_and_basins() {
    let p = fig14();
    let recorded = Parameters { amplitude: 0.0, file_repeat: true, ..p };
    let files = Files { recording: Some(cosine(&p, 500)), table: None };
    let motions = [Motion::take(&p, 200, 20).unwrap(), Motion::take(files.setup(&recorded), 200, 20).unwrap()];
    assert_eq!(motions.each_ref().map(Motion::recurrence), [Some(2); 2]);
    let [ours, theirs] = motions.each_ref().map(Motion::last);
    // Straight lines miss the cosine by (pi / 500)^2 / 2 = 2e-5 at most.
    assert_relative_eq!(ours.displacement, theirs.displacement, max_relative = 1e-3);
    assert_relative_eq!(ours.velocity, theirs.velocity, max_relative = 1e-3);
    assert_relative_eq!(motions[0].own_gain(), motions[1].own_gain(), max_relative = 1e-4);
    let exponents = [exponent(&p, ours, 100), exponent(files.setup(&recorded), theirs, 100)];
    let exponents = exponents.map(|exponent| exponent.unwrap().unwrap());
    assert_relative_eq!(exponents[0], exponents[1], max_relative = 1e-2);
    let periods = Periods { transient: 60, taken: 8 };
    let [harmonic, repeated] = [
        Basins::new(&p, 3, 0.3, periods, &()).unwrap(),
        Basins::new(files.setup(&recorded), 3, 0.3, periods, &()).unwrap(),
    ];
    assert_eq!(harmonic.attractors.len(), repeated.attractors.len());
    for (a, b) in harmonic.ends.iter().zip(&repeated.ends) {
        assert_eq!(a.recurrence, b.recurrence);
    }
}

#[test]
fn a_recording_that_does_not_repeat_with_the_harmonic_force_is_refused_with_the_numbers() {
    let p = fig14();
    let files = Files { recording: Some(cosine(&p, 100)), table: None };
    let refused = |p: Parameters| Motion::take(files.setup(&p), 1, 1).unwrap_err().to_string();
    assert!(refused(p).starts_with("excitation.fileRepeat = false"), "{}", refused(p));
    let repeated = Parameters { file_repeat: true, ..p };
    assert!(Motion::take(files.setup(&repeated), 1, 1).is_ok(), "one period beside the harmonic force");
    let late = refused(Parameters { file_offset: 0.25, ..repeated });
    assert!(late.contains("0.25 s") && late.contains("excitation.fileOffset"), "{late}");
    let apart = refused(Parameters { frequency: 2.1, ..repeated });
    assert!(apart.contains("0.5 s") && apart.contains("1.05") && apart.contains("2.1 Hz"), "{apart}");
    let problem = Problem { parameters: repeated, files: files.clone(), varied: None };
    let orbits = orbits::orbits(&problem, &Search::default(), &()).unwrap_err().to_string();
    assert!(orbits.starts_with("excitation.file"), "{orbits}");
}

#[test]
fn a_membrane_measured_from_the_power_law_has_its_gain_and_orbits() {
    let p = fig14();
    let deflections: Vec<f64> = (0..=1000).map(|k| 1e-5 * f64::from(k)).collect();
    let forces = deflections.iter().map(|x| p.stiffness * x.powf(p.stiffness_exponent)).collect();
    let table = ForceTable::new(deflections, forces, None).unwrap();
    let measured = Parameters { membrane_law: MembraneLaw::Table, ..p };
    let files = Files { recording: None, table: Some(table) };
    let gains = [Motion::take(&p, 100, 10).unwrap(), Motion::take(files.setup(&measured), 100, 10).unwrap()];
    assert_relative_eq!(gains[0].own_gain(), gains[1].own_gain(), max_relative = 1e-6);
    let problem = Problem { parameters: measured, files, varied: None };
    let search = Search { periods: 1, ..Search::default() };
    let of_power = Problem { parameters: p, files: Files::default(), varied: None };
    let [ours, theirs] = [&of_power, &problem].map(|problem| orbits::orbits(problem, &search, &()).unwrap());
    assert_eq!(ours.len(), theirs.len());
    for (a, b) in ours.iter().zip(&theirs) {
        assert_relative_eq!(a.voltage_gain, b.voltage_gain, max_relative = 1e-6);
    }
}

#[test]
fn viscous_films_have_sections_but_no_orbits_or_lyapunov_exponent() {
    let film = Parameters { contact_law: ContactLaw::Compliant, membrane_law: MembraneLaw::Gent, ..fig14() };
    let viscous = Parameters { viscous_modulus: 1e4, relaxation_time: 0.01, ..film };
    let motion = Motion::take(&viscous, 5, 5).unwrap();
    assert_eq!(exponent(&viscous, motion.last(), 2).unwrap(), None);
    assert!(exponent(&film, Motion::take(&film, 5, 5).unwrap().last(), 2).unwrap().is_some());
    let problem = |parameters, varied| Problem { parameters, files: Files::default(), varied };
    let quantity = Parameters::TABLE.iter().find(|it| it.name == "membrane.viscousModulus").unwrap();
    let varied = Some(Varied { quantity, values: vec![0.0, 1e3] });
    let over = Parameters { viscous_modulus: 0.0, ..viscous };
    for (problem, expected) in [(problem(viscous, None), "10000: "), (problem(over, varied), "1000: ")] {
        let refused = problem.check_orbits().unwrap_err().to_string();
        assert!(refused.starts_with(&format!("membrane.viscousModulus = {expected}")), "{refused}");
    }
    assert!(problem(film, None).check_orbits().is_ok());
}

#[test]
fn a_ball_that_presses_a_membrane_in_at_each_start_has_no_lyapunov_exponent() {
    let heavy = (Case::find("table3-2hz").unwrap().parameters)();
    let soft = Parameters { contact_law: ContactLaw::Compliant, ..heavy };
    assert_eq!(exponent(&soft, Motion::take(&soft, 20, 5).unwrap().last(), 5).unwrap(), None);
    // Its neighbour is beyond the membrane on which the ball rests.
    let free = Parameters { outside_gap: OutsideGap::Free, ..heavy };
    let [ours, theirs] =
        [heavy, free].map(|p| exponent(&p, Motion::take(&p, 20, 5).unwrap().last(), 5).unwrap().unwrap());
    assert!(ours < 0.0, "{ours}");
    assert_eq!(ours, theirs);
}
