//! The document `sweep.json`: everything that decides the results of a sweep. Once the results are complete their checksums
//! follow it (`sums.rs`).

use std::collections::BTreeMap;
use std::path::Path;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use super::cases;
use super::column::Column;
use super::order::{Order, Rule};
use super::times::Times;
use super::{Design, Scale, Shard, SweepError, Vary};
use crate::scenario::Setting;
use crate::statistics::CONFIDENCE;
use fmu_import::Bounds;

/// Name of the document in a folder of results.
pub(super) const DOCUMENT: &str = "sweep.json";

/// The document `sweep.json`: the same bytes for the same sweep.
#[derive(Serialize)]
pub(super) struct Document<'a> {
    pub videg: &'static str,
    pub case: &'a str,
    pub model: &'a str,
    pub guid: &'a str,
    /// SHA-256 of the archive, if the model is not the harvester of this project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fmu: Option<&'a str>,
    /// Limits of a run, if each has a process of its own: whether it fails depends on them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub isolation: Option<Limits>,
    pub settings: Vec<Setting>,
    /// What the cases of the axis `case` set besides.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<cases::Documented<'a>>,
    #[serde(flatten)]
    pub times: Times,
    pub design: Design,
    pub vary: &'a [Vary],
    pub points: u64,
    pub samples: u64,
    pub runs: u64,
    pub seed: u64,
    pub common_seeds: bool,
    pub seed_variable: Option<&'a str>,
    /// Probability of the intervals of the statistics, unless it is that of [`CONFIDENCE`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Half the interval of a mean over the mean, at most, and the column of that mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until_precision: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision_of: Option<&'a str>,
    pub columns: &'a [Column],
    /// SHA-256 of the above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// Limits of an isolated FMU in the document; none: unlimited.
#[derive(Serialize)]
pub(super) struct Limits {
    time_limit_s: Option<f64>,
    memory_limit_bytes: Option<u64>,
}

impl From<Bounds> for Limits {
    fn from(bounds: Bounds) -> Self {
        Self { time_limit_s: bounds.time.map(|time| time.as_secs_f64()), memory_limit_bytes: bounds.memory }
    }
}

/// The part of the document that a merge and the statistics need.
#[derive(Debug, Deserialize)]
pub(super) struct Kept {
    pub videg: String,
    pub fmu: Option<String>,
    pub vary: Vec<Varied>,
    pub points: u64,
    pub samples: u64,
    pub until_precision: Option<f64>,
    pub precision_of: Option<String>,
    #[serde(default = "usual_confidence")]
    pub confidence: f64,
    pub columns: Vec<Column>,
}

/// A varied variable in the document.
#[derive(Debug, Deserialize)]
pub(super) struct Varied {
    pub name: String,
    /// How many values a grid has, if they are evenly spread.
    pub count: Option<u64>,
    #[serde(default)]
    pub scale: Scale,
}

fn usual_confidence() -> f64 {
    CONFIDENCE
}

impl Kept {
    /// Reads the `document` of the sweep in `folder`.
    pub fn read(document: &str, folder: &Path) -> Result<Self, SweepError> {
        let refuse = |error: serde_json::Error| SweepError::content(&folder.join(DOCUMENT), error.to_string());
        serde_json::from_str(document).map_err(refuse)
    }

    /// The runs of `shard`, or of the whole.
    pub fn order(&self, shard: Option<Shard>) -> Order {
        let precision = self.precision_of.as_deref().zip(self.until_precision);
        let rule = precision
            .and_then(|(of, precision)| Rule::new(&self.columns, of, precision, self.confidence, self.samples));
        Order::new(self.points, self.samples, rule, shard)
    }
}

impl Document<'_> {
    /// The text of the file: the document with its fingerprint.
    pub fn sealed(mut self) -> String {
        self.sha256 = Some(sha256(self.json()));
        self.json() + "\n"
    }

    fn json(&self) -> String {
        // Numbers, texts and lists of them: nothing that JSON cannot say.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

/// Key of the checksums in the file.
const RESULTS: &str = "results";

/// Length and checksum of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Sum {
    pub bytes: u64,
    pub sha256: String,
}

/// By the names of the files.
pub(super) type Sums = BTreeMap<String, Sum>;

/// JSON whose keys keep their order.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Ordered {
    Object(IndexMap<String, Ordered>),
    List(Vec<Ordered>),
    Leaf(Value),
}

type Object = IndexMap<String, Ordered>;

fn written(document: &Object) -> serde_json::Result<String> {
    serde_json::to_string_pretty(document).map(|text| text + "\n")
}

/// The document in `text` without checksums: only what decides the results. Other texts stay as they are.
pub(super) fn identity(text: &str) -> String {
    let without = || {
        let mut document: Object = serde_json::from_str(text).ok()?;
        document.shift_remove(RESULTS)?;
        written(&document).ok()
    };
    without().unwrap_or_else(|| text.to_owned())
}

/// The document in `text` with these checksums at its end.
pub(super) fn with_sums(text: &str, sums: &Sums) -> serde_json::Result<String> {
    let mut document: Object = serde_json::from_str(text)?;
    document.shift_remove(RESULTS);
    document.insert(RESULTS.to_owned(), serde_json::from_value(serde_json::to_value(sums)?)?);
    written(&document)
}

/// The checksums in `text`.
pub(super) fn sums(text: &str) -> serde_json::Result<Sums> {
    #[derive(Deserialize)]
    struct Kept {
        #[serde(default)]
        results: Sums,
    }
    serde_json::from_str::<Kept>(text).map(|kept| kept.results)
}

/// SHA-256 of `content`, in hexadecimal digits.
pub(super) fn sha256(content: impl AsRef<[u8]>) -> String {
    hexadecimal(&Sha256::digest(content))
}

/// Two digits for each of `bytes`.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    let digits = bytes.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    digits.filter_map(|digit| char::from_digit(digit.into(), 16)).collect()
}
