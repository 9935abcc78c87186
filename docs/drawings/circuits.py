"""Schematics of the harvesting circuit, one for each topology and release element. schemdraw draws the symbols."""

import re

import schemdraw
import schemdraw.elements as elm

from card import BLUE, INK, RED, card, text

schemdraw.use("svg")
schemdraw.config(inches_per_unit=0.5, lw=1.6, color=INK)
# Pixels for a unit of the drawing.
UNIT = 36.0
# Height of a branch to ground, units.
DROP = 2.4

TITLES = {"zener": "a Zener diode into a load", "switch": "a switch into a load", "storage": "a diode into a storage"}


class Schematic:
    """Elements of schemdraw between given points, and labels beside them; as a template, labels have places for values."""

    def __init__(self, is_template: bool = False) -> None:
        self.is_template = is_template
        self.drawing = schemdraw.Drawing(show=False)
        self.labels: list[str] = []

    def put(self, element, start, end, colour=INK) -> None:
        """A two-terminal element from `start` to `end`."""
        self.drawing += element.at(start).to(end).color(colour)

    def line(self, *points) -> None:
        for start, end in zip(points, points[1:]):
            self.put(elm.Line(), start, end)

    def dot(self, point) -> None:
        self.drawing += elm.Dot().at(point)

    def ground(self, point) -> None:
        self.drawing += elm.Ground().at(point)

    def label(self, point, words, anchor="middle", colour=INK) -> None:
        x, y = point
        self.labels.append(text(UNIT * x, -UNIT * y, words, anchor, colour))

    def value(self, name) -> str:
        """What stands behind a symbol."""
        return f" = {{{{ v.{name} }}}}" if self.is_template else ""

    def current(self, start, end, words, offset, anchor="middle") -> None:
        """An arrow in the direction of a positive current."""
        self.drawing += elm.Line(arrow="->", lw=1.4, arrowwidth=0.2, arrowlength=0.28).at(start).to(end).color(BLUE)
        middle = [(a + b) / 2 + shift for a, b, shift in zip(start, end, offset)]
        self.label(middle, words, anchor, BLUE)

    def membrane(self, top, words) -> None:
        """The variable capacitor of a membrane, from its node to ground."""
        x, y = top
        self.dot(top)
        self.put(elm.CapacitorVar(), top, (x, y - DROP), RED)
        self.ground((x, y - DROP))
        self.label((x + 0.5, y - DROP / 2 - 0.15), words, "start", RED)

    def supply(self, top) -> None:
        x, y = top
        self.put(elm.SourceV(), (x, y - DROP), top)
        self.ground((x, y - DROP))
        self.label((x - 0.7, y - DROP / 2 - 0.15), "$U_in$" + self.value("supply"), "end")
        self.current((x + 0.75, y - DROP / 2 - 0.45), (x + 0.75, y - DROP / 2 + 0.45), "$I_in$", (0.2, -0.15), "start")

    def load(self, top, release) -> None:
        """The load or the storage, from the node `out` to ground."""
        x, y = top
        self.dot(top)
        if release != "storage":
            self.label((x + 0.2, y + 0.3), "$U_out$", "start")
        if release == "storage":
            self.put(elm.Battery(), top, (x, y - DROP))
            self.label((x + 0.35, y - DROP / 2 + 0.45), "+", "start")
        else:
            self.put(elm.ResistorIEC(), top, (x, y - DROP))
        self.ground((x, y - DROP))
        self.label((x + 0.55, y - DROP / 2 - 0.15), "$U_out$" + self.value("release") if release == "storage" else "$R$" + self.value("load"), "start")
        self.current((x - 0.65, y - DROP / 2 + 0.45), (x - 0.65, y - DROP / 2 - 0.45), "$I_out$", (-0.2, -0.15), "end")

    def release(self, release, start, end, node, one_way) -> None:
        """The release element between a membrane's node and `out`."""
        middle = ((start[0] + end[0]) / 2, start[1])
        if release == "switch":
            self.put(elm.Switch(), start, end)
            self.label((middle[0], middle[1] + 0.75), f"${node}$ > $U_z$" + self.value("release"))
        elif release == "storage":
            self.put(elm.Diode(), start, end)
        elif one_way:
            self.put(elm.Zener().reverse(), start, middle)
            self.put(elm.Diode(), middle, end)
            self.label(((start[0] + middle[0]) / 2, middle[1] + 0.6), "$U_z$" + self.value("release"))
        else:
            self.put(elm.Zener().reverse(), start, end)
            self.label((middle[0], middle[1] + 0.6), "$U_z$" + self.value("release"))

    def svg(self, title, box) -> str:
        """Lengths of `box` are in units: left, top, width, height. Values take more room at both sides."""
        left, top, width, height = box
        if self.is_template:
            self.label((3.4, top - height - 0.25), "{{ v.membranes }}", colour=RED)
            box = (left - 2.1, top, width + 5.2, height + 0.6)
        drawn = self.drawing.get_imagedata("svg").decode()
        body = re.sub(r"^.*?<svg[^>]*>|</svg>\s*$", "", drawn, flags=re.DOTALL)
        body = body.replace("stroke-dasharray:-;", "").replace(" />", "/>\n")
        # Shortest form of each number.
        body = re.sub(r"-?\d+\.\d+(e-\d+)?", lambda number: f"{round(float(number[0]), 2):g}", body)
        left, top, width, height = (UNIT * value for value in box)
        return card((left, -top, width, height), title, body.strip() + "\n" + "\n".join(self.labels))


def shared_node(release: str, is_template: bool = False) -> str:
    """Both membranes on one node, Fig. 8(a)."""
    it, out = Schematic(is_template), (8.0, 0)
    it.supply((0, 0))
    it.put(elm.Diode(), (0, 0), (2.4, 0))
    it.line((2.4, 0), (4.4, 0))
    it.membrane((2.4, 0), "$C_left$")
    it.membrane((4.4, 0), "$C_right$")
    it.label((3.4, 0.3), "$U_DE$")
    it.release(release, (4.4, 0), out, "U_DE", one_way=False)
    it.load(out, release)
    return it.svg(f"Both membranes on one node, {TITLES[release]}", (-2.0, 1.9, 11.8, 5.9))


def isolated(release: str, is_template: bool = False) -> str:
    """Each membrane with a charging diode and a release element of its own."""
    it, high, out = Schematic(is_template), 4.2, (8.0, 0)
    it.supply((0, 0))
    it.line((0, 0), (0, high))
    it.dot((0, 0))
    for y, side in ((high, "left"), (0, "right")):
        it.put(elm.Diode(), (0, y), (2.4, y))
        it.membrane((2.4, y), f"$C_{side}$")
        it.label((2.6, y + 0.3), f"$U_{side}$", "start")
        it.line((2.4, y), (4.0, y))
        it.release(release, (4.0, y), (7.2, y), f"U_{side}", one_way=True)
        it.line((7.2, y), (8.0, y))
    it.line((8.0, high), out)
    it.load(out, release)
    return it.svg(f"Isolated membranes, {TITLES[release]}", (-2.0, high + 1.4, 11.8, high + 5.1))


LAYOUTS = {"shared": shared_node, "isolated": isolated}


def drawings() -> dict[str, str]:
    """File names and contents."""
    return {f"circuit-{name}-{release}.svg": draw(release) for name, draw in LAYOUTS.items() for release in TITLES}


def templates() -> dict[str, str]:
    """The same with places for the values of a run."""
    return {f"circuit-{name}-{release}.svg": draw(release, True) for name, draw in LAYOUTS.items() for release in TITLES}
