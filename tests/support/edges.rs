//! Numbers at which programs break, for the tests of all packages.

/// Either bound of a parameter, its neighbours, and what no bound can be of.
pub fn around(min: f64, max: f64) -> Vec<f64> {
    let numbers = [0.0, -0.0, 5e-324, -5e-324, 1e-310, 1e308, -1e308, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    [min, min.next_up(), min.next_down(), max, max.next_down(), max.next_up()].into_iter().chain(numbers).collect()
}
