//! The excitation and what it does to the cylinder: Eqs. (7) and (16), Section 5.2.

use core::f64::consts::TAU;

/// Eq. (7): `z_M''`, m/s^2, under a harmonic force of `amplitude` A / M, m/s^2, at this cosine of its angle, and an external force
/// over M, m/s^2.
#[inline]
pub fn acceleration(amplitude: f64, cosine: f64, external: f64) -> f64 {
    amplitude * cosine + external
}

/// Section 5.2: the phase of the force under phase noise, phi + sigma xi, in the unit of `phase` and `intensity`.
#[inline(always)]
#[allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors
pub fn noisy_phase(phase: f64, intensity: f64, xi: f64) -> f64 {
    phase + intensity * xi
}

/// Section 5.1: amplitude of the cylinder's motion, A / (M (2 pi `f_0`)^2), m.
pub fn cylinder_amplitude(amplitude: f64, cylinder_mass: f64, frequency: f64) -> f64 {
    let omega = TAU * frequency;
    amplitude / (cylinder_mass * omega * omega)
}

/// Eq. (16): gamma, the cylinder's amplitude over half the ball's travel, m.
pub fn normalized_amplitude(cylinder_amplitude: f64, half_travel: f64) -> f64 {
    cylinder_amplitude / half_travel
}
