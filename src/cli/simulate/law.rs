//! `--law` of `videg simulate`.

use clap::ValueEnum;

use crate::cli::options::RunOptions;
use crate::scenario::{Scenario, Setting};

/// The variable that the option sets.
const VARIABLE: &str = "contact.law";

/// Laws to choose from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Law {
    /// An impact takes no time, Eqs. (10) and (11)
    Impulsive,
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

    /// Whether `value` of `contact.law`, a name or a number, means this law.
    fn is(self, value: &str) -> bool {
        match self {
            Self::Impulsive => ["impulsive", "1"].contains(&value),
            Self::Compliant => ["compliant", "2"].contains(&value),
            Self::Both => false,
        }
    }
}

/// The scenario of the options under `law`; with both laws, their common part.
///
/// # Errors
/// Whatever in the options makes no sense, or settings that ask for another law.
pub fn scenario(law: Option<Law>, options: &RunOptions) -> anyhow::Result<Scenario> {
    let scenario = options.scenario()?;
    let Some(law) = law else { return Ok(scenario) };
    match scenario.settings.iter().rfind(|setting| setting.name == VARIABLE) {
        Some(set) if !law.is(&set.value) => {
            let (name, place, value) = (law.name(), set.place(), &set.value);
            anyhow::bail!("--law {name}: {place} = {value} says otherwise; leave one of the two out")
        }
        None if law != Law::Both => Ok(options.scenario_with(vec![law.setting()])?),
        _ => Ok(scenario),
    }
}
