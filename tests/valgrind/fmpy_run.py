"""FMPy simulates both FMUs of both versions of FMI under valgrind: an error with a frame in a library of ours is one, whatever Python does is not.

Errors are told apart by the object that a frame lies in, so that no list of suppressions has to follow Python and NumPy.
Shows then that a fault would have been seen, by reading an array beyond its end.

    python tests/valgrind/fmpy_run.py          runs valgrind
    python tests/valgrind/fmpy_run.py WORD     what it watches: "simulate" or "overrun"
"""

import contextlib
import ctypes
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

FMUS = Path(__file__).resolve().parents[2] / "target" / "fmu"
NAMES = ("VibroImpactHarvester", "HarvestingCircuit")
VALGRIND = ["valgrind", "--quiet", "--leak-check=full", "--show-leak-kinds=definite,indirect", "--xml=yes"]
# FMPy unloads the libraries, and what they leaked is only found at the end.
VALGRIND += ["--keep-debuginfo=yes", "--num-callers=40"]


def simulate() -> None:
    for name in NAMES:
        options = {"stop_time": 2.0, "output_interval": 0.1, "fmi_type": "CoSimulation"}
        result = fmpy.simulate_fmu(str(FMUS / f"{name}.fmu"), **options)
        events = {"use_event_mode": True, "early_return_allowed": True} if name == NAMES[0] else {}
        result3 = fmpy.simulate_fmu(str(FMUS / "fmi3" / f"{name}.fmu"), **options, **events)
        print(f"{name}: {len(result)} rows, of FMI 3.0 {len(result3)}")


def overrun() -> None:
    """Reads a thousand values by way of one value reference."""
    with tempfile.TemporaryDirectory() as folder:
        overrun_in(fmpy.extract(str(FMUS / f"{NAMES[0]}.fmu"), folder))


def overrun_in(folder: str) -> None:
    description = fmpy.read_model_description(folder)
    slave = FMU2Slave(guid=description.guid, modelIdentifier=NAMES[0], unzipDirectory=folder, instanceName="overrun")
    slave.instantiate()
    # On the heap of C, where valgrind knows its end.
    calloc = ctypes.CDLL(None).calloc
    calloc.restype = ctypes.c_void_p
    reference = ctypes.cast(calloc(1, 4), ctypes.POINTER(ctypes.c_uint))
    values = (ctypes.c_double * 1000)()
    # What lies behind is no value reference, and is refused.
    with contextlib.suppress(FMICallException):
        slave.fmi2GetReal(slave.component, reference, ctypes.c_size_t(1000), values)
    slave.freeInstance()


def ours(error: ElementTree.Element) -> bool:
    objects = (Path(frame.text).stem for frame in error.iter("obj"))
    return any(name in NAMES for name in objects)


def watched(word: str) -> list[str]:
    """The errors of ours that valgrind sees while `word` runs."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        command = [*VALGRIND, f"--xml-file={report}", sys.executable, __file__, word]
        subprocess.run(command, check=True, env=os.environ | {"PYTHONMALLOC": "malloc"})
        errors = ElementTree.parse(report).getroot().findall("error")
    found = [ElementTree.tostring(error, encoding="unicode") for error in errors if ours(error)]
    print(f"{word}: {len(errors)} errors, {len(found)} of them with a frame in a library of an FMU", flush=True)
    return found


def main() -> int:
    if sys.argv[1:]:
        {"simulate": simulate, "overrun": overrun}[sys.argv[1]]()
        return 0
    found = watched("simulate")
    print(*found, sep="\n", end="")
    if found:
        return 1
    if not any("InvalidRead" in error for error in watched("overrun")):
        print("valgrind did not see a deliberate overrun", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
