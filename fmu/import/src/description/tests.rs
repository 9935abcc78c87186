use crate::{Causality, FmiError, Initial, Kind, ModelDescription, Value, Variability};

const GOOD: &str = include_str!("../testdata/good.xml");

fn parse(text: &str) -> Result<ModelDescription, String> {
    ModelDescription::parse(text.as_bytes(), "test").map_err(|error| match error {
        FmiError::Description { cause, .. } => cause,
        other => panic!("{other}"),
    })
}

#[test]
fn reads_what_the_file_says() {
    let description = parse(GOOD).unwrap();
    assert_eq!(description.model_name, "Toy <model>");
    assert_eq!(description.guid, "{guid}");
    assert_eq!(description.co_simulation.model_identifier, "Toy");
    assert!(description.co_simulation.can_get_and_set_fmu_state);
    assert!(!description.co_simulation.can_interpolate_inputs);
    assert_eq!(description.co_simulation.max_output_derivative_order, 2);
    assert_eq!(description.default_experiment.stop_time, Some(10.0));
    assert_eq!(description.default_experiment.tolerance, None);
    let unit = &description.units[0];
    assert_eq!((unit.name.as_str(), unit.base.as_ref().unwrap().exponents[0]), ("kg", 1));
    assert_eq!(description.variables.len(), 7);
    assert_eq!(description.output_variables().map(|v| v.name.as_str()).collect::<Vec<_>>(), ["position"]);
}

#[test]
fn variables_take_defaults_and_the_attributes_of_their_type() {
    let description = parse(GOOD).unwrap();
    let mass = description.variable("mass").unwrap();
    let unit = Some("kg".into());
    assert_eq!(mass.kind, Kind::Real { unit, start: Some(1.5), min: Some(0.0), max: Some(10.0) });
    assert_eq!(mass.initial, Some(Initial::Exact));
    let force = description.variable("force").unwrap();
    assert_eq!((force.causality, force.variability), (Causality::Input, Variability::Continuous));
    assert_eq!(force.initial, None);
    let position = description.variable("position").unwrap();
    assert_eq!(position.initial, Some(Initial::Calculated));
    assert!(!position.is_settable());
    let law = description.variable("law").unwrap();
    assert_eq!(description.enumeration(law).unwrap().items[1].name, "compliant");
    assert_eq!(description.variable("enabled").unwrap().variability, Variability::Fixed);
    let start = |name| description.start(description.variable(name).unwrap());
    assert_eq!(start("mass"), Some(Value::Real(1.5)));
    assert_eq!(start("seed"), Some(Value::Integer(7)));
    assert_eq!(start("enabled"), Some(Value::Boolean(true)));
    assert_eq!(start("label"), Some(Value::String("a & b".to_owned())));
    assert_eq!(start("law"), Some(Value::Enumeration { value: 1, name: "impulsive".to_owned() }));
    assert_eq!(start("position"), None);
}

#[test]
fn an_unknown_variable_is_answered_with_the_nearest() {
    let error = parse(GOOD).unwrap().variable("Mas").unwrap_err();
    assert_eq!(error.to_string(), "model Toy <model> has no variable \"Mas\"; did you mean \"mass\"?");
}

#[test]
fn declared_latin_1_is_read() {
    let text = GOOD.replacen("UTF-8", "ISO-8859-1", 1).replacen("{guid}", "{gr\u{fc}n}", 1);
    let latin: Vec<u8> = text.chars().map(|char| u8::try_from(char).unwrap()).collect();
    assert_eq!(ModelDescription::parse(&latin, "test").unwrap().guid, "{gr\u{fc}n}");
    assert!(parse(&GOOD.replacen("UTF-8", "ISO-8859-1", 1)).is_ok());
}

#[test]
fn variables_share_the_texts_of_their_type() {
    let variable = |name: &str| {
        format!("<ScalarVariable name=\"{name}\" valueReference=\"9\"><Real declaredType=\"Mass\"/></ScalarVariable>")
    };
    let two = format!("<ModelVariables>{}{}", variable("one"), variable("two"));
    let description = parse(&GOOD.replacen("<ModelVariables>", &two, 1).replace("<Unknown index=\"2\"/>", "")).unwrap();
    let unit = |name: &str| match &description.variable(name).unwrap().kind {
        Kind::Real { unit: Some(unit), .. } => std::sync::Arc::clone(unit),
        kind => panic!("{kind:?}"),
    };
    assert!(std::sync::Arc::ptr_eq(&unit("one"), &unit("two")));
}

