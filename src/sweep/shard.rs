//! A share of the runs: contiguous, so that the shares one after the other are the whole.

use std::fmt;
use std::ops::Range;

/// Share number `number` of `of`, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    of: u64,
}

/// Most shards of a sweep.
const MOST: u64 = 1_000_000;

impl Shard {
    /// Reads `i/n`.
    ///
    /// # Errors
    /// If it is not of that form, or i does not lie from 1 to n.
    pub fn parse(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(number, of)| (number.trim().parse().ok(), of.trim().parse().ok()));
        match numbers {
            Some((Some(number), Some(of))) if 1 <= number && number <= of && of <= MOST => Ok(Self { number, of }),
            _ => Err(format!("a shard is i/n with 1 <= i <= n <= {MOST}, e.g. 2/8")),
        }
    }

    /// All shards of `of`.
    pub fn all(of: u64) -> impl Iterator<Item = Self> {
        (1..=of).map(move |number| Self { number, of })
    }

    /// How many shards make the whole.
    pub fn of(self) -> u64 {
        self.of
    }

    /// The runs that it consists of, among `runs`.
    pub fn range(self, runs: u64) -> Range<u64> {
        // At most `runs`: the quotient fits.
        let edge = |k: u64| u64::try_from(u128::from(runs) * u128::from(k) / u128::from(self.of)).unwrap_or(runs);
        edge(self.number - 1)..edge(self.number)
    }

    /// Its file, without the folder.
    pub fn file_name(self) -> String {
        format!("sweep.{}-of-{}.csv", self.number, self.of)
    }

    /// The shard whose file has this name.
    pub fn of_file_name(name: &str) -> Option<Self> {
        let (number, of) = name.strip_prefix("sweep.")?.strip_suffix(".csv")?.split_once("-of-")?;
        // The same file name again: no other spelling of a number counts.
        Self::parse(&format!("{number}/{of}")).ok().filter(|shard| shard.file_name() == name)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_one_after_the_other_are_the_whole() {
        for runs in [0, 1, 7, 100, u64::MAX] {
            for of in [1, 2, 3, 8, 101] {
                let edges: Vec<_> = Shard::all(of).map(|shard| shard.range(runs)).collect();
                assert_eq!((edges[0].start, edges[edges.len() - 1].end), (0, runs));
                assert!(edges.windows(2).all(|pair| pair[0].end == pair[1].start));
                let lengths = edges.iter().map(|range| range.end - range.start);
                assert!(lengths.clone().max().unwrap() - lengths.min().unwrap() <= 1, "{runs} runs in {of} shards");
            }
        }
    }

    #[test]
    fn a_shard_is_read_and_named_in_one_way_only() {
        let shard = Shard::parse("2/8").unwrap();
        assert_eq!((shard.to_string(), shard.file_name()), ("2/8".to_owned(), "sweep.2-of-8.csv".to_owned()));
        assert_eq!(Shard::of_file_name("sweep.2-of-8.csv"), Some(shard));
        for name in ["sweep.csv", "sweep.02-of-8.csv", "sweep.9-of-8.csv", "sweep.2-of-8.csv.part", "x.2-of-8.csv"] {
            assert_eq!(Shard::of_file_name(name), None, "{name}");
        }
        for text in ["", "2", "0/8", "9/8", "1/0", "-1/2", "a/b", "1/1000001", "1/2/3"] {
            assert!(Shard::parse(text).unwrap_err().contains("1 <= i <= n"), "{text}");
        }
    }
}
