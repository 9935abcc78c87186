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

/// A number as ngspice reads it: digits and an exponent, no suffix letter. The digits are those of this very double; what
/// ngspice makes of them may be off by two units in the last place (every third number is).
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

#[cfg(test)]
mod tests {
    use super::*;

    fn render(text: &'static str, values: &Values) -> Result<String, String> {
        let template = Template { name: "test.cir", text };
        template.render(values).map(|netlist| netlist.text().to_owned()).map_err(|error| error.to_string())
    }

    #[test]
    fn numbers_have_no_suffix_letters_and_read_back_as_themselves() {
        for value in [0.0, -0.0, 1e-13, 3.002_953_489_684_304e-11, 1e9, 2000.0, f64::MAX, 5e-324, -1.0 / 3.0] {
            let text = number("x", value).unwrap();
            assert!(text.chars().all(|c| c.is_ascii_digit() || "+-.e".contains(c)), "{text}");
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn numbers_that_are_none_have_no_way_in() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = render("R1 a 0 <r>", &Values::default().number("r", value)).unwrap_err();
            assert!(error.starts_with("r = ") && error.contains("finite"), "{error}");
        }
    }

    #[test]
    fn placeholders_without_value_end_or_beginning_are_errors_that_name_them() {
        let values = Values::default().number("r", 5.0);
        assert_eq!(render("R1 a 0 <r>\n", &values).unwrap(), "R1 a 0 5e0\n");
        for (text, expected) in [
            ("R1 a 0 <q>", "test.cir: no value for <q>"),
            ("R1 a 0 <R>", "no value for <R>"),
            ("R1 a 0 <r", "\"<r\" has no end"),
            ("R1 a 0 r>", "has no beginning"),
            ("R1 a 0 <<r>>", "no value for <<r>"),
        ] {
            let error = render(text, &values).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn fragments_are_not_rendered_twice() {
        let values = Values::default().number("r", 5.0);
        let fragment = Template { name: "fragment.cir", text: "R1 a 0 <r>\n" }.render(&values).unwrap();
        let values = Values::default().with("load", Value::Fragment(fragment));
        assert_eq!(render("<load>\n.end\n", &values).unwrap(), "R1 a 0 5e0\n.end\n");
    }
}
