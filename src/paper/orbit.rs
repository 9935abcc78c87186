//! The saw-tooth orbit of Figure 10, and its multipliers.
//!
//! With r = 1 the ball flies from membrane to membrane in half a period T/2 and meets each at a turning point of the
//! cylinder, whose velocity is 0 then and whose acceleration is g = A / M. Let it hit dt later than it should and fly
//! by q faster: to first order the wall stands where it should and moves at g dt, so an impact changes q by -2 g dt,
//! and the next one is late by dt - T/(2 V) q, V the speed of the orbit. Half a period thus takes (dt, q) through a
//! matrix of determinant 1 and trace 2 + 2 k, k = g T / (2 V): the orbit is a saddle. Where the force has the opposite
//! sign at the impacts, the trace is 2 - 2 k, and the orbit a centre.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::DMatrix;

use super::excitation::set;
use super::{PaperError, Study};
use crate::dynamics::orbits::Multipliers;
use crate::scenario::Setting;

/// At which turning point of the cylinder the ball hits a membrane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// The wall accelerates away from the ball: the start of the paper.
    Paper,
    /// The force has the opposite sign.
    Opposite,
}

/// A saw-tooth orbit.
#[derive(Debug, Clone, Copy)]
pub(super) struct SawTooth {
    pub(super) phase: Phase,
    /// `f_0`, Hz.
    pub(super) frequency: f64,
    /// s/2, m.
    pub(super) half_travel: f64,
    /// A / M, m/s^2.
    pub(super) acceleration: f64,
}

impl SawTooth {
    /// The orbit of a case, its parameters read from the FMU.
    pub(super) fn of(study: &Study<'_>, settings: &[Setting], phase: Phase) -> Result<Self, PaperError> {
        let instance = study.start(settings)?;
        let names = ["excitation.frequency", "ball.travel", "excitation.amplitude", "cylinder.mass"];
        let [frequency, travel, amplitude, mass] = study.reals(&instance, names)?;
        Ok(Self { phase, frequency, half_travel: travel / 2.0, acceleration: amplitude / mass })
    }

    pub(super) fn period(&self) -> f64 {
        1.0 / self.frequency
    }

    /// `z_M` at the impact on the right membrane, m: minus or plus the amplitude.
    fn turning_point(&self) -> f64 {
        let omega = TAU * self.frequency;
        let swing = self.acceleration / (omega * omega);
        if self.phase == Phase::Paper { -swing } else { swing }
    }

    /// Speed of the ball, m/s: 4 `f_0` `z_m`(0).
    pub(super) fn speed(&self) -> f64 {
        4.0 * self.frequency * (self.half_travel + self.turning_point())
    }

    /// Settings that start the FMU at the impact on the right membrane, with the ball moving away from it.
    pub(super) fn at_impact(&self) -> Vec<Setting> {
        let position = self.turning_point();
        let phase = if self.phase == Phase::Paper { 0.0 } else { PI };
        self.start(phase, [position, 0.0], [self.half_travel + position, -self.speed()])
    }

    /// `z_M - z_m`, m, and its rate, m/s, a quarter of a period after the impact on the right membrane.
    pub(super) fn in_the_middle(&self) -> [f64; 2] {
        [0.0, -self.turning_point() * TAU * self.frequency + self.speed()]
    }

    /// Settings that start the FMU there, with this relative displacement, m, and velocity, m/s.
    fn start_in_the_middle(&self, [displacement, velocity]: [f64; 2]) -> Vec<Setting> {
        let phase = if self.phase == Phase::Paper { FRAC_PI_2 } else { FRAC_PI_2 + PI };
        let cylinder = [0.0, -self.turning_point() * TAU * self.frequency];
        self.start(phase, cylinder, [cylinder[0] - displacement, cylinder[1] - velocity])
    }

    fn start(&self, phase: f64, cylinder: [f64; 2], ball: [f64; 2]) -> Vec<Setting> {
        let values = [
            ("excitation.frequency", self.frequency),
            ("excitation.phase", phase),
            ("initial.cylinderPosition", cylinder[0]),
            ("initial.cylinderVelocity", cylinder[1]),
            ("initial.ballPosition", ball[0]),
            ("initial.ballVelocity", ball[1]),
        ];
        values.map(|(name, value)| set(name, value)).to_vec()
    }

    /// Distance of a relative displacement and velocity from the orbit's in the middle, in units of s/2 and V.
    pub(super) fn distance(&self, [displacement, velocity]: [f64; 2]) -> f64 {
        let [d, v] = self.in_the_middle();
        ((displacement - d) / self.half_travel).hypot((velocity - v) / self.speed())
    }

    /// Multipliers by the closed form.
    pub(super) fn closed_form(&self) -> Multipliers {
        let k = self.acceleration * self.period() / (2.0 * self.speed());
        let k = if self.phase == Phase::Paper { k } else { -k };
        let tau = self.period() / (2.0 * self.speed());
        let g = k / tau;
        // (dt, q) after half a period; the other half is its mirror image.
        let half = DMatrix::from_row_slice(2, 2, &[1.0, -tau, -2.0 * g, 1.0 + 2.0 * g * tau]);
        Multipliers::of(&(&half * &half)).unwrap_or_default()
    }

    /// Multipliers by central differences of runs of the FMU over one period; `settings` are those of the case.
    pub(super) fn by_differences(&self, study: &Study<'_>, settings: &[Setting]) -> Result<Multipliers, PaperError> {
        /// Step in units of s/2 and V: its square is the error of the differences, rounding over it their noise.
        const STEP: f64 = 1e-5;
        let scale = [self.half_travel, self.speed()];
        let middle = self.in_the_middle();
        let mut matrix = DMatrix::zeros(2, 2);
        for column in 0..2 {
            let after = |step: f64| {
                let mut state = middle;
                state[column] += step * scale[column];
                self.after_a_period(study, settings, state)
            };
            let (ahead, behind) = (after(STEP)?, after(-STEP)?);
            for row in 0..2 {
                matrix[(row, column)] = (ahead[row] - behind[row]) / (2.0 * STEP * scale[row]);
            }
        }
        Ok(Multipliers::of(&matrix).unwrap_or_default())
    }

    fn after_a_period(&self, study: &Study<'_>, settings: &[Setting], state: [f64; 2]) -> Result<[f64; 2], PaperError> {
        let mut instance = study.start(&[settings, &self.start_in_the_middle(state)].concat())?;
        instance.do_step(0.0, self.period())?;
        study.relative_motion(&instance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_closed_form_has_the_trace_of_half_a_period() {
        // k = g T / (2 V): multipliers of half a period have the sum 2 + 2 k and the product 1.
        for phase in [Phase::Paper, Phase::Opposite] {
            let orbit = SawTooth { phase, frequency: 2.0, half_travel: 0.022, acceleration: 0.01 / 0.1245 };
            let k = orbit.acceleration * orbit.period() / (2.0 * orbit.speed());
            let found = orbit.closed_form();
            let [large, small] = found.0[..] else { panic!("{found:?}") };
            if phase == Phase::Paper {
                assert_relative_eq!(large.re.sqrt() + small.re.sqrt(), 2.0 + 2.0 * k, max_relative = 1e-12);
                assert_relative_eq!(large.re * small.re, 1.0, max_relative = 1e-12);
            } else {
                assert_relative_eq!(found.largest(), 1.0, max_relative = 1e-12);
                assert_relative_eq!(2.0 * (large.arg() / 2.0).cos(), 2.0 - 2.0 * k, max_relative = 1e-12);
            }
            assert_eq!(large.im == 0.0, phase == Phase::Paper);
        }
    }
}
