"""Rules of the whole suite: reproducible examples, and no silent skips where everything must be there."""

from __future__ import annotations

import gc
import os
from collections.abc import Generator, Iterator
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

from tests import saying, shapes
from tests.commands import Command, Outcome

if TYPE_CHECKING:
    from tests.web.browser import Browser

pytest_plugins = ["tests.order"]
os.environ["AXISCAL_KEY"] = os.devnull + "/none"  # no test signs with the key of who runs it
os.environ["XDG_CONFIG_HOME"] = os.devnull + "/none"  # nor says yes to code for whoever runs it
os.environ["AXISCAL_PROGRESS"] = "off"  # what commands say in tests does not hang on how long they take
shapes.install()  # before anything of the package is loaded
saying.install()
settings.register_profile("axiscal", deadline=None, derandomize=True, print_blob=True, max_examples=25)
settings.register_profile("explore", deadline=None, max_examples=2000)
settings.load_profile(os.environ.get("AXISCAL_HYPOTHESIS", "axiscal"))


@pytest.fixture(scope="session", autouse=True)
def _one_thread() -> Iterator[None]:
    """Hold the linear algebra of all tests to one thread: the workers of a distributed run fill the cores."""
    from axiscal_core.threads import one_thread

    with one_thread():
        yield


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Chromium, one for all tests that look at pages."""
    from tests.web.browser import Browser

    with Browser(tmp_path_factory.mktemp("chromium")) as running:
        yield running


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    """A way to give commands; what was written before them is not theirs."""
    from axiscal.cli.app import run

    def given(*words: object) -> Outcome:
        capsys.readouterr()
        status = run([str(word) for word in words])
        return Outcome(status, *capsys.readouterr())

    return given


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with LinuxCNC: its machines move in their own time, and leave the processor to the other workers."""
    items.sort(key=lambda item: "linuxcnc" not in item.path.parts)


def pytest_collection_finish() -> None:
    """Leave what was loaded to itself: the collector would walk through all tests of the suite again and again."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Fail a test that is skipped, where AXISCAL_NO_SKIPS=1 says that nothing may be missing."""
    report = yield
    if report.skipped and os.environ.get("AXISCAL_NO_SKIPS") == "1":
        report.outcome, report.longrepr = "failed", f"AXISCAL_NO_SKIPS=1 allows no skip: {report.longrepr}"
    return report
