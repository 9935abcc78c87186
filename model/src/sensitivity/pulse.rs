//! First-order changes of a pulse, with the impact and with the shape.

use crate::motion::pulse::{Deflection, Knot, Pulse, PulseChange, PulseShape, Pulses};
use crate::motion::side::Side;
use crate::numerics::series::digamma;

/// Changes of the shape that all pulses share.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ShapeChange {
    /// Of the logarithm of the loading time.
    log_loading: f64,
    stretch: f64,
}

impl ShapeChange {
    /// Change of `shape` with force exponent and restitution.
    pub(crate) fn new(shape: &PulseShape, exponent_change: f64, restitution_change: f64) -> Self {
        // d ln(loading) / da with a = 1 / (n + 1).
        let a = 1.0 / (shape.exponent + 1.0);
        let slope = digamma(1.0 + a) - digamma(0.5 + a);
        let is_stretched = shape.stretch < 1.0 / PulseShape::MIN_RESTITUTION;
        Self {
            log_loading: -a * a * slope * exponent_change,
            stretch: if is_stretched { -shape.stretch * shape.stretch * restitution_change } else { 0.0 },
        }
    }
}

/// Change of the logarithm of the loading time of `pulse`, under the same shape.
fn log_loading_change(pulse: &Pulse) -> f64 {
    if pulse.speed > 0.0 { pulse.change.peak / pulse.peak - pulse.change.speed / pulse.speed } else { 0.0 }
}

/// Change of the deflection at a given `time`, s, under the same shape: with the peak, and with the time since the impact
/// as a fraction of the loading time.
fn deflection_change(pulse: &Pulse, deflection: Deflection, time: f64) -> f64 {
    let later = pulse.change.start + (time - pulse.start) * log_loading_change(pulse);
    deflection.value * pulse.change.peak / pulse.peak - deflection.rate * later
}

impl Knot<'_> {
    /// Change of the time, s.
    pub(crate) fn change(&self, shape: &PulseShape, shape_change: &ShapeChange) -> f64 {
        let loading_time = shape.loading_time(self.pulse);
        let relative = log_loading_change(self.pulse) + shape_change.log_loading;
        let (length, stretch) = if self.is_end { (1.0 + shape.stretch, shape_change.stretch) } else { (1.0, 0.0) };
        self.pulse.change.start + loading_time * (relative * length + stretch)
    }
}

impl Pulses {
    /// Change of the deflection at `side` at `time`, s.
    pub(crate) fn change_at(&self, side: Side, time: f64) -> f64 {
        self.largest(side, time).map_or(0.0, |(pulse, deflection)| deflection_change(pulse, deflection, time))
    }

    /// The pulses under way change no more.
    pub(crate) fn forget_changes(&mut self) {
        self.under_way.iter_mut().flatten().for_each(|pulse| pulse.change = PulseChange::default());
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
        let ends = |n, r| {
            let shape = PulseShape::new(n, r);
            [shape.peak_time(&pulse), shape.end_time(&pulse)]
        };
        let shape = PulseShape::new(2.6, 0.6);
        for (dn, dr) in [(1.0, 0.0), (0.0, 1.0)] {
            let change = ShapeChange::new(&shape, dn, dr);
            let (up, down) = (ends(2.6 + H * dn, 0.6 + H * dr), ends(2.6 - H * dn, 0.6 - H * dr));
            for (k, is_end) in [false, true].into_iter().enumerate() {
                let knot = Knot { time: 0.0, pulse: &pulse, is_end };
                let slope = (up[k] - down[k]) / (2.0 * H);
                assert_relative_eq!(knot.change(&shape, &change), slope, max_relative = 1e-8, epsilon = 1e-10);
            }
        }
    }
}
