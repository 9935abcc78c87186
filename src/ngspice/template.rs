//! Netlist templates and what may be put into them: numbers, and netlists made the same way. A string has no way in.

use super::NgspiceError;

/// A netlist, or a fragment of one, as it was rendered from a template. There is no other way to make one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Netlist(String);

impl Netlist {
    /// The text.
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// What a placeholder stands for.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// A number.
    Number(f64),
    /// A fragment.
    Fragment(Netlist),
    /// A file that the harness names.
    File(FileName),
    /// Vectors that the harness names.
    Vectors(&'static [&'static str]),
}

/// The files of a run, in its folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileName {
    /// The netlist.
    Netlist,
    /// The table of capacitances.
    Table,
    /// The result.
    Raw,
}

impl FileName {
    /// The name, without a folder.
    pub fn name(self) -> &'static str {
        match self {
            Self::Netlist => "harvesting.cir",
            Self::Table => "capacitance.tab",
            Self::Raw => "harvesting.raw",
        }
    }
}

/// A number as ngspice reads it: digits and an exponent, no suffix letter.
///
/// # Errors
/// A number that is not finite.
pub(super) fn number(name: &str, value: f64) -> Result<String, NgspiceError> {
    if value.is_finite() {
        Ok(format!("{value:e}"))
    } else {
        Err(NgspiceError::Value { name: name.to_owned(), value: value.to_string(), bound: "must be a finite number" })
    }
}

/// A template: a netlist with placeholders `<name>` of small letters and underscores.
#[derive(Debug, Clone, Copy)]
pub(super) struct Template {
    /// File name, for messages.
    pub name: &'static str,
    /// The text.
    pub text: &'static str,
}

/// A template from the folder `ngspice_netlists`.
macro_rules! template {
    ($name:literal) => {
        $crate::ngspice::template::Template {
            name: $name,
            text: include_str!(concat!("../../ngspice_netlists/", $name)),
        }
    };
}
pub(super) use template;

impl Template {
    /// Puts `values` in.
    ///
    /// # Errors
    /// A number that is not finite; a vector or fragment that is none; a placeholder without a value.
    pub fn render(&self, values: &Values) -> Result<Netlist, NgspiceError> {
        let mut rendered = String::with_capacity(2 * self.text.len());
        let mut rest = self.text;
        while let Some((before, after)) = rest.split_once('<') {
            let Some((name, behind)) = after.split_once('>') else {
                return Err(self.fail(format!("the placeholder at \"<{}\" has no end", first_line(after))));
            };
            rendered.push_str(before);
            rendered.push_str(&values.text(name).ok_or_else(|| self.fail(format!("no value for <{name}>")))??);
            rest = behind;
        }
        rendered.push_str(rest);
        if rendered.contains('>') {
            return Err(self.fail("a placeholder has no beginning".to_owned()));
        }
        Ok(Netlist(rendered))
    }

    fn fail(&self, reason: String) -> NgspiceError {
        NgspiceError::Template { template: self.name, reason }
    }
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

/// Values by the names of placeholders.
#[derive(Debug, Clone, Default)]
pub(super) struct Values(Vec<(&'static str, Value)>);

impl Values {
    /// Adds a value.
    pub fn with(mut self, name: &'static str, value: Value) -> Self {
        self.0.push((name, value));
        self
    }

    /// Adds a number.
    pub fn number(self, name: &'static str, value: f64) -> Self {
        self.with(name, Value::Number(value))
    }

    fn text(&self, name: &str) -> Option<Result<String, NgspiceError>> {
        let (_, value) = self.0.iter().find(|(known, _)| *known == name)?;
        Some(match value {
            Value::Number(value) => number(name, *value),
            Value::Fragment(netlist) => Ok(netlist.0.trim_end().to_owned()),
            Value::File(file) => Ok(file.name().to_owned()),
            Value::Vectors(vectors) => Ok(vectors.join(" ")),
        })
    }
}
