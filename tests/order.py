"""The order of the tests, drawn anew for each run: no test may hang on what another one left behind.

AXISCAL_ORDER=11 repeats the order of seed 11 in any selection of tests; AXISCAL_ORDER=off keeps that of the files.
"""

import os
import random
from hashlib import sha256

import pytest

VARIABLE = "AXISCAL_ORDER"


def drawn(seed: str, *names: str) -> bytes:
    """Return the place of what has these names, a draw that hangs on nothing else."""
    return sha256("\n".join((seed, *names)).encode()).digest()


def place(seed: str, item: pytest.Item) -> tuple[bytes, bytes]:
    """Return where a test comes: files in a drawn order, and so the tests of each that does not say IN_ORDER."""
    file = item.path.relative_to(item.config.rootpath).as_posix()
    together = getattr(getattr(item, "module", None), "IN_ORDER", False)
    return drawn(seed, file), b"" if together else drawn(seed, file, item.name)


@pytest.hookimpl(tryfirst=True)
def pytest_configure() -> None:
    """Draw a seed where none is given; workers of a distributed run inherit it, since all must have one order."""
    os.environ.setdefault(VARIABLE, str(random.SystemRandom().randrange(1, 10**6)))


def pytest_report_header() -> str:
    """Return the line that says how to repeat this order."""
    return f"order of tests: {VARIABLE}={os.environ[VARIABLE]}"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the tests in the drawn order, before pytest brings those together that share a parameter of a fixture."""
    seed = os.environ[VARIABLE]
    if seed != "off":
        items.sort(key=lambda item: place(seed, item))
