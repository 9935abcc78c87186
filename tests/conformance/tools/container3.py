"""A container of both FMUs with FMI 3.0 outside."""

import container
import job

NAME = "fmucontainer, FMI 3.0"
PROVES = container.PROVES.format(version="3.0")
KNOWN = container.KNOWN
version = container.version


def simulate(fmus: dict[str, str]) -> dict[str, job.Series]:
    return container.simulate(fmus, 3)
