"""The drawings in git are those that `docs/drawings` makes."""

from xml.etree import ElementTree

import draw


def test_every_drawing_is_in_git_as_it_is_drawn():
    for folder, drawn in draw.FOLDERS.items():
        drawings = drawn()
        assert {path.name for path in folder.glob("*.svg")} == set(drawings)
        changed = [name for name, svg in drawings.items() if (folder / name).read_text() != svg]
        assert changed == [], "run .venv/bin/python docs/drawings/draw.py and look at the pictures"


def test_every_drawing_has_a_title_and_paper_behind_it():
    for name, svg in draw.drawings().items():
        root = ElementTree.fromstring(svg)
        tags = [child.tag.split("}")[1] for child in root]
        assert tags[:2] == ["title", "rect"], name
