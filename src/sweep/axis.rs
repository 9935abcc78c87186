//! A varied variable: the values that it takes, of its type.

use super::random::Stream;
use super::vary::{Range, Scale, Spread, Vary};
use super::{Design, SweepError, column};
use fmu_import::{Kind, ModelDescription, Value, Variable};

/// A varied variable.
pub(super) struct Axis {
    /// The variable.
    pub variable: Variable,
    values: Values,
    stream: Stream,
}

enum Values {
    List(Vec<Value>),
    Reals(Range),
    Integers { from: i32, to: i32, count: Option<u64> },
}

impl Axis {
    /// The axis of a variable of `description` over the values of `vary`, for a `design` with this `seed`.
    pub fn new(description: &ModelDescription, vary: &Vary, design: Design, seed: u64) -> Result<Self, SweepError> {
        let name = &vary.name;
        let bad = |reason: String| SweepError::option("vary", name, reason);
        let variable = description.variable(name).map_err(|error| bad(error.to_string()))?.clone();
        if !variable.is_settable() {
            let (variability, causality) = (variable.variability.as_str(), variable.causality.as_str());
            return Err(bad(format!("it is a {variability} {causality}, which cannot be set")));
        }
        let values = match &vary.spread {
            Spread::List { values } if values.is_empty() => {
                return Err(bad("an empty list leaves nothing to run; at least 1 value is allowed".to_owned()));
            }
            Spread::List { values } => {
                let read = values.iter().map(|text| Value::read(description, &variable, text));
                Values::List(read.collect::<Result<_, _>>().map_err(|error| bad(error.to_string()))?)
            }
            Spread::Range(range) => {
                check_range(range, design).map_err(bad)?;
                ranged(&variable, range).map_err(bad)?
            }
        };
        let axis = Self { stream: Stream::new(seed, name), variable, values };
        axis.check_any().map_err(bad)?;
        Ok(axis)
    }

    /// The axis of a variable over these values.
    pub fn of_list(variable: Variable, values: Vec<Value>, seed: u64) -> Self {
        Self { stream: Stream::new(seed, &variable.name), values: Values::List(values), variable }
    }

    /// The values of a list; none of a range.
    pub fn listed(&self) -> &[Value] {
        if let Values::List(values) = &self.values { values } else { &[] }
    }

    /// How many values it has in a grid.
    pub fn len(&self) -> u64 {
        match &self.values {
            Values::List(values) => values.len() as u64,
            Values::Reals(Range { count, .. }) | Values::Integers { count, .. } => count.unwrap_or(0),
        }
    }

    /// Most bytes that a value of it takes of a line.
    pub fn longest(&self) -> usize {
        /// A number with the quotes that it does not need.
        const NUMBER: usize = 32;
        match &self.values {
            Values::List(values) => {
                values.iter().map(|value| column::line([column::cell(value).as_str()]).len()).max().unwrap_or(NUMBER)
            }
            Values::Reals(_) | Values::Integers { .. } => NUMBER,
        }
    }

    /// Value number `index` of a grid, below [`Axis::len`].
    pub fn at(&self, index: u64) -> Value {
        let share = if index == 0 { 0.0 } else { index as f64 / (self.len() - 1) as f64 };
        match &self.values {
            Values::List(values) => pick(values, index),
            Values::Reals(range) => Value::Real(range.at(share)),
            Values::Integers { from, to, .. } => {
                let (from, to) = (i64::from(*from), i64::from(*to));
                let steps = i64::try_from(self.len()).unwrap_or(i64::MAX) - 1;
                let index = i64::try_from(index).unwrap_or(i64::MAX);
                Value::Integer(narrow(if steps == 0 { from } else { from + (to - from) / steps * index }))
            }
        }
    }

    /// The quantile at a `share` from 0 to below 1.
    pub fn quantile(&self, share: f64) -> Value {
        match &self.values {
            Values::List(values) => pick(values, part(share, values.len() as u64)),
            Values::Reals(range) => Value::Real(range.at(share)),
            Values::Integers { from, to, .. } => {
                let (from, to) = (i64::from(*from), i64::from(*to));
                let count = from.abs_diff(to) + 1;
                let offset = i64::try_from(part(share, count)).unwrap_or(0);
                Value::Integer(narrow(if from <= to { from + offset } else { from - offset }))
            }
        }
    }

