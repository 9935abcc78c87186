//! `modelDescription.xml`: a golden file, and the rules that exporters get wrong.
//!
//! Golden files `data/Toy.xml`, `data/Toy3.xml` and `data/Toy.terminalsAndIcons.xml`: written by this test with
//! `UPDATE_GOLDEN=1`, validated against the schemas of FMI 2.0 and 3.0 with FMPy 0.3.32 by hand.
#![cfg(feature = "model-description")]

use core::cell::Cell;
use core::ffi::{CStr, c_char, c_int, c_void};

use crate::common::{slave, toy::Toy};
use fmu_export::abi::describe::Take;
use fmu_export::{
    Causality, EnumerationType, Guid, Kind, ModelInfo, Slave, Standard, Variable, model_description,
    terminals_and_icons,
};
use videg_golden::Golden;

fn text() -> String {
    model_description::<Toy>(Standard::Fmi2).expect("a sound table")
}

/// A golden file of this test.
macro_rules! golden {
    ($file:literal, $text:expr) => {
        let command = "cargo test -p fmu-export --features model-description --test functions model_description";
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/functions/data/", $file);
        Golden::new("UPDATE_GOLDEN", command).file(path, $text);
    };
}

#[test]
fn the_texts_are_as_in_the_golden_files() {
    golden!("Toy.xml", &text());
    golden!("Toy3.xml", &model_description::<Toy>(Standard::Fmi3).expect("a sound table"));
    golden!("Toy.terminalsAndIcons.xml", &terminals_and_icons::<Toy>(false).expect("a sound table"));
}

#[test]
fn the_text_is_the_same_on_every_run_and_has_the_guid_of_the_library() {
    assert_eq!(text(), text());
    assert!(text().contains(&format!("guid=\"{}\"", Guid::of::<Toy>(Standard::Fmi2))));
}

#[test]
fn the_guid_is_a_uuid_in_braces() {
    let guid = Guid::of::<Toy>(Standard::Fmi2).to_string();
    let lengths: Vec<_> = guid.trim_matches(['{', '}']).split('-').map(str::len).collect();
    assert_eq!((lengths, guid.len()), (vec![8, 4, 4, 4, 12], 38));
}

#[test]
fn start_and_initial_stand_exactly_where_they_must() {
    let text = text();
    let rows: Vec<_> = text.split("<ScalarVariable ").skip(1).collect();
    let variables: Vec<_> = Toy::variables().iter().filter(|variable| variable.is_of(Standard::Fmi2)).collect();
    assert_eq!(rows.len(), variables.len());
    for (row, variable) in rows.iter().zip(variables) {
        let settable = matches!(variable.causality(), Causality::Parameter | Causality::Input);
        assert_eq!(row.contains(" start="), settable, "{}", variable.name());
        let silent = matches!(variable.causality(), Causality::Input | Causality::Independent);
        assert_eq!(row.contains(" initial="), !silent, "{}", variable.name());
        let continuous = row.contains("variability=\"continuous\"");
        assert!(!continuous || matches!(variable.kind(), Kind::Real(_)), "{}", variable.name());
    }
}

/// A model of one number that has the rows which a test sets: one type for all, as what writes a description is compiled for each.
#[derive(Clone, Default)]
struct Small(f64);

type V = Variable<Small>;

thread_local! {
    static ROWS: Cell<&'static [V]> = const { Cell::new(&[]) };
}

slave!(Small, ModelInfo::new("Small"), ROWS.get());

macro_rules! rows {
    ($($row:expr),*) => {{
        const ROWS: &[V] = &[$($row),*];
        ROWS
    }};
}

fn text_of(rows: &'static [V]) -> Result<String, String> {
    ROWS.set(rows);
    model_description::<Small>(Standard::Fmi2).map_err(|error| error.to_string())
}

#[test]
fn the_guid_changes_with_the_interface_but_not_with_a_description() {
    let guid = |rows| {
        ROWS.set(rows);
        Guid::of::<Small>(Standard::Fmi2)
    };
    let mut found = vec![guid(rows![V::parameter("a", "m", 1.0, "one").access(|m| m.0, |m, v| m.0 = v)])];
    let described = guid(rows![V::parameter("a", "m", 1.0, "other words").access(|m| m.0, |m, v| m.0 = v)]);
    assert_eq!(described, found[0]);
    for (k, rows) in [
        rows![V::parameter("b", "m", 1.0, "one").access(|m| m.0, |m, v| m.0 = v)],
        rows![V::parameter("a", "s", 1.0, "one").access(|m| m.0, |m, v| m.0 = v)],
        rows![V::parameter("a", "m", 2.0, "one").access(|m| m.0, |m, v| m.0 = v)],
        rows![V::parameter("a", "m", 1.0, "one").min(0.0).access(|m| m.0, |m, v| m.0 = v)],
        rows![V::parameter("a", "m", 1.0, "one").tunable().access(|m| m.0, |m, v| m.0 = v)],
        rows![V::input("a", "m", 1.0, "one").access(|m| m.0, |m, v| m.0 = v)],
        rows![V::output("a", "m", "one").get(|m| m.0)],
        rows![V::output("a", "m", "one").initially_depends_on(&[]).get(|m| m.0)],
    ]
    .into_iter()
    .enumerate()
    {
        let guid = guid(rows);
        assert!(!found.contains(&guid), "{k}");
        found.push(guid);
    }
}

