//! Special functions as series.

/// Sum of a hypergeometric series at 0 <= `x` <= 1/2 from the ratio of its neighbouring coefficients, all below one.
pub fn hypergeometric(x: f64, ratio: impl Fn(f64) -> f64) -> f64 {
    const MAX_TERMS: u32 = 200;
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 0..MAX_TERMS {
        term *= x * ratio(f64::from(k));
        sum += term;
        if term < sum * 1e-17 {
            break;
        }
    }
    sum
}
