"""The libraries of the exporter as a user gets them: packaged, and unpacked outside of the source tree."""

import os
import shutil
import subprocess
import sys
import tarfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from harness import ROOT, TARGET

CRATES = ["fmu-abi", "fmu-derive", "fmu-export", "fmu-import", "fmu-package", "cargo-fmu", "videg-input", "videg-system"]

# Of what is released: a variable of Cargo.
OPTIMISATION = "CARGO_PROFILE_RELEASE_OPT_LEVEL"


@dataclass
class User:
    """Somebody who has Rust, FMPy, and the packages in the place of those of the registry."""

    home: Path
    environment: dict[str, str]

    def run(self, *command: str, folder: Path | None = None, **options) -> subprocess.CompletedProcess:
        """Run a command; what it writes is text."""
        options = {"check": True, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT} | options
        try:
            return subprocess.run(command, cwd=folder or self.home, env=self.environment, text=True, **options)
        except subprocess.CalledProcessError as error:
            pytest.fail(f"{command} failed:\n{error.stdout}")

    def new(self, name: str) -> Path:
        """The folder of a new package."""
        self.run("cargo", "fmu", "new", name)
        return self.share(self.home / name)

    def share(self, folder: Path) -> Path:
        """The folder of a package, which has what it depends on compiled where the others have it."""
        compiled = self.home / "compiled"
        compiled.mkdir(exist_ok=True)
        (folder / "target").symlink_to(compiled)
        return folder

    def crate(self, name: str) -> Path:
        """The folder of a package."""
        return next(self.home.glob(f"crates/{name}-[0-9]*"))


@pytest.fixture(scope="session")
def user(tmp_path_factory) -> User:
    home = tmp_path_factory.mktemp("user")
    version = subprocess.run(
        ["cargo", "pkgid", "-p", "fmu-export"], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True
    ).stdout.strip().rpartition("@")[2].rpartition("#")[2]
    packages = [argument for crate in CRATES for argument in ("-p", crate)]
    package = ["cargo", "package", "--quiet", "--no-verify", "--allow-dirty", *packages]
    subprocess.run(package, cwd=ROOT, check=True, env=os.environ | {"CARGO_TARGET_DIR": str(TARGET)})
    patches = []
    for crate in CRATES:
        with tarfile.open(TARGET / "package" / f"{crate}-{version}.crate") as archive:
            archive.extractall(home / "crates", filter="data")
        patches.append(f'{crate} = {{ path = "{home}/crates/{crate}-{version}" }}\n')
    (home / ".cargo").mkdir()
    (home / ".cargo" / "config.toml").write_text("[patch.crates-io]\n" + "".join(patches))
    # The packages of others in the versions of this source tree, lest a release of today decides.
    shutil.copy(ROOT / "Cargo.lock", home / "crates" / f"cargo-fmu-{version}" / "Cargo.lock")
    environment = os.environ | {"PATH": f"{home}/bin:{Path(sys.executable).parent}:{os.environ['PATH']}"}
    environment.pop("CARGO_TARGET_DIR", None)
    # These models compute little, and many are compiled.
    environment[OPTIMISATION] = "0"
    made = User(home, environment)
    cargo_fmu = ["cargo", "install", "--quiet", "--debug", "--path", str(made.crate("cargo-fmu"))]
    made.run(*cargo_fmu, "--root", str(home), "--target-dir", str(TARGET / "exporter"))
    return made
