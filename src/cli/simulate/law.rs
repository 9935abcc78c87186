//! `--law` of `videg simulate`.

use clap::ValueEnum;

use crate::cli::options::RunOptions;
use crate::scenario::{Scenario, Setting};

/// The variable that the option sets.
const VARIABLE: &str = "contact.law";

/// Laws to choose from. The number is that of the item of `contact.law`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Law {
    /// An impact takes no time, Eqs. (10) and (11)
    Impulsive = 1,
    /// The membrane is a nonlinear spring with losses
    Compliant,
    /// Both laws, side by side
    Both,
}

impl Law {
    /// Name of the item of `contact.law`, and of the option.
    pub fn name(self) -> &'static str {
        match self {
            Self::Impulsive => "impulsive",
            Self::Compliant => "compliant",
            Self::Both => "both",
        }
    }

    /// The setting that chooses the law.
    pub fn setting(self) -> Setting {
        Setting::new(VARIABLE, self.name())
    }
}

/// The scenario of the options under `law`, whatever the law of the case; with both laws, their common part. Settings that ask
/// for another law are an error.
pub fn scenario(law: Option<Law>, options: &RunOptions) -> anyhow::Result<Scenario> {
    let scenario = options.scenario()?;
    let Some(law) = law else { return Ok(scenario) };
    let is_law = |value: &str| law != Law::Both && (value == law.name() || value == (law as u8).to_string());
    match scenario.changes().iter().rfind(|setting| setting.name == VARIABLE) {
        Some(set) if !is_law(&set.value) => {
            let (name, place, value) = (law.name(), set.place(), &set.value);
            anyhow::bail!("--law {name}: {place} = {value} says otherwise; leave one of the two out")
        }
        None if law != Law::Both => Ok(options.scenario_with(vec![law.setting()])?),
        _ => Ok(scenario),
    }
}
