//! Seeds of the samples: other noise in each run, the same on any core, shard or machine.

use super::{Sampling, SweepError};
use fmu_import::{Kind, ModelDescription, Value, Variable};

/// The variable that takes the seed of the harvester's phase noise, and its intensity.
pub const SEED_VARIABLE: &str = "excitation.seed";
const NOISE: &str = "excitation.phaseNoise";

/// Runs that have seeds of their own.
pub(super) const MOST: u64 = 1 << 32;

/// Which seed a run gets.
pub(super) struct Seeds {
    /// The variable.
    pub variable: Variable,
    /// Seed of the first run.
    pub first: u64,
    /// Runs of each point.
    pub samples: u64,
    /// Sample i has the same seed in all points.
    pub common: bool,
}

impl Seeds {
    /// Seeds, if there are several samples, if the variable is named, or if there is noise whose seed nobody set. `given`
    /// are the variables that have a value of the user's, and that value unless it is varied.
    pub fn new(
        description: &ModelDescription,
        sampling: &Sampling,
        given: &[(&str, Option<&Value>)],
    ) -> Result<Option<Self>, SweepError> {
        let (asked, samples) = (sampling.seed_variable.as_deref(), sampling.samples());
        let name = asked.unwrap_or(SEED_VARIABLE);
        let is_noisy = given.iter().any(|(given, value)| *given == NOISE && *value != Some(&Value::Real(0.0)));
        let must = samples > 1 || asked.is_some();
        let given = given.iter().find(|(given, _)| *given == name);
        if !must && (given.is_some() || !is_noisy) {
            return Ok(None);
        }
        if let Some((_, value)) = given {
            let option = if value.is_some() { "set" } else { "vary" };
            let reason = "the samples give it a value of their own: choose the first by --seed";
            return Err(SweepError::option(option, name, reason));
        }
        let variable = match description.variable(name) {
            Ok(variable) if matches!(variable.kind, Kind::Integer { .. }) && variable.is_settable() => variable.clone(),
            Ok(variable) => {
                let reason = format!("a seed is an Integer that can be set; this is a {}", variable.kind.name());
                return Err(SweepError::option("seed-variable", name, reason));
            }
            Err(_) if asked.is_none() => {
                let reason = format!("{} has no {name}; name its seed by --seed-variable", description.model_name);
                return Err(SweepError::option("samples", samples.to_string(), reason));
            }
            Err(error) => return Err(SweepError::option("seed-variable", name, error.to_string())),
        };
        Ok(Some(Self { variable, first: sampling.seed(), samples, common: sampling.common_seeds }))
    }

    /// Seed of sample `sample` of point `point`: the first one and the number of the run, or of the sample if they are
    /// common to all points, in 32 bits.
    pub fn of(&self, point: u64, sample: u64) -> i32 {
        let offset = if self.common { sample } else { point.wrapping_mul(self.samples).wrapping_add(sample) };
        #[allow(clippy::cast_possible_truncation)] // the last 32 bits are meant
        let seed = self.first.wrapping_add(offset) as u32;
        seed.cast_signed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seeds(samples: u64, variable: Option<&str>, given: &[(&str, Option<&Value>)]) -> Result<Option<Seeds>, String> {
        let seed_variable = variable.map(str::to_owned);
        let sampling = Sampling { samples: Some(samples), seed: Some(7), seed_variable, ..Sampling::default() };
        let description = crate::sweep::harvester_description().unwrap();
        Seeds::new(&description, &sampling, given).map_err(|error| error.to_string())
    }

    #[test]
    fn every_run_has_a_seed_of_its_own_and_common_ones_repeat_in_each_point() {
        let mut own = seeds(3, None, &[]).unwrap().unwrap();
        let all = |seeds: &Seeds| -> Vec<i32> {
            (0..4).flat_map(|point| [0, 1, 2].map(|sample| seeds.of(point, sample))).collect()
        };
        assert_eq!(all(&own), (7..19).collect::<Vec<_>>());
        own.common = true;
        assert_eq!(all(&own), [7, 8, 9].repeat(4));
        own.first = u64::from(u32::MAX) - 1;
        assert_eq!([0, 1, 2].map(|sample| own.of(0, sample)), [-2, -1, 0]);
    }

    #[test]
    fn seeds_are_given_where_they_matter_and_nobody_else_gives_them() {
        let (zero, half) = (Value::Real(0.0), Value::Real(0.5));
        for (samples, given, expected) in [
            (1, &[][..], false),
            (2, &[], true),
            (1, &[(NOISE, Some(&zero))], false),
            (1, &[(NOISE, Some(&half))], true),
            (1, &[(NOISE, None)], true),
            (1, &[(NOISE, Some(&half)), (SEED_VARIABLE, None)], false),
        ] {
            assert_eq!(seeds(samples, None, given).unwrap().is_some(), expected, "{samples} {given:?}");
        }
        let message = seeds(2, None, &[(SEED_VARIABLE, None)]).err().unwrap();
        assert!(message.starts_with("--vary excitation.seed: the samples give it a value of their own"), "{message}");
        let message = seeds(1, Some("ball.mass"), &[]).err().unwrap();
        assert!(message.starts_with("--seed-variable ball.mass: a seed is an Integer"), "{message}");
    }
}
