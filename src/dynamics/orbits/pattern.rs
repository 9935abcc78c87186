//! The order of an orbit's impacts, which names it.

use std::fmt;

use videg_model::{Impact, Side};

/// The impacts of an orbit in one round: n on the left and m on the right membrane, n:m. A ball that comes to rest makes infinitely
/// many, each weaker than the one before: these count as one.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pattern {
    /// `L` and `R`, `l` and `r` where the ball comes to rest; of all rounds, the first in the alphabet.
    letters: String,
}

impl Pattern {
    /// That of these impacts.
    pub fn of(impacts: &[Impact]) -> Self {
        let letters: Vec<char> = leading(impacts).iter().map(letter).collect();
        let round = |start: usize| (0..letters.len()).map(|k| letters[(start + k) % letters.len()]).collect::<String>();
        Self { letters: (0..letters.len()).map(round).min().unwrap_or_default() }
    }

    /// Numbers of impacts on the left and on the right membrane.
    pub fn counts(&self) -> [usize; 2] {
        let count = |letter: char| self.letters.chars().filter(|other| other.eq_ignore_ascii_case(&letter)).count();
        [count('L'), count('R')]
    }

    /// Whether the ball comes to rest.
    pub fn rests(&self) -> bool {
        self.letters.contains(['l', 'r'])
    }

    /// The order: `L` and `R`, `l` and `r` where the ball comes to rest.
    pub fn letters(&self) -> &str {
        &self.letters
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [left, right] = self.counts();
        write!(formatter, "{left}:{right}")
    }
}

/// The impacts. Of a row of impacts that ends at rest on a membrane only the first stays, and `rests` is set there.
pub(super) fn leading(impacts: &[Impact]) -> Vec<Impact> {
    let mut kept: Vec<Impact> = Vec::new();
    let mut rows = impacts.chunk_by(|a, b| a.side == b.side && !a.rests).collect::<Vec<_>>();
    // The orbit is closed: the first row continues the last one.
    if let [first, .., last] = rows[..]
        && first[0].side == last[0].side
        && !last[last.len() - 1].rests
        && first[first.len() - 1].rests
    {
        rows.pop();
        kept.push(Impact { rests: true, ..last[0] });
        rows.remove(0);
    }
    for row in rows {
        if row[row.len() - 1].rests {
            kept.push(Impact { rests: true, ..row[0] });
        } else {
            kept.extend(row);
        }
    }
    kept
}

fn letter(impact: &Impact) -> char {
    match (impact.side, impact.rests) {
        (Side::Left, false) => 'L',
        (Side::Left, true) => 'l',
        (Side::Right, false) => 'R',
        (Side::Right, true) => 'r',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(letters: &str) -> Pattern {
        let impact = |letter: char| {
            let side = if letter.eq_ignore_ascii_case(&'L') { Side::Left } else { Side::Right };
            Impact { time: 0.0, side, speed: 1.0, rests: letter.is_lowercase() }
        };
        Pattern::of(&letters.chars().map(impact).collect::<Vec<_>>())
    }

    #[test]
    fn the_round_may_begin_anywhere() {
        for letters in ["LLR", "LRL", "RLL"] {
            assert_eq!((pattern(letters).letters(), pattern(letters).to_string().as_str()), ("LLR", "2:1"));
        }
        assert_eq!(pattern("").to_string(), "0:0");
    }

    #[test]
    fn impacts_that_bring_the_ball_to_rest_count_as_one() {
        for letters in ["LLLlR", "LlRLL", "RLLLl"] {
            let found = pattern(letters);
            assert_eq!((found.to_string().as_str(), found.rests()), ("1:1", true), "{letters}");
        }
        assert_eq!(pattern("LlLl").to_string(), "2:0");
    }
}
