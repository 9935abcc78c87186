"""Build backend of the package: what a wheel contains beside the extension module is built first, then maturin does the rest.

A wheel has the FMUs, the system package of both, and the command-line tool with the same FMUs inside, and with the page of
`videg explore` where Rust compiles for browsers. Environment:

- VIDEG_PROFILE: profile of Cargo: release (default), or dist, which takes longer to compile and is what is released.
- VIDEG_PARTS: a folder with both .fmu, Harvester.ssp, the program `videg` (`videg.exe`) and THIRD-PARTY.md: taken as they are, nothing
  is built. The release makes them for several platforms.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import maturin
from maturin import (  # noqa: F401 - hooks of the build frontend
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "python" / "videg"
ARCHIVES = ("VibroImpactHarvester.fmu", "HarvestingCircuit.fmu", "Harvester.ssp")
PROGRAM = "videg.exe" if sys.platform == "win32" else "videg"


def profile() -> str:
    return os.environ.get("VIDEG_PROFILE", "release")


def cargo(*arguments: str, **environment: str) -> None:
    command = ["cargo", *arguments, "--locked", "--profile", profile()]
    print("+", *command, flush=True)
    subprocess.run(command, cwd=ROOT, env=os.environ | environment, check=True)


def built() -> Path:
    """The folder of Cargo's results."""
    return (ROOT / os.environ.get("CARGO_TARGET_DIR", "target")).resolve() / profile()


def has_wasm() -> bool:
    """Whether Rust compiles for browsers."""
    rustc = ["rustc", "--print", "target-libdir", "--target", "wasm32-unknown-unknown"]
    found = subprocess.run(rustc, cwd=ROOT, capture_output=True, text=True, check=False)
    return found.returncode == 0 and Path(found.stdout.strip()).is_dir()


def place(source: Path, name: str) -> None:
    """Copies a file into the package."""
    target = PACKAGE / name
    target.parent.mkdir(exist_ok=True)
    target.unlink(missing_ok=True)
    shutil.copy2(source, target)


def build_parts() -> None:
    """Puts FMUs and program into the package."""
    if given := os.environ.get("VIDEG_PARTS"):
        for archive in ARCHIVES:
            place(Path(given, archive), f"fmus/{archive}")
        place(Path(given, PROGRAM), f"bin/{PROGRAM}")
        place(Path(given, "THIRD-PARTY.md"), "THIRD-PARTY.md")
        return
    with tempfile.TemporaryDirectory() as folder:
        # The program without FMUs packages them, the one with them is what users get.
        cargo("build", "-p", "videg-fmu-harvester", "-p", "videg-fmu-circuit", "-p", "videg")
        environment = os.environ | {"VIDEG_NO_BUILD": "1"}
        for arguments in (["fmu", "build"], ["ssp"]):
            subprocess.run([built() / PROGRAM, *arguments, "--output", folder], cwd=ROOT, env=environment, check=True)
        features, page = ["embedded-fmus"], Path(folder, "explorer.html")
        if has_wasm():
            subprocess.run([built() / PROGRAM, "explore", "--no-open", "--output", page], cwd=ROOT, check=True)
            features.append("embedded-explorer")
        else:
            print("without the page of `videg explore`: Rust has no target wasm32-unknown-unknown (rustup target add)", flush=True)
        cargo("build", "-p", "videg", "--bin", "videg", "--features", ",".join(features), VIDEG_FMUS=folder, VIDEG_EXPLORER=str(page))
        for archive in ARCHIVES:
            place(Path(folder, archive), f"fmus/{archive}")
        place(built() / PROGRAM, f"bin/{PROGRAM}")
        notices = Path(folder, "THIRD-PARTY.md")
        with notices.open("w", encoding="utf-8") as file:
            subprocess.run([sys.executable, ROOT / "release/notices.py"], cwd=ROOT, stdout=file, check=True)
        place(notices, "THIRD-PARTY.md")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build_parts()
    return maturin.build_wheel(wheel_directory, with_profile(config_settings), metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    build_parts()
    return maturin.build_editable(wheel_directory, with_profile(config_settings), metadata_directory)


def build_sdist(sdist_directory, config_settings=None):
    return maturin.build_sdist(sdist_directory, config_settings)


def with_profile(config_settings):
    """The settings with arguments of maturin for the same profile."""
    settings = dict(config_settings or {})
    given = [settings.pop(key, []) for key in ("maturin.build-args", "build-args")]
    given = [part for parts in given for part in ([parts] if isinstance(parts, str) else parts)]
    environment = os.environ.get("MATURIN_PEP517_ARGS", "")
    settings["build-args"] = " ".join(["--profile", profile(), "--locked", *(given or [environment])]).strip()
    return settings
