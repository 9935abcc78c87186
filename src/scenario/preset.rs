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
