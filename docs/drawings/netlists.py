"""Schematics of the netlists in ngspice_netlists/circuits, for one membrane each."""

import schemdraw.elements as elm

from circuits import DROP, Schematic


def to_ground(it: Schematic, element, top, words) -> None:
    """A two-terminal element from `top` to ground, with its name beside it."""
    x, y = top
    it.dot(top)
    it.put(element, top, (x, y - DROP))
    it.ground((x, y - DROP))
    it.label((x + 0.5, y - DROP / 2 - 0.15), words, "start")


def leaky() -> str:
    it = Schematic()
    it.supply((0, 0))
    it.put(elm.Diode(), (0, 0), (2.4, 0))
    it.line((2.4, 0), (5.0, 0))
    it.membrane((2.4, 0), "$C$")
    to_ground(it, elm.ResistorIEC(), (4.4, 0), "$R_leak$")
    it.put(elm.Zener().reverse(), (5.0, 0), (8.0, 0))
    it.label((6.5, 0.6), "$U_z$")
    it.load((8.0, 0), "zener")
    return it.svg("A film that leaks, in the circuit of the paper", (-2.0, 1.9, 11.8, 5.9))


def half_wave() -> str:
    it = Schematic()
    it.supply((0, 0))
    it.put(elm.Diode(), (0, 0), (2.4, 0))
    it.membrane((2.4, 0), "$C$")
    it.put(elm.Diode(), (2.4, 0), (5.4, 0))
    it.line((5.4, 0), (8.0, 0))
    to_ground(it, elm.Capacitor(), (5.4, 0), "$C_s$")
    it.line((8.0, 0), (8.6, 0))
    it.load((8.6, 0), "zener")
    return it.svg("Half-wave rectifier into a storage capacitor", (-2.0, 1.9, 12.4, 5.9))


def self_priming() -> str:
    it, high = Schematic(), 2.8
    it.line((0, high), (6.4, high))
    it.membrane((0, 0), "$C$")
    it.line((0, 0), (0, high))
    for x, words in ((2.2, "$C_p$"), (6.4, "$2 C_p$")):
        it.put(elm.Capacitor(), (x, high), (x, 0))
        it.label((x + 0.5, high / 2 - 0.15), words, "start")
    it.dot((2.2, high))
    it.put(elm.Diode(), (2.2, -DROP), (2.2, 0))
    it.ground((2.2, -DROP))
    it.put(elm.Diode(), (2.2, 0), (4.3, 0))
    to_ground(it, elm.Capacitor(), (4.3, 0), "$2 C_p$")
    it.put(elm.Diode(), (4.3, 0), (6.4, 0))
    it.dot((2.2, 0))
    it.dot((6.4, 0))
    it.put(elm.Diode(), (6.4, 0), (8.6, 0))
    to_ground(it, elm.Capacitor(), (8.6, 0), "$C_p$")
    it.line((8.6, 0), (10.8, 0))
    to_ground(it, elm.Zener().reverse(), (10.8, 0), "load")
    # Back to the membrane.
    it.line((8.6, 0), (8.6, high))
    it.put(elm.Diode(), (8.6, high), (6.4, high))
    it.label((8.8, 0.3), "$U_out$", "start")
    it.dot((6.4, high))
    return it.svg("Self-priming charge pump with two stages", (-1.2, high + 1.0, 14.4, high + 4.6))


def constant_charge() -> str:
    it, low = Schematic(), -4.0
    it.line((0, 0), (0, low))
    it.supply((0, low))
    it.put(elm.Inductor2(), (0, 0), (2.4, 0))
    it.put(elm.Diode(), (2.4, 0), (4.4, 0))
    it.put(elm.Switch(), (4.4, 0), (6.8, 0))
    it.label((1.2, 0.6), "$L$")
    it.label((5.6, 0.8), "charge")
    it.put(elm.Switch(), (6.8, low), (4.4, low))
    it.put(elm.Diode(), (4.4, low), (2.4, low))
    it.put(elm.Inductor2(), (2.4, low), (0, low))
    it.dot((0, low))
    it.label((1.2, low + 0.6), "$L$")
    it.label((5.6, low + 0.8), "discharge")
    it.line((6.8, 0), (6.8, low))
    it.line((6.8, low), (8.4, low))
    it.dot((6.8, low))
    it.membrane((8.4, low), "$C$")
    return it.svg("Constant-charge cycle with inductors", (-2.0, 1.4, 12.2, 9.4))


def drawings() -> dict[str, str]:
    """File names and contents."""
    layouts = {"leaky": leaky, "half-wave": half_wave, "self-priming": self_priming, "constant-charge": constant_charge}
    return {f"netlist-{name}.svg": draw() for name, draw in layouts.items()}
