//! A ball that bounces on the floor, with its events: in FMI 3.0 a step ends at each bounce if the importer allows it, and a clock
//! ticks there. `cargo fmu build --example ball --fmi 3`
//!
//! Between bounces the motion is exact, so that the division of a run into steps changes nothing but rounding.

use fmu_export::{Logger, ModelInfo, Slave, SlaveError, Stop, Variable, Variables, export_fmu};

/// The model.
#[derive(Clone, Default, Variables)]
struct Ball {
    /// g: acceleration towards the floor
    #[parameter(unit = "m/s2", start = 9.81, min = 1e-3, max = 1e3)]
    gravity: f64,
    /// e: speed after a bounce over that before
    #[parameter(start = 0.7, min = 0.0, max = 0.99)]
    restitution: f64,
    /// h(0): height at the start
    #[parameter(name = "initial.height", unit = "m", start = 1.0, min = 0.0, max = 1e6)]
    initial_height: f64,
    /// v(0): velocity at the start, upwards
    #[parameter(name = "initial.velocity", unit = "m/s", min = -1e4, max = 1e4)]
    initial_velocity: f64,
    /// h: height above the floor
    #[output(unit = "m", depends_on = &[])]
    height: f64,
    /// v: velocity, upwards
    #[output(unit = "m/s", depends_on = &[])]
    velocity: f64,
    /// Whether the ball lies on the floor for good
    #[output]
    resting: bool,
    /// Number of bounces
    #[output(depends_on = &[])]
    bounces: u64,
    /// Ticks at each bounce
    #[output_clock(name = "bounce.clock")]
    bounce: bool,
    /// Speed before the bounce
    #[output(name = "bounce.speed", unit = "m/s", discrete, clocked_by = &["bounce.clock"])]
    bounce_speed: f64,
}

/// Speed after a bounce below which the ball rests, m/s: it would bounce ever faster, infinitely often in a finite time.
const RESTING_SPEED: f64 = 1e-3;

impl Slave for Ball {
    const INFO: ModelInfo = ModelInfo::new("Ball")
        .description("A ball that bounces on the floor")
        .version(env!("CARGO_PKG_VERSION"))
        .license("MIT OR Apache-2.0")
        .default_experiment(0.0, 3.0, 0.01)
        .stops_at_events();

    fn variables() -> &'static [Variable<Self>] {
        &Self::VARIABLES
    }

    fn new() -> Self {
        Self::default()
    }

    fn update(&mut self) {
        (self.height, self.velocity) = (self.initial_height, self.initial_velocity);
        self.resting = self.height == 0.0 && self.velocity <= 0.0;
    }

    fn do_step(&mut self, t: f64, h: f64, log: &Logger) -> Result<(), SlaveError> {
        let mut now = t;
        while let Some(stop) = self.do_step_to_event(now, t + h, log)? {
            now = stop.time;
        }
        Ok(())
    }

    fn do_step_to_event(&mut self, t: f64, end: f64, _log: &Logger) -> Result<Option<Stop>, SlaveError> {
        self.bounce = false;
        let mut now = t;
        loop {
            let impact = now + self.flight();
            if self.resting || impact > end {
                self.fly(end - now);
                return Ok(None);
            }
            self.fly(self.flight());
            self.rebound();
            // A bounce within rounding of the begin would be no progress for the importer.
            if impact > t {
                return Ok(Some(Stop { time: impact, is_event: true }));
            }
            now = impact;
        }
    }
}

impl Ball {
    /// Time until the ball is on the floor, s.
    fn flight(&self) -> f64 {
        let impact_speed = (self.velocity * self.velocity + 2.0 * self.gravity * self.height.max(0.0)).sqrt();
        (self.velocity + impact_speed) / self.gravity
    }

    fn fly(&mut self, duration: f64) {
        if !self.resting {
            self.height += (self.velocity - 0.5 * self.gravity * duration) * duration;
            self.velocity -= self.gravity * duration;
        }
    }

    fn rebound(&mut self) {
        self.bounce_speed = -self.velocity;
        self.height = 0.0;
        self.velocity *= -self.restitution;
        self.bounces += 1;
        self.bounce = true;
        if self.velocity < RESTING_SPEED {
            (self.velocity, self.resting) = (0.0, true);
        }
    }
}

export_fmu!(Ball);
