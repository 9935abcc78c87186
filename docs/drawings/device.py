"""The device, and the shape of a membrane under the ball."""

from math import atan, cos, sin, sqrt

from card import BLUE, INK, RED, card, text

TIPS = (
    f'<defs><marker id="tip" viewBox="0 0 10 10" refX="10" refY="5" markerWidth="8" markerHeight="8" orient="auto-start-reverse">'
    f'<path d="M0,1 L10,5 L0,9 z" fill="{INK}"/></marker><marker id="push" viewBox="0 0 10 10" refX="10" refY="5" markerWidth="5" '
    f'markerHeight="5" orient="auto"><path d="M0,0 L10,5 L0,10 z" fill="{BLUE}"/></marker></defs>'
)


def rectangle(x, y, width, height, fill) -> str:
    return f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" fill="{fill}" stroke="#333"/>'


def line(x1, y1, x2, y2, style="stroke:#222") -> str:
    return f'<line x1="{x1:.5g}" y1="{y1:.5g}" x2="{x2:.5g}" y2="{y2:.5g}" style="{style}"/>'


def length(x1, y1, x2, y2, both=True) -> str:
    """A dimension line; an arrow if not `both`."""
    return line(x1, y1, x2, y2, "stroke:#222;marker-end:url(#tip)" + (";marker-start:url(#tip)" if both else ""))


def force(x1, y1, x2, y2) -> str:
    return line(x1, y1, x2, y2, f"stroke:{BLUE};stroke-width:3.5;marker-end:url(#push)")


def helper(x1, y1, x2, y2) -> str:
    return line(x1, y1, x2, y2, "stroke:#777;stroke-dasharray:4 3")


def angle(deflection, radius, ball) -> float:
    """alpha of Eq. (5)."""
    return 2 * atan(deflection / (radius + sqrt(radius**2 + deflection * (deflection - 2 * ball))))


def film(x, y, radius, deflection, ball) -> str:
    """A membrane with its frame at `x` and its centre at `y`, which a ball presses in to the left: a cone and a cap."""
    alpha = angle(deflection, radius, ball)
    centre = x - deflection + ball
    touch, across = centre - ball * cos(alpha), ball * sin(alpha)
    return (
        f'<path d="M {x:g},{y - radius:g} L {touch:.5g},{y - across:.5g} A {ball:g},{ball:g} 0 0 0 {touch:.5g},{y + across:.5g} '
        f'L {x:g},{y + radius:g}" fill="none" stroke="{RED}" stroke-width="4"/>'
    )


def body(left, right, y, radius) -> list[str]:
    """The cylinder and the frames of its membranes, in section."""
    walls = [rectangle(left + 12, y + side, right - left - 24, 10, "#9aa5b1") for side in (-radius - 10, radius)]
    frames = [rectangle(x, y + side, 24, 12, "#d5dae0") for x in (left - 12, right - 12) for side in (-radius - 11, radius - 1)]
    return [*walls, *frames]


def flat(x, y, radius) -> str:
    """A membrane without ball."""
    return line(x, y - radius - 4, x, y + radius + 4, f"stroke:{RED};stroke-width:4")


def round_ball(x, y, radius) -> str:
    return f'<circle cx="{x:g}" cy="{y:g}" r="{radius}" fill="#a9cbe8" stroke="#333"/>'


def device() -> str:
    """The cylinder with its membranes, and the ball while it presses the left one in."""
    left, right, y, radius, ball, deflection = 108, 332, 104, 36, 21, 24
    middle, centre, low = (left + right) / 2, left - deflection + ball, y + radius + 32
    parts = [
        TIPS,
        helper(left, y - radius, left, low + 6),
        helper(left - deflection, y, left - deflection, low + 6),
        helper(centre, y, centre, 200),
        helper(middle, y - radius, middle, 200),
        *body(left, right, y, radius),
        round_ball(centre, y, ball),
        film(left, y, radius, deflection, ball),
        flat(right, y, radius),
        text(centre, y + 6, "$m$"),
        force(centre + ball + 3, y, centre + ball + 60, y),
        text(centre + ball + 34, y - 10, "$f(x)$", colour=BLUE),
        force(20, y - radius - 5, left - 18, y - radius - 5),
        text(56, y - radius - 15, "$F(t)$", colour=BLUE),
        text(276, y + 6, "$M$"),
        text(middle, 34, "shaken cylinder, ball, two membranes"),
        text(left - deflection - 8, y + 6, "$C_left(t)$", "end", RED),
        text(right + 18, y + 6, "$C_right(t)$", "start", RED),
        length(left - deflection - 24, low, left - deflection, low, both=False),
        length(left + 24, low, left, low, both=False),
        text(left - deflection - 32, low + 5, "$x$", "end"),
        length(centre, 194, middle, 194, both=False),
        text(middle + 8, 199, "$z_M − z_m$", "start"),
        length(right - 10, 194, right + 50, 194, both=False),
        text(right + 58, 199, "$z$", "start"),
    ]
    return card((0, 0, 424.8, 212.4), "The device: a shaken cylinder with a ball between two membranes", "\n".join(parts))


def spring(x, y) -> str:
    """A spring and a damper side by side, from a wall at `x` to a plate."""
    coil = " ".join(f"L {x + 12 + 7 * k},{y - 12 + (6 if k % 2 else -6)}" for k in range(1, 8))
    return (
        line(x, y - 26, x, y + 26, "stroke:#222;stroke-width:3")
        + f'<path d="M {x},{y - 12} L {x + 12},{y - 12} {coil} L {x + 68},{y - 12} L {x + 80},{y - 12}" fill="none" stroke="#222" stroke-width="1.6"/>'
        + f'<path d="M {x},{y + 14} L {x + 44},{y + 14} M {x + 44},{y + 8} L {x + 44},{y + 20} M {x + 52},{y + 6} L {x + 30},{y + 6} M {x + 52},{y + 22} '
        f'L {x + 30},{y + 22} M {x + 52},{y + 6} L {x + 52},{y + 22} M {x + 52},{y + 14} L {x + 80},{y + 14}" fill="none" stroke="#222" stroke-width="1.6"/>'
        + line(x + 80, y - 26, x + 80, y + 26, "stroke:#222;stroke-width:2")
    )


