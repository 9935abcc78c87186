//! A first-order lag as an FMU, with all that a model can offer: T y' = u - y, solved exactly for an input that is
//! constant or linear within a step.
//!
//! `cargo fmu build --example lag` makes the FMU.

use fmu_export::{Logger, ModelInfo, Slave, SlaveError, StateError, StateReader, StateWriter, Variable, export_fmu};

/// The model; `rate` is the time derivative of the input.
#[derive(Clone, Default)]
pub struct Lag {
    time_constant: f64,
    initial_output: f64,
    input: f64,
    rate: f64,
    output: f64,
}

type V = Variable<Lag>;

static VARIABLES: [V; 5] = [
    V::parameter("timeConstant", "s", 1.0, "T: time constant")
        .min(1e-6)
        .access(|m| m.time_constant, |m, v| m.time_constant = v),
    V::parameter("initial.output", "V", 0.0, "y(0): output at the start")
        .access(|m| m.initial_output, |m, v| m.initial_output = v),
    V::calculated_parameter("cutoffFrequency", "Hz", "1/(2 pi T): frequency at which the output is down by 3 dB")
        .get(|m| 1.0 / (core::f64::consts::TAU * m.time_constant)),
    V::input("u", "V", 1.0, "u: input").input_derivatives(1, |m, _, v| m.rate = v).access(
        |m| m.input,
        |m, v| {
            m.input = v;
            m.rate = 0.0; // A derivative belongs to the value that it came with.
        },
    ),
    V::output("y", "V", "y: output").depends_on(&[]).get(|m| m.output),
];

impl Slave for Lag {
    const INFO: ModelInfo = ModelInfo::new("Lag")
        .description("First-order lag")
        .author("The videg developers")
        .version(env!("CARGO_PKG_VERSION"))
        .license("MIT OR Apache-2.0")
        .default_experiment(0.0, 10.0, 0.1)
        .can_serialize();

    fn variables() -> &'static [Variable<Self>] {
        &VARIABLES
    }

    fn new() -> Self {
        Self::default()
    }

    fn update(&mut self) {
        self.output = self.initial_output;
    }

    /// y(h) = u(h) - r T + (y(0) - u(0) + r T) exp(-h/T) for u(t) = u(0) + r t.
    fn do_step(&mut self, _t: f64, h: f64, _log: &Logger) -> Result<(), SlaveError> {
        let lag = self.rate * self.time_constant;
        let decay = (-h / self.time_constant).exp();
        self.output = self.input + self.rate * h - lag + (self.output - self.input + lag) * decay;
        Ok(())
    }

    fn write_state(&self, out: &mut StateWriter) -> Result<(), StateError> {
        out.write(&[self.time_constant, self.initial_output, self.input, self.rate, self.output])
    }

    fn read_state(from: &mut StateReader<'_>, _: &Self) -> Result<Self, StateError> {
        let [time_constant, initial_output, input, rate, output] = from.take()?;
        Ok(Self { time_constant, initial_output, input, rate, output })
    }
}

export_fmu!(Lag);
