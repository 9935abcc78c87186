"""docs/reference/python.md is made from the docstrings: `UPDATE_BOOK=1 python -m pytest tests/python/test_reference.py` writes it."""

import dataclasses
import inspect
import os
import re
from pathlib import Path

import videg

PAGE = Path(__file__).resolve().parent.parent.parent / "docs/reference/python.md"

HEAD = """# The package for Python

Made from the docstrings of `python/videg`, which `help(videg.simulate)` shows, too. [Use Python](../howto/python.md) has examples. All quantities are
in SI units; names of variables are those of [the FMUs](variables.md).
"""

SECTION = re.compile(r"^(Args|Returns|Raises):$")


def paragraphs(text: str) -> str:
    """A docstring as Markdown: its sections become lists."""
    lines, section = [], None
    for line in text.splitlines():
        if found := SECTION.match(line):
            section = found[1]
            lines += ["", {"Args": "Arguments:", "Returns": "Returns:", "Raises": "Raises:"}[section], ""]
        elif section and line.startswith("    ") and not line.startswith("     "):
            name, separator, rest = line.strip().partition(": ")
            is_item = separator and section != "Returns"
            lines.append(f"- `{name}`: {rest}" if is_item else f"{line.strip()}")
        elif section and line.strip():
            lines.append(f"  {line.strip()}" if section != "Returns" else line.strip())
        else:
            lines.append(line)
    return "\n".join(lines).strip()


def signature(name: str, thing: object) -> str:
    """The signature in lines of at most 100 characters."""
    found = inspect.signature(thing)
    said = [str(parameter).replace("'", "") for parameter in found.parameters.values() if parameter.name != "self"]
    kinds = [parameter.kind for parameter in found.parameters.values() if parameter.name != "self"]
    first = next((k for k, kind in enumerate(kinds) if kind is inspect.Parameter.KEYWORD_ONLY), None)
    if first is not None:
        said.insert(first, "*")
    returned = "" if found.return_annotation in (inspect.Signature.empty, None, "None") else f" -> {found.return_annotation}"
    returned = returned.replace("'", "")
    whole = f"{name}({', '.join(said)}){returned}"
    if len(whole) <= 100:
        return whole
    return f"{name}(\n" + "".join(f"    {part},\n" for part in said) + f"){returned}"


def fields(thing: type) -> list[str]:
    """Fields of a data class with the texts behind them."""
    texts = dict(re.findall(r"^    (\w+): [^\n]*\n    \"\"\"(.*?)\"\"\"", inspect.getsource(thing), re.MULTILINE | re.DOTALL))
    texts = {name: " ".join(text.split()) for name, text in texts.items()}
    return [f"- `{it.name}`: {texts.get(it.name, str(it.type))}" for it in dataclasses.fields(thing)]


def members(thing: type) -> list[str]:
    """Public methods and properties, those that are inherited from classes of the package, too."""
    lines = []
    own = [parent for parent in thing.__mro__ if parent.__module__.startswith("videg.")]
    seen = {name: member for parent in reversed(own) for name, member in vars(parent).items()}
    for name, member in seen.items():
        if name.startswith("_") and name not in ("__getitem__", "__setitem__"):
            continue
        if isinstance(member, property):
            lines += [f"### `{name}`", "", paragraphs(inspect.getdoc(member)), ""]
        elif inspect.isfunction(member):
            lines += [f"### `{signature(name, member)}`" if len(signature(name, member)) < 60 else f"### `{name}`", ""]
            if len(signature(name, member)) >= 60:
                lines += ["<!-- run by tests/python/test_reference.py -->", "```text", signature(name, member), "```", ""]
            lines += [paragraphs(inspect.getdoc(member)), ""]
    return lines


def page() -> str:
    lines = [HEAD]
    for name in videg.__all__:
        thing = getattr(videg, name)
        if name == "__version__":
            continue
        lines += [f"## `videg.{name}`", ""]
        if inspect.isfunction(thing):
            lines += ["<!-- run by tests/python/test_reference.py -->", "```text", signature(name, thing), "```", ""]
        lines += [paragraphs(inspect.getdoc(thing)), ""]
        if dataclasses.is_dataclass(thing):
            lines += [*fields(thing), ""]
        elif inspect.isclass(thing) and not issubclass(thing, Exception):
            lines += members(thing)
    text = "\n".join(lines)
    return re.sub(r"\n{3,}", "\n\n", text).strip() + "\n"


def test_the_reference_is_made_from_the_docstrings() -> None:
    if os.environ.get("UPDATE_BOOK"):
        PAGE.write_text(page())
    assert PAGE.read_text() == page(), "UPDATE_BOOK=1 python -m pytest tests/python/test_reference.py"
