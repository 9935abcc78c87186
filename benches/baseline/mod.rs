//! The paper's method: fourth-order Runge-Kutta with a fixed step, Eq. (11) applied at the end of each step that ends
//! beyond a membrane. Twice: stage by stage, as it stands in textbooks, and reduced to what it comes to here. Both are written
//! with care for speed: the loop holds nothing but the state.

use std::f64::consts::TAU;

use videg_model::{Membrane, Parameters};

/// Sum of `U_DE4` - `U_in`, V, over a run of `until`, s, with steps of `dt`, s, stage by stage.
#[allow(dead_code)] // not every benchmark runs it
pub fn runge_kutta_by_stages(p: &Parameters, dt: f64, until: f64) -> f64 {
    let membrane = Membrane::new(p);
    let (omega, amplitude) = (TAU * p.frequency, p.amplitude / p.cylinder_mass);
    let half = p.travel() / 2.0;
    // Rates of z_M, z_M', z_m and z_m': Eqs. (7) and (8) between impacts.
    let rates = |time: f64, y: [f64; 4]| [y[1], amplitude * (omega * time + p.phase).cos(), y[3], 0.0];
    let moved = |y: [f64; 4], k: [f64; 4], h: f64| [0, 1, 2, 3].map(|i| y[i] + h * k[i]);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
    let steps = (until / dt).round() as u64;
    let mut y = [p.cylinder_position, p.cylinder_velocity, p.ball_position, p.ball_velocity];
    let mut gain = 0.0;
    for n in 0..steps {
        let time = n as f64 * dt;
        let k1 = rates(time, y);
        let k2 = rates(time + 0.5 * dt, moved(y, k1, 0.5 * dt));
        let k3 = rates(time + 0.5 * dt, moved(y, k2, 0.5 * dt));
        let k4 = rates(time + dt, moved(y, k3, dt));
        y = [0, 1, 2, 3].map(|i| y[i] + dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        let (dz, approach) = (y[0] - y[2], y[1] - y[3]);
        if dz.abs() >= half && dz * approach > 0.0 {
            gain += p.bias_voltage * membrane.capacitance_excess(membrane.deflection(approach.abs()));
            y[3] = -p.restitution * y[3] + (1.0 + p.restitution) * y[1];
        }
    }
    gain
}

/// The same, reduced: the force depends on the time alone, so that it is evaluated once for each distinct time, and the
/// stages come to Simpson's rule.
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
