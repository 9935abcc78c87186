//! The slave that the tests export: one variable of every sort, and a switch that makes any hook fail.

use fmu_export::{
    ClockInterval, EnumerationType, EventOutcome, Experiment, IntegerWidth, Logger, ModelInfo, Slave, SlaveError,
    StateError, StateReader, StateWriter, Stop, Terminal, Variable, export_fmu,
};
use serde::{Deserialize, Serialize};
use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};

thread_local! {
    /// The folders that toys were told of.
    pub static RESOURCES: RefCell<Vec<PathBuf>> = const { RefCell::new(Vec::new()) };
    /// Makes `Toy::new` panic, which no variable can.
    pub static PANIC_IN_NEW: Cell<bool> = const { Cell::new(false) };
    /// Makes each call of this function on an instance panic.
    pub static PANIC_IN_CALL: Cell<Option<&'static str>> = const { Cell::new(None) };
    /// Makes `Toy::clone` panic.
    pub static PANIC_IN_CLONE: Cell<bool> = const { Cell::new(false) };
    /// Makes dropping a `Toy` panic.
    pub static PANIC_IN_DROP: Cell<bool> = const { Cell::new(false) };
}

#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Toy {
    gain: f64,
    limit: f64,
    doubled: f64,
    input: f64,
    slope: f64,
    integral: f64,
    count: i64,
    seed: i64,
    on: bool,
    label: String,
    law: i32,
    trouble: String,
    updates: i64,
    start_time: f64,
    time: f64,
    switched: f64,
    wide: [i64; 8],
    single: f64,
    sample: bool,
    sampled: f64,
    samples: i64,
}

impl Clone for Toy {
    fn clone(&self) -> Self {
        assert!(!PANIC_IN_CLONE.get(), "panic in clone");
        Self { label: self.label.clone(), trouble: self.trouble.clone(), ..*self }
    }
}

pub static LAW: EnumerationType = EnumerationType {
    name: "Law",
    description: "What is integrated",
    items: &[("value", "The input"), ("square", "Its square, x < y & \"so\"")],
};

pub const GAIN: u32 = 0;
pub const LIMIT: u32 = 1;
pub const DOUBLED: u32 = 2;
pub const INPUT: u32 = 3;
pub const INTEGRAL: u32 = 4;
pub const SEED: u32 = 5;
pub const COUNT: u32 = 6;
pub const ON: u32 = 7;
pub const IS_ON: u32 = 8;
pub const LABEL: u32 = 9;
pub const ECHO: u32 = 10;
pub const LAW_VR: u32 = 11;
pub const CHOSEN: u32 = 12;
pub const TROUBLE: u32 = 13;
pub const UPDATES: u32 = 14;
pub const TIME: u32 = 15;
pub const DERIVATIVE: u32 = 16;
pub const SWITCHED: u32 = 17;
pub const HELD: u32 = 18;
pub const SINGLE: u32 = 19;
/// The first of eight integers, in the order of [`WIDTHS`].
pub const WIDE: u32 = 20;
pub const TICK: u32 = 28;
pub const TICKS: u32 = 29;
pub const SAMPLE: u32 = 30;
pub const SAMPLED: u32 = 31;
pub const SAMPLES: u32 = 32;
pub const TRIGGER: u32 = 33;
pub const COUNT_OF_VARIABLES: u32 = 34;

pub const WIDTHS: [IntegerWidth; 8] = [
    IntegerWidth::Int8,
    IntegerWidth::UInt8,
    IntegerWidth::Int16,
    IntegerWidth::UInt16,
    IntegerWidth::Int32,
    IntegerWidth::UInt32,
    IntegerWidth::Int64,
    IntegerWidth::UInt64,
];

macro_rules! wide {
    ($index:literal, $name:literal) => {
        V::integer_input($name, 0, "An integer of its own width")
            .width(WIDTHS[$index])
            .access(|m| m.wide[$index], |m, v| m.wide[$index] = v)
    };
}

type V = Variable<Toy>;

