"""A preprocessor of mdBook: turns LaTeX between dollar signs into MathML, which browsers draw without a script.

mdBook calls it with `supports RENDERER`, or with context and book as JSON on standard input.
"""

import json
import re
import sys

from latex2mathml.converter import convert

# Code, in which a dollar sign is one, or an equation. Inline code may go on in the next line, but not past its paragraph.
PARTS = re.compile(
    r"(?P<code>^```.*?^```|`(?:[^`\n]|\n(?![ \t]*\n))+`)|\$\$(?P<block>.+?)\$\$|(?<![\\$])\$(?P<inline>[^\s$](?:[^$]*[^\s$])?)\$(?!\d)",
    re.DOTALL | re.MULTILINE,
)
# What Markdown would take for marks of its own.
MARKS = str.maketrans({"_": "&#95;", "*": "&#42;", "|": "&#124;", "[": "&#91;", "]": "&#93;", "\\": "&#92;"})


def equation(found: re.Match) -> str:
    if found["code"]:
        return found["code"]
    display = "block" if found["block"] else "inline"
    return convert(" ".join((found["block"] or found["inline"]).split()), display=display).translate(MARKS)


def equations(section: dict) -> None:
    chapter = section.get("Chapter")
    if chapter:
        chapter["content"] = PARTS.sub(equation, chapter["content"])
        for inner in chapter["sub_items"]:
            equations(inner)


def main() -> None:
    if sys.argv[1:2] == ["supports"]:
        sys.exit(0 if sys.argv[2] == "html" else 1)
    _, book = json.load(sys.stdin)
    for section in book.get("items", book.get("sections", [])):
        if isinstance(section, dict):
            equations(section)
    json.dump(book, sys.stdout)


if __name__ == "__main__":
    main()
