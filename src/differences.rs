//! Differences of two runs or sweeps in words: each setting as a user types it, with its value in either.

use serde_json::{Map, Value};
use sha2::{Digest as _, Sha256};

/// Longest value that is shown, characters, and most settings: advice follows them, and a message has at most some 2000
/// characters.
const LONGEST: usize = 80;
const MOST: usize = 8;

/// A setting that differs, as a user types it, with its values in the one document and in the other.
type Difference = [String; 3];

/// The differences of two documents of runs or sweeps, each in the words of `said`.
pub fn told(there: &str, here: &str, said: impl Fn(&Difference) -> String) -> String {
    let found = differences(there, here);
    let shown = found.iter().take(MOST).map(said);
    let more = found.len().checked_sub(MOST).filter(|more| *more > 0).map(|more| format!("and {more} more"));
    shown.chain(more).collect::<Vec<_>>().join("; ")
}

/// A short name of `text`, which no other text has: hexadecimal digits.
pub fn digest(text: &str) -> String {
    let number = Sha256::digest(text).iter().take(4).fold(0_u32, |number, byte| number << 8 | u32::from(*byte));
    format!("{number:08x}")
}

/// The differences of two documents of sweeps.
fn differences(there: &str, here: &str) -> Vec<Difference> {
    /// They follow from the other keys, except a number of points that was given, and the recorded variables.
    const DERIVED: [&str; 4] = ["columns", "points", "runs", "sha256"];
    let read = |text| serde_json::from_str::<Map<String, Value>>(text).ok();
    let (Some(there), Some(here)) = (read(there), read(here)) else {
        let [there, here] = ["no document of a sweep", "one"].map(str::to_owned);
        return vec![["sweep.json".to_owned(), there, here]];
    };
    let keys = there.keys().chain(here.keys().filter(|key| !there.contains_key(*key)));
    let differ = keys.filter(|key| there.get(*key) != here.get(*key));
    let (derived, differ): (Vec<&String>, Vec<_>) = differ.partition(|key| DERIVED.contains(&key.as_str()));
    let of = |key: &&String| of_key(key, there.get(*key), here.get(*key));
    let mut found: Vec<_> = differ.iter().flat_map(of).collect();
    if found.is_empty() {
        found = derived.iter().filter(|key| **key != "sha256").flat_map(of).collect();
    }
    found
}

/// The differences between the values of a key.
fn of_key(key: &str, there: Option<&Value>, here: Option<&Value>) -> Vec<Difference> {
    let what = typed(key);
    if let (Some(Value::Array(there)), Some(Value::Array(here))) = (there, here)
        && there.iter().chain(here).all(|item| item.get("name").is_some())
    {
        let found = of_named(&what, there, here);
        if !found.is_empty() {
            return found;
        }
    }
    vec![[what, shown(there), shown(here)]]
}

/// The differences between lists of things with names.
fn of_named(what: &str, there: &[Value], here: &[Value]) -> Vec<Difference> {
    let is_in = |list: &[Value], item: &Value| list.iter().any(|other| other.get("name") == item.get("name"));
    let names = there.iter().chain(here.iter().filter(|item| !is_in(there, item)));
    let found = |list: &'_ [Value], name: &Value| list.iter().find(|item| item.get("name") == Some(name)).cloned();
    let differences = names.filter_map(|item| {
        let name = item.get("name")?;
        let (there, here) = (found(there, name), found(here, name));
        let what = format!("{what} {}", shown(Some(name)));
        (there != here).then(|| [what, shown(there.as_ref()), shown(here.as_ref())])
    });
    differences.collect()
}

/// A key of the document as a user knows it.
fn typed(key: &str) -> String {
    match key {
        "settings" => "--set".to_owned(),
        "videg" => "the version of videg".to_owned(),
        "verb" | "case" | "cases" | "model" | "isolation" => format!("the {key}"),
        "guid" => "the GUID of the model".to_owned(),
        "fmu" => "the SHA-256 of the FMU".to_owned(),
        "columns" => "the column".to_owned(),
        "runs" => "the number of runs".to_owned(),
        "items" => "the items".to_owned(),
        option => format!("--{}", option.replace('_', "-")),
    }
}

