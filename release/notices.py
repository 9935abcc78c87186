"""The licences of all that the program and the wheel contain, as Markdown on stdout: notices.py.

The texts are those in the sources of the crates, fonts and scripts inside them included. A crate without a text of its own
gets that of its licence from release/licenses; one whose licence is not among those fails.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# What is released, see release/program.sh.
TARGETS = ["x86_64-unknown-linux-gnu", "x86_64-pc-windows-msvc", "x86_64-apple-darwin", "aarch64-apple-darwin"]
TEXT = re.compile(r"(LICEN[CS]E|COPYING|NOTICE|UNLICENSE)", re.IGNORECASE)
# Of several licences to choose from, the first of these is taken for a crate without a text of its own.
KNOWN = {"MIT": ROOT / "release/licenses/MIT.txt", "Apache-2.0": ROOT / "LICENSE-APACHE"}


def metadata() -> dict:
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--features", "embedded-fmus,embedded-explorer"]
    filters = [argument for target in TARGETS for argument in ("--filter-platform", target)]
    return json.loads(subprocess.run(command + filters, cwd=ROOT, check=True, capture_output=True, text=True).stdout)


def linked(found: dict) -> list[dict]:
    """The crates of others that the program, the page of the explorer and the extension module for Python are linked with, by name; those for building and
    testing are left out."""
    packages = {package["id"]: package for package in found["packages"]}
    nodes = {node["id"]: node for node in found["resolve"]["nodes"]}
    todo = [found["resolve"]["root"], *(name for name, package in packages.items() if package["name"] in ("videg-python", "videg-explorer"))]
    seen = set(todo)
    while todo:
        for dependency in nodes[todo.pop()]["deps"]:
            kinds = {kind["kind"] for kind in dependency["dep_kinds"]}
            if None in kinds and dependency["pkg"] not in seen and not is_macro(packages[dependency["pkg"]]):
                seen.add(dependency["pkg"])
                todo.append(dependency["pkg"])
    crates = (packages[package] for package in seen if packages[package]["source"])
    return sorted(crates, key=lambda crate: (crate["name"], crate["version"]))


def is_macro(package: dict) -> bool:
    """Whether it runs in the compiler, and nothing of it is in the program."""
    return any("proc-macro" in target["kind"] for target in package["targets"])


def texts(crate: dict) -> list[tuple[str, str]]:
    """Name and content of the files with licences."""
    folder = Path(crate["manifest_path"]).parent
    files = sorted(path for path in folder.rglob("*") if path.is_file() and TEXT.match(path.name))
    files = [path for path in files if path.suffix.lower() in ("", ".md", ".txt", ".mit", ".apache", ".apache2")]
    if files:
        return [(path.relative_to(folder).as_posix(), path.read_text("utf-8", "replace")) for path in files]
    offered = re.split(r"\s+OR\s+|/", (crate["license"] or "").strip("()"))
    taken = next((name for name in KNOWN if name in offered), None)
    if taken is None:
        sys.exit(f"notices.py: {crate['name']} {crate['version']} has no text of its licence {crate['license']}")
    authors = ", ".join(re.sub(r"\s*<[^>]*>", "", author) for author in crate["authors"]) or f"the authors of {crate['name']}"
    return [(f"{taken}, by {authors}", KNOWN[taken].read_text())]


def main() -> None:
    crates = linked(metadata())
    same: dict[str, list[str]] = {}
    for crate in crates:
        for name, text in texts(crate):
            key = "\n".join(line.rstrip() for line in text.strip().splitlines())
            same.setdefault(key, []).append(f"{crate['name']} {crate['version']} ({name})")
    print((ROOT / "release/notices-head.md").read_text())
    for crate in crates:
        print(f"- {crate['name']} {crate['version']}: {crate['license']}")
    for text, users in same.items():
        # A fence longer than any in the text.
        print(f"\n## {', '.join(users)}\n\n~~~~text\n{text}\n~~~~")


if __name__ == "__main__":
    main()
