//! What a sweep computes, and the tables that it writes.

use std::fs;
use std::path::Path;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, RowAccessor as _};
use serde_json::Value;

use crate::command::{NOISY, SHORT, column, done, folder, json, refused, rows, stderr, sweep, videg};

#[test]
fn a_run_of_a_sweep_is_the_run_that_simulate_makes() {
    let (_guard, folder) = folder();
    json(&mut sweep(&folder, &["--case", "fig15", "--vary", "membrane.restitution=0.3,0.7"]));
    let alone = tempfile::tempdir().unwrap();
    for (index, restitution) in ["0.3", "0.7"].iter().enumerate() {
        let setting = format!("membrane.restitution={restitution}");
        let mut simulate = videg(&["simulate", "--case", "fig15", "--set", &setting, "--output"]);
        let simulated = json(simulate.arg(alone.path().join(restitution)).args(SHORT));
        for name in ["average_voltage_gain", "average_power_eq13"] {
            let swept: f64 = column(&folder, name)[index].parse().unwrap();
            assert_eq!(swept, simulated[name].as_f64().unwrap(), "{name} at r = {restitution}");
        }
    }
}

#[test]
fn the_order_of_rows_is_that_of_runs_and_each_has_its_seed() {
    let (_guard, folder) = folder();
    let vary = ["--vary", "excitation.amplitude=0.3:0.5:3", "--vary", "contact.law=impulsive,compliant"];
    let said = json(sweep(&folder, &vary).args(["--samples", "2", "--seed", "40"]));
    assert_eq!((&said["points"], &said["runs"], &said["failed"]), (&6.into(), &12.into(), &0.into()));
    let first: Vec<_> = rows(&folder).iter().map(|row| row[..6].join(",")).collect();
    assert_eq!(first[0], "run,point,sample,excitation.amplitude,contact.law,excitation.seed");
    assert_eq!(first[1..4], ["0,0,0,0.3,impulsive,40", "1,0,1,0.3,impulsive,41", "2,1,0,0.3,compliant,42"]);
    assert_eq!(first[12], "11,5,1,0.5,compliant,51");
    assert_eq!(rows(&folder)[0][6..], ["average_voltage_gain", "average_power_eq13", "impacts", "error"]);
    let mut common = sweep(&folder, &vary);
    done(common.args(["--samples", "2", "--seed", "40", "--common-seeds", "--fresh"]));
    assert_eq!(column(&folder, "excitation.seed"), ["40", "41"].repeat(6));
}

#[test]
fn the_model_itself_and_its_fmu_give_the_same_bytes() {
    done(&mut videg(&["fmu", "build"]));
    let archive = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fmu/VibroImpactHarvester.fmu");
    let (_guard, folder) = folder();
    let [built_in, fmu] = ["a", "b"].map(|name| folder.join(name));
    let what =
        ["--vary", "membrane.restitution=0.2:1:5", "--vary", "contact.law=impulsive,compliant", "--samples", "2"];
    let what = [&what[..], &NOISY, &["--window", "0.3,1.7"]].concat();
    done(&mut sweep(&built_in, &what));
    done(sweep(&fmu, &what).arg("--fmu").arg(archive));
    let [a, b] = [&built_in, &fmu].map(|folder| fs::read_to_string(folder.join("sweep.csv")).unwrap());
    assert_eq!(a, b);
    // What the model itself does not offer is recorded through its FMU: the rest stays as it is.
    let recorded = folder.join("c");
    done(sweep(&recorded, &what).args(["--record", "impact.count", "--record", "contact.resting"]));
    for name in ["average_voltage_gain", "average_power_eq13", "impacts"] {
        assert_eq!(column(&built_in, name), column(&recorded, name));
    }
    assert!(column(&recorded, "impact.count").iter().all(|count| count.parse::<i32>().unwrap() > 3));
    assert!(column(&recorded, "contact.resting").iter().all(|resting| resting == "false"));
}

#[test]
fn without_a_circuit_the_membranes_have_the_voltage_of_the_supply() {
    let (_guard, folder) = folder();
    let [built_in, recorded, given] = ["a", "b", "c"].map(|name| folder.join(name));
    let feedback = ["--set", "contact.law=compliant", "--set", "contact.electrostaticFeedback=true"];
    let what = [&feedback[..], &["--vary", "biasVoltage=1000,9000"]].concat();
    done(&mut sweep(&built_in, &what));
    done(sweep(&recorded, &what).args(["--record", "left.electricField", "--record", "impact.count"]));
    let gains = ["average_voltage_gain", "impacts"].map(|name| column(&built_in, name));
    assert_eq!(gains, ["average_voltage_gain", "impacts"].map(|name| column(&recorded, name)));
    let fields: Vec<f64> = column(&recorded, "left.electricField").iter().map(|text| text.parse().unwrap()).collect();
    assert!(fields[1] > 5.0 * fields[0], "{fields:?}");
    // A voltage that is given counts.
    let both = ["--set", "left.voltage=0", "--set", "right.voltage=0", "--record", "left.electricField"];
    done(sweep(&given, &what).args(both));
    assert_eq!(column(&given, "left.electricField"), ["0.0", "0.0"]);
}

