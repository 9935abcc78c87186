//! Roots of monotone functions by Newton's method.

/// Bisection alone needs at most some 110 to exhaust the digits of a double.
const MAX_ITERATIONS: u32 = 200;

/// Root of a monotone `function` (value and slope) that is positive at `low` and not at `high`; bisection wherever Newton's
/// method would leave the bracket.
pub fn bracketed_root(low: f64, high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    root_near(0.5 * (low + high), low, high, function)
}

/// The same, where the root is about at `start`.
pub fn root_near(start: f64, low: f64, high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    newton_or_bisection(start, [low, high], function, |step, x, _| step <= f64::EPSILON * x.abs())
}

/// The same, but for the last steps of Newton's method: the root is right to some 1e-15 of the bracket, and none of its steps go to
/// and fro in the rounding of the function.
pub fn short_root_near(start: f64, low: f64, high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    /// After a step as short as this part of the bracket, the next one would be about its square.
    const SHORT: f64 = 1e-8;
    let shortest = SHORT * (high - low);
    newton_or_bisection(start, [low, high], function, |step, _, is_newton| is_newton && step <= shortest)
}

/// `is_last`: whether a step of this length from x, by Newton's method or not, is the last.
#[inline]
fn newton_or_bisection(
    start: f64,
    [mut low, mut high]: [f64; 2],
    function: impl Fn(f64) -> (f64, f64),
    is_last: impl Fn(f64, f64, bool) -> bool,
) -> f64 {
    let mut x = start;
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = function(x);
        if value > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let is_inside = newton > low && newton < high;
        let next = if is_inside { newton } else { 0.5 * (low + high) };
        let converged = is_last((next - x).abs(), x, is_inside);
        x = next;
        if converged || high - low <= f64::EPSILON * high.abs() {
            break;
        }
    }
    x
}

/// Root of a nearly linear, convex, increasing function that returns value and slope. `start` lies at or beyond the root, so
/// the iteration falls towards it; `end` bounds the range of the function.
pub fn convex_root(start: f64, end: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = start.clamp(0.0, end);
    for _ in 0..20 {
        let (value, slope) = function(x);
        let next = (x - value / slope).clamp(0.0, end);
        let change = (next - x).abs();
        x = next;
        if change <= 1e-15 {
            break;
        }
    }
    x
}
