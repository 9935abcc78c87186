//! The table that is derived from the fields of a model: row by row that which the constructors give.

use crate::common::slave;
use fmu_export::{Choice, ClockInterval, IntegerWidth, ModelInfo, Standard, Variable, Variables};

/// What the contact does.
#[derive(Debug, Clone, Copy, Default, PartialEq, Choice)]
enum Law {
    /// No time passes.
    #[default]
    Impulsive,
    /// It takes time
    /// and energy.
    Compliant,
}

#[derive(Clone, Default, Variables)]
struct Derived {
    /// T: time constant.
    #[parameter(name = "timeConstant", unit = "s", start = 1.5, min = 1e-6, max = f64::INFINITY, infinity_allowed)]
    time_constant: f64,
    /// Law of the contact.
    #[parameter(start = Compliant, tunable)]
    law: Law,
    /** A file.
     *
     * Of the user.
     */
    #[parameter(start = "a.csv", longest = 80)]
    file: String,
    /// Whether it rests.
    #[input]
    rests: bool,
    /// Steps.
    #[input(start = 3, max = 7)]
    r#steps: u8,
    #[input(unit = "V", input_derivatives(1, |m, _, v| m.rate = v))]
    voltage: f64,
    /// 1/T.
    #[calculated_parameter(unit = "Hz")]
    frequency: f64,
    /// A count.
    #[output(depends_on = &[])]
    count: u64,
    /// A temperature.
    #[output(unit = "K", nominal = 300.0, depends_on = &["voltage"])]
    temperature: f32,
    /// What to show.
    #[local(unit = "m/s", derivative_of = "temperature")]
    shown: f64,
    /// Present law.
    #[output]
    present: Law,
    /// A text.
    #[output]
    text: String,
    /// Ticks.
    #[input_clock(interval = ClockInterval::Periodic { interval: 0.1, shift: 0.0 })]
    ticks: bool,
    /// Rings.
    #[output_clock]
    rings: bool,
    /// At a ring.
    #[output(clocked_by = &["rings"], discrete)]
    rung: f64,
    rate: f64,
}

type V = Variable<Derived>;

const LONGHAND: [V; 15] = [
    V::parameter("timeConstant", "s", 1.5, "T: time constant")
        .min(1e-6)
        .max(f64::INFINITY)
        .infinity_allowed()
        .access(|m| m.time_constant, |m, v| m.time_constant = v),
    V::enumeration_parameter("law", Law::TYPE, 2, "Law of the contact")
        .tunable()
        .access(|m| m.law.number(), |m, v| m.law = Law::of(v).unwrap_or_default()),
    V::string_parameter("file", "a.csv", "A file").longest(80).access(|m| m.file.clone(), |m, v| m.file = v),
    V::boolean_input("rests", false, "Whether it rests").access(|m| m.rests, |m, v| m.rests = v),
    V::integer_input("steps", 3, "Steps")
        .width(IntegerWidth::UInt8)
        .max(7)
        .access(|m| m.steps.into(), |m, v| m.steps = u8::try_from(v).unwrap_or_default()),
    V::input("voltage", "V", 0.0, "voltage")
        .input_derivatives(1, |m, _, v| m.rate = v)
        .access(|m| m.voltage, |m, v| m.voltage = v),
    V::calculated_parameter("frequency", "Hz", "1/T").get(|m| m.frequency),
    V::integer_output("count", "A count").width(IntegerWidth::UInt64).depends_on(&[]).get(|m| m.count.cast_signed()),
    V::output("temperature", "K", "A temperature")
        .single()
        .nominal(300.0)
        .depends_on(&["voltage"])
        .get(|m| m.temperature.into()),
    V::output("shown", "m/s", "What to show").local().derivative_of("temperature").get(|m| m.shown),
    V::enumeration_output("present", Law::TYPE, "Present law").get(|m| m.present.number()),
    V::string_output("text", "A text").get(|m| m.text.clone()),
    V::input_clock("ticks", ClockInterval::Periodic { interval: 0.1, shift: 0.0 }, "Ticks")
        .access(|m| m.ticks, |m, v| m.ticks = v),
    V::output_clock("rings", "Rings").get(|m| m.rings),
    V::output("rung", "1", "At a ring").clocked_by(&["rings"]).discrete().get(|m| m.rung),
];

slave!(Derived, ModelInfo::new("Model"), &Self::VARIABLES);

/// The rows of both tables, and what they do, as text.
fn shown(table: &[V]) -> Vec<String> {
    use fmu_export::Kind;
    let mut model = Derived::default();
    let row = |row: &V| {
        let kind = match row.kind() {
            Kind::Real(it) => {
                it.set.into_iter().for_each(|set| set.set(&mut model, 2.5));
                it.input_derivatives.into_iter().for_each(|(_, set)| set(&mut model, 1, 9.0));
                let bounds = (it.min, it.max, it.nominal, it.infinity_allowed, it.single);
                format!(
                    "{:?} {} {bounds:?} {} {:?}",
                    it.start,
                    it.unit,
                    it.get.get(&model),
                    it.input_derivatives.map(|d| d.0)
                )
            }
            Kind::Integer(it) => {
                it.set.into_iter().for_each(|set| set.set(&mut model, 6));
                format!("{:?} {:?} {} {} {}", it.start, it.width, it.min, it.max, it.get.get(&model))
            }
            Kind::Boolean(it) => {
                it.set.into_iter().for_each(|set| set.set(&mut model, true));
                format!("{:?} {}", it.start, it.get.get(&model))
            }
            Kind::String(it) => {
                it.set.into_iter().for_each(|set| set.set(&mut model, "b".to_owned()));
                format!("{:?} {} {}", it.start, it.longest, it.get.get(&model))
            }
            Kind::Enumeration(it) => {
                let start = it.start;
                it.set.into_iter().for_each(|set| set.set(&mut model, 2));
                format!("{start:?} {:?} {}", it.of, it.get.get(&model))
            }
            Kind::Clock(it) => {
                it.set.into_iter().for_each(|set| set.set(&mut model, true));
                format!("{:?} {}", it.interval, it.get.get(&model))
            }
        };
        let facts = (row.causality(), row.variability(), row.dependencies(), row.derivative_of(), row.clocks());
        format!("{} {}: {facts:?} {} {kind}", row.name(), row.description(), row.kind().type_name_3())
    };
    table.iter().map(row).collect()
}

#[test]
fn each_row_is_that_of_the_constructors() {
    assert_eq!(Derived::VARIABLES.len(), LONGHAND.len());
    for (derived, written) in shown(&Derived::VARIABLES).into_iter().zip(shown(&LONGHAND)) {
        assert_eq!(derived, written);
    }
    let rate = {
        let mut model = Derived::default();
        if let fmu_export::Kind::Real(it) = Derived::VARIABLES[5].kind() {
            it.input_derivatives.into_iter().for_each(|(_, set)| set(&mut model, 1, 9.0));
        }
        model.rate
    };
    assert_eq!(rate, 9.0);
    assert_ne!(
        fmu_export::Guid::of::<Derived>(Standard::Fmi2).to_string(),
        fmu_export::Guid::of::<Derived>(Standard::Fmi3).to_string()
    );
}

#[test]
fn an_unknown_number_leaves_a_choice_as_it_is() {
    assert_eq!(Law::of(0), None);
    assert_eq!(Law::of(3), None);
    assert_eq!((1..=2).map(|number| Law::of(number).unwrap().number()).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(Law::TYPE.items, [("Impulsive", "No time passes"), ("Compliant", "It takes time and energy")]);
}
