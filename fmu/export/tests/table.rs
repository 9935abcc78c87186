//! What the constructors of a table and of the facts about an FMU declare. The compiler evaluates those of a `static`; here they run.

use fmu_export::{
    Causality, EnumerationType, Experiment, Kind, Logger, ModelInfo, Slave, SlaveError, StateError, StateReader,
    StateWriter, Variability, Variable, concat,
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

impl Slave for Sample {
    const INFO: ModelInfo = ModelInfo::new("Sample");

    fn variables() -> &'static [V] {
        &[]
    }

    fn new() -> Self {
        Self::default()
    }

    fn do_step(&mut self, _t: f64, _h: f64, _log: &Logger) -> Result<(), SlaveError> {
        Ok(())
    }
}

static COLOUR: EnumerationType =
    EnumerationType { name: "Colour", description: "Of the ball", items: &[("red", "Like a rose"), ("blue", "")] };

fn set_real(sample: &mut Sample, value: f64) {
    sample.real = value;
}

fn set_integer(sample: &mut Sample, value: i32) {
    sample.integer = value;
}

fn set_on(sample: &mut Sample, value: bool) {
    sample.on = value;
}

fn set_text(sample: &mut Sample, value: &str) {
    value.clone_into(&mut sample.text);
}

/// Type, causality and variability of a row, and whether it starts with a value of its own or is calculated.
fn words(row: &V) -> String {
    let initial = row.initial().map_or("-", fmu_export::Initial::as_str);
    let start = if row.kind().has_start() { "start" } else { "no start" };
    let (causality, variability) = (row.causality().as_str(), row.variability().as_str());
    format!("{}: {} {causality} {variability} {initial}, {start}", row.name(), row.kind().type_name())
}

fn reals() -> Vec<V> {
    vec![
        V::parameter("a", "m", 1.0, "").access(|it| it.real, set_real),
        V::parameter("b", "m", 1.0, "").tunable().access(|it| it.real, set_real),
        V::calculated_parameter("c", "m", "").get(|it| it.real),
        V::input("d", "m", 1.0, "").access(|it| it.real, set_real),
        V::input("e", "m", 1.0, "").discrete().access(|it| it.real, set_real),
        V::output("f", "m", "").get(|it| it.real),
        V::output("g", "m", "").local().get(|it| it.real),
        V::independent("t", "").get(|it| it.real),
    ]
}

fn others() -> Vec<V> {
    vec![
        V::integer_parameter("i", 3, "").access(|it| it.integer, set_integer),
        V::integer_input("j", 3, "").access(|it| it.integer, set_integer),
        V::integer_output("k", "").get(|it| it.integer),
        V::boolean_parameter("l", true, "").access(|it| it.on, set_on),
        V::boolean_input("m", true, "").access(|it| it.on, set_on),
        V::boolean_output("n", "").get(|it| it.on),
        V::string_parameter("o", "x", "").access(|it| it.text.clone(), set_text),
        V::string_input("p", "x", "").access(|it| it.text.clone(), set_text),
        V::string_output("q", "").get(|it| it.text.clone()),
        V::enumeration_parameter("r", &COLOUR, 2, "").access(|it| it.integer, set_integer),
        V::enumeration_input("s", &COLOUR, 2, "").access(|it| it.integer, set_integer),
        V::enumeration_output("u", &COLOUR, "").get(|it| it.integer),
    ]
}

#[test]
fn each_constructor_declares_what_it_is_called_after() {
    let found: Vec<_> = reals().iter().chain(&others()).map(words).collect();
    let wanted = [
        "a: Real parameter fixed exact, start",
        "b: Real parameter tunable exact, start",
        "c: Real calculatedParameter fixed calculated, no start",
        "d: Real input continuous -, start",
        "e: Real input discrete -, start",
        "f: Real output continuous calculated, no start",
        "g: Real local continuous calculated, no start",
        "t: Real independent continuous -, no start",
        "i: Integer parameter fixed exact, start",
        "j: Integer input discrete -, start",
        "k: Integer output discrete calculated, no start",
        "l: Boolean parameter fixed exact, start",
        "m: Boolean input discrete -, start",
        "n: Boolean output discrete calculated, no start",
        "o: String parameter fixed exact, start",
        "p: String input discrete -, start",
        "q: String output discrete calculated, no start",
        "r: Enumeration parameter fixed exact, start",
        "s: Enumeration input discrete -, start",
        "u: Enumeration output discrete calculated, no start",
    ];
    assert_eq!(found, wanted);
}

