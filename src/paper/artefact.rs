//! A table or figure that was made.

use serde::{Serialize, Serializer};

use videg_report::{Column, Table};

pub use crate::artefact::{Picture, Sheet};

/// A table or figure, reproduced.
#[derive(Debug, Clone, Default)]
pub struct Artefact {
    /// Its numbers beside the paper's: rows of the summary table.
    pub findings: Vec<Finding>,
    /// Explanations, in paragraphs of plain text.
    pub text: Vec<String>,
    /// Tables for the report.
    pub tables: Vec<Table>,
    /// Pictures, each a file and a part of the report.
    pub pictures: Vec<Picture>,
    /// Data, each a CSV file.
    pub sheets: Vec<Sheet>,
}

/// One number of the paper beside ours.
#[derive(Debug, Clone, Serialize)]
pub struct Finding {
    /// Where the paper has it, e.g. `Table 2, Figure 14`.
    pub place: String,
    /// The quantity, e.g. `<U>, Eq. (15)`.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The number of the paper, if it prints one.
    pub paper: Option<f64>,
    /// The number computed here.
    pub videg: f64,
    /// How the two go together.
    pub verdict: Verdict,
    /// Why, in a few words; empty where there is nothing to explain.
    pub reason: String,
    /// videg / paper - 1, if the paper prints a number.
    pub deviation: Option<f64>,
}

impl Finding {
    /// A number that the paper does not have.
    pub(super) fn new(place: impl Into<String>, quantity: impl Into<String>, unit: &str, videg: f64) -> Self {
        let (place, quantity, unit) = (place.into(), quantity.into(), unit.to_owned());
        let (verdict, reason) = (Verdict::Beyond, String::new());
        Self { place, quantity, unit, paper: None, videg, verdict, reason, deviation: None }
    }

    /// With the number that the paper prints.
    pub(super) fn printed(self, paper: f64) -> Self {
        Self { paper: Some(paper), deviation: Some(self.videg / paper - 1.0), ..self }
    }

    /// How it goes together with what the paper prints or says in words.
    pub(super) fn judged(self, verdict: Verdict) -> Self {
        Self { verdict, ..self }
    }

    /// It agrees with the paper, or differs without a known reason.
    pub(super) fn agrees_if(self, agrees: bool) -> Self {
        self.judged(if agrees { Verdict::Agrees } else { Verdict::Differs })
    }

    /// With a reason.
    pub(super) fn reason(self, reason: impl Into<String>) -> Self {
        Self { reason: reason.into(), ..self }
    }

    /// Whether the paper says something that it can be compared with.
    pub fn is_compared(&self) -> bool {
        self.verdict != Verdict::Beyond
    }
}

/// How the paper's number and ours go together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Within what the paper's digits and method allow; where it prints no number, what it says in words holds.
    Agrees,
    /// The motion is chaotic: the paper's value lies within the middle 95 % of nearby starts.
    WithinEnsemble,
    /// The motion is chaotic: the paper's value lies among the outermost of nearby starts, or beyond.
    Tail,
    /// They differ, for a reason that is shown.
    Explained,
    /// They differ, and the reason is not known.
    Differs,
    /// The paper prints no number.
    Beyond,
}

impl Verdict {
    /// The verdict in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::WithinEnsemble => "within ensemble",
            Self::Tail => "in the tail",
            Self::Explained => "explained",
            Self::Differs => "differs",
            Self::Beyond => "beyond the paper",
        }
    }
}

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.words())
    }
}

/// A table with a column of words and columns of numbers.
pub(super) fn table<C: Into<String>>(words: impl Into<String>, numbers: impl IntoIterator<Item = C>) -> Table {
    Table::new(std::iter::once(Column::words(words)).chain(numbers.into_iter().map(Column::numbers)))
}
