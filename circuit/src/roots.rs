//! Roots of scalar functions: bracketed, so that they always end.

/// Halving a bracket of doubles to its last bit takes about this many evaluations at most.
const EVALUATIONS: usize = 200;

/// Iterations of Newton's method without a bracket; it settles in fewer, or at nothing.
pub(crate) const NEWTON: usize = 12;

/// Root of `f` on `[a, b]` by Newton's method, halved where Newton leaves the bracket or is slow.
///
/// `f` returns value and derivative; the value has to rise or fall through zero between `a` and `b`. Values
/// may be infinite: only their sign is used then.
pub(crate) fn bracketed(mut f: impl FnMut(f64) -> (f64, f64), a: f64, b: f64, guess: f64) -> f64 {
    let at_a = f(a).0;
    if at_a == 0.0 {
        return a;
    }
    if at_a < 0.0 { between(f, a, b, guess) } else { between(f, b, a, guess) }
}

/// [`bracketed`] between places where `f` is known to be below and above zero: near a root, rounding might tell another sign.
fn between(mut f: impl FnMut(f64) -> (f64, f64), mut below: f64, mut above: f64, guess: f64) -> f64 {
    let mut x = if guess > below.min(above) && guess < below.max(above) { guess } else { 0.5 * (below + above) };
    let mut last_move = (above - below).abs();
    for _ in 0..EVALUATIONS {
        let (value, slope) = f(x);
        if value == 0.0 {
            return x;
        }
        if value < 0.0 {
            below = x;
        } else {
            above = x;
        }
        let newton = x - value / slope;
        let inside = newton > below.min(above) && newton < below.max(above);
        let next = if inside && 2.0 * (newton - x).abs() <= last_move { newton } else { 0.5 * (below + above) };
        last_move = (next - x).abs();
        if last_move <= 2.0 * f64::EPSILON * next.abs() || next == below || next == above {
            return next;
        }
        x = next;
    }
    x
}

/// Root of `f` by Newton's method alone, which from a good guess is the quickest; `None` where no step is at most
/// `resolved` long.
pub(crate) fn newton(mut f: impl FnMut(f64) -> (f64, f64), guess: f64, resolved: f64) -> Option<f64> {
    let mut x = guess;
    for _ in 0..NEWTON {
        let (value, slope) = f(x);
        let step = -value / slope;
        x += step;
        // NaN never is.
        if step.abs() <= resolved {
            return Some(x);
        }
    }
    None
}

/// Root of an increasing `f` near `guess`: Newton's method while it converges, else strides of `reach`, four
/// times longer each, until the root is enclosed, then [`bracketed`]. `None` where there is none (or `f` is NaN).
pub(crate) fn increasing(mut f: impl FnMut(f64) -> (f64, f64), guess: f64, reach: f64) -> Option<f64> {
    let mut x = guess;
    let mut stride = reach;
    let mut last_move = f64::INFINITY;
    let mut other_side: Option<(f64, f64)> = None;
    for _ in 0..EVALUATIONS {
        let (value, slope) = f(x);
        if value.is_nan() || !x.is_finite() {
            return None;
        }
        if value == 0.0 {
            return Some(x);
        }
        if let Some((from, from_value)) = other_side
            && from_value * value < 0.0
        {
            let (below, above) = if value < 0.0 { (x, from) } else { (from, x) };
            return Some(between(f, below, above, x - value / slope));
        }
        other_side = Some((x, value.signum()));
        let newton = -value / slope;
        let step = if newton.is_finite() && newton.abs() <= 0.5 * last_move {
            newton
        } else {
            stride *= 4.0;
            -value.signum() * stride
        };
        last_move = step.abs();
        if last_move <= 2.0 * f64::EPSILON * x.abs() {
            return Some(x + step);
        }
        x += step;
    }
    None
}

