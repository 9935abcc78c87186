//! What the constructors of a table and of the facts about an FMU declare. The compiler evaluates those of a `static`; here they
//! run.

use crate::common::slave;
use fmu_export::{
    EnumerationType, Experiment, Initial, Kind, Logger, ModelInfo, Slave, StateError, StateReader, StateWriter,
    Variability, Variable, concat,
};

/// A model that has one of each and nothing to do.
#[derive(Debug, Clone, Default, PartialEq)]
struct Sample {
    real: f64,
    rate: f64,
    integer: i32,
    on: bool,
    text: String,
}

type V = Variable<Sample>;

slave!(Sample, ModelInfo::new("Sample"), &[]);

static COLOUR: EnumerationType =
    EnumerationType { name: "Colour", description: "Of the ball", items: &[("red", "Like a rose"), ("blue", "")] };

fn reals() -> Vec<V> {
    vec![
        V::parameter("a", "m", 1.0, "").access(|it| it.real, |it, value| it.real = value),
        V::parameter("b", "m", 1.0, "")
            .tunable()
            .min(0.5)
            .max(2.0)
            .nominal(1.5)
            .infinity_allowed()
            .access(|it| it.real, |it, value| it.real = value),
        V::calculated_parameter("c", "m", "").initially_depends_on(&[&["a"]]).get(|it| it.real),
        V::input("d", "m", 1.0, "")
            .input_derivatives(2, |it, order, value| it.rate = f64::from(order) * value)
            .access(|it| it.real, |it, value| it.real = value),
        V::input("e", "m", 1.0, "").discrete().access(|it| it.real, |it, value| it.real = value),
        V::output("f", "m", "").reinit().get(|it| it.real),
        V::output("g", "m", "")
            .local()
            .derivative_of("f")
            .depends_on(&["d"])
            .output_derivatives(1, |it, order| f64::from(order) * it.rate)
            .partial_derivative(|_, _| 1.0)
            .get(|it| it.real),
        V::independent("t", "").get(|it| it.real),
    ]
}

fn narrow(value: i64) -> i32 {
    i32::try_from(value).unwrap_or(i32::MAX)
}

fn others() -> Vec<V> {
    vec![
        V::integer_parameter("i", 3, "")
            .min(1)
            .max(9)
            .access(|it| it.integer.into(), |it, value| it.integer = narrow(value)),
        V::integer_input("j", 3, "").access(|it| it.integer.into(), |it, value| it.integer = narrow(value)),
        V::integer_output("k", "").get(|it| it.integer.into()),
        V::boolean_parameter("l", true, "").access(|it| it.on, |it, value| it.on = value),
        V::boolean_input("m", true, "").access(|it| it.on, |it, value| it.on = value),
        V::boolean_output("n", "").get(|it| it.on),
        V::string_parameter("o", "x", "").access(|it| it.text.clone(), |it, value| value.clone_into(&mut it.text)),
        V::string_input("p", "x", "").access(|it| it.text.clone(), |it, value| value.clone_into(&mut it.text)),
        V::string_output("q", "").get(|it| it.text.clone()),
        V::enumeration_parameter("r", &COLOUR, 2, "").access(|it| it.integer, |it, value| it.integer = value),
        V::enumeration_input("s", &COLOUR, 2, "").access(|it| it.integer, |it, value| it.integer = value),
        V::enumeration_output("u", &COLOUR, "").get(|it| it.integer),
    ]
}

/// Type, causality and variability of a row, its start value or how else it comes to one, and what is read of a model in which
/// it has been set, if it can be.
fn words(row: &V) -> String {
    let mut it = Sample { real: 7.5, rate: 0.5, integer: 7, on: false, text: "y".to_owned() };
    let (start, value) = match row.kind() {
        Kind::Real(spec) => {
            spec.set.into_iter().for_each(|set| set.set(&mut it, 4.5));
            (spec.start.map(|start| format!("{start:?}")), spec.get.get(&it).to_string())
        }
        Kind::Integer(spec) => {
            spec.set.into_iter().for_each(|set| set.set(&mut it, 4));
            (spec.start.map(|start| start.to_string()), spec.get.get(&it).to_string())
        }
        Kind::Boolean(spec) => {
            spec.set.into_iter().for_each(|set| set.set(&mut it, true));
            (spec.start.map(|start| start.to_string()), spec.get.get(&it).to_string())
        }
        Kind::String(spec) => {
            spec.set.into_iter().for_each(|set| set.set(&mut it, "z".to_owned()));
            (spec.start.map(str::to_owned), spec.get.get(&it))
        }
        Kind::Enumeration(spec) => {
            spec.set.into_iter().for_each(|set| set.set(&mut it, 1));
            (spec.start.and_then(|start| spec.of.item(start)).map(str::to_owned), spec.get.get(&it).to_string())
        }
        Kind::Clock(_) => unreachable!("no clock among these"),
    };
    assert!(row.initial() != Some(Initial::Exact) || start.is_some());
    let start = start.or(row.initial().map(|initial| initial.as_str().to_owned()));
    let (causality, variability) = (row.causality().as_str(), row.variability().as_str());
    format!("{}: {} {causality} {variability} {start:?} {value}", row.name(), row.kind().type_name())
}

