"""What all drawings share: colours, text with symbols, and a white card, so that they show in light and in dark pages."""

import re
from html import escape

INK = "#222222"
RED = "#b3261e"
BLUE = "#1f5fa8"
SIZE = 17

# A letter with its index, or anything else.
_TOKEN = re.compile(r"([A-Za-zα-ω])(?:_([A-Za-z0-9]+))?|([^A-Za-zα-ω]+)")


def _symbols(formula: str) -> tuple[str, int]:
    """Letters in italics, indices upright and low: `U_in` and the like; and how much lower than the line they end."""
    spans, lowered = [], 0
    for letter, index, other in _TOKEN.findall(formula):
        back = f' dy="-{lowered}"' if lowered else ""
        style = ' font-style="italic"' if letter else ""
        spans.append(f"<tspan{style}{back}>{escape(letter or other)}</tspan>")
        lowered = 5 if index else 0
        if index:
            spans.append(f'<tspan font-size="13" dy="{lowered}">{index}</tspan>')
    return "".join(spans), lowered


def text(x: float, y: float, words: str, anchor: str = "middle", colour: str = INK) -> str:
    """A line of text; what stands between dollar signs is a formula."""
    parts, lowered = [], 0
    for k, part in enumerate(words.split("$")):
        back = f'<tspan dy="-{lowered}">{{}}</tspan>' if lowered and part else "{}"
        drawn, low = _symbols(part) if k % 2 else (escape(part), 0)
        parts.append(back.format(drawn) if not k % 2 or not lowered else drawn)
        lowered = low if part else lowered
    return f'<text x="{x:.5g}" y="{y:.5g}" text-anchor="{anchor}" fill="{colour}" xml:space="preserve">{"".join(parts)}</text>'


def card(box: tuple[float, float, float, float | str], title: str, body: str) -> str:
    """The SVG with the corner, width and height of `box`; words are places of a template."""
    x, y, width, height = (value if isinstance(value, str) else f"{value:.5g}" for value in box)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}" '
        f'font-family="sans-serif" font-size="{SIZE}" role="img">\n<title>{escape(title)}</title>\n'
        f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" fill="#fff"/>\n{body}\n</svg>\n'
    )
