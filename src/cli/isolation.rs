//! Which FMUs run in processes of their own, with which limits.

use std::path::Path;
use std::time::Duration;

use anyhow::ensure;
use clap::Args;

use super::{output, packaging};
use crate::package;
use fmu_import::{Bounds, Fmu, Isolation};

/// Shortest and longest time limit, s.
const SHORTEST: f64 = 1e-3;
const LONGEST: f64 = 1e9;

/// How FMUs are run.
#[derive(Args, Default)]
pub struct IsolationOptions {
    /// Run each instance of an FMU in its own process, so that a crash ends only that process [default: for FMUs that are not
    /// of this project]
    #[arg(long, conflicts_with = "no_isolate")]
    isolate: bool,
    /// Run the FMU in this process: faster, for FMUs that you trust
    #[arg(long)]
    no_isolate: bool,
    /// Longest duration of a call of an isolated FMU, s; 0: no limit [default: 60]
    #[arg(long, value_name = "S", value_parser = parse_time, allow_negative_numbers = true, conflicts_with = "no_isolate")]
    time_limit: Option<f64>,
    /// Largest address space of the process of an isolated FMU, MiB; 0: no limit. Not on macOS and Windows [default: 4096]
    #[arg(long, value_name = "MIB", conflicts_with = "no_isolate")]
    memory_limit: Option<u32>,
}

fn parse_time(text: &str) -> Result<f64, String> {
    let time = text.trim().parse().ok().filter(|time| *time == 0.0 || (SHORTEST..=LONGEST).contains(time));
    time.ok_or_else(|| format!("0 or a time from {SHORTEST:e} to {LONGEST:e} s is expected"))
}

impl IsolationOptions {
    /// Opens an FMU of the user.
    pub fn open(&self, path: &Path) -> anyhow::Result<Fmu> {
        if self.no_isolate {
            return Ok(Fmu::open(path)?);
        }
        let is_trusted = |identifier: &str, library: &Path| !self.isolate && package::is_own(identifier, library);
        let fmu = Fmu::open_isolated_unless(path, &self.isolation()?, is_trusted)?;
        if let Some(limit) = self.limit().filter(|_| !fmu.is_isolated()) {
            let path = path.display();
            // Not an error: the same limits may be given for many FMUs.
            output::warn(&[format!(
                "{limit} does not bind {path}: it is one of videg's, which run in its own process; add --isolate"
            )]);
        }
        Ok(fmu)
    }

    /// Packages the FMUs of this project, with progress, and opens the one with this identifier.
    pub fn open_own(&self, identifier: &str) -> anyhow::Result<Fmu> {
        self.check_own()?;
        self.open_beside(identifier)
    }

    /// The same beside an FMU of the user, which limits bind.
    pub fn open_beside(&self, identifier: &str) -> anyhow::Result<Fmu> {
        let path = packaging::path(identifier)?;
        if self.isolate { Ok(Fmu::open_isolated(path, &self.isolation()?)?) } else { Ok(Fmu::open(path)?) }
    }

    /// Checks that no limit was given that would have no effect on the FMUs of this project.
    pub fn check_own(&self) -> anyhow::Result<()> {
        let limit = self.limit().filter(|_| !self.isolate).unwrap_or_default();
        ensure!(
            limit.is_empty(),
            "{limit} needs --isolate here: the FMUs of videg run in its own process, which it would not bind"
        );
        Ok(())
    }

    /// Whether the FMUs of this project run in processes of their own, too.
    pub fn is_forced(&self) -> bool {
        self.isolate
    }

    /// A limit that was given, by its option.
    fn limit(&self) -> Option<&'static str> {
        let time = self.time_limit.map(|_| "--time-limit");
        time.or(self.memory_limit.map(|_| "--memory-limit"))
    }

    fn isolation(&self) -> anyhow::Result<Isolation> {
        if cfg!(any(windows, target_vendor = "apple")) && self.memory_limit.is_some_and(|mib| mib > 0) {
            // Not an error: on Linux the same script has the limit.
            output::warn(&["--memory-limit binds nothing on this system".to_owned()]);
        }
        Ok(Isolation { program: packaging::program()?, bounds: self.bounds() })
    }

    /// Limits of the FMU of the user, or of those of this project if there is none; none if it is not isolated.
    pub fn bounds_of(&self, fmu: Option<&Fmu>) -> Option<Bounds> {
        fmu.map_or(self.isolate, Fmu::is_isolated).then(|| self.bounds())
    }

    fn bounds(&self) -> Bounds {
        let Bounds { time, memory } = Bounds::default();
        Bounds {
            time: self.time_limit.map_or(time, |s| (s > 0.0).then(|| Duration::from_secs_f64(s))),
            memory: self.memory_limit.map_or(memory, |mib| (mib > 0).then(|| u64::from(mib) << 20)),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[derive(clap::Parser)]
    struct Alone {
        #[command(flatten)]
        _options: IsolationOptions,
    }

    #[test]
    fn the_defaults_are_those_that_help_shows() {
        let Bounds { time, memory } = IsolationOptions::default().bounds();
        let help = Alone::command().render_long_help().to_string();
        for shown in [time.unwrap().as_secs(), memory.unwrap() >> 20] {
            assert!(help.contains(&format!("[default: {shown}]")), "{shown}: {help}");
        }
    }

    #[test]
    fn bounds_on_what_is_not_isolated_are_refused() {
        let options = IsolationOptions { time_limit: Some(1.0), ..IsolationOptions::default() };
        let error = options.open_own("VibroImpactHarvester").err().unwrap().to_string();
        assert!(error.starts_with("--time-limit needs --isolate here"), "{error}");
    }
}
