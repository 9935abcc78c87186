//! Named cases: the parameters of Figures 9 to 15 and of Table 3 of the paper, and the inclined capsule of later papers.

use core::f64::consts::{FRAC_PI_4, FRAC_PI_6, PI, TAU};

use crate::parameters::{ContactLaw, Parameters};

/// A published case.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Short name, as given to `--case`.
    pub name: &'static str,
    /// What the case shows.
    pub description: &'static str,
    /// Where its system was published: [`Case::PAPER`] or another paper.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: fn() -> Parameters,
    /// Voltage gain that the paper prints for it, V/s (Table 2).
    pub paper_voltage_gain: Option<f64>,
    /// Power that the paper prints for it, W (Table 3).
    pub paper_power: Option<f64>,
}

/// Sources of the inclined capsule: motions with two and three impacts on the lower membrane, dry friction, soft membranes.
const GRAZING: &str = "Serdukova, Kuske, Yurchenko, arXiv:2003.02167";
const FRICTION: &str = "Athanasouli, Yurchenko, Kuske, arXiv:2502.12288";
const SOFT: &str = "Costa, Kuske, Yurchenko, Chaos 32, 103120";

impl Case {
    /// Source of the cases of the paper that videg follows.
    pub const PAPER: &'static str = "the paper";

    /// All cases: the paper's in its order, then those of other papers.
    pub const ALL: &'static [Self] = &[
        figure("fig9", "no impact: A = 0.01 N, r = 1", || driven_from_rest(0.01, 1.0), None),
        figure("fig10", "saw-tooth motion: A = 0.01 N, r = 1", || saw_tooth(0.01, 1.0), Some(1831.0)),
        figure("fig11", "saw-tooth start, A = 0.5 N, r = 1: chaotic", || saw_tooth(0.5, 1.0), Some(6749.0)),
        figure(
            "fig12",
            "start outside the gap, A = 0.5 N, r = 1: chaotic",
            || driven_from_rest(0.5, 1.0),
            Some(6730.0),
        ),
        figure("fig13", "zero start, A = 0.5 N, r = 1: chaotic", || zero_start(0.5, 1.0), Some(6989.0)),
        figure("fig14", "saw-tooth start, A = 0.5 N, r = 0.6: periodic", || saw_tooth(0.5, 0.6), Some(8079.0)),
        figure("fig15", "saw-tooth start, A = 0.5 N, r = 0.3: weakly chaotic", || saw_tooth(0.5, 0.3), Some(8652.0)),
        flashlight("table3-2hz", "size of the electromagnetic flashlight, 2 Hz", || flashlight_sized(2.0), 0.061),
        flashlight("table3-5hz", "size of the electromagnetic flashlight, 5 Hz", || flashlight_sized(5.0), 0.132),
        capsule("capsule-1-1", "inclined capsule, d = 0.342: one impact at each end a period", GRAZING, || {
            inclined(FRAC_PI_4, 0.55)
        }),
        capsule(
            "capsule-2-1",
            "inclined capsule, d = 0.187: two impacts at the bottom, one at the top",
            GRAZING,
            || inclined(FRAC_PI_4, 0.3),
        ),
        capsule(
            "capsule-3-1",
            "inclined capsule, d = 0.125: three impacts at the bottom, one at the top",
            GRAZING,
            || inclined(FRAC_PI_6, 0.2),
        ),
        capsule("capsule-friction", "slightly inclined capsule, d = 0.342, with dry friction", FRICTION, || {
            Parameters { friction: 0.15, ..inclined(0.2, 0.55) }
        }),
        capsule("capsule-soft", "capsule-1-1 with contacts that take time", SOFT, || Parameters {
            contact_law: ContactLaw::Compliant,
            ..inclined(FRAC_PI_4, 0.55)
        }),
    ];

    /// The case called `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|case| case.name == name)
    }
}

const fn figure(
    name: &'static str,
    description: &'static str,
    parameters: fn() -> Parameters,
    gain: Option<f64>,
) -> Case {
    Case { name, description, source: Case::PAPER, parameters, paper_voltage_gain: gain, paper_power: None }
}

const fn flashlight(name: &'static str, description: &'static str, parameters: fn() -> Parameters, power: f64) -> Case {
    Case { name, description, source: Case::PAPER, parameters, paper_voltage_gain: None, paper_power: Some(power) }
}

