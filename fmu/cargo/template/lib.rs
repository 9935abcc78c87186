//! A first-order lag, T y' = u - y, solved exactly for an input that is constant within a step.

use fmu_export::{Logger, ModelInfo, Slave, SlaveError, Variable, Variables, export_fmu};

/// The model: a field is a variable of the FMU if it has an attribute.
#[derive(Clone, Default, Variables)]
struct Model {
    /// T: time constant
    #[parameter(name = "timeConstant", unit = "s", start = 1.0, min = 1e-6)]
    time_constant: f64,
    /// u: input
    #[input(start = 1.0)]
    u: f64,
    /// y: output
    #[output(depends_on = &[])]
    y: f64,
}

impl Slave for Model {
    const INFO: ModelInfo = ModelInfo::new("{identifier}")
        .description("First-order lag")
        .version(env!("CARGO_PKG_VERSION"))
        .default_experiment(0.0, 10.0, 0.1);

    fn variables() -> &'static [Variable<Self>] {
        &Self::VARIABLES
    }

    fn new() -> Self {
        Self::default()
    }

    fn do_step(&mut self, _t: f64, h: f64, _log: &Logger) -> Result<(), SlaveError> {
        self.advance(h);
        Ok(())
    }
}

impl Model {
    fn advance(&mut self, h: f64) {
        self.y += (self.u - self.y) * -(-h / self.time_constant).exp_m1();
    }
}

export_fmu!(Model);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_steps_are_one_of_twice_the_length() {
        let mut once = Model { time_constant: 2.0, u: 1.0, y: 0.0 };
        let mut twice = once.clone();
        once.advance(1.0);
        twice.advance(0.5);
        twice.advance(0.5);
        assert!((once.y - twice.y).abs() < 1e-15);
    }
}
