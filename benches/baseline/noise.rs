//! Phase noise as a plain program would have it: one hold interval after the other, ziggurat samples, the mathematical
//! library's cosine, Eq. (11) at the end of each interval that ends beyond a membrane. Written with care for speed: what is
//! constant stands outside of the loop, which holds nothing but the state.

use std::f64::consts::TAU;

use rand::SeedableRng;
use rand::rngs::SmallRng;
use rand_distr::{Distribution, StandardNormal};
use videg_model::{Membrane, Parameters};

/// Cylinder: position, m, and velocity, m/s.
type Cylinder = [f64; 2];

/// Sum of `U_DE4` - `U_in`, V, over a run of `until`, s, by the paper's Runge-Kutta method with the hold time as step. A new
/// phase in each step leaves no value of the force to share with the next one.
pub fn runge_kutta(p: &Parameters, until: f64) -> f64 {
    let (omega, amplitude, h) = (TAU * p.frequency, p.amplitude / p.cylinder_mass, p.noise_hold);
    run(p, until, |[z, v], n, phase| {
        let begin = omega * (n as f64 * h) + phase;
        let [a, b, c] = [begin, begin + 0.5 * omega * h, begin + omega * h].map(f64::cos);
        [z + h * v + amplitude * h * h / 6.0 * (a + 2.0 * b), v + amplitude * h / 6.0 * (a + 4.0 * b + c)]
    })
}

/// The same by the closed form of a hold interval, the angle taken in its middle: one sine and cosine each.
pub fn closed_form(p: &Parameters, until: f64) -> f64 {
    let (omega, h) = (TAU * p.frequency, p.noise_hold);
    let (swing, x) = (p.amplitude / p.cylinder_mass / (omega * omega), 0.5 * omega * h);
    let push = 2.0 * swing * omega * x.sin();
    let shift = [swing * omega * h * x.sin(), swing * 2.0 * (x.sin() - x * x.cos())];
    run(p, until, |[z, v], n, phase| {
        let (sin, cos) = (omega * ((n as f64 + 0.5) * h) + phase).sin_cos();
        [z + h * v + shift[0] * cos + shift[1] * sin, v + push * cos]
    })
}

fn run(p: &Parameters, until: f64, step: impl Fn(Cylinder, u64, f64) -> Cylinder) -> f64 {
    let (membrane, half) = (Membrane::new(p), p.travel() / 2.0);
    let mut random = SmallRng::seed_from_u64(u64::from(p.seed.cast_unsigned()));
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
    let steps = (until / p.noise_hold).round() as u64;
    let mut cylinder = [p.cylinder_position, p.cylinder_velocity];
    let (mut ball, mut ball_velocity, mut gain) = (p.ball_position, p.ball_velocity, 0.0);
    for n in 0..steps {
        let xi: f64 = StandardNormal.sample(&mut random);
        cylinder = step(cylinder, n, p.phase + p.phase_noise * xi);
        ball += p.noise_hold * ball_velocity;
        let (dz, approach) = (cylinder[0] - ball, cylinder[1] - ball_velocity);
        if dz.abs() >= half && dz * approach > 0.0 {
            gain += p.bias_voltage * membrane.capacitance_excess(membrane.deflection(approach.abs()));
            ball_velocity = -p.restitution * ball_velocity + (1.0 + p.restitution) * cylinder[1];
        }
    }
    gain
}
