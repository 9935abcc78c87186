//! Products without rounding.

use super::elementary::round;

/// Fraction of a turn in `frequency` x `time`, in [-1/2, 1/2]. The product is formed exactly, as a sum of two doubles
/// (Dekker 1971), so that the fraction is right to rounding however many turns there were.
pub fn cycle_fraction(frequency: f64, time: f64) -> f64 {
    let product = frequency * time;
    (product - round(product)) + product_error(frequency, time, product)
}

/// What rounding has taken from the `product` of `x` and `y`.
pub fn product_error(x: f64, y: f64, product: f64) -> f64 {
    let (a, b) = split(x);
    let (c, d) = split(y);
    ((a * c - product) + a * d + b * c) + b * d
}

/// High and low half of `x`; their sum is `x`, and products of halves are exact.
fn split(x: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0; // 2^27 + 1
    let scaled = SPLITTER * x;
    let high = scaled - (scaled - x);
    (high, x - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fraction_keeps_its_digits_for_a_long_run() {
        // 2.1 Hz has no finite binary expansion; the fused product is the reference.
        for time in [0.123, 1.0e3 + 0.1, 1.0e6 + 0.3, 1.0e9 + 0.7] {
            let product: f64 = 2.1 * time;
            let exact = (product - product.round()) + 2.1_f64.mul_add(time, -product);
            assert_eq!(cycle_fraction(2.1, time), exact, "at {time} s");
        }
    }
}
