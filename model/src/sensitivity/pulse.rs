//! First-order changes of a pulse, with the impact and with the shape.

use crate::motion::pulse::{Knot, Pulse, PulseChange, PulseShape, Pulses};
use crate::motion::side::Side;

/// Change of the shape that all pulses share, with the restitution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ShapeChange {
    stretch: f64,
}

impl ShapeChange {
    /// Change of `shape` with the restitution.
    pub(crate) fn new(shape: &PulseShape, restitution_change: f64) -> Self {
        let is_stretched = shape.stretch < 1.0 / PulseShape::MIN_RESTITUTION;
        Self { stretch: if is_stretched { -shape.stretch * shape.stretch * restitution_change } else { 0.0 } }
    }
}

/// Change of the logarithm of the loading time of `pulse`.
fn log_loading_change(pulse: &Pulse) -> f64 {
    if pulse.speed > 0.0 { pulse.change.peak / pulse.peak - pulse.change.speed / pulse.speed } else { 0.0 }
}

impl Knot<'_> {
    /// Change of the time, s.
    pub(crate) fn change(&self, shape: &PulseShape, shape_change: ShapeChange) -> f64 {
        let loading_time = shape.loading_time(self.pulse);
        let relative = log_loading_change(self.pulse);
        let (length, stretch) = if self.is_end { (1.0 + shape.stretch, shape_change.stretch) } else { (1.0, 0.0) };
        self.pulse.change.start + loading_time * (relative * length + stretch)
    }
}

impl Pulses {
    /// Change of the deflection at `side` at `time`, s: with the peak, with the time since the impact as a fraction of the loading
    /// time, and with the unloading.
    pub(crate) fn change_at(&self, side: Side, time: f64, shape_change: ShapeChange) -> f64 {
        let Some((pulse, deflection)) = self.largest(side, time) else { return 0.0 };
        let unloading = (time - self.shape.peak_time(pulse)).max(0.0);
        let later = pulse.change.start
            + (time - pulse.start) * log_loading_change(pulse)
            + unloading * shape_change.stretch / self.shape.stretch;
        deflection.value * pulse.change.peak / pulse.peak - deflection.rate * later
    }

    /// The pulses under way change no more.
    pub(crate) fn forget_changes(&mut self) {
        self.under_way.iter_mut().flatten().for_each(|running| running.pulse.change = PulseChange::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_shape_changes_as_central_differences_say() {
        const H: f64 = 1e-5;
        let pulse = Pulse { start: 1.0, speed: 0.3, peak: 0.002, change: PulseChange::default() };
        let ends = |r| {
            let shape = PulseShape::new(2.6, r);
            [shape.peak_time(&pulse), shape.end_time(&pulse)]
        };
        let shape = PulseShape::new(2.6, 0.6);
        let change = ShapeChange::new(&shape, 1.0);
        let (up, down) = (ends(0.6 + H), ends(0.6 - H));
        for (k, is_end) in [false, true].into_iter().enumerate() {
            let knot = Knot { time: 0.0, pulse: &pulse, is_end };
            let slope = (up[k] - down[k]) / (2.0 * H);
            assert_relative_eq!(knot.change(&shape, change), slope, max_relative = 1e-8, epsilon = 1e-10);
        }
    }
}
