"""The README of fmu-export, followed by somebody who has nothing else."""

import re
import shutil
import subprocess
import time
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

import harness
from conftest import OPTIMISATION

README = (harness.ROOT / "fmu" / "export" / "README.md").read_text()
TEMPLATE = (harness.ROOT / "fmu" / "cargo" / "template" / "lib.rs").read_text()
MINUTES = 10


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def test_the_steps_give_an_fmu_that_fmpy_runs_in_ten_minutes(user):
    (steps,) = blocks("console")
    parts = re.split(r"^\$ ", steps, flags=re.MULTILINE)[1:]
    assert parts[0] == "cargo install cargo-fmu\n", "the fixture has done that"
    folder, started = user.home, time.monotonic()
    for part in parts[1:]:
        command, _, shown = part.partition("\n")
        if command.startswith("cd "):
            folder /= command.removeprefix("cd ")
            continue
        if command.startswith("pip install"):
            continue  # The environment of the tests has it.
        printed = user.run("env", "-u", OPTIMISATION, "bash", "-c", command, folder=folder, stderr=None).stdout
        assert printed == shown, command
    assert time.monotonic() - started < 60 * MINUTES


def test_the_model_shown_is_the_one_that_is_made():
    shown = blocks("rust")[0]
    made = TEMPLATE.replace("{identifier}", "Lag").partition("#[cfg(test)]")[0]
    assert made.partition("\n\n")[2].strip() == shown.strip()


def test_a_first_fmu_takes_thirty_lines():
    lines = [line for line in blocks("rust")[0].splitlines() if line.strip() and not line.strip().startswith("//")]
    settings = [line for line in lines if line.strip().startswith(".")]
    assert len(lines) - len(settings) <= 30, "without the settings of the description, which are optional"


def test_the_tests_of_a_new_package_pass_and_a_panic_that_aborts_is_refused(user):
    folder = user.new("heat-pump")
    assert "1 passed" in user.run("cargo", "test", folder=folder).stdout
    assert user.run("cargo", "fmu", "build", "--fmi", "3", folder=folder).stdout.endswith("target/fmu/fmi3/HeatPump.fmu\n")
    with (folder / "Cargo.toml").open("a") as manifest:
        manifest.write('\n[profile.release]\npanic = "abort"\n')
    failed = user.run("cargo", "fmu", "build", folder=folder, check=False)
    assert failed.returncode == 1
    assert 'with panic = "abort" a panic of the model would end the process of the importer' in failed.stdout


def test_what_cannot_be_packaged_is_refused_with_what_is_needed(user):
    for name, said in [("1x", "cannot start with a digit"), ("a b", "invalid character"), ("crates", "already exists")]:
        failed = user.run("cargo", "fmu", "new", name, check=False)
        assert failed.returncode == 1 and said in failed.stdout, failed.stdout
    plain = user.home / "plain"
    user.run("cargo", "new", "--quiet", "--lib", "plain")
    failed = user.run("cargo", "fmu", "build", folder=plain, check=False)
    assert failed.returncode == 1
    assert 'needs [lib] with crate-type = ["cdylib"]' in failed.stdout
    for arguments, said in [
        (["--package", "other"], "no package is called other; its packages are plain"),
        (["--example", "other"], 'no example other of crate-type cdylib'),
        (["--target", "linux65"], "no FMI 2.0 platform for the target linux65"),
        (["--add-binary", "linux64"], 'wants PLATFORM=FILE, found "linux64"'),
    ]:
        failed = user.run("cargo", "fmu", "build", *arguments, folder=plain, check=False)
        assert failed.returncode == 1 and said in failed.stdout, failed.stdout
    with (plain / "Cargo.toml").open("a") as manifest:
        manifest.write('\n[lib]\ncrate-type = ["cdylib"]\n')
    failed = user.run("cargo", "fmu", "build", folder=plain, check=False)
    assert failed.returncode == 1 and "does not contain this feature: fmu-export" in failed.stdout, failed.stdout
    failed = user.run("cargo", "fmu", "build", check=False)
    assert failed.returncode == 1 and "could not find `Cargo.toml`" in failed.stdout, failed.stdout


MODEL = """
use fmu_export::{Choice, Logger, ModelInfo, Slave, SlaveError, Variable, Variables, export_fmu};

/// Items in an order of their own.
#[derive(Clone, Copy, Default, Choice)]
enum Law { #[default] Soft, Hard }

#[derive(Clone, Default, Variables)]
struct Model { FIELDS }

impl Slave for Model {
    const INFO: ModelInfo = ModelInfo::new("Own");
    fn variables() -> &'static [Variable<Self>] { &Self::VARIABLES }
    fn new() -> Self { Self::default() }
    fn do_step(&mut self, _t: f64, _h: f64, _log: &Logger) -> Result<(), SlaveError> { Ok(()) }
}
export_fmu!(Model);
"""


