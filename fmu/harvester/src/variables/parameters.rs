//! Rows of the parameters, from the tables of the model.

use fmu_export::{EnumerationItem, EnumerationType, Variable};
use videg_model::Parameters;

use crate::slave::Harvester;

type V = Variable<Harvester>;

static CONTACT_LAW: EnumerationType = EnumerationType::new(
    "ContactLaw",
    "Law of the contact between ball and membrane",
    &[
        EnumerationItem::new("impulsive", "An impact takes no time, Eqs. (10) and (11)"),
        EnumerationItem::new("compliant", "The membrane is a nonlinear spring with losses"),
    ],
);

static NOISE_MODEL: EnumerationType = EnumerationType::new(
    "NoiseModel",
    "How the phase noise of Section 5.2 is read",
    &[
        EnumerationItem::new("held", "A fresh Gaussian sample in each hold interval, as the formula of the paper says"),
        EnumerationItem::new("wiener", "A Wiener process, sampled at each hold interval"),
    ],
);

static OUTSIDE_GAP: EnumerationType = EnumerationType::new(
    "OutsideGap",
    "What a start with abs(z_M - z_m) > s/2 means",
    &[
        EnumerationItem::new("project", "The ball is put on the membrane that it is beyond"),
        EnumerationItem::new("free", "The ball is free until it has come inside the gap"),
    ],
);

/// Real parameter number `INDEX` of the model's table.
const fn parameter<const INDEX: usize>() -> V {
    let quantity = &Parameters::TABLE[INDEX];
    V::parameter(quantity.name, quantity.unit, quantity.start, quantity.description)
        .min(quantity.min)
        .max(quantity.max)
        .access(
            |slave| (Parameters::TABLE[INDEX].get)(&slave.parameters),
            |slave, value| (Parameters::TABLE[INDEX].set)(&mut slave.parameters, value),
        )
}

macro_rules! parameters {
    ($($index:literal)*) => { [$(parameter::<$index>()),*] };
}

/// Every real parameter of the model.
pub(super) static PARAMETERS: [V; Parameters::TABLE.len()] =
    parameters!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21);

/// Integer parameter number `INDEX` of the model's choices.
const fn number<const INDEX: usize>() -> V {
    let choice = &Parameters::CHOICES[INDEX];
    V::integer_parameter(choice.name, choice.start, choice.description).access(
        |slave| (Parameters::CHOICES[INDEX].get)(&slave.parameters),
        |slave, value| (Parameters::CHOICES[INDEX].set)(&mut slave.parameters, value),
    )
}

/// Number `INDEX` of the model's choices, among the items of an enumeration.
const fn item<const INDEX: usize>(of: &'static EnumerationType) -> V {
    let choice = &Parameters::CHOICES[INDEX];
    V::enumeration_parameter(choice.name, of, choice.start, choice.description).access(
        |slave| (Parameters::CHOICES[INDEX].get)(&slave.parameters),
        |slave, item| (Parameters::CHOICES[INDEX].set)(&mut slave.parameters, item),
    )
}

/// Number `INDEX` of the model's choices, on or off.
const fn switch<const INDEX: usize>() -> V {
    let choice = &Parameters::CHOICES[INDEX];
    V::boolean_parameter(choice.name, choice.start != 0, choice.description).access(
        |slave| (Parameters::CHOICES[INDEX].get)(&slave.parameters) != 0,
        |slave, on| (Parameters::CHOICES[INDEX].set)(&mut slave.parameters, i32::from(on)),
    )
}

/// Parameters that choose or count.
pub(super) static CHOICES: [V; Parameters::CHOICES.len()] = [
    number::<0>(),
    item::<1>(&NOISE_MODEL),
    item::<2>(&OUTSIDE_GAP),
    item::<3>(&CONTACT_LAW),
    switch::<4>(),
    switch::<5>(),
];

#[cfg(test)]
#[path = "parameters_tests.rs"]
mod tests;