#[test]
fn a_real_has_no_bounds_unless_it_is_given_some() {
    let plain = V::parameter("a", "m", 1.0, "").access(|it| it.real, set_real);
    let Kind::Real(plain) = plain.kind() else { panic!("no Real") };
    assert_eq!((plain.min, plain.max, plain.nominal), (f64::NEG_INFINITY, f64::INFINITY, None));
    assert!(!plain.infinity_allowed && plain.input_derivatives.is_none() && plain.output_derivatives.is_none());

    let bounded = V::parameter("a", "m", 1.0, "").min(0.5).max(2.0).nominal(1.5).infinity_allowed();
    let bounded = bounded.access(|it| it.real, set_real);
    let Kind::Real(bounded) = bounded.kind() else { panic!("no Real") };
    assert_eq!((bounded.unit, bounded.start), ("m", Some(1.0)));
    assert_eq!((bounded.min, bounded.max, bounded.nominal), (0.5, 2.0, Some(1.5)));
    assert!(bounded.infinity_allowed);

    let counter = V::integer_parameter("n", 3, "").min(1).max(9).access(|it| it.integer, set_integer);
    let Kind::Integer(counter) = counter.kind() else { panic!("no Integer") };
    assert_eq!((counter.start, counter.min, counter.max), (Some(3), 1, 9));
}

#[test]
fn accessors_are_those_that_the_row_was_finished_with() {
    let mut sample = Sample::new();
    for row in reals().iter().chain(&others()) {
        let written = row.causality() == Causality::Parameter || row.causality() == Causality::Input;
        match row.kind() {
            Kind::Real(it) => assert_eq!(it.set.map(|set| set(&mut sample, 4.0)).is_some(), written, "{}", row.name()),
            Kind::Integer(it) => assert_eq!(it.set.map(|set| set(&mut sample, 5)).is_some(), written, "{}", row.name()),
            Kind::Boolean(it) => {
                assert_eq!(it.set.map(|set| set(&mut sample, true)).is_some(), written, "{}", row.name());
            }
            Kind::String(it) => {
                assert_eq!(it.set.map(|set| set(&mut sample, "y")).is_some(), written, "{}", row.name());
            }
            Kind::Enumeration(it) => assert_eq!(it.set.is_some(), written, "{}", row.name()),
        }
    }
    for row in reals().iter().chain(&others()) {
        match row.kind() {
            Kind::Real(it) => assert_eq!((it.get)(&sample), 4.0, "{}", row.name()),
            Kind::Integer(it) => assert_eq!((it.get)(&sample), 5, "{}", row.name()),
            Kind::Boolean(it) => assert!((it.get)(&sample), "{}", row.name()),
            Kind::String(it) => assert_eq!((it.get)(&sample), "y", "{}", row.name()),
            Kind::Enumeration(it) => {
                assert_eq!(((it.get)(&sample), it.of.name), (5, "Colour"), "{}", row.name());
                assert_eq!(it.of.item(2), Some("blue"));
            }
        }
    }
}

#[test]
fn derivatives_and_dependencies_stay_with_their_row() {
    let input = V::input("u", "m", 0.0, "").input_derivatives(2, |it, order, value| it.rate = f64::from(order) * value);
    let input = input.access(|it| it.real, set_real);
    let Kind::Real(spec) = input.kind() else { panic!("no Real") };
    let (order, set) = spec.input_derivatives.unwrap();
    let mut sample = Sample::new();
    set(&mut sample, 2, 3.0);
    assert_eq!((order, sample.rate), (2, 6.0));

    let output = V::output("der(y)", "m/s", "").derivative_of("y").depends_on(&["u"]);
    let output = output.output_derivatives(1, |it, order| f64::from(order) * it.rate).get(|it| it.real);
    assert_eq!((output.derivative_of(), output.dependencies()), (Some("y"), Some(&["u"][..])));
    let Kind::Real(spec) = output.kind() else { panic!("no Real") };
    let (order, get) = spec.output_derivatives.unwrap();
    assert_eq!((order, get(&sample, 3)), (1, 18.0));
}

#[test]
fn groups_of_rows_become_one_table_in_their_order() {
    let (reals, others) = (reals(), others());
    let table: [V; 20] = concat(&[&reals, &others]);
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
    assert!(plain.variable_step_size && !plain.can_serialize && !plain.directional_derivatives);
    assert_eq!((plain.model_exchange, plain.default_experiment), (None, None));
    assert_eq!(plain.default_tolerance(1e-6).default_experiment, None, "without an experiment there is no tolerance");

    let info = ModelInfo::new("Sample").model_name("A sample").description("d").author("a").version("1.2.3");
    let info = info.copyright("c").license("l").generation_tool("g").default_experiment(1.0, 2.0, 0.1);
    let info = info.default_tolerance(1e-6).can_serialize().directional_derivatives().model_exchange(3);
    let info = info.constant_step_size();
    let texts = [info.model_name, info.description, info.author, info.version];
    assert_eq!(texts, ["A sample", "d", "a", "1.2.3"]);
    assert_eq!([info.copyright, info.license, info.generation_tool], ["c", "l", "g"]);
    let experiment = info.default_experiment.unwrap();
    assert_eq!((experiment.start_time, experiment.stop_time, experiment.step_size), (1.0, 2.0, 0.1));
    assert_eq!((experiment.tolerance, info.model_exchange), (Some(1e-6), Some(3)));
    assert!(info.can_serialize && info.directional_derivatives && !info.variable_step_size);
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
    assert_eq!(Sample::read_state(&mut StateReader::new(&[])), Err(StateError::Unsupported));
    assert_eq!(sample, Sample::default());
}
