//! The paper's own method: Runge-Kutta of fourth order with a fixed step, and Eq. (11) where a step ends beyond a
//! membrane. It stands here to be compared with.

use std::f64::consts::TAU;

use videg_model::{Membrane, Parameters};

/// What a run by the paper's method comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stepped {
    /// P, Eq. (14), over the window, W.
    pub(super) power: f64,
    /// Impacts counted within the window.
    pub(super) impacts: u64,
}

/// Steps Eq. (7) by `dt`, s, from 0 s to the end of the `window`, s.
pub(super) fn run(p: &Parameters, dt: f64, [from, to]: [f64; 2]) -> Stepped {
    let membrane = Membrane::new(p);
    let acceleration = |time: f64| p.amplitude / p.cylinder_mass * (TAU * p.frequency * time + p.phase).cos();
    let (mut z, mut v) = (p.cylinder_position, p.cylinder_velocity);
    let (mut ball, mut ball_velocity) = (p.ball_position, p.ball_velocity);
    let half = p.travel() / 2.0;
    let (mut energy, mut impacts) = (0.0, 0);
    let mut start = acceleration(0.0);
    let (mut time, mut steps) = (0.0, 0_u64);
    while time < to {
        // The right-hand side depends on time only: the two middle stages of the method are one.
        let (middle, end) = (acceleration(time + 0.5 * dt), acceleration(time + dt));
        z += dt * v + dt * dt / 6.0 * (start + 2.0 * middle);
        v += dt / 6.0 * (start + 4.0 * middle + end);
        ball += dt * ball_velocity;
        steps += 1;
        time = steps as f64 * dt;
        start = end;
        let (gap, closing) = (z - ball, v - ball_velocity);
        if gap.abs() >= half && gap * closing > 0.0 {
            ball_velocity = v + p.restitution * closing;
            if time > from {
                energy += membrane.impact_energy(membrane.deflection(closing.abs()), p.bias_voltage);
                impacts += 1;
            }
        }
    }
    Stepped { power: energy / (to - from), impacts }
}
