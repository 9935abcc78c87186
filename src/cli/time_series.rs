//! A warning before a large time series is written.

use crate::scenario::Scenario;

/// Bytes of a row without and with a circuit, as `simulate --until 20` and `cosim --until 20` write them.
const ROW: [f64; 2] = [240.0, 475.0];
/// Size above which the user is warned, bytes.
const LARGE: f64 = 1e9;

/// The warning if the time series of `scenario`, with or without a circuit, fills more than 1 GB.
pub fn warning(scenario: &Scenario, circuit: bool) -> Option<String> {
    let points = (scenario.until / scenario.step).ceil() + 1.0;
    let bytes = points * ROW[usize::from(circuit)];
    (bytes > LARGE).then(|| {
        format!(
            "the time series will have {points:.0} points or more and fill some {:.0} GB; a larger --step or a smaller \
             --until makes it smaller, and sweep writes none",
            bytes / 1e9
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Request;

    fn of(until: f64, step: Option<f64>, circuit: bool) -> Option<String> {
        warning(&Request { until: Some(until), step, ..Request::default() }.resolve().unwrap(), circuit)
    }

    #[test]
    fn a_time_series_of_more_than_a_gigabyte_is_told_of_with_its_points_and_size() {
        let said = of(200_000.0, None, true).unwrap();
        assert!(said.starts_with("the time series will have 200000001 points or more and fill some 95 GB; "), "{said}");
        assert_eq!((of(2100.0, None, true), of(4100.0, None, false)), (None, None));
        assert!(of(2200.0, None, true).is_some() && of(4200.0, None, false).is_some());
        assert_eq!(of(200_000.0, Some(0.1), true), None);
    }
}
