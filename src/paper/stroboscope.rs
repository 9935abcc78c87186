//! The motion once a period, in phase with the force: the data of Poincare sections and bifurcation diagrams.

use super::excitation::{Cylinder, set};
use super::{PaperError, Study};
use crate::scenario::Setting;
use fmu_import::Instance;

/// The relative motion at the start of a period, when the cylinder is at the end of its swing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flash {
    /// `z_M` - `z_m`, m.
    pub displacement: f64,
    /// `z_M`' - `z_m`', m/s.
    pub velocity: f64,
    /// Sum of `U_DE4` - `U_in` so far, V.
    pub gain: f64,
}

/// A harvester that is sampled once a period.
pub struct Stroboscope<'a> {
    study: &'a Study<'a>,
    instance: Instance,
    /// s.
    period: f64,
    /// Periods so far.
    count: f64,
}

impl<'a> Stroboscope<'a> {
    /// Starts with `settings` under a force of `frequency`, Hz.
    pub fn new(study: &'a Study<'_>, settings: &[Setting], frequency: f64) -> Result<Self, PaperError> {
        Ok(Self { study, instance: study.start(settings)?, period: 1.0 / frequency, count: 0.0 })
    }

    /// Lets `periods` pass.
    pub fn pass(&mut self, periods: u32) -> Result<(), PaperError> {
        // Products, not sums, so that the flashes do not drift against the force.
        let (now, next) = (self.count * self.period, (self.count + f64::from(periods)) * self.period);
        self.instance.do_step(now, next - now)?;
        self.count += f64::from(periods);
        Ok(())
    }

    /// The motion now.
    pub fn flash(&self) -> Result<Flash, PaperError> {
        let [displacement, velocity] = self.study.relative_motion(&self.instance)?;
        let [gain] = self.study.reals(&self.instance, ["gain.voltage"])?;
        Ok(Flash { displacement, velocity, gain })
    }

    /// Lets `transient` periods pass and takes the motion at the ends of `periods` more, and before.
    pub fn take(&mut self, transient: u32, periods: u32) -> Result<Orbit, PaperError> {
        self.pass(transient)?;
        let mut flashes = vec![self.flash()?];
        for _ in 0..periods {
            self.pass(1)?;
            flashes.push(self.flash()?);
        }
        Ok(Orbit { flashes, period: self.period })
    }
}

/// Flashes of a motion, one a period.
#[derive(Debug, Clone)]
pub struct Orbit {
    /// At least one.
    pub flashes: Vec<Flash>,
    /// s.
    period: f64,
}

impl Orbit {
    /// The motion at the end.
    pub fn last(&self) -> Flash {
        self.flashes.last().copied().unwrap_or(Flash { displacement: f64::NAN, velocity: f64::NAN, gain: f64::NAN })
    }

    /// The smallest number of periods, up to half of those taken, after which the motion comes back to within 1 um: in
    /// displacement, and in velocity times a period's 2 pi-th.
    pub fn recurrence(&self) -> Option<usize> {
        const TOLERANCE: f64 = 1e-6;
        let flashes = &self.flashes;
        let near = |a: &Flash, b: &Flash| {
            let time = self.period / std::f64::consts::TAU;
            (a.displacement - b.displacement).abs() <= TOLERANCE && (a.velocity - b.velocity).abs() * time <= TOLERANCE
        };
        (1..=(flashes.len() - 1) / 2).find(|&n| flashes.iter().zip(&flashes[n..]).all(|(a, b)| near(a, b)))
    }

    /// `<U>`, Eq. (15), V/s, over the last `periods`.
    pub fn voltage_gain(&self, periods: usize) -> f64 {
        let (end, start) = (self.flashes.len() - 1, self.flashes.len() - 1 - periods);
        (self.flashes[end].gain - self.flashes[start].gain) / (periods as f64 * self.period)
    }

    /// Mean displacement, m, of the last `periods` flashes.
    pub fn mean_displacement(&self, periods: usize) -> f64 {
        let last = self.flashes.iter().rev().take(periods);
        super::statistics::mean(last.map(|flash| flash.displacement))
    }
}

/// A number of periods after which a motion comes back, in words; none: `never`.
pub fn periods(recurrence: Option<usize>, never: impl Into<String>) -> String {
    match recurrence {
        Some(1) => "1 period".to_owned(),
        Some(n) => format!("{n} periods"),
        None => never.into(),
    }
}

/// A harmonically driven cylinder that swings about 0, and where the ball starts in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// r.
    pub restitution: f64,
    /// gamma, Eq. (16).
    pub gamma: f64,
    /// `f_0`, Hz.
    pub frequency: f64,
    /// `z_M` - `z_m`, m, at 0 s.
    pub displacement: f64,
    /// `z_M`' - `z_m`', m/s, at 0 s.
    pub velocity: f64,
}

impl Start {
    /// The start of Figures 10, 11, 14 and 15: `z_m`(0) = `z_M`(0) + s/2, `z_m`'(0) = -4 `f_0` `z_m`(0).
    pub fn saw_tooth(cylinder: &Cylinder, restitution: f64, gamma: f64, frequency: f64) -> Self {
        let half = cylinder.travel() / 2.0;
        let velocity = 4.0 * frequency * half * (1.0 - gamma);
        Self { restitution, gamma, frequency, displacement: -half, velocity }
    }

    /// The same excitation with the ball where `flash` has it.
    pub fn from(self, flash: Flash) -> Self {
        Self { displacement: flash.displacement, velocity: flash.velocity, ..self }
    }

    /// Its settings.
    pub fn settings(&self, cylinder: &Cylinder) -> Vec<Setting> {
        let position = -self.gamma * cylinder.travel() / 2.0;
        vec![
            set("membrane.restitution", self.restitution),
            set("excitation.amplitude", cylinder.force(self.gamma, self.frequency)),
            set("excitation.frequency", self.frequency),
            set("initial.cylinderPosition", position),
            set("initial.ballPosition", position - self.displacement),
            set("initial.ballVelocity", -self.velocity),
        ]
    }
}
