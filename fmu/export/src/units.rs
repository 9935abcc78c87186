//! Units and their SI base units, for the unit definitions of `modelDescription.xml`.

/// A unit as a product of powers of SI base units: `value_in_base = factor * value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BaseUnit {
    /// Exponents of kg, m, s, A, K, mol, cd and rad, in the order of [`BaseUnit::NAMES`].
    pub(crate) exponents: [i8; 8],
    /// What one of the unit is in base units.
    pub(crate) factor: f64,
}

impl BaseUnit {
    /// Names of the base units, in the order in which the schema lists them.
    pub(crate) const NAMES: [&'static str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
}

const fn unit(kg: i8, m: i8, s: i8, a: i8) -> BaseUnit {
    BaseUnit { exponents: [kg, m, s, a, 0, 0, 0, 0], factor: 1.0 }
}

const fn single(index: usize) -> BaseUnit {
    let mut exponents = [0; 8];
    exponents[index] = 1;
    BaseUnit { exponents, factor: 1.0 }
}

const fn scaled(factor: f64, unit: BaseUnit) -> BaseUnit {
    BaseUnit { factor, ..unit }
}

const RAD: BaseUnit = single(7);

const UNITS: &[(&str, BaseUnit)] = &[
    ("kg", unit(1, 0, 0, 0)),
    ("m", unit(0, 1, 0, 0)),
    ("s", unit(0, 0, 1, 0)),
    ("A", unit(0, 0, 0, 1)),
    ("K", single(4)),
    ("mol", single(5)),
    ("cd", single(6)),
    ("rad", RAD),
    ("deg", scaled(core::f64::consts::PI / 180.0, RAD)),
    ("g", scaled(1e-3, unit(1, 0, 0, 0))),
    ("mm", scaled(1e-3, unit(0, 1, 0, 0))),
    ("m2", unit(0, 2, 0, 0)),
    ("m3", unit(0, 3, 0, 0)),
    ("ms", scaled(1e-3, unit(0, 0, 1, 0))),
    ("Hz", unit(0, 0, -1, 0)),
    ("1/s", unit(0, 0, -1, 0)),
    ("rad/s", BaseUnit { exponents: [0, 0, -1, 0, 0, 0, 0, 1], factor: 1.0 }),
    ("m/s", unit(0, 1, -1, 0)),
    ("m/s2", unit(0, 1, -2, 0)),
    ("N", unit(1, 1, -2, 0)),
    ("N/m", unit(1, 0, -2, 0)),
    ("N.s/m", unit(1, 0, -1, 0)),
    ("Pa", unit(1, -1, -2, 0)),
    ("J", unit(1, 2, -2, 0)),
    ("W", unit(1, 2, -3, 0)),
    ("C", unit(0, 0, 1, 1)),
    ("V", unit(1, 2, -3, -1)),
    ("V/s", unit(1, 2, -4, -1)),
    ("V/m", unit(1, 1, -3, -1)),
    ("Ohm", unit(1, 2, -3, -2)),
    ("S", unit(-1, -2, 3, 2)),
    ("F", unit(-1, -2, 4, 2)),
    ("F/m", unit(-1, -3, 4, 2)),
    ("H", unit(1, 2, -2, -2)),
];

/// What a unit is in SI base units; `None` if this crate does not know, as for `N/m^n` with a real `n`. Such a
/// unit is still written to `modelDescription.xml`, where its base unit is left open.
pub(crate) fn base_unit(name: &str) -> Option<BaseUnit> {
    let found = UNITS.iter().find(|(known, _)| *known == name);
    found.map(|(_, unit)| *unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(units: &[(&str, i8)]) -> [i8; 8] {
        let mut exponents = [0; 8];
        for &(name, power) in units {
            let base = base_unit(name).unwrap();
            for (sum, exponent) in exponents.iter_mut().zip(base.exponents) {
                *sum += power * exponent;
            }
        }
        exponents
    }

    #[test]
    fn derived_units_agree_with_the_laws_of_physics() {
        let laws: [(&str, &[(&str, i8)]); 11] = [
            ("N", &[("kg", 1), ("m/s2", 1)]),
            ("J", &[("N", 1), ("m", 1)]),
            ("W", &[("J", 1), ("s", -1)]),
            ("V", &[("W", 1), ("A", -1)]),
            ("C", &[("A", 1), ("s", 1)]),
            ("F", &[("C", 1), ("V", -1)]),
            ("Ohm", &[("V", 1), ("A", -1)]),
            ("S", &[("Ohm", -1)]),
            ("H", &[("V", 1), ("s", 1), ("A", -1)]),
            ("Pa", &[("N", 1), ("m2", -1)]),
            ("V/s", &[("V", 1), ("Hz", 1)]),
        ];
        for (name, law) in laws {
            assert_eq!(base_unit(name).unwrap().exponents, product(law), "{name}");
        }
        assert_eq!(base_unit("N/m^n"), None);
    }

    #[test]
    fn no_unit_occurs_twice() {
        for (i, (name, _)) in UNITS.iter().enumerate() {
            assert!(UNITS[..i].iter().all(|(other, _)| other != name), "{name}");
        }
    }
}
