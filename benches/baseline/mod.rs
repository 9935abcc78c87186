//! The paper's method: fourth-order Runge-Kutta with a fixed step, Eq. (11) applied at the end of each step that ends
//! beyond a membrane. Written with care for speed: the force is evaluated once for each distinct time, the velocity at
//! the half step is shared, and the loop holds nothing but the state.

use std::f64::consts::TAU;

use videg_model::{Membrane, Parameters};

/// Sum of `U_DE4` - `U_in`, V, over a run of `until`, s, with steps of `dt`, s.
pub fn runge_kutta(p: &Parameters, dt: f64, until: f64) -> f64 {
    let membrane = Membrane::new(p);
    let (omega, amplitude) = (TAU * p.frequency, p.amplitude / p.cylinder_mass);
    let half = p.travel() / 2.0;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
    let steps = (until / dt).round() as u64;
    let (mut z, mut v) = (p.cylinder_position, p.cylinder_velocity);
    let (mut ball, mut ball_velocity) = (p.ball_position, p.ball_velocity);
    let mut gain = 0.0;
    let mut before = amplitude * p.phase.cos();
    for n in 0..steps {
        let time = n as f64 * dt;
        let middle = amplitude * (omega * (time + 0.5 * dt) + p.phase).cos();
        let after = amplitude * (omega * (time + dt) + p.phase).cos();
        z += dt * v + dt * dt / 6.0 * (before + 2.0 * middle);
        v += dt / 6.0 * (before + 4.0 * middle + after);
        ball += dt * ball_velocity;
        before = after;
        let dz = z - ball;
        if dz.abs() >= half && dz * (v - ball_velocity) > 0.0 {
            let speed = (v - ball_velocity).abs();
            gain += p.bias_voltage * membrane.capacitance_excess(membrane.deflection(speed));
            ball_velocity = -p.restitution * ball_velocity + (1.0 + p.restitution) * v;
        }
    }
    gain
}
