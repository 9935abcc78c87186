//! First-order changes of a pulse, with the impact and with the shape.

use crate::motion::pulse::{Deflection, Knot, KnotKind, Pulse, PulseChange, PulseShape, Pulses};
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

/// Change of the deflection of `pulse`, which is `deflection`, at `time`, s: with the peak, with the time since the impact as a
/// fraction of the loading time, and with the unloading.
fn deflection_change(
    pulse: &Pulse,
    deflection: Deflection,
    time: f64,
    shape: &PulseShape,
    shape_change: ShapeChange,
) -> f64 {
    let unloading = (time - shape.peak_time(pulse)).max(0.0);
    let later = pulse.change.start
        + (time - pulse.start) * log_loading_change(pulse)
        + unloading * shape_change.stretch / shape.stretch;
    deflection.value * pulse.change.peak / pulse.peak - deflection.rate * later
}

impl Knot<'_> {
    /// Change of the time, s.
    pub(crate) fn change(&self, shape: &PulseShape, shape_change: ShapeChange) -> f64 {
        let (length, stretch) = match self.kind {
            KnotKind::Peaks => (1.0, 0.0),
            KnotKind::Ends => (1.0 + shape.stretch, shape_change.stretch),
            KnotKind::Meets(other) => {
                let [(change, rate), (other_change, other_rate)] = [self.pulse, other].map(|pulse| {
                    let deflection = shape.at(pulse, self.time);
                    (deflection_change(pulse, deflection, self.time, shape, shape_change), deflection.rate)
                });
                return (change - other_change) / (other_rate - rate);
            }
        };
        let relative = log_loading_change(self.pulse);
        self.pulse.change.start + shape.loading_time(self.pulse) * (relative * length + stretch)
    }
}

impl Pulses {
    /// Change of the deflection at `side` at `time`, s.
    pub(crate) fn change_at(&self, side: Side, time: f64, shape_change: ShapeChange) -> f64 {
        let Some((pulse, deflection)) = self.largest(side, time) else { return 0.0 };
        deflection_change(pulse, deflection, time, &self.shape, shape_change)
    }

    /// The pulses under way change no more.
    pub(crate) fn forget_changes(&mut self) {
        self.under_way.iter_mut().flatten().for_each(|running| running.pulse.change = PulseChange::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameters;
    use crate::membrane::Membrane;
    use crate::shared::Shared;
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
        for (k, kind) in [KnotKind::Peaks, KnotKind::Ends].into_iter().enumerate() {
            let knot = Knot { time: 0.0, pulse: &pulse, kind };
            let slope = (up[k] - down[k]) / (2.0 * H);
            assert_relative_eq!(knot.change(&shape, change), slope, max_relative = 1e-8, epsilon = 1e-10);
        }
    }

    #[test]
    fn the_meeting_of_two_pulses_changes_as_central_differences_say() {
        const H: f64 = 1e-6;
        // Start, speed and peak of both, and the restitution, which makes the shape.
        let values: [f64; 7] = [0.0, 0.5, 0.0036, 0.02, 0.25, 0.0021, 0.6];
        let meets = |values: &[f64; 7], changes: &[f64; 7]| {
            let shape = PulseShape::new(2.6, values[6]);
            let membrane = Shared::new(Membrane::new(&Parameters::default()));
            let mut pulses = Pulses { shape, under_way: Default::default() };
            for k in [0, 3] {
                let change = PulseChange { start: changes[k], speed: changes[k + 1], peak: changes[k + 2] };
                let pulse = Pulse { start: values[k], speed: values[k + 1], peak: values[k + 2], change };
                pulses.push(&membrane, Side::Left, pulse);
            }
            let knot = pulses.next_knots(values[3]).next().unwrap();
            assert!(matches!(knot.kind, KnotKind::Meets(_)), "{knot:?}");
            (knot.time, knot.change(&shape, ShapeChange::new(&shape, changes[6])))
        };
        for k in 0..7 {
            let moved = |by: f64| {
                let mut moved = values;
                moved[k] += by * values[k].max(0.01);
                (moved[k], meets(&moved, &[0.0; 7]).0)
            };
            let ((up, later), (down, earlier)) = (moved(H), moved(-H));
            let mut changes = [0.0; 7];
            changes[k] = 1.0;
            assert_relative_eq!(meets(&values, &changes).1, (later - earlier) / (up - down), max_relative = 1e-6);
        }
    }
}
