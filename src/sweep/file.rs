//! Sweep files: case files that also say what is varied.
//!
//! ```toml
//! case = "fig14"
//! until = 60.0
//! design = "lhs"                 # or "grid" (default), "random"
//! points = 1000                  # of lhs and random; a grid has as many as it has
//! samples = 200                  # runs of each point, each with a seed of its own
//! confidence = 0.9               # of the intervals of means
//! until_precision = 0.05         # samples, at most so many, until the interval of a mean is that narrow
//! precision_of = "impacts"
//! seed = 7
//! common_seeds = true            # sample i has the same seed in all points
//! seed_variable = "excitation.seed"
//! record = ["cylinder.position"]
//!
//! [set]
//! excitation.phaseNoise = 0.5
//!
//! [vary]
//! membrane.restitution = { from = 0.2, to = 0.9 }
//! membrane.stiffness = { from = 1e4, to = 1e6, scale = "log" }
//! initial.outsideGap = ["project", "free"]
//! ```

use std::path::Path;

use serde::Deserialize;
use toml::Table;

use super::{Sampling, Vary};
use crate::scenario::{CaseFile, Origin, ScenarioError, check_characters, read_file, toml_error, with_plain_ends};

/// Contents of a sweep file.
#[derive(Debug, Default)]
pub struct SweepFile {
    /// The part that a case file has, too.
    pub case: CaseFile,
    /// Points and samples.
    pub sampling: Sampling,
    /// Variables to record at the end of each run.
    pub record: Vec<String>,
    /// Variables to vary.
    pub vary: Vec<Vary>,
}

/// The keys that a case file does not have, but for those of [`Sampling`].
#[derive(Deserialize)]
struct Layout {
    #[serde(default)]
    record: Vec<String>,
    #[serde(default)]
    vary: Table,
}

impl SweepFile {
    /// Reads the file at `path`. The sweep is called after it unless it says otherwise.
    ///
    /// # Errors
    /// An unreadable file; no TOML; an unknown key; a value that no variable can have.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let (mut file, stem) = read_file(path, Self::parse)?;
        file.case.name = file.case.name.or(stem);
        file.vary.iter_mut().for_each(|vary| vary.origin = Origin::File(path.to_owned()));
        Ok(Self { case: file.case.at(path), ..file })
    }

    /// Reads the text of a sweep file.
    ///
    /// # Errors
    /// Not TOML, an unknown key, a value that no variable can have, a control character; with the place.
    pub fn parse(text: &str) -> Result<Self, String> {
        let said = |error: toml::de::Error| toml_error(&error);
        let table: Table = toml::from_str(&with_plain_ends(text)).map_err(said)?;
        check_characters(&table)?;
        let with = |keys: &'static [&str]| move |(key, _): &(String, toml::Value)| keys.contains(&key.as_str());
        // Not by `flatten` of serde, whose errors do not name the key.
        let (sampling, rest): (Table, Table) = table.into_iter().partition(with(&[
            "design",
            "points",
            "samples",
            "confidence",
            "until_precision",
            "precision_of",
            "seed",
            "common_seeds",
            "seed_variable",
        ]));
        let (own, case): (Table, Table) = rest.into_iter().partition(with(&["record", "vary"]));
        let Layout { record, vary } = own.try_into().map_err(said)?;
        let sampling = sampling.try_into().map_err(said)?;
        Ok(Self { case: CaseFile::from_table(case)?, sampling, record, vary: Vary::all_of(&vary)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Design;

    #[test]
    fn the_example_above_is_read() {
        let source = include_str!("file.rs");
        let example: Vec<_> = source.lines().map_while(|line| line.strip_prefix("//!")).collect();
        let text = example.join("\n");
        let file = SweepFile::parse(text.split("```toml").nth(1).unwrap().split("```").next().unwrap()).unwrap();
        let Sampling {
            design,
            points,
            samples,
            confidence,
            until_precision,
            precision_of,
            seed,
            common_seeds,
            seed_variable,
        } = file.sampling;
        assert_eq!((design, points, samples, seed), (Some(Design::Lhs), Some(1000), Some(200), Some(7)));
        assert_eq!((confidence, until_precision, precision_of.as_deref()), (Some(0.9), Some(0.05), Some("impacts")));
        assert_eq!((common_seeds, seed_variable.as_deref()), (true, Some("excitation.seed")));
        assert_eq!((file.case.until, file.record), (Some(60.0), vec!["cylinder.position".to_owned()]));
        let options =
            ["membrane.restitution=0.2:0.9", "membrane.stiffness=log:1e4:1e6", "initial.outsideGap=project,free"];
        assert_eq!(file.vary, options.map(|text| Vary::parse(text).unwrap()));
        assert_eq!(file.case.settings.len(), 1);
    }

    #[test]
    fn what_a_sweep_file_cannot_say_is_an_error_that_names_it() {
        for (text, named) in [
            ("untill = 3", "untill"),
            ("points = -1", "points"),
            ("design = 'square'", "square"),
            ("samples = 1.5", "samples"),
            ("[vary]\na.b = 3", "vary.a.b"),
            ("points = ", "line 1"),
            ("record = ['y', \"y\\u001b[2J\"]", "record: the character U+001B in it"),
            ("[vary]\na.b = [\"\\u0007\"]", "vary.a.b: the character U+0007 in it"),
        ] {
            let reason = SweepFile::parse(text).unwrap_err();
            assert!(reason.contains(named), "{text}: {reason}");
        }
    }
}