@pytest.fixture(scope="module")
def own(user):
    """Builds a model with these fields: its FMU, or what was said."""
    folder = user.new("own")

    def own(fields: str, *arguments: str) -> Path | str:
        (folder / "src" / "lib.rs").write_text(MODEL.replace("FIELDS", fields))
        made = user.run("cargo", "fmu", "build", *arguments, folder=folder, check=False, stderr=subprocess.PIPE)
        return folder / made.stdout.strip() if made.returncode == 0 else made.stderr

    own.folder = folder
    return own


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ("#[parameter(start = 300)] x: u8", "literal out of range for `u8`"),
        ("#[parameter(start = 2.5)] x: i32", "mismatched types"),
        ("#[parameter(max = 1000)] x: u8", "its bounds 0 and 1000 are beyond UInt8"),
        ("#[parameter(start = u64::MAX)] x: u64", "the start is beyond the largest i64"),
        ("#[parameter(start = Medium)] x: Law", "the enumeration has no such item"),
        ('#[parameter(start = "a")] x: f64', "mismatched types"),
        ("#[parameter] x: Option<f64>", "is no type of a variable"),
        ("#[parameter(colour = 3)] x: f64", "no method named `colour`"),
        ("#[output] x: f64, #[output(name = \"x\")] y: f64", "its name occurs twice"),
        ("#[output(unit = \"s\")] time: f64", "FMI 3.0 adds a variable of this name"),
        ("#[output(depends_on = &[\"z\"])] y: f64", "depends on z, which is not in the table"),
    ],
)
def test_a_mistake_in_a_model_is_told_where_it_is(own, fields, said):
    told = own(fields)
    assert isinstance(told, str) and said in told, told
    assert "no associated item named `VARIABLES`" not in told


def test_values_beyond_a_type_are_refused_and_names_are_as_they_are_written(own):
    fields = """
        #[parameter(start = 7, tunable)] byte: u8,
        #[parameter] single: f32,
        #[input] r#type: f64,
        #[parameter(start = Hard)] law: Law,
        #[output] wide: i64,
    """
    fmu = own(fields)
    description = fmpy.read_model_description(str(fmu))
    variables = {variable.name: variable for variable in description.modelVariables}
    assert list(variables) == ["byte", "single", "type", "law", "wide"]
    assert (variables["byte"].min, variables["byte"].max, variables["law"].start) == ("0", "255", "2")
    for name, value in [("byte", 256), ("single", 1e39)]:
        with pytest.raises(Exception, match="fmi2Set"):
            fmpy.simulate_fmu(str(fmu), start_values={name: value})
    assert fmpy.simulate_fmu(str(fmu), start_values={"byte": 255, "single": 1e38}) is not None
    assert validate_fmu(str(own(fields, "--fmi", "3"))) == []


def test_what_lies_beside_the_manifest_is_in_the_fmu_once(own):
    (own.folder / "LICENSE.txt").write_text("mine")
    (own.folder / "documentation").mkdir()
    (own.folder / "documentation" / "Index.html").write_text("<html></html>")
    (own.folder / "resources" / "curves").mkdir(parents=True)
    (own.folder / "resources" / "curves" / "a.csv").write_text("1")
    (own.folder / "resources" / ".hidden").write_text("1")
    with zipfile.ZipFile(own("#[output] y: f64")) as archive:
        names = archive.namelist()
    assert sorted(name for name in names if name.startswith(("documentation", "resources"))) == [
        "documentation/Index.html",
        "documentation/licenses/LICENSE.txt",
        "resources/curves/a.csv",
    ]
    (own.folder / "resources" / "Curves").mkdir()
    (own.folder / "resources" / "Curves" / "a.csv").write_text("1")
    told = own("#[output] y: f64")
    assert "resources/Curves/a.csv is in the FMU already" in told, told
    shutil.rmtree(own.folder / "resources")


def test_a_manifest_may_be_named_and_arguments_go_on_to_cargo(user, own):
    own("#[output] y: f64")
    build = ("cargo", "fmu", "build", "--manifest-path")
    assert user.run(*build, "Cargo.toml", folder=own.folder, stderr=None).stdout == "target/fmu/Own.fmu\n"
    assert user.run(*build, "own/Cargo.toml", stderr=None).stdout == "own/target/fmu/Own.fmu\n"
    failed = user.run(*build, "own/Nope.toml", check=False)
    assert failed.returncode == 1 and "Nope.toml" in failed.stdout, failed.stdout
    failed = user.run("cargo", "fmu", "build", "--", "--features", "fast", folder=own.folder, check=False)
    assert failed.returncode == 1 and "does not contain this feature: fast" in failed.stdout, failed.stdout
