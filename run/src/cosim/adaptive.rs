//! The length of a communication step that adapts to the signals.

/// Chooses steps so that the error of the signals within each stays below a tolerance.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepControl {
    tolerance: f64,
    step: f64,
    longest: f64,
}

impl StepControl {
    /// Longest step, in units of the regular one. It bounds the gaps in a time series.
    const LONGEST: f64 = 100.0;
    /// Fraction of the step at the tolerance that is tried, so that few steps are undone.
    const SAFETY: f64 = 0.9;
    /// Bounds of the change from one step to the next.
    const CHANGE: [f64; 2] = [0.01, 5.0];

    /// Begins with the regular `step`, s.
    pub(super) fn new(tolerance: f64, step: f64) -> Self {
        Self { tolerance, step, longest: Self::LONGEST * step }
    }

    /// The step to try, s.
    pub(super) fn step(&self) -> f64 {
        self.step
    }

    /// Whether the `error` of a `step`, s, is small enough; adapts the next step. The step may have been shorter than the one
    /// proposed. Errors grow with the square of the step.
    pub(super) fn accepts(&mut self, step: f64, error: f64) -> bool {
        let [least, most] = Self::CHANGE;
        let factor = Self::SAFETY * (self.tolerance / error).sqrt();
        let accepted = error <= self.tolerance;
        let next = step * if factor.is_nan() { least } else { factor.clamp(least, most) };
        // A step that a knot cut short does not shorten the next one.
        self.step = if accepted && step < self.step { next.max(self.step) } else { next };
        self.step = self.step.min(self.longest);
        accepted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_too_long_is_undone_and_the_next_try_is_tolerated() {
        let mut control = StepControl::new(1e-4, 1e-3);
        let error = |step: f64| 400.0 * step * step; // tolerated up to 0.5 ms
        assert!(!control.accepts(1e-3, error(1e-3)));
        let second = control.step();
        assert!(second < 0.5e-3 && second > 0.4e-3, "{second}");
        assert!(control.accepts(second, error(second)));
    }

    #[test]
    fn quiet_signals_let_the_step_grow_to_its_bound_and_a_knot_does_not_shorten_it() {
        let mut control = StepControl::new(1e-4, 1e-3);
        for _ in 0..5 {
            assert!(control.accepts(control.step(), 0.0));
        }
        assert_eq!(control.step(), 0.1);
        assert!(control.accepts(1e-6, 0.0));
        assert_eq!(control.step(), 0.1);
    }

    #[test]
    fn an_error_without_a_number_undoes_the_step() {
        let mut control = StepControl::new(1e-4, 1e-3);
        assert!(!control.accepts(1e-3, f64::NAN) && !control.accepts(1e-3, f64::INFINITY));
        assert_eq!(control.step(), 1e-5);
    }
}
