//! When to communicate.

/// Communication points: a regular grid, the edges of the averaging window, the end, and the knots of C(t).
#[derive(Debug, Clone, Copy)]
pub struct Schedule {
    step: f64,
    until: f64,
    window: [f64; 2],
}

impl Schedule {
    /// Shortest step, in units of the regular one, except before an edge of the window. A ball that comes to rest has endless
    /// knots; those closer to another communication point than this get no point.
    const CLOSEST: f64 = 1e-3;

    /// A grid of `step`, s, up to `until`, s, with the edges of `window`, s.
    pub fn new(step: f64, until: f64, window: [f64; 2]) -> Self {
        Self { step, until, window }
    }

    /// The next communication point after `now`, s, if a capacitance has a kink or an extremum at `knot`, s. Points of
    /// the grid are products, not sums, so that they do not drift.
    pub fn next(&self, now: f64, knot: f64) -> f64 {
        let target = (((now + self.closest()) / self.step).floor() + 1.0) * self.step;
        let stop = self.stop(now);
        // A hair after the point of the grid rather than a hair before the edge or the end.
        let target = if stop < target + self.closest() { stop } else { target };
        self.land(now, target, knot)
    }

    /// The next communication point at most `step`, s, after `now`, or later where that would be too short a step; off the grid,
    /// the rest as for [`Schedule::next`].
    pub(super) fn within(&self, now: f64, step: f64, knot: f64) -> f64 {
        let (stop, closest) = (self.stop(now), self.closest());
        let target = now + step.max(closest);
        let target = if stop <= target || stop - now < 2.0 * closest {
            stop
        } else {
            // The step after this one is not too short, either.
            target.min(stop - closest)
        };
        self.land(now, target, knot)
    }

    /// The edge of the window, or the end, that comes next after `now`, s: averages are those of the window only if its
    /// edges are met.
    fn stop(&self, now: f64) -> f64 {
        self.window.into_iter().filter(|&edge| edge > now).fold(self.until, f64::min)
    }

    /// Shortest step that the schedule chooses by itself, s.
    pub(super) fn closest(&self) -> f64 {
        Self::CLOSEST * self.step
    }

    fn land(&self, now: f64, target: f64, knot: f64) -> f64 {
        let closest = self.closest();
        // A knot that is too close is passed with the shortest step, so that it does not hide the one behind it.
        let landing = knot.max(now + closest);
        if landing < target - closest { landing } else { target }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(schedule: Schedule, until: f64, knots: &[f64]) -> Vec<f64> {
        let (mut now, mut points) = (0.0, Vec::new());
        while now < until {
            let knot = knots.iter().copied().find(|&knot| knot > now).unwrap_or(f64::MAX);
            now = schedule.next(now, knot);
            points.push(now);
        }
        points
    }

    #[test]
    fn the_grid_the_window_and_the_end_are_met_exactly() {
        let found = points(Schedule::new(0.25, 1.1, [0.3, 0.9]), 1.1, &[]);
        assert_eq!(found, [0.25, 0.3, 0.5, 0.75, 0.9, 1.0, 1.1]);
        let fine = points(Schedule::new(1e-3, 100.0, [50.0, 100.0]), 100.0, &[]);
        assert_eq!(fine.len(), 100_000);
        assert!(fine.contains(&50.0) && fine.last() == Some(&100.0));
    }

    #[test]
    fn an_edge_of_the_window_is_met_however_close_it_is_to_a_point_of_the_grid_a_knot_or_the_end() {
        let met = |window: [f64; 2], until: f64, knots: &[f64]| {
            let found = points(Schedule::new(0.5, until, window), until, knots);
            assert!(window.iter().all(|edge| found.contains(edge)), "{window:?}: {found:?}");
            assert_eq!(found.last(), Some(&until));
            found
        };
        assert_eq!(met([1.000_4, 1.5], 2.0, &[]), [0.5, 1.000_4, 1.5, 2.0]);
        assert_eq!(met([0.999_6, 1.5], 2.0, &[]), [0.5, 0.999_6, 1.5, 2.0]);
        assert_eq!(met([0.000_4, 1.0], 1.0, &[]), [0.000_4, 0.5, 1.0]);
        assert_eq!(met([0.5, 1.999_8], 2.0, &[]), [0.5, 1.0, 1.5, 1.999_8, 2.0]);
        assert_eq!(met([0.7, 0.700_1], 1.0, &[]), [0.5, 0.7, 0.700_1, 1.0]);
        assert_eq!(met([0.700_4, 1.0], 1.0, &[0.7]), [0.5, 0.700_4, 1.0]);
    }

    #[test]
    fn steps_off_the_grid_meet_knots_window_and_end_and_are_never_too_short() {
        let schedule = Schedule::new(0.25, 1.1, [0.3, 0.9]);
        let next = |now, step, knot| schedule.within(now, step, knot);
        assert_eq!(next(0.0, 0.2, f64::MAX), 0.2);
        assert_eq!(next(0.2, 0.2, f64::MAX), 0.3);
        assert_eq!(next(0.3, 0.5, 0.4), 0.4);
        assert_eq!(next(0.4, 1e-9, f64::MAX), 0.4 + 0.25e-3);
        assert_eq!(next(0.95, 0.149_9, f64::MAX), 1.1 - 0.25e-3);
        assert_eq!(next(1.1 - 0.25e-3, 0.1, f64::MAX), 1.1);
    }

    #[test]
    fn a_step_off_the_grid_is_no_longer_than_asked_for_unless_it_is_the_shortest() {
        for edge in (1..120).map(|k| f64::from(k) * 0.1 * 0.25e-3) {
            for knot in [f64::MAX, 1e-4, 3e-4, 6e-4] {
                let schedule = Schedule::new(0.25, 0.1, [edge, 0.1]);
                let shortest = schedule.within(0.0, 0.0, knot);
                for step in (0..300).map(|k| 1e-5 * f64::from(k)) {
                    let next = schedule.within(0.0, step, knot);
                    assert!(next > 0.0 && (next <= step || next <= shortest), "{edge} {knot} {step}: {next} s");
                    let is_left = edge <= next || edge - next >= 0.999 * schedule.closest();
                    assert!(is_left || next == knot, "{edge} {knot} {step}: {next} s is a hair before the edge");
                }
            }
        }
    }

    #[test]
    fn knots_are_landed_on_unless_they_crowd() {
        let crowd: Vec<f64> = (0..1000).map(|k| 0.3 + 1e-7 * f64::from(k)).collect();
        let found =
            points(Schedule::new(0.25, 0.5, [0.0, 0.5]), 0.5, &[&[0.1, 0.250_000_1], crowd.as_slice()].concat());
        assert_eq!(found, [0.1, 0.25, 0.25 + 0.25e-3, 0.3, 0.3 + 0.25e-3, 0.5]);
    }
}