#[test]
fn any_fmu_is_swept_once_it_is_said_what_to_record() {
    done(&mut videg(&["fmu", "build"]));
    let archive = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fmu/HarvestingCircuit.fmu");
    let archive = archive.to_str().unwrap();
    let (_guard, folder) = folder();
    let what = ["--fmu", archive, "--vary", "load.resistance=log:1e8:1e10:3"];
    let recorded = [&what[..], &["--record", "load.voltage", "--record", "supply.energy", "--step", "0.1"]].concat();
    assert_eq!(json(&mut sweep(&folder, &recorded))["case"], "HarvestingCircuit");
    let heading = ["run", "point", "sample", "load.resistance", "load.voltage", "supply.energy", "error"];
    assert_eq!(rows(&folder)[0], heading);
    assert_eq!(column(&folder, "load.resistance"), ["100000000.0", "1000000000.0", "10000000000.0"]);
    assert!(column(&folder, "load.voltage").iter().all(|voltage| voltage.parse::<f64>().unwrap().is_finite()));
    assert_eq!(column(&folder, "error"), [""; 3]);
    for (more, named) in [
        (&[][..], "HarvestingCircuit has no gain.voltage, so say what to record"),
        (
            &["--samples", "2"],
            "--samples 2: HarvestingCircuit has no excitation.seed; name its seed by --seed-variable",
        ),
        (&["--case", "fig14"], "--case: HarvestingCircuit is not the harvester, of which the cases are"),
        (&["--set", "ball.mass=1"], "ball.mass"),
    ] {
        let (code, message) = refused(&mut sweep(&folder, &[&what[..], more].concat()));
        assert!(code == Some(2) && message.contains(named), "{message}");
    }
}

#[test]
fn runs_that_fail_are_rows_and_fail_a_sweep_only_if_all_do() {
    let (_guard, folder) = folder();
    let [some, all] = ["some", "all"].map(|name| folder.join(name));
    let vary = "membrane.initialRadius=0.001,0.00315,0.005";
    let output = done(sweep(&some, &["--vary", vary]).arg("--json"));
    assert_eq!(stderr(&output), "videg: warning: 1 of 3 runs failed; the column error says why\n");
    assert_eq!(serde_json::from_slice::<Value>(&output.stdout).unwrap()["failed"], 1);
    let errors = column(&some, "error");
    assert_eq!(errors, ["membrane.radius = 0.002 m must be greater than ball.radius = 0.005 m", "", ""]);
    assert_eq!(column(&some, "average_voltage_gain")[0], "");
    assert_eq!(json(&mut sweep(&some, &["--vary", vary]))["failed"], 1, "counted again when there is nothing to do");
    let output = sweep(&all, &["--vary", "membrane.initialRadius=0.001,0.0011"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
}

#[test]
fn the_parquet_file_holds_the_table_with_types_and_the_document() {
    let (_guard, folder) = folder();
    let vary = ["--vary", "membrane.initialRadius=0.001,0.00315", "--vary", "contact.reaction=false"];
    done(&mut sweep(&folder, &[&vary[..], &["--vary", "contact.law=compliant,1"]].concat()));
    let reader = SerializedFileReader::new(fs::File::open(folder.join("sweep.parquet")).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let document = metadata.key_value_metadata().unwrap().iter().find(|pair| pair.key == "videg.sweep").unwrap();
    // The document cannot hold the checksum of the file that it stands in.
    let beside = fs::read_to_string(folder.join("sweep.json")).unwrap();
    let decides = beside.split_once(",\n  \"results\": {").unwrap().0;
    assert_eq!(document.value.as_ref().unwrap(), &format!("{decides}\n}}\n"));
    let table: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    let csv = rows(&folder);
    assert_eq!(table.len(), csv.len() - 1);
    for (row, cells) in table.iter().zip(&csv[1..]) {
        assert_eq!(row.get_column_iter().map(|(name, _)| name).collect::<Vec<_>>(), csv[0].iter().collect::<Vec<_>>());
        for ((name, field), cell) in row.get_column_iter().zip(cells) {
            match field {
                Field::Long(value) => assert_eq!(value.to_string(), *cell, "{name}"),
                Field::Double(value) => assert_eq!(*value, cell.parse::<f64>().unwrap(), "{name}"),
                Field::Bool(value) => assert_eq!(value.to_string(), *cell, "{name}"),
                Field::Str(value) => assert_eq!(value, cell, "{name}"),
                Field::Null => assert_eq!(cell, "", "{name}"),
                other => panic!("{name} is {other}"),
            }
        }
    }
    assert_eq!((table[0].get_long(0).unwrap(), table[3].get_bool(4).unwrap()), (0, false));
    assert!(table[2].get_double(6).unwrap() > 0.0 && table[0].get_double(6).is_err());
}
