//! The published cases as settings of FMU variables.

use videg_model::{Case, Parameters};

use super::Setting;

/// The case called `name`.
///
/// # Errors
/// The names of all, if there is none.
pub(super) fn find(name: &str) -> Result<&'static Case, String> {
    Case::find(name).ok_or_else(|| Case::ALL.iter().map(|case| case.name).collect::<Vec<_>>().join(", "))
}

/// Whether the case has the number of `setting` already.
pub(super) fn has(case: &Case, setting: &Setting) -> bool {
    let quantity = Parameters::TABLE.iter().find(|quantity| quantity.name == setting.name);
    let value = setting.value.trim().parse::<f64>().ok();
    quantity.zip(value).is_some_and(|(quantity, value)| (quantity.get)(&(case.parameters)()) == value)
}

/// Settings of the case: every parameter whose value is not the start value. Numbers read back to the same bits, choices are
/// their numbers.
pub(super) fn settings(case: &Case) -> Vec<Setting> {
    let parameters = (case.parameters)();
    let changed = Parameters::TABLE.iter().filter(|quantity| (quantity.get)(&parameters) != quantity.start);
    let numbers = changed.map(|quantity| Setting::new(quantity.name, format!("{:?}", (quantity.get)(&parameters))));
    let chosen = Parameters::CHOICES.iter().filter(|choice| (choice.get)(&parameters) != choice.start);
    let choices = chosen.map(|choice| Setting::new(choice.name, (choice.get)(&parameters).to_string()));
    numbers.chain(choices).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_make_the_parameters_of_every_case() {
        for case in Case::ALL {
            let mut made = Parameters::default();
            for setting in settings(case) {
                if let Some(quantity) = Parameters::TABLE.iter().find(|it| it.name == setting.name) {
                    (quantity.set)(&mut made, setting.value.parse().unwrap());
                } else {
                    let choice = Parameters::CHOICES.iter().find(|it| it.name == setting.name).unwrap();
                    (choice.set)(&mut made, setting.value.parse().unwrap());
                }
            }
            assert_eq!(made, (case.parameters)(), "{}", case.name);
        }
    }
}
