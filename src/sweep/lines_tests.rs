//! What is written can be read again: long texts, line ends in the names of an FMU, results spoilt while they were written,
//! and shards that are merged.

use std::fs;
use std::path::Path;

use super::column::Type;
use super::document::DOCUMENT;
use super::folder::RESULTS;
use super::lines::LONGEST;
use super::plan::Results;
use super::record::{Found, Record};
use super::{Request, Sweep, SweepError, Times, Vary, merge};
use fmu_import::{ModelDescription, Value};

/// An FMU with a text, an enumeration, and as many outputs as asked for with names of as many letters.
fn description(outputs: usize, letters: usize) -> ModelDescription {
    let scalar = |name: &str, reference: usize, causality: &str, kind: &str| {
        format!(
            "<ScalarVariable name='{name}' valueReference='{reference}' causality='{causality}' {}>{kind}</ScalarVariable>",
            if causality == "parameter" { "variability='fixed' initial='exact'" } else { "variability='discrete'" }
        )
    };
    let mut variables = scalar("label", 0, "parameter", "<String start='text'/>");
    variables += &scalar("two&#10;lines", 1, "output", "<Enumeration declaredType='Mode'/>");
    let mut units = "<Unknown index='2'/>".to_owned();
    for output in 0..outputs {
        variables += &scalar(&format!("y{output:0letters$}"), 2 + output, "output", "<Integer/>");
        units.extend(["<Unknown index='", &(output + 3).to_string(), "'/>"]);
    }
    let text = format!(
        "<fmiModelDescription fmiVersion='2.0' modelName='Toy' guid='toy'><CoSimulation modelIdentifier='Toy'/>\
         <TypeDefinitions><SimpleType name='Mode'><Enumeration><Item name='on&#13;&#10;off' value='1'/></Enumeration>\
         </SimpleType></TypeDefinitions><ModelVariables>{variables}</ModelVariables>\
         <ModelStructure><Outputs>{units}</Outputs></ModelStructure></fmiModelDescription>"
    );
    ModelDescription::parse(text.as_bytes(), "test").unwrap()
}

/// A sweep over the text, of one run for each of `values`, that records all outputs.
fn sweep(description: &ModelDescription, values: &[&str]) -> Result<Sweep, SweepError> {
    let values = toml::Value::Array(values.iter().map(|value| (*value).into()).collect());
    let vary = Vary::all_of(&toml::Table::from_iter([("label".to_owned(), values)])).unwrap();
    let is_recorded = |name: &str| name != "label";
    let names = description.variables.iter().map(|variable| variable.name.clone());
    let times = Times { until: 1.0, step: None, window: [0.0, 1.0] };
    Sweep::new(&Request {
        vary,
        record: names.filter(|name| is_recorded(name)).collect(),
        ..Request::new("toy".to_owned(), description, Vec::new(), times)
    })
}

fn recorded(value: Value) -> Results {
    Results { averages: None, recorded: vec![value] }
}

