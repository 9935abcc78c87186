//! The published cases as settings of FMU variables.

use fmu_import::{Value, nearest_name};
use videg_model::{Case, Parameters};

use super::Setting;
use super::harvester::harvester_description;
use super::user_file::is_file;

/// The case called `name`.
///
/// # Errors
/// The nearest name and the names of all, if there is none.
pub(super) fn find(name: &str) -> Result<&'static Case, String> {
    Case::find(name).ok_or_else(|| {
        let names: Vec<_> = Case::ALL.iter().map(|case| case.name).collect();
        let nearest = nearest_name(name, names.iter().copied());
        let hint =
            nearest.map_or_else(|| "there are: ".to_owned(), |nearest| format!("did you mean {nearest}? There are: "));
        hint + &names.join(", ")
    })
}

/// Whether the case has the value of `setting` already. No case names a file.
pub(super) fn has(case: &Case, setting: &Setting) -> bool {
    let parameters = (case.parameters)();
    if let Some(quantity) = Parameters::TABLE.iter().find(|quantity| quantity.name == setting.name) {
        return setting.value.trim().parse() == Ok((quantity.get)(&parameters));
    }
    let chosen = Parameters::CHOICES.iter().find(|choice| choice.name == setting.name);
    chosen.map_or_else(
        || is_file(&setting.name) && setting.value.is_empty(),
        |choice| item(setting) == Some((choice.get)(&parameters)),
    )
}

/// The number of an item that is chosen by name or number.
fn item(setting: &Setting) -> Option<i32> {
    let description = harvester_description().ok()?;
    match Value::parse(&description, description.variable(&setting.name).ok()?, &setting.value).ok()? {
        Value::Enumeration { value, .. } | Value::Integer(value) => Some(value),
        Value::Boolean(value) => Some(value.into()),
        Value::Real(_) | Value::String(_) => None,
    }
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
    fn a_case_has_the_items_that_it_chooses_by_name_and_number() {
        let has = |case: &str, name: &str, value: &str| has(find(case).unwrap(), &Setting::new(name, value));
        for (case, name, value, expected) in [
            ("fig14", "contact.law", "impulsive", true),
            ("fig14", "contact.law", "1", true),
            ("fig14", "contact.law", "compliant", false),
            ("capsule-soft", "contact.law", "compliant", true),
            ("fig14", "contact.reaction", "false", true),
            ("fig14", "contact.reaction", "true", false),
            ("fig14", "excitation.seed", "1", true),
            ("fig14", "excitation.file", "", true),
            ("fig14", "excitation.file", "shaker.csv", false),
            ("fig14", "load.resistance", "", false),
        ] {
            assert_eq!(has(case, name, value), expected, "{case}: {name} = {value}");
        }
    }

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
