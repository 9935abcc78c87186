"""A federate of HELICS that cannot hang: one whose partner, broker or own FMU fails ends with an error."""

import argparse
import queue
import socket
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from tool import Problem, need

need("helics")

import helics  # noqa: E402
from fmpy.fmi1 import FMICallException  # noqa: E402

NEVER = helics.HELICS_TIME_MAXTIME
"""What a federate asks for that waits for values, s."""

MASTERS = ["gauss-seidel", "plain"]
TIMEOUT = 30.0
PATIENCE = 3.0
"""How long HELICS may take to be taken in by a broker, in times of the timeout: it tries more than once."""
BROKER = "127.0.0.1:23404"
CORES = ["zmq_ss", "zmq", "tcp"]
"""Cores of HELICS. Of helics 3.6.1's tcp_ss the message that registers a federate is lost now and then."""


def arguments(description: str) -> argparse.ArgumentParser:
    """Options that both federates have."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--fmu", type=Path, required=True, metavar="FILE", help="the FMU")
    parser.add_argument(
        "--parameters", type=Path, metavar="FILE.ssv", help="its parameter set (SSP 1.0), as in Harvester.ssp"
    )
    parser.add_argument(
        "--output", type=Path, required=True, metavar="FILE.csv", help="time series, a row a communication point"
    )
    parser.add_argument("--broker", default=BROKER, metavar="HOST:PORT", help="where the broker listens [%(default)s]")
    add_run_options(parser)
    return parser


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """Options that must be the same for all of a federation."""
    parser.add_argument("--until", type=float, default=100.0, metavar="S", help="end of the run, s [%(default)s]")
    parser.add_argument("--step", type=float, default=1e-3, metavar="S", help="communication step, s [%(default)s]")
    parser.add_argument("--master", choices=MASTERS, default=MASTERS[0], help="as of videg cosim [%(default)s]")
    parser.add_argument(
        "--core", choices=CORES, default=CORES[0], help="core of HELICS, as of the broker [%(default)s]"
    )
    parser.add_argument(
        "--timeout",
        type=float,
        default=TIMEOUT,
        metavar="S",
        help="a partner silent for so long is lost, s [%(default)s]",
    )


def core_options(timeout: float) -> str:
    """Options of a core or broker: how long to wait for partners, and how often to ask whether they live. One that does
    not answer twice is lost."""
    if not 1.0 <= timeout <= 1e6:
        raise Problem(f"--timeout {timeout} s: must lie from 1 to 1e6 s")
    return f"--timeout={timeout}s --tick={timeout / 3.0}s --loglevel=no_print"


def in_step(partner: str, reached: float, now: float) -> None:
    """Checks that the partner has come to `now`, s, and no further: two that were started differently would go on with
    old values."""
    if reached != now:
        raise Problem(
            f"the {partner} is at {reached} s in place of {now} s: --until, --step and --master must be the same"
        )


def reach(host: str, port: int, timeout: float) -> None:
    """Waits until somebody listens at the address of the broker."""
    deadline = time.monotonic() + timeout
    while True:
        try:
            socket.create_connection((host, port), timeout).close()
            return
        except OSError as error:
            if time.monotonic() > deadline:
                raise Problem(f"no HELICS broker at {host}:{port} within {timeout} s: {error}") from error
            time.sleep(0.1)


def registered(name: str, info: object, broker: str, timeout: float) -> object:
    """The federate, taken in by the broker. HELICS 3.6.1 waits for ever for one that listens and says nothing, as one does
    that has just ended because another federate failed."""
    answers: queue.SimpleQueue = queue.SimpleQueue()

    def register() -> None:
        try:
            answers.put(helics.helicsCreateValueFederate(name, info))
        except helics.HelicsException as error:
            answers.put(error)

    # Mostly HELICS gives up by itself, and says why.
    threading.Thread(target=register, daemon=True).start()
    try:
        answer = answers.get(timeout=PATIENCE * timeout)
    except queue.Empty:
        problem = Problem(f"the broker at {broker} does not answer within {PATIENCE * timeout} s")
        # Where the process ends in order, the library waits for its threads.
        problem.at_once = True
        raise problem from None
    if isinstance(answer, helics.HelicsException):
        raise Problem(f"the broker at {broker} does not take it in: {answer}") from answer
    return answer


class Federate:
    """A value federate that publishes and subscribes to doubles. Use it in a `with` statement: what goes wrong within
    ends the whole federation."""

    def __init__(self, name: str, options: argparse.Namespace, *, waits: bool):
        """With `waits`, the federate runs last of those granted one time, and sees what they published at it; else it
        sees what they published before."""
        host, _, port = options.broker.rpartition(":")
        if not host or not port.isdigit():
            raise Problem(f"--broker {options.broker}: must be HOST:PORT")
        settings = core_options(options.timeout)
        reach(host, int(port), options.timeout)
        info = helics.helicsCreateFederateInfo()
        helics.helicsFederateInfoSetCoreTypeFromString(info, options.core)
        where = f"--federates=1 --broker_address={host} --brokerport={port}"
        helics.helicsFederateInfoSetCoreInitString(info, f"{where} {settings}")
        flags = {
            helics.HELICS_FLAG_TERMINATE_ON_ERROR: True,
            helics.HELICS_FLAG_WAIT_FOR_CURRENT_TIME_UPDATE: waits,
            helics.HELICS_FLAG_UNINTERRUPTIBLE: not waits,
        }
        for flag, value in flags.items():
            helics.helicsFederateInfoSetFlagOption(info, flag, value)
        helics.helicsFederateInfoSetTimeProperty(info, helics.HELICS_PROPERTY_TIME_GRANT_TIMEOUT, options.timeout)
        self._federate = registered(name, info, options.broker, options.timeout)
        self._name, self._time, self._timeout = name, 0.0, options.timeout
        self._joining = False
        self._publications: list = []
        self._inputs: list = []

    def __enter__(self) -> "Federate":
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if self._joining:
            # The federate waits and answers to nothing, but its core does. The message is not encoded by helics 3.6.1.
            core = helics.helicsFederateGetCore(self._federate)
            helics.helicsCoreGlobalError(core, 2, f"{self._name}: {error}".encode())
            helics.helicsCoreDisconnect(core)
            return
        try:
            if error is not None and not isinstance(error, helics.HelicsException):
                helics.helicsFederateGlobalError(self._federate, 2, f"{self._name}: {error}")
            helics.helicsFederateDisconnect(self._federate)
        except helics.HelicsException:
            pass  # The federation is broken; the error that broke it is on its way up.
        helics.helicsCloseLibrary()
        if isinstance(error, FMICallException):
            raise Problem(f"after {self._time} s an FMU failed: {error}") from error
        if isinstance(error, helics.HelicsException):
            raise Problem(f"the federation broke after {self._time} s: {error}") from error

    def publications(self, names: Sequence[str], unit: str) -> None:
        """Registers publications FEDERATE/NAME."""
        register = helics.helicsFederateRegisterPublication
        double = helics.HELICS_DATA_TYPE_DOUBLE
        self._publications += [register(self._federate, name, double, unit) for name in names]

    def subscriptions(self, names: Sequence[str], unit: str) -> None:
        """Registers subscriptions to FEDERATE/NAME."""
        self._inputs += [helics.helicsFederateRegisterSubscription(self._federate, name, unit) for name in names]

    def enter(self, values: Sequence[float] | None = None) -> None:
        """Enters the run, once all have; `values` are known to the others from the start."""
        self._await(helics.helicsFederateEnterInitializingModeAsync)
        helics.helicsFederateEnterInitializingModeComplete(self._federate)
        if values is not None:
            self.publish(values)
        self._await(helics.helicsFederateEnterExecutingModeAsync)
        helics.helicsFederateEnterExecutingModeComplete(self._federate)

    def _await(self, begin: Callable) -> None:
        """Begins what ends once all federates have come so far; HELICS itself would wait for ever."""
        begin(self._federate)
        self._joining = True
        deadline = time.monotonic() + self._timeout
        while not helics.helicsFederateIsAsyncOperationCompleted(self._federate):
            if time.monotonic() > deadline:
                raise Problem(f"the other federates did not join within {self._timeout} s")
            time.sleep(0.005)
        self._joining = False

    def publish(self, values: Sequence[float]) -> None:
        """Publishes one value for each publication, in the order of their registration."""
        for publication, value in zip(self._publications, values, strict=True):
            helics.helicsPublicationPublishDouble(publication, value)

    def request(self, time: float) -> float:
        """Waits for `time`, s, or for values if the federate is one that waits for them; returns the time granted."""
        self._time = helics.helicsFederateRequestTime(self._federate, time)
        return self._time

    def values(self) -> list[float]:
        """What was published for the subscriptions, in the order of their registration."""
        return [helics.helicsInputGetDouble(value) for value in self._inputs]