#[test]
fn each_constructor_declares_what_it_is_called_after() {
    let found: Vec<_> = reals().iter().chain(&others()).map(words).collect();
    let wanted = [
        r#"a: Real parameter fixed Some("1.0") 4.5"#,
        r#"b: Real parameter tunable Some("1.0") 4.5"#,
        r#"c: Real calculatedParameter fixed Some("calculated") 7.5"#,
        r#"d: Real input continuous Some("1.0") 4.5"#,
        r#"e: Real input discrete Some("1.0") 4.5"#,
        r#"f: Real output continuous Some("calculated") 7.5"#,
        r#"g: Real local continuous Some("calculated") 7.5"#,
        "t: Real independent continuous None 7.5",
        r#"i: Integer parameter fixed Some("3") 4"#,
        r#"j: Integer input discrete Some("3") 4"#,
        r#"k: Integer output discrete Some("calculated") 7"#,
        r#"l: Boolean parameter fixed Some("true") true"#,
        r#"m: Boolean input discrete Some("true") true"#,
        r#"n: Boolean output discrete Some("calculated") false"#,
        r#"o: String parameter fixed Some("x") z"#,
        r#"p: String input discrete Some("x") z"#,
        r#"q: String output discrete Some("calculated") y"#,
        r#"r: Enumeration parameter fixed Some("blue") 1"#,
        r#"s: Enumeration input discrete Some("blue") 1"#,
        r#"u: Enumeration output discrete Some("calculated") 7"#,
    ];
    assert_eq!(found, wanted);
}

#[test]
fn groups_of_rows_become_one_table_in_their_order() {
    let table: [V; 20] = concat(&[&reals(), &others()]);
    let found: String = table.iter().map(Variable::name).collect();
    assert_eq!(found, "abcdefgtijklmnopqrsu");
    assert_eq!(table[1].variability(), Variability::Tunable);
}

#[test]
#[should_panic(expected = "N is not the number of rows")]
fn a_table_longer_than_its_groups_is_refused() {
    let _: [V; 21] = concat(&[&reals(), &others()]);
}

#[test]
fn facts_about_an_fmu_are_those_that_were_set() {
    let plain = ModelInfo::new("Sample");
    assert_eq!((plain.model_identifier, plain.model_name, plain.description), ("Sample", "Sample", ""));
    assert_eq!(plain.default_tolerance(1e-6), plain, "without an experiment there is no tolerance");

    let info = ModelInfo::new("Sample").model_name("A sample").description("d").author("a").version("1.2.3");
    let info = info.copyright("c").license("l").generation_tool("g").default_experiment(1.0, 2.0, 0.1);
    let info = info.default_tolerance(1e-6).can_serialize().directional_derivatives().model_exchange(3);
    let found = format!("{:?}", info.constant_step_size());
    let wanted = "ModelInfo { model_identifier: \"Sample\", model_name: \"A sample\", description: \"d\", author: \"a\", \
        version: \"1.2.3\", copyright: \"c\", license: \"l\", generation_tool: \"g\", default_experiment: \
        Some(DefaultExperiment { start_time: 1.0, stop_time: 2.0, step_size: 0.1, tolerance: Some(1e-6) }), \
        can_serialize: true, directional_derivatives: true, model_exchange: Some(3), stops_at_events: false, terminals: [], variable_step_size: false }";
    assert_eq!(found, wanted);
}

#[test]
fn a_model_without_further_hooks_takes_everything_but_model_exchange_and_states() {
    let (mut sample, log) = (Sample::new(), Logger::silent());
    let experiment = Experiment { start_time: 0.0, stop_time: None, tolerance: None };
    sample.update();
    assert!(sample.setup_experiment(&experiment, &log).is_ok());
    assert!(sample.initialize(&log).is_ok() && sample.terminate(&log).is_ok());
    let error = sample.place(0.0, None).unwrap_err();
    assert_eq!(error.to_string(), "this FMU does not offer model exchange");
    assert_eq!(sample.event_indicators(), [0.0; 0]);
    let outcome = sample.handle_events(&log).unwrap();
    assert_eq!((outcome.states_changed, outcome.next_event_time), (false, None));
    assert_eq!(sample.write_state(&mut StateWriter::default()), Err(StateError::Unsupported));
    assert_eq!(Sample::read_state(&mut StateReader::new(&[]), &Sample::new()), Err(StateError::Unsupported));
    assert_eq!(sample, Sample::default());
}