    /// Share that belongs to point number `point` of `points` in a `design` that draws.
    pub fn share(&self, design: Design, point: u64, points: u64) -> f64 {
        let unit = self.stream.unit(point);
        if design == Design::Lhs { (self.stream.permuted(point, points) as f64 + unit) / points as f64 } else { unit }
    }

    /// Checks that a value lies in the bounds of the variable. One of a range does if an end does, or if a bound lies between.
    fn check_any(&self) -> Result<(), String> {
        let (values, spans_bounds) = match &self.values {
            Values::List(values) => (values.clone(), false),
            Values::Reals(range) => {
                let ends = [range.from, range.to];
                let (low, high) = (range.from.min(range.to), range.from.max(range.to));
                let inside = match &self.variable.kind {
                    Kind::Real { min, max, .. } => [min, max].into_iter().flatten().any(|b| low <= *b && *b <= high),
                    _ => false,
                };
                (ends.map(Value::Real).to_vec(), inside)
            }
            Values::Integers { from, to, .. } => (vec![Value::Integer(*from), Value::Integer(*to)], false),
        };
        let mut found = values.iter().map(|value| value.check(&self.variable));
        match found.next() {
            Some(Err(error)) if !spans_bounds && found.all(|other| other.is_err()) => Err(error.to_string()),
            _ => Ok(()),
        }
    }
}

/// Index among `count` of the part that `share`, from 0 to below 1, falls into.
fn part(share: f64, count: u64) -> u64 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // not negative, at most a count
    let index = (share * count as f64) as u64;
    index.min(count.saturating_sub(1))
}

fn pick(values: &[Value], index: u64) -> Value {
    usize::try_from(index).ok().and_then(|index| values.get(index)).cloned().unwrap_or(Value::Real(f64::NAN))
}

/// Between two numbers of 32 bits: it is one.
fn narrow(value: i64) -> i32 {
    i32::try_from(value).unwrap_or(i32::MAX)
}

fn check_range(range: &Range, design: Design) -> Result<(), String> {
    let Range { from, to, count, scale } = *range;
    if !(from.is_finite() && to.is_finite() && (to - from).is_finite()) {
        return Err(format!("a range goes from one finite number to another, not from {from} to {to}"));
    }
    if scale == Scale::Log && !(from > 0.0 && to > 0.0) {
        return Err(format!("equal ratios need numbers above 0, not from {from} to {to}"));
    }
    if scale == Scale::Log && !(to / from).is_normal() {
        return Err(format!("the ratio of {to:e} to {from:e} is beyond floating-point numbers"));
    }
    match (design, count) {
        (Design::Grid, None) => Err(format!("a grid needs a count, as in {from}:{to}:11")),
        (Design::Grid, Some(0)) => Err("a count of 0 leaves nothing to run; at least 1 is allowed".to_owned()),
        (Design::Grid, Some(1)) if from != to => {
            Err(format!("a count of 1 cannot go from {from} to {to}; at least 2 are allowed"))
        }
        (Design::Grid, Some(_)) | (Design::Lhs | Design::Random, None) => Ok(()),
        (Design::Lhs | Design::Random, Some(count)) => {
            Err(format!("a count of {count} belongs to a grid; the design {design} takes from {from} to {to} alone"))
        }
    }
}

fn ranged(variable: &Variable, range: &Range) -> Result<Values, String> {
    match variable.kind {
        Kind::Real { .. } => Ok(Values::Reals(*range)),
        Kind::Integer { .. } => integers(range),
        ref other => Err(format!("a range is for numbers, and this is a {}: list its values", other.name())),
    }
}

