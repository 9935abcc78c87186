//! What the points of a recording, or of a measured membrane, may be.

use core::fmt;

/// A quantity that is given at points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointQuantity {
    /// `time`, `force`, ...
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// By how much a value must exceed the one before at least; negative infinity if it need not.
    pub rise: f64,
}

/// Why a point is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PointFault {
    /// Outside of its bounds, or NaN.
    Outside(PointQuantity, f64),
    /// Not above the value before, which comes last.
    Order(PointQuantity, [f64; 2]),
}

impl fmt::Display for PointFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside(PointQuantity { name, unit, min, max, .. }, value) => {
                let [value, min, max] = [*value, *min, *max].map(Short);
                write!(out, "{name} = {value} {unit} is outside [{min}, {max}] {unit}")
            }
            Self::Order(PointQuantity { name, unit, rise, .. }, [value, before]) => {
                let [value, before] = [*value, *before].map(Short);
                if *rise > 0.0 {
                    let rise = Short(*rise);
                    write!(
                        out,
                        "{name} = {value} {unit} must exceed that of the point before, {before} {unit}, by {rise} {unit}"
                    )
                } else {
                    write!(out, "{name} = {value} {unit} must not be below that of the point before, {before} {unit}")
                }
            }
        }
    }
}

/// A number in messages, with an exponent where it has many zeros.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if value == 0.0 || (1e-4..1e7).contains(&value.abs()) {
            write!(out, "{value}")
        } else {
            write!(out, "{value:e}")
        }
    }
}

impl PointQuantity {
    /// That this quantity may have such values at the points; else the number of the first that is none, from 0.
    pub(crate) fn check(self, values: &[f64]) -> Result<(), (usize, PointFault)> {
        let mut before = f64::NEG_INFINITY;
        for (index, &value) in values.iter().enumerate() {
            // NaN is within no bounds.
            if !(self.min..=self.max).contains(&value) {
                return Err((index, PointFault::Outside(self, value)));
            }
            if value - before < self.rise {
                return Err((index, PointFault::Order(self, [value, before])));
            }
            before = value;
        }
        Ok(())
    }
}
