//! Netlist templates and the values of their placeholders: numbers, file names and netlists made the same way. Text of a
//! user cannot get in.

use super::NgspiceError;

/// A netlist, or a part of one, rendered from a template. There is no other way to make one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Netlist(String);

impl Netlist {
    /// The text.
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// File name of the netlist in the folder of a run.
pub const NETLIST_FILE: &str = "harvesting.cir";
/// File name of the table of capacitances in the folder of a run.
pub const TABLE_FILE: &str = "capacitance.tab";
/// File name of the result in the folder of a run.
pub const RAW_FILE: &str = "harvesting.raw";

/// A number as ngspice reads it: digits and an exponent, no suffix letter. The digits are those of this very double; what
/// ngspice makes of them may be off by two units in the last place (every third number is).
fn number(name: &str, value: f64) -> Result<String, NgspiceError> {
    if value.is_finite() {
        Ok(format!("{value:e}"))
    } else {
        Err(NgspiceError::Value { name: name.to_owned(), value: value.to_string(), bound: "must be a finite number" })
    }
}

/// A netlist from the folder `ngspice_netlists`, with placeholders `<name>` of small letters and underscores.
macro_rules! template {
    ($name:literal) => {
        include_str!(concat!("../../../ngspice_netlists/", $name))
    };
}
pub(super) use template;

/// The value of a placeholder.
#[derive(Debug)]
enum Value {
    Number(f64),
    Text(String),
}

/// Values by the names of placeholders.
#[derive(Debug, Default)]
pub(super) struct Values(Vec<(&'static str, Value)>);

impl Values {
    fn with(mut self, name: &'static str, value: Value) -> Self {
        self.0.push((name, value));
        self
    }

    pub fn number(self, name: &'static str, value: f64) -> Self {
        self.with(name, Value::Number(value))
    }

    pub fn part(self, name: &'static str, part: &Netlist) -> Self {
        self.with(name, Value::Text(part.0.trim_end().to_owned()))
    }

    /// Words of this program: `'static`, so that none can come from a user.
    pub fn words(self, name: &'static str, words: &'static [&'static str]) -> Self {
        self.with(name, Value::Text(words.join(" ")))
    }

    /// Puts the values into `template`, which need not use all of them.
    pub fn render(&self, template: &str) -> Result<Netlist, NgspiceError> {
        let mut netlist = template.to_owned();
        for (name, value) in &self.0 {
            let placeholder = format!("<{name}>");
            if netlist.contains(&placeholder) {
                let text = match value {
                    Value::Number(value) => &number(name, *value)?,
                    Value::Text(text) => text,
                };
                netlist = netlist.replace(&placeholder, text);
            }
        }
        Ok(Netlist(netlist))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_suffix_letters_and_read_back_as_themselves() {
        for value in [0.0, -0.0, 1e-13, 3.002_953_489_684_304e-11, 1e9, 2000.0, f64::MAX, 5e-324, -1.0 / 3.0] {
            let text = number("x", value).unwrap();
            assert!(text.chars().all(|c| c.is_ascii_digit() || "+-.e".contains(c)), "{text}");
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn a_number_that_is_not_finite_is_an_error_where_it_is_used() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let values = Values::default().number("r", value).number("c", 5.0);
            let error = values.render("R1 a 0 <r>").unwrap_err().to_string();
            assert!(error.starts_with("r = ") && error.contains("finite"), "{error}");
            assert_eq!(values.render("C1 a 0 <c>\n").unwrap().text(), "C1 a 0 5e0\n");
        }
    }
}
