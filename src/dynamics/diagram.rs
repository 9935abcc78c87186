//! Bifurcation diagrams: how the motion changes along a parameter.

use videg_model::Parameters;

use super::motion::Motion;
use super::{DynamicsError, Files};
use crate::progress::Progress;
use crate::threads;

/// How the motion at a value of the parameter is reached.
pub const WAYS: [&str; 3] = ["own start", "followed upwards", "followed downwards"];

/// Periods that a motion is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Periods {
    /// Before it is looked at.
    pub transient: u32,
    /// At whose ends it is looked at.
    pub taken: u32,
}

/// A diagram: for each way, the motion at each value.
#[derive(Debug, Clone)]
pub struct Diagram {
    /// Values of the parameter, ascending.
    pub xs: Vec<f64>,
    /// One of [`WAYS`] each.
    pub ways: Vec<Vec<Motion>>,
    /// Periods of each motion.
    pub periods: Periods,
}

impl Diagram {
    /// The motions at the values `xs`, where the parameters and the start are `at` them, with these files: from that start, and upwards and downwards,
    /// each motion going on from the last state of the one before.
    ///
    /// # Errors
    /// The first parameter out of its bounds; more events than can be resolved; stopped by the observer.
    pub fn new(
        xs: Vec<f64>,
        (at, files): (impl Fn(f64) -> Parameters + Sync, &Files),
        periods: Periods,
        observer: &dyn Progress,
    ) -> Result<Self, DynamicsError> {
        let take = |parameters: &Parameters| -> Result<Motion, DynamicsError> {
            if observer.is_stopped() {
                return Err(DynamicsError::Stopped);
            }
            Motion::take(files.setup(parameters), periods.transient, periods.taken)
        };
        let fresh = threads::map(&xs, observer, |&x| take(&at(x)))?;
        // Each motion begins where the one before has ended, so these are one task each.
        let followed = threads::map(&[false, true], observer, |&downwards| {
            let mut motions: Vec<Motion> = Vec::new();
            for k in 0..xs.len() {
                let start = at(if downwards { xs[xs.len() - 1 - k] } else { xs[k] });
                motions.push(take(&motions.last().map_or(start, |before| before.last().start(start)))?);
            }
            if downwards {
                motions.reverse();
            }
            Ok::<_, DynamicsError>(motions)
        })?;
        let ways: Vec<_> = std::iter::once(fresh).chain(followed).collect();
        Ok(Self { xs, ways, periods })
    }

    /// Values at which two ways lead to different `<U>`, by more than a part in a thousand, though both are periodic.
    pub fn coexisting(&self) -> Vec<f64> {
        let periodic = |motion: &Motion| motion.recurrence().map(|n| motion.voltage_gain(n));
        let differs = |index: usize| {
            let gains: Vec<f64> = self.ways.iter().filter_map(|motions| periodic(&motions[index])).collect();
            let [low, high] = [f64::min, f64::max].map(|pick| gains.iter().copied().reduce(pick).unwrap_or_default());
            high - low > 1e-3 * high
        };
        self.xs.iter().enumerate().filter(|(index, _)| differs(*index)).map(|(_, &x)| x).collect()
    }

    /// Stretches of the parameter, of at least four values, over which the own start leads to one number of periods; `None` is no
    /// recurrence.
    pub fn stretches(&self) -> Vec<(f64, f64, Option<usize>)> {
        let mut found: Vec<(f64, f64, Option<usize>)> = Vec::new();
        for (&x, motion) in self.xs.iter().zip(self.ways.iter().flatten()) {
            let recurrence = motion.recurrence();
            match found.last_mut() {
                Some(last) if last.2 == recurrence => last.1 = x,
                _ => found.push((x, x, recurrence)),
            }
        }
        let spacing = self.xs.get(1).zip(self.xs.first()).map_or(0.0, |(b, a)| b - a);
        found.retain(|(from, to, _)| to - from > 2.5 * spacing);
        found
    }
}
