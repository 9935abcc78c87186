"""The README of fmu-export, followed by somebody who has nothing else."""

import re
import time

import harness

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
        printed = user.run("bash", "-c", command, folder=folder, stderr=None).stdout
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
    user.run("cargo", "fmu", "new", "heat-pump")
    folder = user.home / "heat-pump"
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
    assert failed.returncode == 1 and "fmu-export" in failed.stdout, failed.stdout
    failed = user.run("cargo", "fmu", "build", check=False)
    assert failed.returncode == 1 and "could not find `Cargo.toml`" in failed.stdout, failed.stdout