#[test]
fn a_minimal_table_has_no_empty_elements() {
    let text = text_of(rows![V::parameter("a", "1", 1.0, "").access(|m| m.0, |m, v| m.0 = v)]).expect("a sound table");
    for element in ["UnitDefinitions", "TypeDefinitions", "DefaultExperiment", "Outputs", "description=\"\""] {
        assert!(!text.contains(element), "{element}");
    }
    assert!(text.contains("<ModelStructure"));
}

const TWINS: &[V] = rows![V::output("a", "1", "").get(|m| m.0), V::output("a", "1", "").get(|m| m.0)];

#[test]
fn mistakes_in_a_table_are_found_and_named() {
    static LAW: EnumerationType = EnumerationType { name: "Law", description: "", items: &[("a", "")] };
    static OTHER: EnumerationType = EnumerationType { name: "Law", description: "", items: &[("b", "")] };
    for (rows, mistake) in [
        (TWINS, "a: its name occurs twice"),
        (
            rows![V::parameter("a", "m", 1.0, "").min(2.0).access(|m| m.0, |m, v| m.0 = v)],
            "a: start 1: below its min 2 m",
        ),
        (
            rows![V::input("a", "m", 1.0, "").tunable().access(|m| m.0, |m, v| m.0 = v)],
            "a: a Real cannot be a tunable input",
        ),
        (
            rows![V::output("a", "m", "").depends_on(&["b"]).get(|m| m.0)],
            "a: it depends on b, which is not in the table",
        ),
        (
            rows![
                V::output("a", "m", "").get(|m| m.0),
                V::output("b", "m", "").initially_depends_on(&[&["a"]]).get(|m| m.0)
            ],
            "b: it initially depends on a, which is no input or parameter",
        ),
        (
            rows![V::enumeration_parameter("a", &LAW, 2, "").access(|_| 1, |_, _| ())],
            "a: start 2: no item of Law; allowed: 1 (a)",
        ),
        (
            rows![V::enumeration_output("a", &LAW, "").get(|_| 1), V::enumeration_output("b", &OTHER, "").get(|_| 1)],
            "b: there are two enumerations named Law",
        ),
        (rows![V::output("a", "m", "one\ntwo").get(|m| m.0)], "a: \"one\\ntwo\" contains a control character"),
        (
            rows![V::independent("t", "").get(|m| m.0), V::independent("u", "").get(|m| m.0)],
            "table: there are two independent variables",
        ),
        (
            rows![V::output("a", "1", "").reinit().get(|m| m.0)],
            "a: it jumps at events, but this FMU is not for model exchange",
        ),
        (rows![V::output("a", "", "").get(|m| m.0)], "a: its unit is empty; use \"1\" for none"),
    ] {
        assert_eq!(text_of(rows), Err(format!("the FMU is faulty: {mistake}")));
    }
}

#[test]
fn what_jumps_in_model_exchange_is_a_continuous_state() {
    #[derive(Clone, Default)]
    struct NoState(f64);
    slave!(NoState, ModelInfo::new("Small").model_exchange(0), {
        const { &[Variable::<NoState>::output("a", "1", "").reinit().get(|m| m.0)] }
    });
    let mistake = model_description::<NoState>(Standard::Fmi2).expect_err("a mistake").to_string();
    assert_eq!(mistake, "the FMU is faulty: a: it jumps at events, but is no continuous state");
}

/// Names and texts that the library gives a packager.
fn described(describe: impl FnOnce(*const c_char, c_int, Take, *mut c_void), icon: bool) -> Vec<(String, String)> {
    unsafe extern "C" fn take(context: *mut c_void, name: *const c_char, text: *const c_char) {
        let [name, text] = [name, text].map(|text| unsafe { CStr::from_ptr(text) }.to_str().expect("UTF-8").to_owned());
        unsafe { &mut *context.cast::<Vec<(String, String)>>() }.push((name, text));
    }
    let mut texts = Vec::new();
    describe(core::ptr::null(), icon.into(), take, (&raw mut texts).cast());
    texts
}

#[test]
fn the_library_gives_a_packager_the_same_texts_or_the_reason_why_not() {
    unsafe extern "C" {
        fn fmu_export_describe_1(resources: *const c_char, icon: c_int, take: Take, context: *mut c_void);
    }
    for icon in [false, true] {
        let texts = described(|r, i, take, context| unsafe { fmu_export_describe_1(r, i, take, context) }, icon);
        let expected = [
            ("fmi2/modelDescription.xml", text()),
            ("fmi3/modelDescription.xml", model_description::<Toy>(Standard::Fmi3).unwrap()),
            ("fmi3/terminalsAndIcons/terminalsAndIcons.xml", terminals_and_icons::<Toy>(icon).unwrap()),
        ];
        assert_eq!(texts, expected.map(|(name, text)| (name.to_owned(), text)));
    }
    ROWS.set(TWINS);
    let of_twins = fmu_export::describe::fmu_export_describe_1::<Small>;
    let texts = described(|r, i, take, context| unsafe { of_twins(r, i, take, context) }, false);
    assert_eq!(texts, [("error".to_owned(), "the FMU is faulty: a: its name occurs twice".to_owned())]);
}
