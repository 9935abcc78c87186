"""One instance of an FMU in a process of its own, driven through FMPy.

    second_process.py FMU <commands

A command is a method of Client and its arguments. Commands and answers are JSON; an answer is [value, error, lines of the log].
"""

import ctypes
import json
import shutil
import sys
from pathlib import Path

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.logging import addLoggerProxy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from slaves import FMU2NamedSlave  # noqa: E402


class Client:
    def __init__(self, slave: FMU2NamedSlave):
        self.start, self.step, self.get, self.set = slave.begin, slave.doStep, slave.get, slave.set
        self.outputs = lambda: list(slave.outputs().values())
        self.slave = slave

    def save(self, path: str) -> None:
        state = self.slave.getFMUstate()
        Path(path).write_bytes(self.slave.serializeFMUstate(state))
        self.slave.freeFMUstate(state)

    def load(self, path: str) -> None:
        state = self.slave.deSerializeFMUstate(Path(path).read_bytes())
        self.slave.setFMUstate(state)
        self.slave.freeFMUstate(state)


def answer(client: Client, log: list, command: str, *arguments) -> list:
    log.clear()
    try:
        return [getattr(client, command)(*arguments), None, log.copy()]
    except FMICallException as error:
        return [None, error.status, log.copy()]


def main(fmu: str) -> None:
    log = []

    def hear(_environment, _instance, status, category, message):
        log.append([status, category.decode(), message.decode()])

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = fmi2CallbackLoggerTYPE(hear)
    callbacks.allocateMemory, callbacks.freeMemory = defaultCallbacks.allocateMemory, defaultCallbacks.freeMemory
    # Formats each message before it hands it on.
    addLoggerProxy(ctypes.byref(callbacks))
    folder = fmpy.extract(fmu)
    slave = FMU2NamedSlave(fmpy.read_model_description(folder), folder)
    slave.instantiate(callbacks=callbacks, loggingOn=True)
    client = Client(slave)
    json.dump([answer(client, log, *command) for command in json.load(sys.stdin)], sys.stdout)
    slave.freeInstance()
    shutil.rmtree(folder)


if __name__ == "__main__":
    main(sys.argv[1])