const fn capsule(
    name: &'static str,
    description: &'static str,
    source: &'static str,
    parameters: fn() -> Parameters,
) -> Case {
    Case { name, description, source, parameters, paper_voltage_gain: None, paper_power: None }
}

/// Section 4.2, zero initial conditions.
fn zero_start(amplitude: f64, restitution: f64) -> Parameters {
    Parameters { restitution, amplitude, ..Parameters::default() }
}

/// Figures 9 and 12: the cylinder starts at the end of its swing, the ball at zero.
fn driven_from_rest(amplitude: f64, restitution: f64) -> Parameters {
    let p = zero_start(amplitude, restitution);
    Parameters { cylinder_position: -p.cylinder_amplitude(), ..p }
}

/// Figures 10, 11, 14 and 15: `z_m`(0) = `z_M`(0) + s/2, `z_m`'(0) = -4 `f_0` `z_m`(0).
fn saw_tooth(amplitude: f64, restitution: f64) -> Parameters {
    let p = driven_from_rest(amplitude, restitution);
    let ball_position = p.cylinder_position + p.travel() / 2.0;
    Parameters { ball_position, ball_velocity: -4.0 * p.frequency * ball_position, ..p }
}

/// Section 5.3: a cylinder of 42.2 cm^3 and 8 mm inner radius, A = 5 N, r = 0.5, zero initial conditions.
///
/// Its length follows from the volume; how much of it is frame does not matter, as only s enters.
fn flashlight_sized(frequency: f64) -> Parameters {
    let radius: f64 = 0.008;
    let length = 42.2e-6 / (PI * radius * radius);
    let p = Parameters::default();
    Parameters {
        cylinder_mass: 0.012,
        cylinder_length: length - 2.0 * p.frame_width,
        ball_mass: 0.053,
        ball_radius: 0.0075,
        initial_radius: radius / p.prestretch,
        restitution: 0.5,
        amplitude: 5.0,
        frequency,
        ..p
    }
}

/// The inclined capsule with the way `travel`, m: M = 124.5 g, A = 5 N, w = 5 pi, r = 0.5 as in the papers on it, m = 0.1 M,
/// membranes of Section 4.2. Both bodies start at rest, the ball on the lower membrane.
fn inclined(inclination: f64, travel: f64) -> Parameters {
    let p = Parameters::default();
    Parameters {
        cylinder_length: travel - 2.0 * p.frame_width + 2.0 * p.ball_radius,
        ball_mass: 0.012_45,
        ball_position: -travel / 2.0,
        restitution: 0.5,
        amplitude: 5.0,
        frequency: 2.5,
        inclination,
        ..p
    }
}

/// Largest amplitude, N, of the saw-tooth motion at these parameters: M (2 pi `f_0`)^2 s / 2 (Section 4.2).
pub fn saw_tooth_limit(parameters: &Parameters) -> f64 {
    let omega = TAU * parameters.frequency;
    parameters.cylinder_mass * omega * omega * parameters.travel() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_saw_tooth_limit_is_the_papers() {
        assert_relative_eq!(saw_tooth_limit(&Parameters::default()), 0.4325, max_relative = 1e-4);
    }

    #[test]
    fn every_case_is_valid_and_found_by_its_name() {
        for case in Case::ALL {
            (case.parameters)().validate().unwrap();
            assert_eq!(Case::find(case.name).unwrap().description, case.description);
        }
        assert!(Case::find("fig8").is_none());
    }

    /// d = s M w^2 / (A pi^2), the length of the capsule in the literature.
    #[test]
    fn the_capsules_have_the_lengths_that_they_say() {
        for case in Case::ALL.iter().filter(|case| case.source != Case::PAPER && case.name != "capsule-soft") {
            let p = (case.parameters)();
            let omega = TAU * p.frequency;
            let length = p.travel() * p.cylinder_mass * omega * omega / (p.amplitude * PI * PI);
            assert!(case.description.contains(&format!("d = {length:.3}")), "{}: {length}", case.name);
        }
    }

    #[test]
    fn table_3_has_the_capacitance_that_the_paper_prints() {
        let membrane = crate::Membrane::new(&flashlight_sized(2.0));
        assert_relative_eq!(membrane.rest_capacitance(), 2.42e-11, max_relative = 2e-3);
    }
}
