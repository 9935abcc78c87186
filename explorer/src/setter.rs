//! Variables by the names that the FMUs have.

use videg_circuit::Settings;
use videg_coupled::Given;
use videg_model::Parameters;

/// What a machine is set to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Values {
    pub parameters: Parameters,
    pub circuit: Settings,
    pub given: Given,
}

/// How a variable is set.
#[derive(Clone, Copy)]
pub enum Setter {
    Mechanical(fn(&mut Parameters, f64)),
    MechanicalChoice(fn(&mut Parameters, i32)),
    Electrical(&'static str, fn(&mut Settings, f64)),
    ElectricalChoice(fn(&mut Settings, i32)),
}

impl Setter {
    /// That of the variable called `name`.
    ///
    /// # Errors
    /// If there is no such variable.
    pub fn of(name: &str) -> Result<Self, String> {
        let quantity = Parameters::TABLE.iter().find(|it| it.name == name).map(|it| Self::Mechanical(it.set));
        let choice = || Parameters::CHOICES.iter().find(|it| it.name == name).map(|it| Self::MechanicalChoice(it.set));
        let electrical =
            || Settings::QUANTITIES.iter().find(|it| it.name == name).map(|it| Self::Electrical(it.name, it.set));
        let item = || Settings::CHOICES.iter().find(|it| it.name == name).map(|it| Self::ElectricalChoice(it.set));
        let found = quantity.or_else(choice).or_else(electrical).or_else(item);
        found.ok_or_else(|| format!("{name}: no such variable"))
    }

    /// Whether C(t) is the same whatever its value.
    pub fn is_electrical(self) -> bool {
        matches!(self, Self::Electrical(..) | Self::ElectricalChoice(_))
    }

    /// Sets the variable in `values`; choices have the numbers that FMI gives them.
    ///
    /// # Errors
    /// A choice that is no whole number. Bounds are checked by what takes the values.
    pub fn set(self, values: &mut Values, number: f64) -> Result<(), String> {
        match self {
            Self::Mechanical(set) => set(&mut values.parameters, number),
            Self::MechanicalChoice(set) => set(&mut values.parameters, whole(number)?),
            Self::Electrical(name, set) => {
                set(&mut values.circuit, number);
                values.given.add(name);
            }
            Self::ElectricalChoice(set) => set(&mut values.circuit, whole(number)?),
        }
        Ok(())
    }
}

fn whole(number: f64) -> Result<i32, String> {
    let is_whole = number.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&number);
    #[expect(clippy::cast_possible_truncation, reason = "a whole number within the bounds of the type")]
    if is_whole { Ok(number as i32) } else { Err(format!("{number} is no whole number of 32 bits")) }
}
