"""A Mach-O library that nothing can run but every check of an FMU's library takes: fake_macho.py FILE.

Stands in for the library of macOS where none can be built. One part for Intel and one for Apple silicon, as released.
"""

import struct
import sys
from pathlib import Path

INTEL, ARM = 0x01000007, 0x0100000C
LIBRARY = 6


def part(machine: int, symbol: bytes) -> bytes:
    names = b"\0" + symbol + b"\0"
    symbols = 32 + 24 + 80
    header = struct.pack("<8I", 0xFEEDFACF, machine, 3, LIBRARY, 2, 24 + 80, 0, 0)
    symbol_table = struct.pack("<6I", 2, 24, symbols, 1, symbols + 16, len(names))
    # Symbol 0 is an exported one.
    dynamic_symbols = struct.pack("<20I", 0xB, 80, 0, 0, 0, 1, *[0] * 14)
    # Name at 1, external, absolute, since there are no sections.
    entry = struct.pack("<IBBHQ", 1, 0x03, 0, 0, 0)
    return header + symbol_table + dynamic_symbols + entry + names


def universal(parts: list[tuple[int, bytes]]) -> bytes:
    step = 4096
    table = b"".join(
        struct.pack(">5I", machine, 3, step * (place + 1), len(data), 12) for place, (machine, data) in enumerate(parts)
    )
    file = struct.pack(">2I", 0xCAFEBABE, len(parts)) + table
    for place, (_, data) in enumerate(parts):
        file = file.ljust(step * (place + 1), b"\0") + data
    return file


if __name__ == "__main__":
    Path(sys.argv[1]).write_bytes(universal([(machine, part(machine, b"_fmi2Instantiate")) for machine in (INTEL, ARM)]))
