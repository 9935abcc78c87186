//! The cases of the paper: the parameters of Figures 9 to 15 and of Table 3.

use core::f64::consts::{PI, TAU};

use crate::parameters::Parameters;

/// A case of the paper.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Short name, as given to `--case`.
    pub name: &'static str,
    /// What the case shows.
    pub description: &'static str,
    /// Its parameters.
    pub parameters: fn() -> Parameters,
    /// Voltage gain that the paper prints for it, V/s (Table 2).
    pub paper_voltage_gain: Option<f64>,
    /// Power that the paper prints for it, W (Table 3).
    pub paper_power: Option<f64>,
}

impl Case {
    /// All cases, in the paper's order.
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
    Case { name, description, parameters, paper_voltage_gain: gain, paper_power: None }
}

const fn flashlight(name: &'static str, description: &'static str, parameters: fn() -> Parameters, power: f64) -> Case {
    Case { name, description, parameters, paper_voltage_gain: None, paper_power: Some(power) }
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

    #[test]
    fn table_3_has_the_capacitance_that_the_paper_prints() {
        let membrane = crate::Membrane::new(&flashlight_sized(2.0));
        assert_relative_eq!(membrane.rest_capacitance(), 2.42e-11, max_relative = 2e-3);
    }
}
