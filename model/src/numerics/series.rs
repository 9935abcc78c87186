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

/// Logarithmic derivative of the Gamma function at `x` > 0: recurrence and asymptotic series.
pub fn digamma(x: f64) -> f64 {
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

    #[test]
    fn the_digamma_function_has_its_known_values() {
        const EULER: f64 = 0.577_215_664_901_532_9;
        approx::assert_relative_eq!(digamma(1.0), -EULER, max_relative = 1e-14);
        approx::assert_relative_eq!(digamma(0.5), -EULER - 2.0 * core::f64::consts::LN_2, max_relative = 1e-14);
    }
}