static VARIABLES: [V; COUNT_OF_VARIABLES as usize] = [
    V::parameter("toy.gain", "N/m", 2.0, "k: gain").min(0.5).max(8.0).nominal(2.0).access(
        |m| {
            m.fail_in("getter");
            m.gain
        },
        |m, v| {
            m.fail_in("setter");
            m.gain = v;
        },
    ),
    V::parameter("limit", "1", f64::INFINITY, "Bound of the integral")
        .min(0.0)
        .tunable()
        .infinity_allowed()
        .access(|m| m.limit, |m, v| m.limit = v),
    V::calculated_parameter("doubled", "N/m", "2 k")
        .initially_depends_on(&[&["toy.gain"]])
        .partial_derivative(|m, known| m.of(known, "toy.gain", 2.0))
        .get(|m| m.doubled),
    V::input("u", "V", 1.0, "Input")
        .input_derivatives(1, |m, _order, v| m.slope = v)
        .access(|m| m.input, |m, v| m.input = v),
    V::output("integral", "N.s/m", "Integral of k u")
        .depends_on(&[])
        .output_derivatives(1, |m, _order| m.gain * m.input)
        // Through a step of one second; at one point it depends on nothing, as the row says.
        .partial_derivative(|m, known| m.of(known, "u", m.gain))
        .reinit()
        .get(|m| m.integral),
    V::integer_parameter("seed", 1, "Seed").min(0).max(9).access(|m| m.seed, |m, v| m.seed = v),
    V::integer_output("count", "Number of steps").get(|m| m.count),
    V::boolean_input("on", true, "Whether to integrate").access(|m| m.on, |m, v| m.on = v),
    V::boolean_output("isOn", "Whether it integrates").depends_on(&["on"]).get(|m| m.on),
    V::string_parameter("label", "toy", "Label")
        .longest(1000)
        .access(|m| m.label.clone(), |m, v| v.clone_into(&mut m.label)),
    V::string_output("echo", "The label, with a NUL after it").get(|m| format!("{}\0", m.label)),
    V::enumeration_parameter("law", &LAW, 1, "What is integrated").access(|m| m.law, |m, v| m.law = v),
    V::enumeration_output("chosen", &LAW, "The law in force").local().get(|m| m.law),
    V::string_input("trouble", "", "The hook that is to fail, and how")
        .access(|m| m.trouble.clone(), |m, v| v.clone_into(&mut m.trouble)),
    V::integer_output("updates", "How often update ran").local().get(|m| m.updates),
    V::independent("time", "Time").get(|m| m.time),
    V::output("der(integral)", "V.N/m", "k u")
        .local()
        .depends_on(&["u", "switched"])
        .initially_depends_on(&[&["toy.gain"], &["u", "switched"]])
        .derivative_of("integral")
        .partial_derivative(|m, known| m.of(known, "u", m.gain) + m.of(known, "switched", 1.0))
        .get(|m| m.gain * m.input + m.switched),
    V::input("switched", "1", 0.0, "Added to k u").discrete().access(|m| m.switched, |m, v| m.switched = v),
    V::output("held", "1", "What is added to k u")
        .discrete()
        .initially_depends_on(&[&["switched"]])
        .partial_derivative(|m, known| m.of(known, "switched", 1.0))
        .get(|m| m.switched),
    V::input("single", "1", 0.5, "In single precision").single().access(|m| m.single, |m, v| m.single = v),
    wide!(0, "wide[1]"),
    wide!(1, "wide[2]"),
    wide!(2, "wide[3]"),
    wide!(3, "wide[4]"),
    wide!(4, "wide[5]"),
    wide!(5, "wide[6]"),
    wide!(6, "wide[7]"),
    wide!(7, "wide[8]"),
    V::output_clock("tick", "Ticks at each full second").get(|m| m.time.fract() == 0.0),
    V::integer_output("ticks", "Number of steps at the last tick")
        .width(IntegerWidth::UInt64)
        .clocked_by(&["tick"])
        .get(|m| m.count),
    V::input_clock("sample", ClockInterval::Periodic { interval: 0.5, shift: 0.0 }, "Samples `sampled`")
        .access(|m| m.sample, |m, on| m.sample = on),
    V::input("sampled", "1", 0.0, "What is summed up at each sample")
        .discrete()
        .clocked_by(&["sample"])
        .access(|m| m.sampled, |m, v| m.sampled = v),
    V::integer_output("samples", "Number of samples").get(|m| m.samples),
    V::input_clock("trigger", ClockInterval::Triggered, "Does nothing").access(|_| false, |_, _| ()),
];

impl Toy {
    /// Panics if the variable `trouble` says so.
    fn fail_in(&self, hook: &str) {
        assert!(self.trouble != format!("panic {hook}"), "panic in {hook}");
    }

    /// A partial derivative that is `value` with respect to the variable `name`, zero with respect to others.
    fn of(&self, known: &V, name: &str, value: f64) -> f64 {
        self.fail_in("derivative");
        if known.name() == name { value } else { 0.0 }
    }

