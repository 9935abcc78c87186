//! Patterns that the paper points out in sequences of impacts, by rule.

use super::recording::Impact;

/// Pairs of consecutive impacts that the paper circles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pattern {
    /// Figure 11: on opposite membranes, while the ball moves over less than half of its travel s.
    ShortFlight,
    /// Figure 12: both on one membrane.
    DoubleHit,
}

impl Pattern {
    /// The rule in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::ShortFlight => "pairs of impacts on opposite membranes between which the ball moves by less than s/2",
            Self::DoubleHit => "pairs of consecutive impacts on one membrane",
        }
    }

    fn is(self, pair: &[Impact], travel: f64) -> bool {
        let [first, second] = pair else { return false };
        match self {
            Self::ShortFlight => first.left != second.left && (second.ball - first.ball).abs() < travel / 2.0,
            Self::DoubleHit => first.left == second.left,
        }
    }

    /// How many pairs are of this kind; `travel` is s, m.
    pub(super) fn count(self, impacts: &[Impact], travel: f64) -> usize {
        impacts.windows(2).filter(|pair| self.is(pair, travel)).count()
    }

    /// The impacts that make such pairs, each once.
    pub(super) fn members(self, impacts: &[Impact], travel: f64) -> Vec<Impact> {
        let in_pair = |index: usize| impacts.get(index..index + 2).is_some_and(|pair| self.is(pair, travel));
        let members = impacts.iter().enumerate();
        members
            .filter(|(index, _)| in_pair(*index) || index.checked_sub(1).is_some_and(in_pair))
            .map(|(_, impact)| *impact)
            .collect()
    }
}

/// Mean length of the rows of impacts that weaken from one to the next. The first and the last row may be cut and do not
/// count. NaN without others.
pub(super) fn mean_falling_row(impacts: &[Impact]) -> f64 {
    let rises = impacts.windows(2).enumerate().filter(|(_, pair)| pair[1].gain > pair[0].gain);
    let rises: Vec<usize> = rises.map(|(index, _)| index).collect();
    match rises[..] {
        [first, .., last] => (last - first) as f64 / (rises.len() - 1) as f64,
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn impact(left: bool, ball: f64, gain: f64) -> Impact {
        Impact { time: 0.0, left, speed: 0.0, gain, ball, displacement: 0.0 }
    }

    #[test]
    fn pairs_are_found_by_side_and_by_how_far_the_ball_went() {
        let impacts = [
            impact(true, 0.0, 3.0),
            impact(false, 0.01, 2.0), // after a short flight
            impact(true, -0.03, 1.0),
            impact(true, -0.03, 3.0), // again
            impact(false, 0.01, 2.0),
        ];
        assert_eq!(Pattern::ShortFlight.count(&impacts, 0.044), 1);
        assert_eq!(Pattern::ShortFlight.members(&impacts, 0.044), impacts[..2]);
        assert_eq!(Pattern::DoubleHit.count(&impacts, 0.044), 1);
        assert_eq!(Pattern::DoubleHit.members(&impacts, 0.044), impacts[2..4]);
    }

    #[test]
    fn rows_that_the_ends_may_cut_do_not_count() {
        let row =
            |gains: &[f64]| mean_falling_row(&gains.iter().map(|&gain| impact(true, 0.0, gain)).collect::<Vec<_>>());
        assert_eq!(row(&[1.0, 3.0, 2.0, 1.0, 2.0, 1.0, 5.0]), 2.5);
        assert!(row(&[3.0, 2.0, 1.0, 3.0, 2.0]).is_nan());
    }
}
