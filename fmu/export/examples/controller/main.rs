//! A sampled PI controller, whose clock the importer makes tick: `cargo fmu build --example controller --fmi 3`. In FMI 2.0, which
//! has no clocks, it would be empty but for its parameters.

use fmu_export::{ClockInterval, EventOutcome, Logger, ModelInfo, Slave, SlaveError, Variable, Variables, export_fmu};

/// From one sample to the next, s.
const INTERVAL: f64 = 0.1;

/// The model.
#[derive(Clone, Default, Variables)]
struct Controller {
    /// K: gain
    #[parameter(start = 1.0, min = 0.0)]
    gain: f64,
    /// T: integration time
    #[parameter(name = "integrationTime", unit = "s", start = 1.0, min = 1e-6)]
    integration_time: f64,
    /// Bound on the control signal, both ways
    #[parameter(start = 10.0, min = 0.0)]
    limit: f64,
    /// Ticks at each sample
    #[input_clock(name = "sample.clock", interval = ClockInterval::Periodic { interval: INTERVAL, shift: 0.0 })]
    sample: bool,
    /// What the measured value is to be
    #[input(discrete, clocked_by = &["sample.clock"])]
    setpoint: f64,
    /// Measured value
    #[input(discrete, clocked_by = &["sample.clock"])]
    measured: f64,
    /// Control signal: it holds until the next sample
    #[output(discrete, clocked_by = &["sample.clock"])]
    control: f64,
    /// Sum of the deviations, in units of K e INTERVAL / T
    integral: f64,
    /// The sample at hand has been worked out: events may be iterated.
    done: bool,
}

impl Slave for Controller {
    const INFO: ModelInfo = ModelInfo::new("Controller")
        .description("Sampled PI controller")
        .version(env!("CARGO_PKG_VERSION"))
        .license("MIT OR Apache-2.0")
        .default_experiment(0.0, 10.0, INTERVAL);

    fn variables() -> &'static [Variable<Self>] {
        &Self::VARIABLES
    }

    fn new() -> Self {
        Self::default()
    }

    fn handle_events(&mut self, _log: &Logger) -> Result<EventOutcome, SlaveError> {
        if self.sample && !self.done {
            let deviation = self.gain * (self.setpoint - self.measured);
            let integral = self.integral + deviation * INTERVAL / self.integration_time;
            self.control = (deviation + integral).clamp(-self.limit, self.limit);
            // At its bound the signal does not wind up.
            if self.control == deviation + integral {
                self.integral = integral;
            }
        }
        self.done = self.sample;
        Ok(EventOutcome::default())
    }

    fn do_step(&mut self, _t: f64, _h: f64, _log: &Logger) -> Result<(), SlaveError> {
        self.done = false;
        Ok(())
    }
}

export_fmu!(Controller);
