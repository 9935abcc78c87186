//! The motion once a period, in phase with the excitation: what Poincare sections and bifurcation diagrams are made of.

use videg_model::{ExcitationKind, Harvester, Parameters, Setup};

use super::{DynamicsError, excitation};

/// The motion at the start of a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flash {
    /// `z_M` - `z_m`, m.
    pub displacement: f64,
    /// `z_M`' - `z_m`', m/s.
    pub velocity: f64,
    /// `z_M`, m, and `z_M`', m/s.
    pub cylinder: [f64; 2],
    /// Sum of `U_DE4` - `U_in` so far, V.
    pub gain: f64,
}

impl Flash {
    /// The motion of a harvester now.
    pub fn of(harvester: &Harvester) -> Self {
        let cylinder = [harvester.cylinder_position(), harvester.cylinder_velocity()];
        let velocity = cylinder[1] - harvester.ball_velocity();
        let (displacement, gain) = (harvester.relative_displacement(), harvester.totals().voltage_gain);
        Self { displacement, velocity, cylinder, gain }
    }

    /// These parameters with this motion as the start. The position of the cylinder counts only if it is suspended: otherwise the
    /// relative motion does not depend on it.
    pub fn start(&self, mut parameters: Parameters) -> Parameters {
        let p = &mut parameters;
        if p.is_suspended() && p.excitation_kind == ExcitationKind::Force {
            [p.cylinder_position, p.cylinder_velocity] = self.cylinder;
        }
        p.ball_position = p.cylinder_position - self.displacement;
        p.ball_velocity = p.cylinder_velocity - self.velocity;
        parameters
    }
}

/// Flashes of a motion, one a period.
#[derive(Debug, Clone)]
pub struct Motion {
    /// At least one.
    pub flashes: Vec<Flash>,
    /// s.
    period: f64,
}

impl Motion {
    /// Lets `transient` periods of the excitation pass and takes the motion at the ends of `periods` more, and before.
    ///
    /// # Errors
    /// A parameter out of its bounds; an excitation that does not repeat; more events than can be resolved.
    pub fn take<'a>(setup: impl Into<Setup<'a>>, transient: u32, periods: u32) -> Result<Self, DynamicsError> {
        let setup = setup.into();
        let period = excitation::period(&setup)?;
        let mut harvester = Harvester::new(setup, 0.0)?;
        let mut flashes = Vec::new();
        for k in 0..=periods {
            // Products, not sums, so that the flashes do not drift against the excitation.
            harvester.advance(f64::from(transient + k) * period)?;
            flashes.push(Flash::of(&harvester));
        }
        Ok(Self { flashes, period })
    }

    /// The motion at the end.
    pub fn last(&self) -> Flash {
        let nowhere = Flash { displacement: f64::NAN, velocity: f64::NAN, cylinder: [f64::NAN; 2], gain: f64::NAN };
        self.flashes.last().copied().unwrap_or(nowhere)
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

    /// `<U>`, V/s, until the motion comes back, or over all periods if it does not.
    pub fn own_gain(&self) -> f64 {
        self.voltage_gain(self.recurrence().unwrap_or(self.flashes.len() - 1))
    }

    /// Mean displacement, m, of the last `periods` flashes.
    pub fn mean_displacement(&self, periods: usize) -> f64 {
        let last = self.flashes.iter().rev().take(periods);
        let (count, sum) = last.fold((0.0, 0.0), |(count, sum), flash| (count + 1.0, sum + flash.displacement));
        sum / count
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
