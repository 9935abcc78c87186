//! The folder with the results of a run. Its name follows from verb, case and settings, and it holds the results of no other run:
//! `result.json` says of which. The files get their names together; a run that ends early leaves none.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::{Args, ValueEnum};
use serde::Serialize;
use serde_json::{Map, Value};

use super::interruption::Interruption;
use super::output;
use crate::differences::told;
use crate::scenario::Scenario;
use videg_system::atomic_file::Batch;
use videg_system::folders;

/// The file that says which run the results are of, and the key in it that says so.
pub const RESULT: &str = "result.json";
const KEY: &str = "request";

/// Where results go.
#[derive(Args)]
pub struct OutputOptions {
    /// Folder for the results [default: out/VERB-CASE and the settings]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the results of another run in the folder
    #[arg(long)]
    fresh: bool,
}

/// All that decides the results of a run, as `request` in its JSON.
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub struct Identity {
    fields: Map<String, Value>,
    /// What differs from the plain run of the case.
    #[serde(skip)]
    distinct: Vec<(String, String)>,
    /// The name of the folder without that.
    #[serde(skip)]
    name: String,
}

impl Identity {
    /// A run of `verb` with these `options`: names, and values if they are not the defaults.
    pub fn new(verb: &str, options: impl IntoIterator<Item = (&'static str, Option<String>)>) -> Self {
        let given = options.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
        let distinct: Vec<_> = given.collect();
        let mut fields = Map::from_iter([("verb".to_owned(), verb.into())]);
        fields.extend(distinct.iter().map(|(name, value)| (name.clone(), Value::from(value.as_str()))));
        Self { fields, distinct, name: verb.to_owned() }
    }

    /// The same on a `scenario`.
    pub fn of(
        verb: &str,
        scenario: &Scenario,
        options: impl IntoIterator<Item = (&'static str, Option<String>)>,
    ) -> anyhow::Result<Self> {
        let mut identity = Self::new(verb, options);
        let Scenario { name, until, step, window, effective, .. } = scenario;
        let own = serde_json::json!({
            "case": name, "until": until, "step": step, "window": window, "settings": effective,
        });
        identity.fields.extend(serde_json::from_value::<Map<_, _>>(own)?);
        identity.distinct = [scenario.distinct.clone(), identity.distinct].concat();
        identity.name = format!("{verb}-{}", output::safe(name));
        Ok(identity)
    }

    /// The path of the results in `out/`, unless the user gives another.
    pub fn path(&self) -> PathBuf {
        Path::new("out").join(self.file_name())
    }

    /// Names and values as they are where a file system can take them; otherwise with their digest, so that no two are the same.
    fn file_name(&self) -> String {
        /// Longest name, bytes: file systems allow 255, and endings follow.
        const LONGEST: usize = 120;
        let typed = self.distinct.iter().map(|(name, value)| match value.as_str() {
            "true" => format!("-{name}"),
            value => format!("-{name}={value}"),
        });
        let typed: Vec<_> = typed.collect();
        let whole = self.name.clone() + &typed.concat();
        let is_bare = |c: char| c.is_ascii_alphanumeric() || "._-=,+".contains(c);
        if typed.concat().chars().all(is_bare) && whole.len() <= LONGEST {
            return whole;
        }
        let bare: String = whole.chars().map(|c| if is_bare(c) || c.is_alphanumeric() { c } else { '_' }).collect();
        let digest = crate::differences::digest(&whole);
        let end = (0..=LONGEST - digest.len()).rev().find(|end| bare.is_char_boundary(*end)).unwrap_or_default();
        format!("{}-{digest}", &bare[..end.min(bare.len())])
    }
}

/// The value of an option that is not its default.
pub fn chosen<T: ValueEnum + PartialEq>(value: &T, default: &T) -> Option<String> {
    value.to_possible_value().filter(|_| value != default).map(|value| value.get_name().to_owned())
}

/// The values of an option that may have several.
pub fn listed(values: &[String]) -> Option<String> {
    (!values.is_empty()).then(|| values.join(","))
}

/// A flag that is given.
pub fn flag(is_given: bool) -> Option<String> {
    is_given.then(|| "true".to_owned())
}

/// The folder of a run that is going on.
#[must_use]
pub struct Results<'a> {
    pub folder: PathBuf,
    pub identity: Identity,
    interruption: &'a Interruption,
    batch: Batch,
    /// Files of another run, to be replaced.
    stale: Vec<PathBuf>,
}

impl<'a> Results<'a> {
    /// Takes the folder for the run of `identity`. It may hold results of the same run; of another one with `--fresh`.
    pub fn claim(options: &OutputOptions, identity: Identity, interruption: &'a Interruption) -> anyhow::Result<Self> {
        let folder = options.folder(&identity)?;
        let stale = if options.fresh { files(&folder) } else { Vec::new() };
        interruption.tell("nothing of this run is left");
        Ok(Self { batch: Batch::begin(&folder), folder, identity, interruption, stale })
    }

    /// Writes the `result`, with which the results are complete.
    pub fn complete(self, result: &str) -> anyhow::Result<()> {
        let path = self.folder.join(RESULT);
        output::write(&path, result)?;
        let written = self.batch.commit();
        written.with_context(|| format!("cannot give the files in {} their names", self.folder.display()))?;
        self.interruption.tell(&format!("the results are complete in {}", self.folder.display()));
        let there = files(&self.folder);
        for file in self.stale.iter().filter(|file| !there.contains(file)) {
            // Results of a run that the user does not want any more.
            let _ = std::fs::remove_file(file);
        }
        Ok(())
    }
}

impl OutputOptions {
    /// Makes the folder for the run of `identity`, if no results of another run are in it, or if they may go.
    pub fn folder(&self, identity: &Identity) -> anyhow::Result<PathBuf> {
        let folder = self.output.clone().unwrap_or_else(|| identity.path());
        if !self.fresh {
            check(&folder, identity)?;
        }
        folders::make(&folder).with_context(|| format!("cannot make the output folder {}", folder.display()))?;
        Ok(folder)
    }
}

/// Checks that the folder holds the results of this run or of none.
fn check(folder: &Path, identity: &Identity) -> anyhow::Result<()> {
    let Some(there) = read(folder) else { return Ok(()) };
    let path = folder.join(RESULT);
    let path = path.display();
    let way_out = "type the command with another --output to keep both, or with --fresh to replace what is there";
    let Some(there) = there.get(KEY) else { anyhow::bail!("{path}: it does not say which run it is of; {way_out}") };
    // Read back, as the other: a number may lose its last bit there.
    let here: Value = serde_json::from_str(&serde_json::to_string(identity)?)?;
    if *there == here {
        return Ok(());
    }
    let differences =
        told(&there.to_string(), &here.to_string(), |[what, was, is]| format!("{what} was {was}, is {is}"));
    anyhow::bail!("{path}: it belongs to another run: {differences}; {way_out}")
}

/// The result in the folder, if there is one.
fn read(folder: &Path) -> Option<Value> {
    let text = videg_input::read_text(&folder.join(RESULT)).ok()?;
    Some(serde_json::from_str(&text).unwrap_or_default())
}

/// The files that belong to the result in the folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let result = read(folder).unwrap_or_default();
    let names = result.get("files").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    // Those in the folder itself; the user may stand elsewhere now.
    let files = names.filter_map(|name| Some(folder.join(Path::new(name).file_name()?)));
    files.filter(|file| file.is_file()).collect()
}
