//! The excitation by its normalised amplitude.

use std::f64::consts::TAU;

use videg_model::Parameters;

use super::{PaperError, Study};
use crate::scenario::Setting;

/// `f_0`, Hz, and A, N, of Figures 11 to 15.
pub const FREQUENCY: f64 = 2.0;
pub const FORCE: f64 = 0.5;

/// The variable called `name` at `value`, to the last bit.
pub fn set(name: &str, value: f64) -> Setting {
    Setting::new(name, format!("{value:?}"))
}

/// The cylinder as the FMU has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// M, kg.
    mass: f64,
    /// s, m: largest distance that the ball moves.
    travel: f64,
}

impl Cylinder {
    /// Reads the start values of the FMU, those of Section 4.2.
    pub fn new(study: &Study<'_>) -> Result<Self, PaperError> {
        let [mass, travel] = study.reals(&study.start(&[])?, ["cylinder.mass", "ball.travel"])?;
        Ok(Self { mass, travel })
    }

    /// A, N, of the normalised amplitude `gamma` at `frequency`, Hz: Eq. (16).
    pub fn force(&self, gamma: f64, frequency: f64) -> f64 {
        gamma * self.mass * (TAU * frequency).powi(2) * self.travel / 2.0
    }

    /// The normalised amplitude of the `force`, N, at `frequency`, Hz: Eq. (16).
    pub fn gamma(&self, force: f64, frequency: f64) -> f64 {
        force / self.force(1.0, frequency)
    }

    /// The start of Figures 10, 11, 14 and 15 at r = `restitution`, the normalised amplitude `gamma` and `frequency`, Hz:
    /// `z_m`(0) = `z_M`(0) + s/2, `z_m`'(0) = -4 `f_0` `z_m`(0).
    pub fn saw_tooth(&self, restitution: f64, gamma: f64, frequency: f64) -> Parameters {
        let half = self.travel / 2.0;
        let cylinder_position = -gamma * half;
        Parameters {
            restitution,
            amplitude: self.force(gamma, frequency),
            frequency,
            cylinder_position,
            ball_position: cylinder_position + half,
            ball_velocity: -4.0 * frequency * half * (1.0 - gamma),
            ..Parameters::default()
        }
    }

    /// Zero start, r = 1, at the normalised amplitude `gamma` and `frequency`, Hz: Section 5.1. The ball starts with
    /// `nudge`, m/s.
    pub fn elastic(&self, gamma: f64, frequency: f64, nudge: f64) -> Vec<Setting> {
        vec![
            set("membrane.restitution", 1.0),
            set("excitation.amplitude", self.force(gamma, frequency)),
            set("excitation.frequency", frequency),
            set("initial.ballVelocity", nudge),
        ]
    }
}

/// Velocity of the ball, m/s, in the `index`-th of `count` starts that no measurement tells apart: evenly spaced over 1e-6 m/s about
/// 0. A chaotic motion forgets them within seconds.
pub fn nudge(index: usize, count: usize) -> f64 {
    1e-6 * ((index as f64 + 0.5) / count as f64 - 0.5)
}
