"""A federate of HELICS that cannot hang: one whose partner, broker or own FMU fails ends with an error."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from tool import Problem, need

need("helics", "scale/requirements.txt")

import helics  # noqa: E402

NEVER = helics.HELICS_TIME_MAXTIME
"""What a federate asks for that waits for values, s."""

MASTERS = ["gauss-seidel", "plain"]
TIMEOUT = 30.0
BROKER = "127.0.0.1:23404"
CORE = "tcp_ss"


def arguments(description: str) -> argparse.ArgumentParser:
    """Options that both federates have."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--fmu", type=Path, required=True, metavar="FILE", help="the FMU")
    parser.add_argument("--parameters", type=Path, metavar="FILE.ssv", help="its parameter set (SSP 1.0), as in Harvester.ssp")
    parser.add_argument("--output", type=Path, required=True, metavar="FILE.csv", help="time series, a row a communication point")
    parser.add_argument("--broker", default=BROKER, metavar="HOST:PORT", help="where the broker listens [%(default)s]")
    add_run_options(parser)
    return parser


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """Options that must be the same for all of a federation."""
    parser.add_argument("--until", type=float, default=100.0, metavar="S", help="end of the run, s [%(default)s]")
    parser.add_argument("--step", type=float, default=1e-3, metavar="S", help="communication step, s [%(default)s]")
    parser.add_argument("--master", choices=MASTERS, default=MASTERS[0], help="as of videg cosim [%(default)s]")
    parser.add_argument("--core", default=CORE, metavar="TYPE", help="HELICS core: tcp_ss, tcp, zmq, ... [%(default)s]")
    parser.add_argument(
        "--timeout", type=float, default=TIMEOUT, metavar="S", help="a partner silent for so long is lost, s [%(default)s]"
    )


def core_options(timeout: float) -> str:
    """Options of a core or broker: how long to wait for partners, and how often to ask whether they live. One that does not
    answer twice is lost."""
    if not 1.0 <= timeout <= 1e6:
        raise Problem(f"--timeout {timeout} s: must lie from 1 to 1e6 s")
    return f"--timeout={timeout}s --tick={timeout / 3.0}s --loglevel=no_print"


class Federate:
    """A value federate that publishes and subscribes to doubles. Use it in a `with` statement: what goes wrong within ends
    the whole federation."""

    def __init__(self, name: str, options: argparse.Namespace, *, waits: bool):
        """With `waits`, the federate runs last of those granted one time, and sees what they published at it; else it sees
        what they published before."""
        host, _, port = options.broker.rpartition(":")
        if not host or not port.isdigit():
            raise Problem(f"--broker {options.broker}: must be HOST:PORT")
        info = helics.helicsCreateFederateInfo()
        helics.helicsFederateInfoSetCoreTypeFromString(info, options.core)
        where = f"--federates=1 --broker_address={host} --brokerport={port}"
        helics.helicsFederateInfoSetCoreInitString(info, f"{where} {core_options(options.timeout)}")
        flags = {
            helics.HELICS_FLAG_TERMINATE_ON_ERROR: True,
            helics.HELICS_FLAG_WAIT_FOR_CURRENT_TIME_UPDATE: waits,
            helics.HELICS_FLAG_UNINTERRUPTIBLE: not waits,
        }
        for flag, value in flags.items():
            helics.helicsFederateInfoSetFlagOption(info, flag, value)
        helics.helicsFederateInfoSetTimeProperty(info, helics.HELICS_PROPERTY_TIME_GRANT_TIMEOUT, options.timeout)
        try:
            self._federate = helics.helicsCreateValueFederate(name, info)
        except helics.HelicsException as error:
            raise Problem(f"{name}: no HELICS broker at {options.broker} within {options.timeout} s: {error}") from error
        self._name, self._time = name, 0.0
        self._publications: list = []
        self._inputs: list = []

    def __enter__(self) -> "Federate":
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        try:
            if error is not None and not isinstance(error, helics.HelicsException):
                helics.helicsFederateGlobalError(self._federate, 2, f"{self._name}: {error}")
            helics.helicsFederateDisconnect(self._federate)
        except helics.HelicsException:
            pass  # The federation is broken; the error that broke it is on its way up.
        helics.helicsCloseLibrary()
        if isinstance(error, helics.HelicsException):
            raise Problem(f"{self._name}: the federation broke after {self._time} s: {error}") from error

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
        helics.helicsFederateEnterInitializingMode(self._federate)
        if values is not None:
            self.publish(values)
        helics.helicsFederateEnterExecutingMode(self._federate)

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