#[test]
fn a_byte_order_mark_and_unknown_parts_are_tolerated() {
    let text = format!("\u{feff}{}", GOOD.replacen("<ModelVariables>", "<New a='1'><b/></New><ModelVariables>", 1));
    assert_eq!(parse(&text).unwrap().variables.len(), 7);
}

/// Replaces one part of the good description; says what is told of it.
fn told(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    parse(&GOOD.replacen(from, to, 1)).unwrap_err()
}

#[test]
fn missing_and_bad_parts_are_named_with_place_found_and_allowed() {
    let entities = "?><!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>";
    let long = |name: &str| format!("{name}=\"{}\"", "k".repeat(1025));
    let second = format!("{}<fmiModelDescription fmiVersion=\"2.0\"/>", "</fmiModelDescription>");
    for (from, to, part) in [
        ("guid=\"{guid}\"", "", "fmiModelDescription has no guid"),
        ("modelIdentifier=\"Toy\"", "", "CoSimulation has no modelIdentifier"),
        ("valueReference=\"0\"", "", "variable \"mass\" has no valueReference"),
        ("declaredType=\"Law\"", "", "variable \"law\" has no declaredType"),
        ("fmiVersion=\"2.0\"", "fmiVersion=\"1.0\"", "fmiVersion is \"1.0\", allowed is \"2.0\" or \"3.0\""),
        ("start=\"1.5\"", "start=\"heavy\"", "variable \"mass\": start is \"heavy\", allowed is a number"),
        ("causality=\"input\"", "causality=\"in\"", "allowed is parameter, calculatedParameter, input"),
        ("index=\"2\"", "index=\"99\"", "index is \"99\", allowed is 1 .. 7"),
        ("modelIdentifier=\"Toy\"", "modelIdentifier=\"../../evil\"", "modelIdentifier is \"../../evil\""),
        ("modelIdentifier=\"Toy\"", "modelIdentifier=\"\"", "allowed is a C identifier"),
        ("declaredType=\"Law\"", "declaredType=\"Lex\"", "declaredType is \"Lex\""),
        ("unit=\"kg\"", &long("unit"), "kk\", allowed is at most 1024 bytes"),
        ("name=\"compliant\"", &long("name"), "kk\", allowed is at most 1024 bytes"),
        ("name=\"force\"", "name=\"mass\"", "two variables are named \"mass\""),
        ("?>", entities, "has a DOCTYPE, which is not allowed"),
        ("{guid}", "&xxe;", "the model description cannot be read: "),
        ("</fmiModelDescription>", &second, "the document has a second root element"),
    ] {
        let found = told(from, to);
        assert!(found.contains(part), "{part}: {found}");
    }
    let exchange = parse(&GOOD.replace("CoSimulation", "ModelExchange")).unwrap_err();
    assert_eq!(exchange, "fmiModelDescription has no CoSimulation element, so it cannot co-simulate");
}

#[test]
fn documents_that_are_broken_or_beyond_bounds_are_refused() {
    let root = "<fmiModelDescription fmiVersion=\"2.0\">";
    for text in ["", "   ", root, &format!("{root}<a></b>")] {
        assert!(parse(text).unwrap_err().contains("is not well-formed XML at byte "), "{text}");
    }
    assert_eq!(parse("<html/>").unwrap_err(), "the root element is <html>, allowed is <fmiModelDescription>");
    let error = ModelDescription::parse(b"<fmiModelDescription \xff>", "x.fmu").unwrap_err().to_string();
    assert_eq!(error, "x.fmu: the model description is not UTF-8 (first bad byte at 21)");
    let huge = " ".repeat(usize::try_from(ModelDescription::MAX_BYTES).unwrap() + 1);
    assert_eq!(parse(&huge).unwrap_err(), "the model description has 33554433 bytes, allowed are 33554432");
    let deep = format!("{root}{}", "<a>".repeat(100_000));
    assert_eq!(parse(&deep).unwrap_err(), "the model description nests elements deeper than 64");
    // Refused before they are compared with each other.
    let many = (0..300_000).fold(String::new(), |all, k| all + &format!(" a{k}=''"));
    assert!(
        told("<ModelVariables>", &format!("<New{many}/><ModelVariables>"))
            .ends_with("<New> with more than 256 attributes")
    );
    assert!(parse(&format!("<fmiModelDescription{many} fmiVersion='2.0'>")).unwrap_err().ends_with("256 attributes"));
    let error = told("unit=\"m\"", &format!("unit=\"{}\"", "m".repeat(65_537)));
    assert!(error.ends_with("an element <Real> whose unit has 65537 bytes, allowed are 65536"), "{error}");
    let error = told("<ModelVariables>", &format!("<ModelVariables>{}", "<a/>".repeat(1_000_000)));
    assert_eq!(error, "the model description has more than 1000000 elements");
}