/// Opens the results of `sweep` with these bytes of them in the folder; where it would go on, or why it does not.
fn resumed(sweep: &Sweep, folder: &Path, bytes: &[u8]) -> Result<u64, String> {
    fs::write(folder.join(DOCUMENT), sweep.document()).unwrap();
    fs::write(folder.join("sweep.csv.part"), bytes).unwrap();
    match Record::open(folder, sweep, None, false) {
        Ok(Found::Unfinished(record)) => Ok(record.next()),
        Ok(Found::Complete { .. }) => Err("complete".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn a_run_whose_line_would_be_too_long_has_failed_and_is_gone_on_behind() {
    let sweep = sweep(&description(0, 1), &["a", "b"]).unwrap();
    let long = sweep.line(&sweep.run(0), &Ok(recorded(Value::String("x".repeat(3_000_000)))));
    let reason = "its results take 3000010 bytes, and a line has at most 1048576";
    assert_eq!(String::from_utf8_lossy(&long), format!("0,0,0,a,,\"{reason}\"\n"));
    let short = sweep.line(&sweep.run(0), &Ok(recorded(Value::String("x".repeat(LONGEST - 10)))));
    assert!(short.len() == LONGEST && short.ends_with(b",\n"), "{} bytes", short.len());
    let failed = sweep.line(&sweep.run(1), &Err("\"".repeat(3_000_000)));
    assert!(failed.len() < LONGEST, "{} bytes", failed.len());
    let folder = tempfile::tempdir().unwrap();
    for line in [long, short] {
        let bytes = [&b"run,point,sample,label,two lines,error\n"[..], &line, &failed[..9]].concat();
        assert_eq!(resumed(&sweep, folder.path(), &bytes), Ok(1));
    }
}

#[test]
fn a_heading_or_values_that_are_too_long_are_refused_before_the_first_run() {
    let message = |sweep: Result<Sweep, SweepError>| sweep.err().unwrap().to_string();
    let many = description(5000, 220);
    assert_eq!(
        message(sweep(&many, &["a"])),
        "--record: the heading of 5006 columns takes 1110039 bytes; at most 1048576"
    );
    let long = "x".repeat(LONGEST);
    let refused = message(sweep(&description(0, 1), &["a", &long]));
    assert_eq!(refused, "--vary label: the values of a run take up to 1114220 bytes of its line; at most 1048576");
}

#[test]
fn line_ends_in_names_of_columns_and_items_leave_a_line_a_row() {
    let sweep = sweep(&description(0, 1), &["a"]).unwrap();
    let item = Value::Enumeration { value: 1, name: "on\r\noff".to_owned() };
    let line = sweep.line(&sweep.run(0), &Ok(recorded(item)));
    assert_eq!(String::from_utf8_lossy(&line), "0,0,0,a,on off,\n");
    let names: Vec<_> = sweep.columns().iter().map(|column| (column.name.as_str(), column.kind)).collect();
    assert_eq!(names[4], ("two lines", Type::Text));
    let folder = tempfile::tempdir().unwrap();
    let bytes = [&b"run,point,sample,label,two lines,error\n"[..], &line].concat();
    assert_eq!(resumed(&sweep, folder.path(), &bytes), Ok(1));
}

#[test]
fn whole_lines_that_are_not_those_expected_are_kept_and_named() {
    let sweep = sweep(&description(0, 1), &["a", "b", "c"]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let kept = folder.path().join("sweep.csv.unfinished");
    let heading = "run,point,sample,label,two lines,error\n";
    for (bytes, said) in [
        (format!("{heading}0,0,0,a,,\n2,2,0,c,,\n1,1,0,b,,\n"), "line 3 is not run 1 of runs 0 to 2"),
        (format!("{heading}0,0,0,a,,\n1,1,x,b,,\n"), "line 3, of run 1, has sample = \"x\", which is not of its type"),
        ("run,point\n0,0,0,a,,\n".to_owned(), "its first line is not the heading of this sweep"),
    ] {
        let message = resumed(&sweep, folder.path(), bytes.as_bytes()).unwrap_err();
        let expected = format!("sweep.csv.unfinished: {said}; no interruption leaves a whole line like that");
        assert!(message.contains(&expected), "{message}");
        assert_eq!(fs::read(&kept).unwrap(), bytes.as_bytes(), "something was thrown away");
    }
}

#[test]
fn a_merge_of_cells_of_other_types_names_them_and_leaves_nothing_behind() {
    let sweep = sweep(&description(1, 1), &["a", "b"]).unwrap();
    let guard = tempfile::tempdir().unwrap();
    let [shards, output] = ["shards", "merged"].map(|name| guard.path().join(name));
    fs::create_dir(&shards).unwrap();
    fs::write(shards.join(DOCUMENT), sweep.document()).unwrap();
    let heading = "run,point,sample,label,two lines,y0,error\n";
    fs::write(shards.join("sweep.1-of-2.csv"), format!("{heading}0,0,0,a,,7,\n")).unwrap();
    for (line, said) in [
        ("1,1,0,b,,seven,\n", "sweep.2-of-2.csv: line 2, of run 1, has y0 = \"seven\", which is not of its type"),
        ("1,1,0,b,,7,,\n", "sweep.2-of-2.csv: line 2, of run 1, is no row of 7 cells"),
    ] {
        fs::write(shards.join("sweep.2-of-2.csv"), format!("{heading}{line}")).unwrap();
        let message = merge(std::slice::from_ref(&shards), &output).unwrap_err().to_string();
        assert!(message.contains(said), "{message}");
        assert_eq!(fs::read_dir(&output).unwrap().count(), 0, "{said}");
    }
    // What another merge left there stays.
    fs::write(output.join(DOCUMENT), sweep.document()).unwrap();
    merge(std::slice::from_ref(&shards), &output).unwrap_err();
    assert!(output.join(DOCUMENT).exists() && !output.join("sweep.csv.part").exists());
    fs::write(shards.join("sweep.2-of-2.csv"), format!("{heading}1,1,0,b,,8,\n")).unwrap();
    merge(&[shards], &output).unwrap();
    assert!(output.join(RESULTS).exists());
}