/// First place where a function, not negative at 0, falls through zero, from its parts with one zero at most: `ends` of
/// these, in order. `value` has the function and the size of the terms that it is a difference of; a dip below zero by
/// less than `noise` times this size is rounding.
pub(crate) fn first_descent(
    value: impl Fn(f64) -> (f64, f64),
    slope: impl Fn(f64) -> f64,
    ends: impl Iterator<Item = f64>,
    noise: f64,
) -> Option<f64> {
    let mut from = 0.0;
    for to in ends {
        let (at_end, size) = value(to);
        if at_end < -noise * size {
            if value(from).0 <= 0.0 {
                return Some(from);
            }
            return Some(bracketed(|t| (value(t).0, slope(t)), from, to, 0.5 * (from + to)));
        }
        from = to;
    }
    None
}

/// A smooth function on a span that starts at 0, with what is needed to find all its zeros.
pub(crate) struct Curve<F, D> {
    /// The function and the size of the terms that it is a difference of.
    pub value: F,
    /// Its first and second derivative.
    pub slopes: D,
    /// The only place where the second derivative may change sign.
    pub inflection: f64,
}

impl<F: Fn(f64) -> (f64, f64), D: Fn(f64) -> (f64, f64)> Curve<F, D> {
    /// First place in `[0, end]` where the function, not negative at 0, falls through zero.
    ///
    /// The inflection splits the span into parts on which the slope is monotone, the zeros of the slope into
    /// parts on which the function is monotone: no zero can be missed. A dip below zero by less than `noise` times
    /// the size of the terms is rounding.
    pub fn first_descent(&self, end: f64, noise: f64) -> Option<f64> {
        first_descent(&self.value, |t| (self.slopes)(t).0, self.turning_points(end), noise)
    }

    /// Ends of the parts on which the function is monotone, in order; `end` is the last.
    fn turning_points(&self, end: f64) -> impl Iterator<Item = f64> {
        let middle = if self.inflection > 0.0 && self.inflection < end { Some(self.inflection) } else { None };
        let first = self.turning_point(0.0, middle.unwrap_or(end));
        let second = middle.and_then(|m| self.turning_point(m, end));
        [first, second, Some(end)].into_iter().flatten()
    }

    /// The zero of the slope inside `(a, b)`, where the slope is monotone.
    fn turning_point(&self, a: f64, b: f64) -> Option<f64> {
        let (at_a, at_b) = ((self.slopes)(a).0, (self.slopes)(b).0);
        if at_a * at_b < 0.0 { Some(bracketed(&self.slopes, a, b, 0.5 * (a + b))) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_bracketed_root_is_found_to_the_last_bits() {
        let root = bracketed(|x| (x.exp() - 1e30, x.exp()), -1e3, 1e3, 0.0);
        assert_relative_eq!(root, 1e30_f64.ln(), max_relative = 1e-15);
    }

    #[test]
    fn newton_alone_settles_near_a_root_and_gives_up_far_from_it() {
        let f = |x: f64| (x.exp() - 1e30, x.exp());
        assert_relative_eq!(newton(f, 69.0, 1e-8).unwrap(), 1e30_f64.ln(), max_relative = 1e-15);
        assert_eq!(newton(f, -1e3, 1e-8), None);
    }

    #[test]
    fn infinite_values_only_steer_the_bracket() {
        let root = increasing(|x| ((x * x * x).exp() - 1.5, f64::NAN), 900.0, 1.0);
        assert_relative_eq!(root.unwrap(), 1.5_f64.ln().cbrt(), max_relative = 1e-15);
    }

    #[test]
    fn a_function_without_a_root_is_reported() {
        assert_eq!(increasing(|_| (1.0, 0.0), 0.0, 1.0), None);
    }

    #[test]
    fn the_first_of_three_zeros_is_taken_and_a_touching_start_is_not() {
        // x (x - 0.1)(x - 2) starts at zero, rises, and falls through zero at 0.1.
        let cubic = Curve {
            value: |x: f64| (x * (x - 0.1) * (x - 2.0), 1.0),
            slopes: |x: f64| (3.0 * x * x - 4.2 * x + 0.2, 6.0 * x - 4.2),
            inflection: 0.7,
        };
        assert_relative_eq!(cubic.first_descent(5.0, 1e-15).unwrap(), 0.1, max_relative = 1e-14);
        assert_eq!(cubic.first_descent(0.09, 1e-15), None);
    }
}
