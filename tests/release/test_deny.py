"""The rules for dependencies find what they are there for."""

import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
FONT = '    { crate = "notosans", allow = ["OFL-1.1"] },\n'


def licences(config: Path) -> subprocess.CompletedProcess:
    environment = {**os.environ, "CONFIG": str(config)}
    return subprocess.run([ROOT / "release/deny.sh", "licenses"], env=environment, capture_output=True, text=True)


def test_the_licence_of_the_font_is_looked_at(tmp_path: Path) -> None:
    """A clarification whose hash is not that of the file counts for nothing, and nobody is told."""
    rules = (ROOT / "deny.toml").read_text()
    assert FONT in rules
    config = tmp_path / "deny.toml"
    config.write_text(rules)
    assert licences(config).returncode == 0
    config.write_text(rules.replace(FONT, ""))
    found = licences(config)
    assert found.returncode != 0 and "OFL-1.1 - SIL Open Font License 1.1" in found.stderr, found.stderr