fn integers(range: &Range) -> Result<Values, String> {
    let Range { from, to, count, scale } = *range;
    #[allow(clippy::cast_possible_truncation)] // compared with what it was
    let integer = |number: f64| Some(number as i32).filter(|integer| f64::from(*integer) == number);
    let (Some(from), Some(to)) = (integer(from), integer(to)) else {
        return Err(format!("an Integer takes whole numbers of 32 bits, not from {from} to {to}"));
    };
    if scale == Scale::Log {
        return Err("equal ratios do not go with an Integer: list its values".to_owned());
    }
    let steps = count.map_or(1, |count| count.max(2) - 1);
    if !u64::from(from.abs_diff(to)).is_multiple_of(steps) {
        return Err(format!("{from} to {to} in {} values does not give whole numbers", steps + 1));
    }
    Ok(Values::Integers { from, to, count })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(text: &str, design: Design) -> Result<Axis, String> {
        let description = crate::sweep::harvester_description().unwrap();
        Axis::new(&description, &Vary::parse(text).unwrap(), design, 1).map_err(|error| error.to_string())
    }

    fn grid(text: &str) -> Vec<String> {
        let axis = axis(text, Design::Grid).unwrap();
        (0..axis.len()).map(|index| axis.at(index).to_string()).collect()
    }

    #[test]
    fn a_grid_has_its_ends_and_equal_differences_or_ratios() {
        assert_eq!(grid("membrane.restitution=0.2:0.8:4"), ["0.2", "0.4", "0.6000000000000001", "0.8"]);
        assert_eq!(grid("membrane.stiffness=log:100:10000:3"), ["100", "1000", "10000"]);
        assert_eq!(grid("membrane.restitution=0.5:0.5:1"), ["0.5"]);
        assert_eq!(grid("excitation.seed=3:-3:4"), ["3", "1", "-1", "-3"]);
        assert_eq!(grid("contact.law=compliant,1"), ["compliant", "impulsive"]);
        assert_eq!(grid("contact.reaction=true,0"), ["true", "false"]);
    }

    #[test]
    fn shares_reach_every_value_and_stay_in_the_range() {
        let seed = axis("excitation.seed=1:3", Design::Random).unwrap();
        let found: Vec<_> = [0.0, 0.32, 0.34, 0.66, 0.67, 0.999].map(|share| seed.quantile(share).to_string()).into();
        assert_eq!(found, ["1", "1", "2", "2", "3", "3"]);
        let stiffness = axis("membrane.stiffness=log:100:10000", Design::Lhs).unwrap();
        assert_eq!(stiffness.quantile(0.5), Value::Real(1000.0));
        let law = axis("contact.law=impulsive,compliant", Design::Random).unwrap();
        assert_eq!([0.49, 0.51].map(|share| law.quantile(share).to_string()), ["impulsive", "compliant"]);
    }

    #[test]
    fn what_a_variable_cannot_take_is_an_error_that_names_it() {
        for (text, design, named) in [
            ("membrane.restitutoin=1:2:3", Design::Grid, "did you mean \"membrane.restitution\""),
            ("impact.count=1,2", Design::Grid, "--vary impact.count: it is a discrete local, which cannot be set"),
            ("membrane.restitution=0:1", Design::Grid, "a grid needs a count, as in 0:1:11"),
            ("membrane.restitution=0:1:0", Design::Grid, "a count of 0"),
            ("membrane.restitution=0:1:1", Design::Grid, "a count of 1 cannot go from 0 to 1"),
            ("membrane.restitution=0:1:5", Design::Lhs, "a count of 5 belongs to a grid; the design lhs"),
            ("membrane.restitution=0:inf", Design::Random, "from 0 to inf"),
            ("membrane.stiffness=log:0:1", Design::Random, "above 0, not from 0 to 1"),
            ("membrane.stiffness=log:1e-200:1e200", Design::Random, "the ratio of 1e200 to 1e-200"),
            ("membrane.restitution=0.5,high", Design::Grid, "membrane.restitution = \"high\": allowed is a number"),
            ("membrane.restitution=1.5,2", Design::Grid, "membrane.restitution = 1.5"),
            ("membrane.restitution=1.5:2", Design::Random, "membrane.restitution = 1.5"),
            ("contact.law=1:2", Design::Random, "this is a Enumeration: list its values"),
            ("contact.law=soft", Design::Grid, "allowed is one of impulsive, compliant"),
            ("excitation.seed=1:2.5", Design::Random, "not from 1 to 2.5"),
            ("excitation.seed=1:10:4", Design::Grid, ""),
            ("excitation.seed=1:10:5", Design::Grid, "1 to 10 in 5 values does not give whole numbers"),
            ("excitation.seed=log:1:8:4", Design::Grid, "equal ratios do not go with an Integer"),
        ] {
            match axis(text, design) {
                Ok(_) => assert_eq!(named, "", "{text}"),
                Err(message) => assert!(!named.is_empty() && message.contains(named), "{text}: {message}"),
            }
        }
        assert!(axis("membrane.restitution=0.5,1.5", Design::Grid).is_ok(), "one value is allowed");
        assert!(axis("membrane.restitution=-1:2", Design::Random).is_ok(), "the bounds lie in between");
    }
}
