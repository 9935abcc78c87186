use crate::{Causality, DescriptionError, FmiError, Initial, Kind, ModelDescription, Variability};

const GOOD: &str = include_str!("../testdata/good.xml");

fn parse(text: &str) -> Result<ModelDescription, DescriptionError> {
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
}

#[test]
fn an_unknown_variable_is_answered_with_the_nearest() {
    let error = parse(GOOD).unwrap().variable("Mas").unwrap_err();
    assert_eq!(error.to_string(), "model Toy <model> has no variable \"Mas\"; did you mean \"mass\"?");
}

#[test]
fn a_document_type_is_refused() {
    let bomb = GOOD.replacen("?>", "?><!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>", 1);
    assert_eq!(parse(&bomb).unwrap_err(), DescriptionError::Doctype);
}

#[test]
fn an_undefined_entity_is_refused() {
    let text = GOOD.replacen("{guid}", "&xxe;", 1);
    assert!(matches!(parse(&text).unwrap_err(), DescriptionError::Content { .. }));
}

#[test]
fn declared_latin_1_is_read() {
    let text = GOOD.replacen("UTF-8", "ISO-8859-1", 1).replacen("{guid}", "{gr\u{fc}n}", 1);
    let latin: Vec<u8> = text.chars().map(|char| u8::try_from(char).unwrap()).collect();
    assert_eq!(ModelDescription::parse(&latin, "test").unwrap().guid, "{gr\u{fc}n}");
    assert!(parse(&GOOD.replacen("UTF-8", "ISO-8859-1", 1)).is_ok());
}

#[test]
fn another_version_is_refused() {
    let error = parse(&GOOD.replacen("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\"", 1)).unwrap_err();
    assert_eq!(error, DescriptionError::Version { found: "3.0".to_owned() });
}

#[test]
fn another_root_is_refused() {
    let error = parse("<html/>").unwrap_err();
    assert_eq!(error, DescriptionError::Root { found: "html".to_owned() });
}

#[test]
fn missing_parts_are_named() {
    for (part, name) in [
        ("guid=\"{guid}\"", "fmiModelDescription has no guid"),
        ("modelIdentifier=\"Toy\"", "CoSimulation has no modelIdentifier"),
        ("valueReference=\"0\"", "variable \"mass\" has no valueReference"),
        ("declaredType=\"Law\"", "variable \"law\" has no declaredType"),
    ] {
        assert_eq!(parse(&GOOD.replacen(part, "", 1)).unwrap_err().to_string(), name);
    }
    let error = parse(&GOOD.replace("CoSimulation", "ModelExchange")).unwrap_err().to_string();
    assert!(error.contains("no CoSimulation"), "{error}");
}

#[test]
fn bad_values_are_named_with_place_found_and_allowed() {
    for (from, to, part) in [
        ("start=\"1.5\"", "start=\"heavy\"", "variable \"mass\": start is \"heavy\", allowed is a number"),
        ("causality=\"input\"", "causality=\"in\"", "allowed is parameter, calculatedParameter, input"),
        ("index=\"2\"", "index=\"99\"", "index is \"99\", allowed is 1 .. 7"),
        ("modelIdentifier=\"Toy\"", "modelIdentifier=\"../../evil\"", "modelIdentifier is \"../../evil\""),
        ("modelIdentifier=\"Toy\"", "modelIdentifier=\"\"", "allowed is a C identifier"),
        ("declaredType=\"Law\"", "declaredType=\"Lex\"", "declaredType is \"Lex\""),
        ("unit=\"kg\"", &format!("unit=\"{}\"", "k".repeat(1025)), "kk\", allowed is at most 1024 bytes"),
        ("name=\"compliant\"", &format!("name=\"{}\"", "c".repeat(1025)), "cc\", allowed is at most 1024 bytes"),
        ("name=\"force\"", "name=\"mass\"", "two variables are named \"mass\""),
    ] {
        let error = parse(&GOOD.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn broken_documents_are_errors() {
    for text in
        ["", "   ", "<fmiModelDescription fmiVersion=\"2.0\">", "<fmiModelDescription fmiVersion=\"2.0\"><a></b>"]
    {
        assert!(matches!(parse(text).unwrap_err(), DescriptionError::Syntax { .. }), "{text}");
    }
    let error = ModelDescription::parse(b"<fmiModelDescription \xff>", "x.fmu").unwrap_err().to_string();
    assert_eq!(error, "x.fmu: the model description is not UTF-8 (first bad byte at 21)");
}

#[test]
fn a_huge_or_deep_document_is_refused() {
    let huge = vec![b' '; usize::try_from(ModelDescription::MAX_BYTES).unwrap() + 1];
    let error = ModelDescription::parse(&huge, "test").unwrap_err().to_string();
    assert!(error.contains("has 33554433 bytes, allowed are 33554432"), "{error}");
    let deep = format!("<fmiModelDescription fmiVersion=\"2.0\">{}", "<a>".repeat(100_000));
    assert_eq!(parse(&deep).unwrap_err(), DescriptionError::Depth { allowed: 64 });
}

#[test]
fn attributes_without_end_are_refused_before_they_are_compared() {
    let many = (0..300_000).fold(String::new(), |all, k| all + &format!(" a{k}=''"));
    let error = parse(&GOOD.replacen("<ModelVariables>", &format!("<New{many}/><ModelVariables>"), 1)).unwrap_err();
    assert_eq!(error, DescriptionError::Attributes { element: "New".to_owned(), allowed: 256 });
    let error = parse(&format!("<fmiModelDescription{many} fmiVersion='2.0'>")).unwrap_err();
    assert_eq!(error, DescriptionError::Attributes { element: "fmiModelDescription".to_owned(), allowed: 256 });
}

#[test]
fn attributes_and_documents_that_swell_are_refused() {
    let error = parse(&GOOD.replacen("unit=\"m\"", &format!("unit=\"{}\"", "m".repeat(65_537)), 1)).unwrap_err();
    let (element, attribute) = ("Real".to_owned(), "unit".to_owned());
    assert_eq!(error, DescriptionError::Value { element, attribute, found: 65_537, allowed: 65_536 });
    let error = parse(&GOOD.replacen("<ModelVariables>", &format!("<ModelVariables>{}", "<a/>".repeat(1_000_000)), 1));
    assert_eq!(error.unwrap_err(), DescriptionError::Elements { allowed: 1_000_000 });
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
fn a_second_root_is_refused() {
    for more in ["<fmiModelDescription fmiVersion=\"2.0\"/>", "<a></a>"] {
        let error = parse(&format!("{GOOD}{more}")).unwrap_err();
        assert!(matches!(&error, DescriptionError::Syntax { cause, .. } if cause.contains("second root")), "{error}");
    }
}

#[test]
fn a_byte_order_mark_and_unknown_parts_are_tolerated() {
    let text = format!("\u{feff}{}", GOOD.replacen("<ModelVariables>", "<New a='1'><b/></New><ModelVariables>", 1));
    assert_eq!(parse(&text).unwrap().variables.len(), 7);
}