    /// Panics or returns an error if the variable `trouble` says so.
    fn trouble_in(&self, hook: &str, log: &Logger) -> Result<(), SlaveError> {
        self.fail_in(hook);
        match self.trouble.strip_suffix(hook).map(str::trim_end) {
            Some("error") => Err(SlaveError::error("asked for an error, 100 %s")),
            Some("fatal") => Err(SlaveError::fatal("asked for a fatal error")),
            Some("refuse") => Err(SlaveError::discard(self.time, "asked to refuse")),
            Some("discard") => Err(SlaveError::discard(self.time + 0.25, "asked for a discard")),
            Some("terminate") => Err(SlaveError::terminate(self.time + 0.125, "asked to terminate")),
            Some("warning") => {
                log.warning("asked for a warning");
                Ok(())
            }
            Some("event") => {
                log.event(format_args!("an event with a NUL \0 at {} s", self.time));
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

impl Drop for Toy {
    fn drop(&mut self) {
        assert!(!PANIC_IN_DROP.replace(false), "panic in drop");
    }
}

impl Slave for Toy {
    const INFO: ModelInfo = ModelInfo::new("Toy")
        .model_name("A toy & its tests")
        .description("Integrates its input")
        .author("Nobody")
        .version("1.0")
        .copyright("(c) Nobody")
        .license("MIT OR Apache-2.0")
        .generation_tool("fmu-export")
        .default_experiment(0.0, 10.0, 0.5)
        .default_tolerance(1e-4)
        .can_serialize()
        .directional_derivatives()
        .model_exchange(1)
        .stops_at_events()
        .terminals(&[Terminal { name: "port", description: "A port", members: &[("in", "u"), ("out", "integral")] }]);

    fn variables() -> &'static [Variable<Self>] {
        &VARIABLES
    }

    fn new() -> Self {
        assert!(!PANIC_IN_NEW.get(), "panic in new");
        Self::default()
    }

    fn set_resources(&mut self, folder: &Path) {
        RESOURCES.with_borrow_mut(|folders| folders.push(folder.to_owned()));
    }

    fn setup_experiment(&mut self, experiment: &Experiment, log: &Logger) -> Result<(), SlaveError> {
        self.start_time = experiment.start_time;
        self.time = experiment.start_time;
        self.trouble_in("setup", log)
    }

    fn update(&mut self) {
        self.fail_in("update");
        self.updates += 1;
        self.doubled = 2.0 * self.gain;
    }

    fn initialize(&mut self, log: &Logger) -> Result<(), SlaveError> {
        self.trouble_in("initialize", log)
    }

    fn do_step(&mut self, t: f64, h: f64, log: &Logger) -> Result<(), SlaveError> {
        self.trouble_in("step", log)?;
        let input = self.input + 0.5 * h * self.slope;
        let rate = if self.law == 1 { input } else { input * input };
        if self.on {
            self.integral = (self.integral + self.gain * rate * h).min(self.limit);
        }
        self.count += 1;
        self.time = t + h;
        Ok(())
    }

    /// There is an event at each full second.
    fn do_step_to_event(&mut self, t: f64, end: f64, log: &Logger) -> Result<Option<Stop>, SlaveError> {
        let time = t.floor() + 1.0;
        self.do_step(t, time.min(end) - t, log)?;
        Ok((time <= end).then_some(Stop { time, is_event: true }))
    }

    fn terminate(&mut self, log: &Logger) -> Result<(), SlaveError> {
        self.trouble_in("terminate", log)
    }

    fn place(&mut self, time: f64, states: Option<&[f64]>) -> Result<(), SlaveError> {
        self.fail_in("place");
        self.time = time;
        self.integral = states.map_or(self.integral, |states| states[0]);
        Ok(())
    }

    fn event_indicators(&self) -> Vec<f64> {
        vec![self.limit - self.integral]
    }

    /// The integral falls back to zero at its limit, and there is an event each second.
    fn handle_events(&mut self, log: &Logger) -> Result<EventOutcome, SlaveError> {
        self.trouble_in("event handler", log)?;
        self.samples += i64::from(self.sample);
        let states_changed = self.integral >= self.limit;
        if states_changed {
            self.integral = 0.0;
            self.count += 1;
        }
        Ok(EventOutcome { states_changed, next_event_time: Some(self.time.floor() + 1.0) })
    }

    fn on_call(&self, function: &'static str) {
        assert!(PANIC_IN_CALL.get() != Some(function), "panic in {function}");
    }

    fn write_state(&self, out: &mut StateWriter) -> Result<(), StateError> {
        self.fail_in("write");
        out.write(self)
    }

    fn read_state(from: &mut StateReader<'_>, _: &Self) -> Result<Self, StateError> {
        let toy: Self = from.take()?;
        toy.fail_in("read");
        Ok(toy)
    }
}

export_fmu!(Toy, model_exchange);