const GOOD_3: &str = include_str!("../testdata/good3.xml");

#[test]
fn fmi_3_has_other_elements_for_the_same_facts() {
    let description = parse(GOOD_3).unwrap();
    assert!(description.is_fmi_3() && !parse(GOOD).unwrap().is_fmi_3());
    assert_eq!(description.guid, "{token}");
    assert!(description.co_simulation.can_get_and_set_fmu_state);
    assert!(description.co_simulation.provides_directional_derivative);
    assert_eq!(description.output_variables().map(|it| it.name.as_str()).collect::<Vec<_>>(), ["tick", "position"]);
    let kind = |name: &str| {
        let variable = description.variable(name).unwrap();
        (variable.type_name, variable.kind.clone())
    };
    let unit = Some("kg".into());
    let mass = Kind::Real { unit, start: Some(1.5), min: Some(0.0), max: Some(10.0) };
    assert_eq!(kind("mass"), ("Float64", mass));
    let vector = Kind::Real { unit: None, start: Some(1.0), min: None, max: None };
    assert_eq!(kind("vector"), ("Float32", vector), "of an array the first value");
    assert_eq!(kind("count"), ("Int32", Kind::Integer { start: Some(2), min: Some(1), max: Some(9) }));
    assert_eq!(kind("large"), ("UInt64", Kind::Integer { start: Some(i64::MAX), min: None, max: None }));
    assert_eq!(description.start(description.variable("large").unwrap()), None, "beyond 32 bits");
    assert_eq!(kind("enabled"), ("Boolean", Kind::Boolean { start: Some(true) }));
    assert_eq!(kind("label"), ("String", Kind::String { start: Some("a & b".to_owned()) }));
    assert_eq!(kind("law"), ("Enumeration", Kind::Enumeration { start: Some(2) }));
    assert_eq!(description.enumeration(description.variable("law").unwrap()).unwrap().items[1].name, "compliant");
    assert_eq!((kind("blob"), kind("tick")), (("Binary", Kind::Other), ("Clock", Kind::Other)));
    assert_eq!(description.variable("time").unwrap().initial, None);
}

#[test]
fn bad_parts_of_fmi_3_are_named_with_place_found_and_allowed() {
    for (from, to, part) in [
        ("instantiationToken=\"{token}\"", "", "fmiModelDescription has no instantiationToken"),
        ("start=\"1 2 3\"", "start=\"one\"", "variable \"vector\": start is \"one\", allowed is a number"),
        (
            "start=\"18446744073709551615\"",
            "start=\"1e3\"",
            "variable \"large\": start is \"1e3\", allowed is an integer",
        ),
        ("declaredType=\"Law\"", "", "variable \"law\": declaredType is \"\", allowed is an enumeration"),
        (
            "<Output valueReference=\"9\"",
            "<Output valueReference=\"99\"",
            "valueReference is \"99\", allowed is that of a",
        ),
        ("<Output valueReference=\"9\"", "<Output", "ModelStructure/Output has no valueReference"),
        ("<Start value=", "<Start text=", "variable \"label\" has no value"),
        ("name=\"tick\"", "name=\"blob\"", "two variables are named \"blob\""),
    ] {
        let found = parse(&GOOD_3.replacen(from, to, 1)).unwrap_err();
        assert!(found.contains(part), "{part}: {found}");
    }
}
