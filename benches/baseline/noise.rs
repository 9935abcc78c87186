//! Phase noise as a plain program in C has it (`noise.c`).

#[path = "c.rs"]
mod c;

use core::f64::consts::TAU;
use core::ffi::c_void;

use anyhow::Result;
use libloading::Library;
use videg_model::{Membrane, Parameters};

/// `struct parameters` of `noise.c`.
#[repr(C)]
struct Run {
    cylinder_mass: f64,
    amplitude: f64,
    omega: f64,
    phase: f64,
    phase_noise: f64,
    hold: f64,
    restitution: f64,
    half_travel: f64,
    cylinder_position: f64,
    cylinder_velocity: f64,
    ball_position: f64,
    ball_velocity: f64,
    gain: extern "C" fn(*const c_void, f64) -> f64,
    membrane: *const c_void,
    seed: u64,
    steps: u64,
}

/// A membrane and its bias voltage, V.
struct Generator(Membrane, f64);

extern "C" fn gain(generator: *const c_void, speed: f64) -> f64 {
    // SAFETY: `Plain::run` hands this over and keeps it meanwhile.
    let Generator(membrane, bias) = unsafe { &*generator.cast() };
    bias * membrane.capacitance_excess(membrane.deflection(speed))
}

/// The plain program.
pub struct Plain(Library);

impl Plain {
    pub fn compile() -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let library = c::compile("noise.c", folder.path(), &[])?;
        // SAFETY: nothing runs when the library is loaded.
        Ok(Self(unsafe { Library::new(library) }?))
    }

    /// Sum of `U_DE4` - `U_in`, V, over a run of `until`, s, by the paper's Runge-Kutta method.
    pub fn runge_kutta(&self, p: &Parameters, until: f64) -> Result<f64> {
        self.run(b"noise_runge_kutta", p, until)
    }

    /// The same by the closed form of each hold interval.
    pub fn closed_form(&self, p: &Parameters, until: f64) -> Result<f64> {
        self.run(b"noise_closed_form", p, until)
    }

    fn run(&self, function: &[u8], p: &Parameters, until: f64) -> Result<f64> {
        let generator = Generator(Membrane::new(p), p.bias_voltage);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a positive number of steps
        let steps = (until / p.noise_hold).round() as u64;
        let run = Run {
            cylinder_mass: p.cylinder_mass,
            amplitude: p.amplitude,
            omega: TAU * p.frequency,
            phase: p.phase,
            phase_noise: p.phase_noise,
            hold: p.noise_hold,
            restitution: p.restitution,
            half_travel: p.travel() / 2.0,
            cylinder_position: p.cylinder_position,
            cylinder_velocity: p.cylinder_velocity,
            ball_position: p.ball_position,
            ball_velocity: p.ball_velocity,
            gain,
            membrane: (&raw const generator).cast(),
            seed: u64::from(p.seed.cast_unsigned()),
            steps,
        };
        // SAFETY: the functions of this name in noise.c have this signature.
        let function = unsafe { self.0.get::<unsafe extern "C" fn(*const Run) -> f64>(function) }?;
        // SAFETY: `run` and what it points to live until the call returns.
        Ok(unsafe { function(&raw const run) })
    }

    /// Standard normal samples of the plain program.
    #[allow(dead_code)] // for the tests of the baseline
    pub fn samples(&self, seed: u64, count: usize) -> Result<Vec<f64>> {
        let mut samples = vec![0.0; count];
        // SAFETY: the function of this name in noise.c has this signature.
        let fill = unsafe { self.0.get::<unsafe extern "C" fn(u64, u64, *mut f64)>(b"noise_samples") }?;
        // SAFETY: there is room for so many samples.
        unsafe { fill(seed, count as u64, samples.as_mut_ptr()) };
        Ok(samples)
    }
}