def values() -> str:
    """The device as a template with the values of a run: what it does not have is left out."""
    left, right, y, radius, ball = 196, 424, 98, 40, 22
    middle, foot = (left + right) / 2, 290
    dimension = y + radius + 52
    parts = [
        TIPS,
        *body(left, right, y, radius),
        round_ball(middle, y, ball),
        flat(left, y, radius),
        flat(right, y, radius),
        text(middle, y + 6, "$m$"),
        text(middle, y - radius - 20, "$M$ = {{ v.mass }}"),
        text(middle, y + radius + 32, "$m$ = {{ v.ball_mass }}, $r_b$ = {{ v.ball_radius }}"),
        force(30, y - radius - 5, left - 26, y - radius - 5),
        text(96, y - radius - 15, "{{ v.drive }}", colour=BLUE),
        text(30, y - radius + 17, "{{ v.amplitude }}", "start", BLUE),
        text(30, y - radius + 38, "{{ v.frequency }}", "start", BLUE),
        text(left - 22, y + radius - 2, "$C_left(t)$", "end", RED),
        text(right + 24, y - radius + 2, "$C_right(t)$", "start", RED),
        text(right + 24, y - radius + 26, "$R_2$ = {{ v.radius }}", "start"),
        text(right + 24, y - radius + 50, "$h_2$ = {{ v.thickness }}", "start"),
        text(right + 24, y - radius + 74, "{{ v.contact }}", "start"),
        helper(left + 12, y + radius, left + 12, dimension + 6),
        helper(right - 12, y + radius, right - 12, dimension + 6),
        length(left + 12, dimension, right - 12, dimension),
        text(middle, dimension + 22, "$d$ = {{ v.length }}, free travel $s$ = {{ v.travel }}"),
        "{%- if let Some(rates) = v.suspension %}",
        spring(30, foot),
        text(122, foot - 6, "$k$ = {{ rates.0 }}", "start"),
        text(122, foot + 20, "$c$ = {{ rates.1 }}", "start"),
        "{%- endif %}",
        "{%- if let Some(slope) = v.slope %}",
        helper(330, foot + 22, 420, foot + 22),
        '<line x1="330" y1="{{ slope.end.1 }}" x2="{{ slope.end.0 }}" y2="{{ slope.end.2 }}" style="stroke:#222;stroke-width:3"/>',
        text(432, foot - 6, "$β$ = {{ slope.angle }}", "start"),
        text(432, foot + 20, "$g$ = {{ slope.gravity }}, $μ$ = {{ slope.friction }}", "start"),
        "{%- endif %}",
    ]
    return card((0, 0, 620, "{{ v.height }}"), "The device with the values of the run, not to scale", "\n".join(parts))


def membrane() -> str:
    """Lengths, angle and areas of Eqs. (3) to (5)."""
    x, y, radius, ball, deflection = 230, 96, 150, 62, 92
    alpha = angle(deflection, radius, ball)
    centre, bottom = y + deflection - ball, y + deflection
    across, touch = ball * sin(alpha), centre + ball * cos(alpha)
    arc = 46
    parts = [
        TIPS,
        helper(x - radius, y, x + radius, y),
        helper(x, 20, x, bottom),
        helper(x, bottom, x + radius + 50, bottom),
        helper(x + radius, y, x + radius + 50, y),
        f'<circle cx="{x}" cy="{centre}" r="{ball}" fill="#a9cbe8" stroke="#333"/>',
        rectangle(x - radius - 44, y - 7, 44, 14, "#d5dae0"),
        rectangle(x + radius, y - 7, 30, 14, "#d5dae0"),
        f'<path d="M {x - radius},{y} L {x - across:.5g},{touch:.5g} A {ball},{ball} 0 0 0 {x + across:.5g},{touch:.5g} L {x + radius},{y}" '
        f'fill="none" stroke="{RED}" stroke-width="4"/>',
        helper(x - across, touch, x + across, touch),
        length(x, centre, x + across, touch, both=False),
        text(x + across / 2 + 8, centre + 20, "$r_b$", "start"),
        length(x - radius, 40, x, 40),
        text(x - radius / 2, 32, "$R_2$"),
        helper(x - radius, 30, x - radius, y),
        length(x + radius + 44, y, x + radius + 44, bottom),
        text(x + radius + 54, (y + bottom) / 2 + 6, "$δ$", "start"),
        f'<path d="M {x - radius + arc},{y} A {arc},{arc} 0 0 1 {x - radius + arc * cos(alpha):.5g},{y + arc * sin(alpha):.5g}" fill="none" stroke="#222"/>',
        text(x - radius + arc + 8, y + 20, "$α$", "start"),
        text(x - radius + 18, y + 70, "cone $A_32$", colour=RED),
        text(x, bottom + 26, "cap $A_31$", colour=RED),
    ]
    return card((0, 0, 460, 230), "A membrane pressed in by the ball", "\n".join(parts))


def drawings() -> dict[str, str]:
    """File names and contents."""
    return {"device.svg": device(), "membrane.svg": membrane()}


def templates() -> dict[str, str]:
    """Drawings with places for the values of a run."""
    return {"device.svg": values()}
