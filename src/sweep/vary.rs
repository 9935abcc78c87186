//! Varied variables as a user writes them: on the command line or in a sweep file.

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::SweepError;
use crate::scenario::{Origin, dotted, value_text};

/// A variable and the values that it takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Vary {
    /// Name of the variable.
    pub name: String,
    /// Its values.
    #[serde(flatten)]
    pub spread: Spread,
    /// Where it was said.
    #[serde(skip)]
    pub origin: Origin,
}

/// Values of a variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Spread {
    /// These, each as a user writes it.
    List {
        /// At least one.
        values: Vec<String>,
    },
    /// Evenly spread ones.
    Range(Range),
}

/// Numbers from one to another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// First or smallest.
    pub from: f64,
    /// Last or largest.
    pub to: f64,
    /// How many, in a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<u64>,
    /// How they are spread.
    #[serde(default)]
    pub scale: Scale,
}

impl Range {
    /// The number a `share` of the way, 0 to 1; the ends are met exactly.
    pub fn at(&self, share: f64) -> f64 {
        let Self { from, to, .. } = *self;
        if share == 0.0 || share == 1.0 {
            return if share == 0.0 { from } else { to };
        }
        match self.scale {
            Scale::Linear => from + (to - from) * share,
            Scale::Log => from * (to / from).powf(share),
        }
    }
}

/// How numbers are spread.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// With equal differences.
    #[default]
    Linear,
    /// With equal ratios.
    Log,
}

impl Vary {
    /// The variable called `name` over these values.
    pub fn new(name: &str, spread: Spread) -> Self {
        Self { name: name.to_owned(), spread, origin: Origin::Option }
    }

    /// Reads `name=from:to`, `name=from:to:count`, either of them after `log:`, or `name=a,b,c`.
    ///
    /// # Errors
    /// If it is of none of these forms.
    pub fn parse(text: &str) -> Result<Self, SweepError> {
        const FORMS: &str = "allowed is name=from:to:count, name=from:to or name=a,b,c, with log: before from for \
                             equal ratios";
        let bad = || SweepError::option("vary", text, FORMS);
        let (name, values) = text.split_once('=').map(|(name, values)| (name.trim(), values.trim())).ok_or_else(bad)?;
        if name.is_empty() || values.is_empty() {
            return Err(bad());
        }
        let spread = if values.contains(':') { Spread::Range(range(values).ok_or_else(bad)?) } else { list(values) };
        Ok(Self { name: name.to_owned(), spread, origin: Origin::Option })
    }

    /// Reads a table of lists and of ranges `{ from, to, count, scale }`, whose names may be dotted.
    ///
    /// # Errors
    /// An entry that is neither a list nor a range, by its name.
    pub fn all_of(table: &Table) -> Result<Vec<Self>, String> {
        // Values are a list or a table: a table whose `from` is neither is a range.
        let is_range = |table: &Table| table.get("from").is_some_and(|from| !from.is_table() && !from.is_array());
        let all = dotted("", table, is_range).into_iter().map(|(name, value)| {
            let spread = spread(&name, value)?;
            Ok(Self { name, spread, origin: Origin::Option })
        });
        all.collect()
    }
}

fn range(text: &str) -> Option<Range> {
    let (scale, numbers) = text.strip_prefix("log:").map_or((Scale::Linear, text), |numbers| (Scale::Log, numbers));
    let parts: Vec<&str> = numbers.split(':').map(str::trim).collect();
    let (from, to, count) = match parts[..] {
        [from, to] => (from, to, None),
        [from, to, count] => (from, to, Some(count.parse().ok()?)),
        _ => return None,
    };
    Some(Range { from: from.parse().ok()?, to: to.parse().ok()?, count, scale })
}

fn list(text: &str) -> Spread {
    Spread::List { values: text.split(',').map(|value| value.trim().to_owned()).collect() }
}

/// Reads the values of the variable called `name`: a list or a range.
fn spread(name: &str, value: &Value) -> Result<Spread, String> {
    match value {
        Value::Table(range) => {
            let read = Range::deserialize(range.clone()).map_err(|error| format!("vary.{name}: {error}"))?;
            Ok(Spread::Range(read))
        }
        Value::Array(values) => {
            let values = values.iter().map(|value| value_text(name, value));
            Ok(Spread::List { values: values.collect::<Result<_, _>>()? })
        }
        other => {
            let kind = other.type_str();
            Err(format!("vary.{name} is of type {kind}: a list or {{ from, to, count, scale }} is expected"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(from: f64, to: f64, count: Option<u64>, scale: Scale) -> Spread {
        Spread::Range(Range { from, to, count, scale })
    }

    #[test]
    fn every_form_is_read() {
        for (text, spread) in [
            ("a.b=0.1:0.9:9", range(0.1, 0.9, Some(9), Scale::Linear)),
            ("a.b=log:1e3:1e6:4", range(1e3, 1e6, Some(4), Scale::Log)),
            ("a.b = -1:2.5", range(-1.0, 2.5, None, Scale::Linear)),
            ("a.b=x, y", Spread::List { values: vec!["x".to_owned(), "y".to_owned()] }),
            ("a.b=7", Spread::List { values: vec!["7".to_owned()] }),
        ] {
            assert_eq!(Vary::parse(text).unwrap(), Vary { name: "a.b".to_owned(), spread, origin: Origin::Option });
        }
        for text in ["", "a", "a=", "=1:2", "a=1:", "a=1:2:3:4", "a=1:2:x", "a=1:2:-3", "a=log:x:2", "a=1:2,3"] {
            let message = Vary::parse(text).unwrap_err().to_string();
            let option = format!("--vary {text}");
            let expected = format!("{}: allowed is name=from:to:count", option.trim_end());
            assert!(message.starts_with(&expected), "{message}");
        }
    }

    #[test]
    fn a_table_says_the_same_as_options() {
        let table: Table = toml::from_str(
            "z.b = { from = 0.1, to = 0.9, count = 9 }\n'a.c' = ['x', true, 2]\n\
             d = { from = 1, to = 2, scale = 'log' }",
        )
        .unwrap();
        let options = ["z.b=0.1:0.9:9", "a.c=x,true,2", "d=log:1:2"].map(|text| Vary::parse(text).unwrap());
        assert_eq!(Vary::all_of(&table).unwrap(), options);
    }

    #[test]
    fn what_a_table_cannot_say_is_an_error_that_names_it() {
        for (text, named) in [
            ("a.b = 3", "vary.a.b is of type integer"),
            ("a = { from = 1, two = 2 }", "vary.a: unknown field `two`"),
            ("a = { from = 1 }", "vary.a: missing field `to`"),
            ("a = [[1]]", "a is of type array"),
        ] {
            let reason = Vary::all_of(&toml::from_str(text).unwrap()).unwrap_err();
            assert!(reason.contains(named), "{text}: {reason}");
        }
    }
}
