//! Values that a user types with a unit. Variables take plain numbers in their own unit, so this finds which number is meant.

/// Exponents of m, kg, s and A.
type Dimension = [i32; 4];

/// Symbols that take a prefix of SI, with the power of ten to SI units.
const SYMBOLS: [(&str, i32, Dimension); 17] = [
    ("m", 0, [1, 0, 0, 0]),
    ("g", -3, [0, 1, 0, 0]),
    ("s", 0, [0, 0, 1, 0]),
    ("A", 0, [0, 0, 0, 1]),
    ("Hz", 0, [0, 0, -1, 0]),
    ("N", 0, [1, 1, -2, 0]),
    ("Pa", 0, [-1, 1, -2, 0]),
    ("J", 0, [2, 1, -2, 0]),
    ("W", 0, [2, 1, -3, 0]),
    ("C", 0, [0, 0, 1, 1]),
    ("V", 0, [2, 1, -3, -1]),
    ("F", 0, [-2, -1, 4, 2]),
    ("Ohm", 0, [2, 1, -3, -2]),
    ("ohm", 0, [2, 1, -3, -2]),
    ("\u{3a9}", 0, [2, 1, -3, -2]),
    ("H", 0, [2, 1, -2, -2]),
    ("rad", 0, [0; 4]),
];

/// Symbols without a prefix, with their values in SI units.
const OTHERS: [(&str, f64, Dimension); 6] = [
    ("deg", std::f64::consts::PI / 180.0, [0; 4]),
    ("\u{b0}", std::f64::consts::PI / 180.0, [0; 4]),
    ("%", 0.01, [0; 4]),
    ("1", 1.0, [0; 4]),
    ("min", 60.0, [0, 0, 1, 0]),
    ("h", 3600.0, [0, 0, 1, 0]),
];

/// Prefixes of SI with their powers of ten.
const PREFIXES: [(&str, i32); 13] = [
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// A unit: its value in SI units is `factor` 10^`power`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unit {
    factor: f64,
    power: i32,
    dimension: Dimension,
}

impl Unit {
    /// Reads a product of powers: `mm`, `m/s2`, `N.s/m`.
    fn parse(text: &str) -> Option<Self> {
        let mut unit = Self { factor: 1.0, power: 0, dimension: [0; 4] };
        let mut sign = 1;
        let mut rest = text;
        loop {
            let end = rest.find(['.', '*', '\u{b7}', '/']).unwrap_or(rest.len());
            let (symbol, exponent) = Self::split(&rest[..end])?;
            let one = Self::symbol(symbol)?;
            let exponent = sign * exponent;
            unit.factor *= one.factor.powi(exponent);
            unit.power += exponent * one.power;
            unit.dimension.iter_mut().zip(one.dimension).for_each(|(sum, each)| *sum += exponent * each);
            let Some(separator) = rest[end..].chars().next() else { return Some(unit) };
            sign = if separator == '/' { -1 } else { 1 };
            rest = &rest[end + separator.len_utf8()..];
        }
    }

    /// A symbol and its exponent: `s2`, `s^2`, `s-1`.
    fn split(text: &str) -> Option<(&str, i32)> {
        let end = text.find(|c: char| c.is_ascii_digit() || "^-".contains(c)).filter(|end| *end > 0);
        let Some(end) = end else { return Some((text, 1)) };
        let exponent = text[end..].trim_start_matches('^').parse().ok().filter(|exponent: &i32| exponent.abs() < 10)?;
        Some((&text[..end], exponent))
    }

    fn symbol(text: &str) -> Option<Self> {
        let other = OTHERS.iter().find(|(symbol, ..)| *symbol == text);
        if let Some(&(_, factor, dimension)) = other {
            return Some(Self { factor, power: 0, dimension });
        }
        let prefixed = || PREFIXES.iter().filter_map(|&(prefix, power)| Some((text.strip_prefix(prefix)?, power)));
        [(text, 0)].into_iter().chain(prefixed()).find_map(|(text, prefix)| {
            let &(_, power, dimension) = SYMBOLS.iter().find(|(symbol, ..)| *symbol == text)?;
            Some(Self { factor: 1.0, power: power + prefix, dimension })
        })
    }
}

/// What to say of `text`, which is no number, for a variable in `unit`: the number that is meant, if it is one with a unit.
pub fn hint(text: &str, unit: Option<&str>) -> Option<String> {
    let (number, found) = number_and_unit(text.trim())?;
    let shown = unit.unwrap_or("1");
    if found == shown {
        return Some(format!("in {shown}; did you mean {number}?"));
    }
    let is_in = || unit.map_or_else(|| "without a unit".to_owned(), |unit| format!("in {unit}"));
    let (given, own) = (Unit::parse(found)?, Unit::parse(shown)?);
    if given.dimension != own.dimension {
        return Some(format!("{}, and {found} is no such unit", is_in()));
    }
    let meant = scaled(number, given.factor / own.factor, given.power - own.power)?;
    Some(format!("{}; did you mean {meant}?", is_in()))
}

/// A number and what follows it.
fn number_and_unit(text: &str) -> Option<(&str, &str)> {
    let is_number = |end: &usize| text.is_char_boundary(*end) && text[..*end].parse::<f64>().is_ok();
    let end = (1..text.len()).rev().find(is_number)?;
    let unit = text[end..].trim_start();
    // Words such as inf and nan are numbers to the parser.
    (text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) && !unit.is_empty())
        .then_some((text[..end].trim_end(), unit))
}

/// `number` times `factor` 10^`power`, with its own digits.
fn scaled(number: &str, factor: f64, power: i32) -> Option<f64> {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let exponent = exponent.parse::<i32>().ok()?.checked_add(power)?;
    let value = format!("{mantissa}e{exponent}").parse::<f64>().ok()? * factor;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::hint;

    #[test]
    fn the_number_that_is_meant_is_found_for_every_prefix_and_unit() {
        for (text, unit, meant) in [
            ("42mm", "m", "0.042"),
            ("42 mm", "m", "0.042"),
            ("3.5g", "kg", "0.0035"),
            ("2kV", "V", "2000"),
            ("10Mohm", "Ohm", "10000000"),
            ("1.5e1Gohm", "Ohm", "15000000000"),
            ("0.1uF", "F", "0.0000001"),
            ("0.1\u{b5}F", "F", "0.0000001"),
            ("5ms", "s", "0.005"),
            ("2min", "s", "120"),
            ("180deg", "rad", "3.141592653589793"),
            ("60%", "1", "0.6"),
            ("981cm/s2", "m/s2", "9.81"),
            ("981 cm/s^2", "m/s2", "9.81"),
            ("2N.s/mm", "N.s/m", "2000"),
            ("45kPa", "N/m2", "45000"),
            ("1J/C", "V", "1"),
            ("-3m", "m", "-3"),
        ] {
            let said = hint(text, Some(unit)).unwrap();
            assert_eq!(said, format!("in {unit}; did you mean {meant}?"), "{text}");
        }
        assert_eq!(hint("60%", None).unwrap(), "without a unit; did you mean 0.6?");
    }

    #[test]
    fn another_dimension_is_named_and_what_is_no_unit_is_not_guessed() {
        assert_eq!(hint("42mV", Some("m")).unwrap(), "in m, and mV is no such unit");
        assert_eq!(hint("3kg", None).unwrap(), "without a unit, and kg is no such unit");
        for text in ["heavy", "42apples", "inf", "", "mm", "4..2", "1e5000mm"] {
            assert_eq!(hint(text, Some("m")), None, "{text}");
        }
    }
}
