//! Signals over one step: the input of a subsystem, and the true output of the other one.

/// A value that runs linearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    /// Value at the start of the step.
    pub start: f64,
    /// Its rate, 1/s.
    pub rate: f64,
}

impl Line {
    /// The value `time` after the start of the step, s.
    pub(super) fn at(&self, time: f64) -> f64 {
        self.start + self.rate * time
    }
}

/// A value known with its rate at both ends of a step: the cubic through them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Curve {
    /// Length of the step, s.
    pub step: f64,
    /// Values at its ends.
    pub value: [f64; 2],
    /// Rates there, 1/s.
    pub rate: [f64; 2],
}

impl Curve {
    /// Instants of a step at which signals are compared, as fractions. Quarters, because a value at rest at both ends differs
    /// from its chord everywhere but in the middle.
    const INSTANTS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

    /// The value at the fraction `s` of the step.
    fn at(&self, s: f64) -> f64 {
        let (t, h) = (1.0 - s, self.step);
        let ([start, end], [rising, falling]) = (self.value, self.rate);
        t * t * (1.0 + 2.0 * s) * start + s * s * (1.0 + 2.0 * t) * end + h * s * t * (t * rising - s * falling)
    }

    /// Its rate there, 1/s.
    fn rate_at(&self, s: f64) -> f64 {
        let mean = (self.value[1] - self.value[0]) / self.step;
        6.0 * s * (1.0 - s) * mean + (1.0 - s) * (1.0 - 3.0 * s) * self.rate[0] + s * (3.0 * s - 2.0) * self.rate[1]
    }

    /// How far `line` is from this curve, relative to its values.
    pub(super) fn deviation(&self, line: &Line) -> f64 {
        let relative = |s: f64| ((line.at(s * self.step) - self.at(s)) / self.at(s)).abs();
        Self::INSTANTS.into_iter().map(relative).fold(0.0, f64::max)
    }

    /// The integral of -1/2 U^2 dC, J, where this is C(t) and `voltage` U(t): the work of the mechanics. Gauss's rule with
    /// three points is exact for it.
    pub(super) fn work(&self, voltage: &Line) -> f64 {
        let offset = 0.5 * 0.6_f64.sqrt();
        let points = [(0.5 - offset, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + offset, 5.0 / 18.0)];
        let power = |s: f64| -0.5 * voltage.at(s * self.step).powi(2) * self.rate_at(s);
        points.into_iter().map(|(s, weight)| weight * power(s)).sum::<f64>() * self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// The cubic 2 + 3 t - 5 t^2 + 7 t^3 over 0.5 s.
    const CUBIC: Curve = Curve { step: 0.5, value: [2.0, 3.125], rate: [3.0, 3.25] };

    #[test]
    fn a_cubic_is_found_again_with_its_rate() {
        for s in [0.0, 0.3, 1.0] {
            let t = 0.5 * s;
            assert_relative_eq!(CUBIC.at(s), 2.0 + 3.0 * t - 5.0 * t * t + 7.0 * t * t * t, max_relative = 1e-15);
            assert_relative_eq!(CUBIC.rate_at(s), 3.0 - 10.0 * t + 21.0 * t * t, max_relative = 1e-14);
        }
    }

    /// Integrated by hand: (4 + t)^2 (3 - 10 t + 21 t^2), term by term.
    #[test]
    fn the_work_against_a_linear_voltage_is_exact() {
        let antiderivative =
            |t: f64| 48.0 * t - 68.0 * t.powi(2) + 259.0 / 3.0 * t.powi(3) + 39.5 * t.powi(4) + 4.2 * t.powi(5);
        assert_relative_eq!(
            CUBIC.work(&Line { start: 4.0, rate: 1.0 }),
            -0.5 * antiderivative(0.5),
            max_relative = 1e-14
        );
    }

    #[test]
    fn the_chord_of_a_curve_at_rest_at_both_ends_is_not_taken_for_the_curve() {
        let pulse = Curve { step: 0.01, value: [15e-12, 20e-12], rate: [0.0; 2] };
        let chord = Line { start: 15e-12, rate: 5e-10 };
        assert!(pulse.deviation(&chord) > 0.02);
        assert_eq!(Curve { value: [15e-12; 2], ..pulse }.deviation(&Line { start: 15e-12, rate: 0.0 }), 0.0);
    }
}
