//! The compiler makes the rows of the table; here some are made again, where they can be looked at as they are made.

use fmu_export::Kind;

use super::*;

#[test]
fn a_parameter_has_name_unit_start_and_bounds_of_the_table_of_the_model() {
    let rows = parameters!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21);
    assert_eq!(rows.len(), Parameters::TABLE.len());
    for (row, quantity) in rows.iter().zip(Parameters::TABLE) {
        assert_eq!((row.name(), row.description()), (quantity.name, quantity.description));
        let Kind::Real(real) = row.kind() else { panic!("{} is no Real", row.name()) };
        assert_eq!((real.unit, real.start), (quantity.unit, Some(quantity.start)), "{}", row.name());
        assert_eq!((real.min, real.max), (quantity.min, quantity.max), "{}", row.name());
    }
}

#[test]
fn a_choice_has_name_and_start_of_the_table_of_the_model() {
    let rows = [number::<0>(), item::<1>(&NOISE_MODEL), switch::<4>()];
    let found = rows.iter().map(|row| match row.kind() {
        Kind::Integer(it) => (row.name(), row.description(), it.start),
        Kind::Enumeration(it) => (row.name(), row.description(), it.start),
        Kind::Boolean(it) => (row.name(), row.description(), it.start.map(i32::from)),
        _ => panic!("{} is another type", row.name()),
    });
    let wanted = [0, 1, 4].map(|index| &Parameters::CHOICES[index]);
    assert!(found.eq(wanted.map(|choice| (choice.name, choice.description, Some(choice.start)))));
}
