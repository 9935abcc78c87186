"""The scripts of a release that need nothing to be built, on a copy of the source tree that the tests may spoil."""

import hashlib
import shutil
import subprocess
import tarfile
import tomllib
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
MAJOR, MINOR, PATCH = map(int, VERSION.split("."))
# A patch later, and one that may break things.
LATER = f"{MAJOR}.{MINOR}.{PATCH + 1}"
BREAKING = f"{MAJOR + 1}.0.0" if MAJOR else f"0.{MINOR + 1}.0"
CHANGELOG = f"""# Changelog

## [Unreleased]

## [{VERSION}] - 2026-01-31

### Added

- One thing.

## [0.0.1] - 2025-12-31

- Another.

[0.0.1]: somewhere
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    names = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    folder = tmp_path / "tree"
    for name in names.stdout.splitlines():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name)
    (folder / "CHANGELOG.md").write_text(CHANGELOG)
    return folder


def run(tree: Path, script: str, *arguments: object) -> subprocess.CompletedProcess:
    command = [tree / "release" / script, *map(str, arguments)]
    return subprocess.run(command, cwd=tree, capture_output=True, text=True)


def replace(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text, f"{file} does not hold {old}"
    file.write_text(text.replace(old, new, 1))


def test_the_version_is_that_of_the_workspace_and_the_same_everywhere(tree: Path) -> None:
    assert run(tree, "version.sh").stdout == f"{VERSION}\n"
    for arguments in ([], [f"v{VERSION}"]):
        found = run(tree, "version.sh", "check", *arguments)
        assert (found.returncode, found.stdout) == (0, f"version {VERSION} everywhere\n"), found.stderr


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("model/Cargo.toml", "version.workspace = true", f'version = "{BREAKING}"', f"package videg-model has version {BREAKING}"),
        ("Cargo.toml", f'path = "circuit", version = "{VERSION}"', 'path = "circuit", version = "0.0.9"', "asks for videg-circuit ^0.0.9"),
        ("fuzz/Cargo.lock", f'name = "videg-model"\nversion = "{VERSION}"', 'name = "videg-model"\nversion = "0.0.9"', "fuzz/Cargo.lock has videg-model 0.0.9"),
        ("modelDescription/HarvestingCircuit.xml", f'version="{VERSION}"', 'version="0.0.9"', "not in modelDescription/HarvestingCircuit.xml"),
        ("modelDescription/VibroImpactHarvester.xml", f"videg {VERSION}", "videg 0.0.9", "VibroImpactHarvester.xml names another generationTool"),
        ("CHANGELOG.md", "## [Unreleased]\n", "", f'the first section is "## [{VERSION}] - 2026-01-31"'),
        ("CHANGELOG.md", " - 2026-01-31", "", f'the section "## [{VERSION}]" has not the form'),
    ],
)
def test_a_place_with_another_version_is_named(tree: Path, file: str, old: str, new: str, message: str) -> None:
    replace(tree / file, old, new)
    found = run(tree, "version.sh", "check")
    assert found.returncode == 1 and message in found.stderr, found.stderr


def test_a_tag_is_taken_for_this_version_with_its_notes_and_no_changes_left_over(tree: Path) -> None:
    found = run(tree, "version.sh", "check", f"v{BREAKING}")
    assert found.returncode == 1 and f"the tag is v{BREAKING}, wanted is v{VERSION}" in found.stderr
    replace(tree / "CHANGELOG.md", "## [Unreleased]\n", "## [Unreleased]\n\n- New.\n")
    found = run(tree, "version.sh", "check", f"v{VERSION}")
    assert found.returncode == 1 and 'there are changes under "Unreleased"' in found.stderr
    replace(tree / "CHANGELOG.md", f"## [{VERSION}]", f"## [{LATER}]")
    found = run(tree, "version.sh", "check", f"v{VERSION}")
    assert found.returncode == 1 and f'nothing under "## [{VERSION}]"' in found.stderr


def test_the_notes_of_a_version_are_its_section_of_the_changelog(tree: Path) -> None:
    assert run(tree, "notes.sh", VERSION).stdout == "### Added\n\n- One thing.\n"
    assert run(tree, "notes.sh", "0.0.1").stdout == "- Another.\n"
    for version in ("Unreleased", f"{MAJOR}.{MINOR}", LATER):
        found = run(tree, "notes.sh", version)
        assert found.returncode == 1 and f'nothing under "## [{version}]"' in found.stderr, found.stdout


def test_checksums_name_every_file_and_hold(tmp_path: Path, tree: Path) -> None:
    folder = tmp_path / "files"
    folder.mkdir()
    assert "no file in" in run(tree, "checksums.sh", folder).stderr
    contents = {"a.fmu": b"first", "b.tar.gz": b"second"}
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    # The second time over the result of the first.
    for _ in range(2):
        assert run(tree, "checksums.sh", folder).returncode == 0
        lines = (folder / "SHA256SUMS").read_text().splitlines()
        assert lines == [f"{hashlib.sha256(content).hexdigest()} *{name}" for name, content in contents.items()]
    subprocess.run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=folder, check=True, capture_output=True)


def test_files_are_those_that_other_jobs_made_and_no_others(tmp_path: Path, tree: Path) -> None:
    folder, sums = tmp_path / "files", []
    folder.mkdir()
    assert "no file in" in run(tree, "sums.sh", folder).stderr
    for job, name in (("program", "first.tar.gz"), ("libraries", "win64/second.dll")):
        for file in (tmp_path / job / name, folder / name):
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(job)
        sums.append(run(tree, "sums.sh", tmp_path / job).stdout)
        assert sums[-1] and "\n" not in sums[-1]
    found = run(tree, "sums.sh", folder, *sums)
    assert found.returncode == 0 and found.stdout.count("\n") == 2, found.stderr

    def refusal(*sums: str) -> str:
        found = run(tree, "sums.sh", folder, *sums)
        assert found.returncode == 1
        return found.stderr

    assert "first.tar.gz" in refusal(sums[1]) and "second.dll" in refusal(sums[0])
    assert "a job has handed on no checksums" in refusal(*sums, "")
    (folder / "first.tar.gz").write_text("another")
    assert "first.tar.gz" in refusal(*sums)
    (folder / "first.tar.gz").unlink()
    assert "first.tar.gz" in refusal(*sums)


def packed(tree: Path, name: str, program: str) -> Path:
    """The archive of a program, packed twice with the same bytes."""
    (tree / "fmus").mkdir(exist_ok=True)
    for fmu in ("VibroImpactHarvester", "HarvestingCircuit"):
        (tree / f"fmus/{fmu}.fmu").write_text(fmu)
    (tree / program).write_text("program")
    (tree / "notices.md").write_text("notices")
    found = run(tree, "pack.sh", name, tree / program, tree / "fmus", tree / "notices.md", tree / "packed")
    assert found.returncode == 0, found.stderr
    archive = Path(found.stdout.strip())
    first = archive.read_bytes()
    (tree / program).touch()
    run(tree, "pack.sh", name, tree / program, tree / "fmus", tree / "notices.md", tree / "packed")
    assert archive.read_bytes() == first
    return archive


WANTED = [
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "THIRD-PARTY.md",
    "fmu/HarvestingCircuit.fmu",
    "fmu/VibroImpactHarvester.fmu",
]


def test_an_archive_holds_program_fmus_and_licences(tree: Path) -> None:
    archive = packed(tree, "linux-x86_64", "videg")
    assert archive.name == f"videg-{VERSION}-linux-x86_64.tar.gz"
    with tarfile.open(archive) as files:
        modes = {member.name: member.mode for member in files.getmembers()}
    inside = f"videg-{VERSION}-linux-x86_64"
    assert modes == {f"{inside}/{name}": 0o644 for name in WANTED} | {f"{inside}/videg": 0o755}


def test_an_archive_for_windows_is_a_zip_file(tree: Path) -> None:
    archive = packed(tree, "windows-x86_64", "videg.exe")
    assert archive.name == f"videg-{VERSION}-windows-x86_64.zip"
    names = zipfile.ZipFile(archive).namelist()
    assert names == [f"videg-{VERSION}-windows-x86_64/{name}" for name in [*WANTED, "videg.exe"]]


@pytest.mark.parametrize(
    ("script", "arguments", "message"),
    [
        ("libraries.sh", ["linux32", "out"], 'no way to build for "linux32"'),
        ("fmus.sh", ["absent", "out"], "no folder of a platform in absent"),
        ("program.sh", ["linux-x86_64", "absent", "out"], "absent/VibroImpactHarvester.fmu is missing"),
        ("standalone.sh", ["absent"], "wants a packed archive"),
    ],
)
def test_what_is_missing_is_named(tree: Path, script: str, arguments: list[str], message: str) -> None:
    found = run(tree, script, *arguments)
    assert found.returncode == 1 and message in found.stderr, found.stderr


def test_every_licence_of_what_is_linked_is_in_the_notices(tree: Path) -> None:
    text = subprocess.run(["python3", tree / "release/notices.py"], check=True, capture_output=True, text=True).stdout
    for wanted in ("SIL OPEN FONT LICENSE", "Plotly, Inc.", "- tiny-skia ", "- clap ", "- thiserror "):
        assert wanted in text, wanted
    # Nothing that only tests or builds use.
    for other in ("- proptest ", "- criterion ", "- serde_derive "):
        assert other not in text, other


def interface(tree: Path, task: str) -> subprocess.CompletedProcess:
    return subprocess.run(["python3", tree / "release/interface.py", task], capture_output=True, text=True)


def test_a_variable_that_was_released_changes_only_with_the_version(tree: Path) -> None:
    (tree / "release/interface.txt").unlink(missing_ok=True)
    assert "nothing released yet" in interface(tree, "check").stdout
    interface(tree, "record")
    assert interface(tree, "check").returncode == 0
    description = tree / "modelDescription/HarvestingCircuit.xml"
    replace(description, 'name="load.resistance"', 'name="load.ohms"')
    found = interface(tree, "check")
    assert found.returncode == 1 and "  HarvestingCircuit load.resistance " in found.stderr, found.stderr
    set_version(tree, LATER)
    assert interface(tree, "check").returncode == 1
    set_version(tree, BREAKING)
    assert interface(tree, "check").returncode == 0


def set_version(tree: Path, version: str) -> None:
    before = subprocess.run([tree / "release/version.sh"], check=True, capture_output=True, text=True).stdout.strip()
    replace(tree / "Cargo.toml", f'version = "{before}"', f'version = "{version}"')


def insert_variable(description: Path, place: int) -> None:
    """A new variable in front of another one, with value references anew, as the exporter would count them."""
    document = ElementTree.parse(description)
    variables = document.getroot().find("ModelVariables")
    new = ElementTree.Element("ScalarVariable", name="new.thing", causality="output")
    ElementTree.SubElement(new, "Real", unit="V")
    variables.insert(place, new)
    for reference, variable in enumerate(variables):
        variable.set("valueReference", str(reference))
    document.write(description)


def test_a_new_variable_breaks_nothing_at_the_end_and_much_in_the_middle(tree: Path) -> None:
    interface(tree, "record")
    description = tree / "modelDescription/HarvestingCircuit.xml"
    original, count = description.read_text(), sum(1 for _ in ElementTree.parse(description).iter("ScalarVariable"))
    insert_variable(description, count)
    assert interface(tree, "check").returncode == 0
    description.write_text(original)
    insert_variable(description, count - 2)
    found = interface(tree, "check")
    assert found.returncode == 1 and "new variables go to the end of the table" in found.stderr, found.stderr
    last = list(ElementTree.fromstring(original).iter("ScalarVariable"))[-1].get("name")
    assert f"  HarvestingCircuit {last} had value reference {count - 1}, now {count}\n" in found.stderr, found.stderr
    assert found.stderr.count(" had value reference ") == 2


def git(tree: Path, *arguments: str) -> None:
    author = ["-c", "user.name=Somebody", "-c", "user.email=somebody@example.org", "-c", "commit.gpgSign=false"]
    subprocess.run(["git", *author, *arguments], cwd=tree, check=True, capture_output=True)


def test_a_commit_is_released_only_from_its_branch(tree: Path) -> None:
    git(tree, "init", "--initial-branch", "main")
    git(tree, "commit", "--allow-empty", "--message", "First")
    git(tree, "checkout", "--detach")
    assert run(tree, "on-branch.sh", "main").returncode == 0
    git(tree, "commit", "--allow-empty", "--message", "Beside")
    found = run(tree, "on-branch.sh", "main")
    assert found.returncode == 1 and "is not on main" in found.stderr, found.stderr
    found = run(tree, "on-branch.sh", "origin/main")
    assert found.returncode == 1 and "there is no branch origin/main" in found.stderr, found.stderr