/// A value as a user types it, in few words.
fn shown(value: Option<&Value>) -> String {
    let list = |items: &[Value]| items.iter().map(name_or_value).collect::<Vec<_>>().join(",");
    let text = match value {
        None | Some(Value::Null) => "not given".to_owned(),
        Some(Value::Array(items)) => list(items),
        Some(Value::Object(fields)) => of_object(fields),
        Some(other) => plain(other),
    };
    if text.chars().count() <= LONGEST { text } else { text.chars().take(LONGEST).chain("...".chars()).collect() }
}

/// Of what is varied the spread, of a setting its value, of a column its type, of anything else its fields.
fn of_object(fields: &Map<String, Value>) -> String {
    if let Some(values) = ["values", "value", "type"].iter().find_map(|key| fields.get(*key)) {
        return shown(Some(values));
    }
    if let (Some(from), Some(to)) = (fields.get("from"), fields.get("to")) {
        let log = if fields.get("scale").is_some_and(|scale| scale == "log") { "log:" } else { "" };
        let count = fields.get("count").map(|count| format!(":{count}")).unwrap_or_default();
        return format!("{log}{}:{}{count}", plain(from), plain(to));
    }
    let limit = |(key, value): (&String, &Value)| match value {
        Value::Null => format!("any {key}"),
        value => format!("{key} {}", plain(value)),
    };
    fields.iter().filter(|(key, _)| *key != "name").map(limit).collect::<Vec<_>>().join(" and ")
}

fn name_or_value(item: &Value) -> String {
    plain(item.get("name").unwrap_or(item))
}

/// A text as it is, a whole number without a point.
fn plain(value: &Value) -> String {
    let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    if value.is_f64() { text.trim_end_matches(".0").to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_named_as_they_are_typed_with_both_values() {
        for (there, here, expected) in [
            (r#"{"seed": 1, "runs": 2}"#, r#"{"seed": 1, "runs": 3}"#, "the number of runs was 2, is 3"),
            (r#"{"window": [1.0, 2.0]}"#, r#"{"window": [1.0, 3.5]}"#, "--window was 1,2, is 1,3.5"),
            (r#"{"step": null}"#, r#"{"step": 0.001}"#, "--step was not given, is 0.001"),
            (
                r#"{"settings": [{"name": "a", "value": "1"}, {"name": "b", "value": "2"}]}"#,
                r#"{"settings": [{"name": "b", "value": "3"}]}"#,
                "--set a was 1, is not given; --set b was 2, is 3",
            ),
            (
                r#"{"vary": [{"name": "a", "from": 0.2, "to": 0.9, "count": 8, "scale": "linear"}], "runs": 8}"#,
                r#"{"vary": [{"name": "a", "from": 1.0, "to": 10.0, "scale": "log"}], "runs": 9}"#,
                "--vary a was 0.2:0.9:8, is log:1:10",
            ),
            (
                r#"{"vary": [{"name": "a", "values": ["x", "y"]}]}"#,
                r#"{"vary": [{"name": "a", "values": ["x"]}]}"#,
                "--vary a was x,y, is x",
            ),
            (
                r#"{"vary": [{"name": "a", "values": ["x"]}, {"name": "b", "values": ["y"]}]}"#,
                r#"{"vary": [{"name": "b", "values": ["y"]}, {"name": "a", "values": ["x"]}]}"#,
                "--vary was a,b, is b,a",
            ),
            (
                r#"{"columns": [{"name": "y", "type": "real", "optional": true}]}"#,
                r#"{"columns": []}"#,
                "the column y was real, is not given",
            ),
            (
                r#"{"isolation": {"time_limit_s": 60.0}}"#,
                r#"{"isolation": {"time_limit_s": null}}"#,
                "the isolation was time_limit_s 60, is any time_limit_s",
            ),
            ("{", "{}", "sweep.json was no document of a sweep, is one"),
        ] {
            assert_eq!(told(there, here, |[what, was, is]| format!("{what} was {was}, is {is}")), expected);
        }
    }

    #[test]
    fn however_much_differs_there_is_room_for_what_to_do() {
        let settings = |value: &str| {
            let one = |k: usize| format!("{{\"name\": \"p{k}\", \"value\": \"{}\"}}", value.repeat(1000));
            format!("{{\"settings\": [{}]}}", (0..100).map(one).collect::<Vec<_>>().join(","))
        };
        let said = told(&settings("1"), &settings("2"), |[what, there, here]| format!("{what} is {here}, not {there}"));
        assert!(said.starts_with("--set p0 is 2222") && said.ends_with("; and 92 more") && said.len() < 1700, "{said}");
    }
}
