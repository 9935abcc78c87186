//! The FMU driven through its C functions, its variables by name.

use VibroImpactHarvester::Harvester;
use core::ops::Deref;
use fmu_export::abi::{fmi2CoSimulation, fmi2FMUstate, fmi2ModelExchange, fmi2Status, fmi2Type, fmi2Warning};
use fmu_export::{Causality, Guid, Kind, Slave, Standard, Variability, Variable, value_reference};
use fmu_host::slave::row;
use fmu_host::{linked_functions, ok};

/// Names of the Real variables that `is_listed`.
fn reals(is_listed: impl Fn(&Variable<Harvester>) -> bool) -> Vec<&'static str> {
    let rows = Harvester::variables().iter().filter(|v| matches!(v.kind(), Kind::Real(_)) && is_listed(v));
    rows.map(Variable::name).collect()
}

/// Those that FMI 3.0 alone has, at the ticks of a clock.
pub const CLOCKED: [&str; 2] = ["impact.speed", "impact.energy"];

/// The Real outputs and the derivatives of the continuous states, as FMI 2.0 has them.
pub fn unknowns() -> Vec<&'static str> {
    reals(|v| v.is_of(Standard::Fmi2) && (v.causality() == Causality::Output || v.derivative_of().is_some()))
}

/// The continuous ones among them.
pub fn continuous_unknowns() -> Vec<&'static str> {
    let is_continuous = |name: &&str| row::<Harvester>(name).variability() == Variability::Continuous;
    unknowns().into_iter().filter(is_continuous).collect()
}

/// The calculated parameters besides.
pub fn initial_unknowns() -> Vec<&'static str> {
    [reals(|v| v.causality() == Causality::CalculatedParameter), unknowns()].concat()
}

/// Real parameters and inputs.
pub fn initial_knowns() -> Vec<&'static str> {
    reals(|v| matches!(v.causality(), Causality::Parameter | Causality::Input))
}

fn references(names: &[&str]) -> Vec<u32> {
    names.iter().map(|name| reference(name)).collect()
}

pub fn reference(name: &str) -> u32 {
    value_reference(Harvester::variables(), name).expect(name)
}

fn warns(status: fmi2Status) -> bool {
    ok(status);
    status == fmi2Warning
}

/// An instance; it must answer each call with `fmi2OK` or `fmi2Warning`.
pub struct Host(fmu_host::Host);

impl Deref for Host {
    type Target = fmu_host::Host;

    fn deref(&self) -> &fmu_host::Host {
        &self.0
    }
}

impl Host {
    /// In initialization mode, with these Reals set.
    pub fn initializing(kind: fmi2Type, start: f64, settings: &[(&str, f64)]) -> Self {
        let guid = Guid::of::<Harvester>(Standard::Fmi2).to_string();
        let functions = linked_functions!(model_exchange);
        let host = Self(fmu_host::Host::of(functions, &guid, kind == fmi2ModelExchange));
        for (name, value) in settings {
            host.set(name, *value);
        }
        ok(host.setup(start, None));
        ok(host.enter_initialization());
        host
    }

    /// Co-simulation, ready for the first step at 0 s.
    pub fn stepping(settings: &[(&str, f64)]) -> Self {
        let host = Self::initializing(fmi2CoSimulation, 0.0, settings);
        ok(host.exit_initialization());
        host
    }

    /// Model exchange, in event mode at 0 s.
    pub fn exchanging(settings: &[(&str, f64)]) -> Self {
        let host = Self::initializing(fmi2ModelExchange, 0.0, settings);
        ok(host.exit_initialization());
        host
    }

    /// Whether the end of the initialisation warns.
    pub fn initialization_warns(&self) -> bool {
        warns(self.exit_initialization())
    }

    /// Sets a Real, or, if it is `contact.reaction`, a Boolean.
    pub fn set(&self, name: &str, value: f64) {
        ok(if name == "contact.reaction" {
            self.set_boolean(reference(name), (value > 0.0).into())
        } else {
            self.set_real(reference(name), value)
        });
    }

    pub fn set_rate(&self, name: &str, rate: f64) {
        ok(self.set_derivative(reference(name), 1, rate));
    }

    pub fn get_all(&self, names: &[&str]) -> Vec<f64> {
        self.reals(&references(names))
    }

    pub fn get(&self, name: &str) -> f64 {
        self.real(reference(name))
    }

    pub fn count(&self, name: &str) -> i32 {
        self.integer(reference(name))
    }

    pub fn rests(&self) -> bool {
        self.boolean(reference("contact.resting")) == 1
    }

    pub fn step(&self, t: f64, h: f64) {
        ok(self.0.step(t, h));
    }

    /// Whether a step warns.
    pub fn step_warns(&self, t: f64, h: f64) -> bool {
        warns(self.0.step(t, h))
    }

    /// Whether the end of the run warns.
    pub fn terminate_warns(&self) -> bool {
        warns(self.terminate())
    }

    pub fn choose(&self, name: &str, item: i32) {
        ok(self.set_integer(reference(name), item));
    }

    /// d unknown / d known, or the status if that is no good.
    pub fn try_derivatives(&self, unknowns: &[&str], known: &str) -> Result<Vec<f64>, fmi2Status> {
        self.directional_derivative(&references(unknowns), &[reference(known)], &[1.0])
    }

    pub fn derivatives(&self, unknowns: &[&str], known: &str) -> Vec<f64> {
        self.try_derivatives(unknowns, known).expect(known)
    }

    pub fn restore(&self, state: fmi2FMUstate) {
        ok(self.0.restore(state));
    }

    pub fn free(&self, mut state: fmi2FMUstate) {
        ok(self.free_state(&mut state));
    }
}
