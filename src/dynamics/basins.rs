//! Basins of attraction: which motion a start leads to, over relative position and velocity of the ball.

use videg_model::Setup;

use super::DynamicsError;
use super::diagram::Periods;
use super::motion::{Flash, Motion, periods};
use crate::progress::Progress;
use crate::threads;

/// A motion by its rule: after how many periods it comes back, `<U>`, and where it is at their starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attractor {
    /// Periods; none if it does not come back.
    pub recurrence: Option<usize>,
    /// `<U>`, V/s.
    pub gain: f64,
    /// Mean relative displacement at the starts of the periods, m: tells a motion from its mirror image.
    pub displacement: f64,
}

impl Attractor {
    fn of(motion: &Motion) -> Self {
        let recurrence = motion.recurrence();
        let count = recurrence.unwrap_or(motion.flashes.len() - 1);
        Self { recurrence, gain: motion.voltage_gain(count), displacement: motion.mean_displacement(count) }
    }

    /// The same: within 0.5 % of `<U>` and 0.1 mm, but for the fluctuations of a motion that does not come back, 2 %
    /// and 5 mm.
    fn is_like(&self, other: &Self) -> bool {
        let [gain, displacement] = if self.recurrence.is_some() { [5e-3, 1e-4] } else { [0.02, 5e-3] };
        self.recurrence == other.recurrence
            && (self.gain - other.gain).abs() <= gain * self.gain
            && (self.displacement - other.displacement).abs() <= displacement
    }

    /// After how many periods it comes back, in words.
    pub fn periods(&self) -> String {
        periods(self.recurrence, "aperiodic")
    }

    /// In words.
    pub fn label(&self) -> String {
        format!("{}, {:.0} V/s, {:+.1} mm", self.periods(), self.gain, 1e3 * self.displacement)
    }
}

/// The plane of starts and what each leads to.
#[derive(Debug, Clone)]
pub struct Basins {
    /// Relative displacement, m.
    pub xs: Vec<f64>,
    /// Relative velocity, m/s.
    pub ys: Vec<f64>,
    /// Row by row from the lowest velocity.
    pub ends: Vec<Attractor>,
    /// By falling share of the starts.
    pub attractors: Vec<(Attractor, f64)>,
    /// Periods of each motion.
    pub periods: Periods,
}

impl Basins {
    /// Basins over `count` displacements between the membranes and `count` relative velocities from -`fastest` to `fastest`, m/s. The
    /// cylinder starts as the parameters say.
    ///
    /// # Errors
    /// A parameter out of its bounds; more events than can be resolved; stopped by the observer.
    pub fn new<'a>(
        setup: impl Into<Setup<'a>>,
        count: u32,
        fastest: f64,
        periods: Periods,
        observer: &dyn Progress,
    ) -> Result<Self, DynamicsError> {
        let Setup { parameters, recording, table } = setup.into();
        let middle = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(count) - 1.0;
        let xs: Vec<f64> = (0..count).map(|k| middle(k) * parameters.travel() / 2.0).collect();
        let ys: Vec<f64> = (0..count).map(|k| middle(k) * fastest).collect();
        let cylinder = [parameters.cylinder_position, parameters.cylinder_velocity];
        let start = |displacement: f64, velocity: f64| Flash { displacement, velocity, cylinder, gain: 0.0 };
        let starts: Vec<Flash> = ys.iter().flat_map(|&y| xs.iter().map(move |&x| start(x, y))).collect();
        let ends = threads::map(&starts, observer, |start| -> Result<Attractor, DynamicsError> {
            if observer.is_stopped() {
                return Err(DynamicsError::Stopped);
            }
            let parameters = start.start(*parameters);
            let setup = Setup { parameters: &parameters, recording, table };
            Ok(Attractor::of(&Motion::take(setup, periods.transient, periods.taken)?))
        })?;
        let attractors = by_share(&ends);
        Ok(Self { xs, ys, ends, attractors, periods })
    }

    /// Number of the attractor in order of share.
    pub fn kind(&self, end: &Attractor) -> Option<usize> {
        self.attractors.iter().position(|(attractor, _)| attractor.is_like(end))
    }
}

/// The attractors and the part of all starts that each takes.
fn by_share(ends: &[Attractor]) -> Vec<(Attractor, f64)> {
    let mut found: Vec<(Attractor, f64)> = Vec::new();
    for end in ends {
        match found.iter_mut().find(|(attractor, _)| attractor.is_like(end)) {
            Some((_, count)) => *count += 1.0,
            None => found.push((*end, 1.0)),
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found.into_iter().map(|(attractor, count)| (attractor, count / ends.len() as f64)).collect()
}
