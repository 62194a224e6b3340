"""Which tests run which lines of a room, and runs of tests chosen from them: for `make mutants`.

Tests are run once under coverage, each a context of its own with what sets it up; chosen tests are run in the order in
which they are named, until one fails. Both are done once in the life of a process.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from coverage import Coverage

_QUIET = (
    *("-q", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning"),
    *("-m", "not long and not linuxcnc and not chromium"),
)


@dataclass(frozen=True, slots=True)
class Covered:
    """What tests run.

    seconds : of a processor, by test, of those that pass
    lines : by file and line, the tests that run it; line 0 has those that run any line of the file
    """

    seconds: Mapping[str, float]
    lines: Mapping[str, Mapping[int, Sequence[str]]]

    @staticmethod
    def read(path: Path) -> Covered:
        """Return what `learn` wrote."""
        said = json.loads(path.read_text())
        names = list(said["seconds"])
        files = {
            file: {int(line): [names[test] for test in tests] for line, tests in lines.items()}
            for file, lines in said["lines"].items()
        }
        return Covered(said["seconds"], files)

    def tests_of(self, file: str, lines: Sequence[int]) -> list[str]:
        """Return the tests that run one of these lines, fastest first; where none does, of the file."""
        known = self.lines.get(file, {})
        found = {test for line in lines for test in known.get(line, ())} or set(known.get(0, ()))
        return sorted(found, key=lambda test: (self.seconds[test], test))


class _Learning:
    """Gives each test a context, and notes what it took."""

    def __init__(self, coverage: Coverage) -> None:
        self._coverage = coverage
        self.seconds = dict[str, float]()
        self.failed = set[str]()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self._coverage.switch_context(item.nodeid)
        begin = time.process_time()
        result = yield
        self.seconds[item.nodeid] = time.process_time() - begin
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if not report.passed:
            self.failed.add(report.nodeid)


class _Chosen:
    """Leaves of what is collected what was chosen, in its order, and notes what fails."""

    def __init__(self, tests: Sequence[str], failed: Path) -> None:
        self._place, self._failed = {test: place for place, test in enumerate(tests)}, failed

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = sorted(
            (item for item in items if item.nodeid in self._place), key=lambda item: self._place[item.nodeid]
        )

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self._failed.write_text(report.nodeid)


def learn(files: Sequence[str], sources: Path, out: Path) -> int:
    """Run files of tests and write which lines of the files below a folder each of them runs."""
    from coverage import Coverage

    coverage = Coverage(data_file=None, config_file=False, include=[f"{sources}/*"])
    learning = _Learning(coverage)
    coverage.start()
    pytest.main([*_QUIET, *files], plugins=[learning])
    coverage.stop()
    passed = [test for test in learning.seconds if test not in learning.failed]
    if not passed:
        return 1
    number, data = {test: place for place, test in enumerate(passed)}, coverage.get_data()
    lines = dict[str, dict[int, list[int]]]()
    for file in sorted(data.measured_files()):
        by_line = {
            line: sorted(number[test] for test in tests if test in number)
            for line, tests in sorted(data.contexts_by_lineno(file).items())
        }
        lines[file] = {0: sorted({test for tests in by_line.values() for test in tests}), **by_line}
    out.parent.mkdir(parents=True, exist_ok=True)
    said: dict[str, Any] = {"seconds": {test: round(learning.seconds[test], 3) for test in passed}, "lines": lines}
    out.write_text(json.dumps(said))
    return 0


def run(file: Path) -> int:
    """Run the tests that a file lists until one fails, whose name is written beside it; return pytest's status."""
    tests = json.loads(file.read_text())
    files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
    return int(pytest.main([*_QUIET, "-x", *files], plugins=[_Chosen(tests, failed_of(file))]))


def failed_of(file: Path) -> Path:
    """Return where the name of the test stands that failed."""
    return file.with_suffix(".failed")
