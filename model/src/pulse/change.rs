//! First-order changes of a pulse, with the impact and with the shape.

use super::{Deflection, Pulse, PulseShape, Pulses};

/// Changes of a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PulseChange {
    /// Of the time of the impact, s.
    pub start: f64,
    /// Of the relative speed of the impact, m/s.
    pub speed: f64,
    /// Of the largest deflection, m.
    pub peak: f64,
}

/// Changes of the shape that all pulses share.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ShapeChange {
    /// Of the logarithm of the loading time.
    log_loading: f64,
    stretch: f64,
}

/// A time at which a pulse peaks or ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Knot<'a> {
    /// Time, s.
    pub(crate) time: f64,
    pulse: &'a Pulse,
    is_end: bool,
}

impl PulseShape {
    /// Change with force exponent and restitution.
    pub(crate) fn change(&self, exponent_change: f64, restitution_change: f64) -> ShapeChange {
        // d ln(loading) / da with a = 1 / (n + 1).
        let a = 1.0 / (self.exponent + 1.0);
        let slope = digamma(1.0 + a) - digamma(0.5 + a);
        let is_stretched = self.stretch < 1.0 / Self::MIN_RESTITUTION;
        ShapeChange {
            log_loading: -a * a * slope * exponent_change,
            stretch: if is_stretched { -self.stretch * self.stretch * restitution_change } else { 0.0 },
        }
    }

    /// Change of the logarithm of the loading time of `pulse`, under the same shape.
    fn log_loading_change(pulse: &Pulse) -> f64 {
        if pulse.speed > 0.0 { pulse.change.peak / pulse.peak - pulse.change.speed / pulse.speed } else { 0.0 }
    }

    /// Change of the deflection at a given `time`, s, under the same shape: with the peak, and with the time since the
    /// impact as a fraction of the loading time.
    fn deflection_change(pulse: &Pulse, deflection: Deflection, time: f64) -> f64 {
        let later = pulse.change.start + (time - pulse.start) * Self::log_loading_change(pulse);
        deflection.value * pulse.change.peak / pulse.peak - deflection.rate * later
    }
}

impl Knot<'_> {
    /// Change of the time, s.
    pub(crate) fn change(&self, shape: &PulseShape, shape_change: &ShapeChange) -> f64 {
        let loading_time = shape.loading_time(self.pulse);
        let relative = PulseShape::log_loading_change(self.pulse) + shape_change.log_loading;
        let (length, stretch) = if self.is_end { (1.0 + shape.stretch, shape_change.stretch) } else { (1.0, 0.0) };
        self.pulse.change.start + loading_time * (relative * length + stretch)
    }
}

impl Pulses {
    /// Change of the deflection at `time`, s.
    pub(crate) fn change_at(&self, shape: &PulseShape, time: f64) -> f64 {
        self.largest(shape, time)
            .map_or(0.0, |(pulse, deflection)| PulseShape::deflection_change(pulse, deflection, time))
    }

    /// The pulses under way change no more.
    pub(crate) fn forget_changes(&mut self) {
        self.under_way.iter_mut().for_each(|pulse| pulse.change = PulseChange::default());
    }

    /// The first time after `time`, s, at which a pulse peaks or ends; none when the membrane is flat.
    pub(crate) fn next_knot(&self, shape: &PulseShape, time: f64) -> Option<Knot<'_>> {
        let knots = self.under_way.iter().flat_map(|pulse| {
            let peak = Knot { time: shape.peak_time(pulse), pulse, is_end: false };
            [peak, Knot { time: shape.end_time(pulse), pulse, is_end: true }]
        });
        knots.filter(|knot| knot.time > time).min_by(|a, b| a.time.total_cmp(&b.time))
    }
}

/// Logarithmic derivative of the Gamma function at `x` > 0: recurrence and asymptotic series.
fn digamma(x: f64) -> f64 {
    const ASYMPTOTIC: f64 = 20.0; // from here on the terms left out are below 1e-17
    let (mut x, mut sum) = (x, 0.0);
    while x < ASYMPTOTIC {
        sum -= 1.0 / x;
        x += 1.0;
    }
    let square = 1.0 / (x * x);
    let series = square
        * (1.0 / 12.0 - square * (1.0 / 120.0 - square * (1.0 / 252.0 - square * (1.0 / 240.0 - square / 132.0))));
    sum + x.ln() - 0.5 / x - series
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_digamma_function_has_its_known_values() {
        const EULER: f64 = 0.577_215_664_901_532_9;
        assert_relative_eq!(digamma(1.0), -EULER, max_relative = 1e-14);
        assert_relative_eq!(digamma(0.5), -EULER - 2.0 * core::f64::consts::LN_2, max_relative = 1e-14);
    }

    #[test]
    fn the_shape_changes_as_central_differences_say() {
        const H: f64 = 1e-5;
        let pulse = Pulse { start: 1.0, speed: 0.3, peak: 0.002, change: PulseChange::default() };
        let ends = |n, r| {
            [false, true].map(|is_end| {
                let shape = PulseShape::new(n, r);
                if is_end { shape.end_time(&pulse) } else { shape.peak_time(&pulse) }
            })
        };
        let shape = PulseShape::new(2.6, 0.6);
        for (dn, dr) in [(1.0, 0.0), (0.0, 1.0)] {
            let change = shape.change(dn, dr);
            let (up, down) = (ends(2.6 + H * dn, 0.6 + H * dr), ends(2.6 - H * dn, 0.6 - H * dr));
            for (k, is_end) in [false, true].into_iter().enumerate() {
                let knot = Knot { time: 0.0, pulse: &pulse, is_end };
                let slope = (up[k] - down[k]) / (2.0 * H);
                assert_relative_eq!(knot.change(&shape, &change), slope, max_relative = 1e-8, epsilon = 1e-10);
            }
        }
    }
}
