"""`make mutants`: the source changed by a word, one place at a time, and whether a test fails that did not fail before.

Places are drawn at random from all of a room (cosmic-ray finds and changes them; `.venv-mutants` has it), and one
change at each. The tests of a room are run once under coverage; then for each change those that run its line, fastest
first, until one fails. Types and decorators are left alone: no run can tell them apart.
"""

from __future__ import annotations

import argparse
import ast
import compileall
import hashlib
import json
import os
import random
import resource
import shutil
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib import import_module
from itertools import accumulate
from pathlib import Path

import pytest
from scipy.stats import binomtest

from tests.reliability import covering
from tests.reliability.covering import Covered
from tests.reliability.kept import FOLDER, HOUSE, Kept, state_of_sources

SOURCES, TESTS = HOUSE / "src", HOUSE / "tests"
_PACKAGE = SOURCES / "axiscal"
ROOMS = {"core": SOURCES / "axiscal_core"} | {
    room.name: room for room in sorted(_PACKAGE.iterdir()) if (TESTS / room.name).is_dir()
}
"""Its folder, by the name that its tests have."""
_APART = ("docs", "cli", "web", "scenarios", "benchmarks", "reliability")
_LOADED = ("hypothesis", "scipy.linalg", "scipy.optimize", "threadpoolctl")
"""What tests and package need of others, loaded once for all forks; nothing of the package itself."""
_FIRST = 8
"""So many tests are run first, the fastest: they find most changes, and to load all files takes longer than they do."""
_ARITHMETIC = ("Add", "Sub", "Mul", "Div", "Pow", "FloorDiv", "Mod")
_ORDER = ("Eq", "NotEq", "Lt", "LtE", "Gt", "GtE")


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change: of a file, by an operator of cosmic-ray's, where it applies for the so-manieth time."""

    path: Path
    operator: str
    occurrence: int
    line: int

    @property
    def name(self) -> str:
        """Return what it is called in what is kept."""
        return f"{self.path.relative_to(SOURCES)}:{self.line} {self.operator} {self.occurrence}"


def mutants(path: Path) -> dict[tuple[int, int], list[Mutant]]:
    """Return every change of a file that can be told by a run, by the place (line, column) that is changed."""
    from cosmic_ray.ast import ast_nodes, get_ast_from_path
    from cosmic_ray.plugins import get_operator

    tree, left = get_ast_from_path(path), silent(ast.parse(path.read_text()))
    found = defaultdict[tuple[int, int], list[Mutant]](list)
    for operator in _operators():
        places = [place for node in ast_nodes(tree) for place in get_operator(operator)().mutation_positions(node)]
        for occurrence, (begin, _) in enumerate(places):
            if not any(first <= begin < last for first, last in left):
                found[begin].append(Mutant(path, operator, occurrence, begin[0]))
    return found


def drawn(room: str, number: int, seed: int = 1) -> list[Mutant]:
    """Return so many places of a room, drawn at random, and a change drawn at each: the same ones for the same seed."""
    places = [changes for path in sorted(ROOMS[room].rglob("*.py")) for changes in mutants(path).values()]
    dice = random.Random(f"{room} {len(places)}{'' if seed == 1 else f' {seed}'}")
    return [dice.choice(changes) for changes in dice.sample(places, min(number, len(places)))]


def outcome(mutant: Mutant, covered: Covered, seconds: float) -> str:
    """Return by which test a change is `killed`, or that it `survives` the tests that run its line.

    seconds : of a processor, as many as the tests may take on the sources as they are, fastest first
    """
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    text = mutant.path.read_text()
    tests = covered.tests_of(str(mutant.path), statement(ast.parse(text), mutant.line))
    chosen = [
        test
        for test, spent in zip(tests, accumulate(map(covered.seconds.__getitem__, tests)), strict=True)
        if spent <= seconds
    ]
    if not chosen:
        return "survives: no test runs it"
    changed = mutate_code(text, get_operator(mutant.operator)(), mutant.occurrence)
    with tempfile.TemporaryDirectory(dir=FOLDER) as name:
        sources = Path(name) / "src"
        shutil.copytree(SOURCES, sources, copy_function=os.link)
        here = sources / mutant.path.relative_to(SOURCES)
        here.unlink()
        here.write_text(changed)
        batches = (some for some in (chosen[:_FIRST], chosen[_FIRST:]) if some)
        each = (first_failed(some, sources, 30 + 3 * sum(map(covered.seconds.__getitem__, some))) for some in batches)
        failed = next((found for found in each if found is not None), None)
    return f"survives {len(chosen)} of {len(tests)} tests" if failed is None else f"killed by {failed}"


def first_failed(tests: Sequence[str], sources: Path, seconds: float) -> str | None:
    """Return the test that fails on these sources, or what else ends their run; None where all pass."""
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "tests.json"
        file.write_text(json.dumps(list(tests)))
        status = _status(partial(covering.run, file), sources, seconds)
        if status < 0:
            return f"signal {-status}: it went on for more than {seconds:.0f} s of a processor"
        failed = covering.failed_of(file)
        if failed.exists():
            return failed.read_text()
    return None if status in {pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED} else "the loading of tests"


def learnt(room: str, own: bool) -> Covered:
    """Return what the tests of a room run, and those elsewhere that name one of its modules.  own : not those

    It is the same for all places that are drawn, so that other places of the same sources are tried without it.
    """
    paths = ROOMS[room].rglob("*.py")
    files = sorted({file for path in paths for file in files_of_tests(path) if not own or _room_of(file) == room})
    said = hashlib.sha256(f"{state_of_sources(('src', 'tests'))} {files}".encode()).hexdigest()
    file = FOLDER / f"covered-{room}-{said[:12]}.json"
    if not file.exists():
        _say(f"{room}: {len(files)} files of tests are run once")
        compileall.compile_dir(SOURCES, quiet=2)
        if _status(partial(covering.learn, files, ROOMS[room], file), SOURCES, 7200) != 0:
            sys.exit(f"no test of {room} passes without any change")
    covered = Covered.read(file)
    wrong = first_failed(sorted(covered.seconds, key=covered.seconds.__getitem__)[:1], SOURCES, 600)
    if wrong is not None:
        sys.exit(f"{wrong} fails without any change")
    return covered


def _status(work: Callable[[], int], sources: Path, seconds: float) -> int:
    """Return how work with pytest ends on sources, in a fork of this process that may use so many processor seconds."""
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    status = 3
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds)))
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in range(3):
            os.dup2(nowhere, stream)
        os.chdir(HOUSE)
        os.environ["PYTHONPATH"] = str(sources)
        sys.path.insert(0, str(sources))
        status = work()
    finally:
        os._exit(status)


@cache
def files_of_tests(path: Path) -> tuple[str, ...]:
    """Return the files of tests for a changed module: those of its room, those that name it, and rows of refusals.

    Tests of whole commands, pages and docs are left out. `covering` leaves out long ones, which `make test` does not
    run either, and what starts a LinuxCNC or a browser.
    """
    module = ".".join(path.relative_to(SOURCES).with_suffix("").parts).removesuffix(".__init__")
    room, _, word = module.rpartition(".")
    naming = (f"import {module}", f"from {module} import", f"from {room} import {word}")
    own = TESTS / next(name for name, folder in ROOMS.items() if folder in path.parents)
    return tuple(
        str(test.relative_to(HOUSE))
        for test in sorted(TESTS.rglob("test_*.py"))
        if own in test.parents
        or _room_of(str(test.relative_to(HOUSE))) == "refusals"
        or (
            _room_of(str(test.relative_to(HOUSE))) not in _APART
            and (test.name == f"test_{path.stem}.py" or _says(test, naming))
        )
    )


def _room_of(test: str) -> str:
    """Return the room for which a file of tests stands."""
    return Path(test).parts[1]


def statement(tree: ast.Module, line: int) -> range:
    """Return the lines of the statement around a line, of one that holds others those before them."""
    spans = [_own_lines(node) for node in ast.walk(tree) if isinstance(node, ast.stmt)]
    return min((span for span in spans if line in span), key=len, default=range(line, line + 1))


def _own_lines(node: ast.stmt) -> range:
    """Return the lines of a statement without those of the statements in it."""
    inner = [part.lineno for part in ast.walk(node) if part is not node and isinstance(part, ast.stmt)]
    end = (node.end_lineno or node.lineno) + 1
    return range(node.lineno, max(node.lineno + 1, min([end, *inner])))


def _says(test: Path, words: Sequence[str]) -> bool:
    """Return whether a file of tests has one of these words."""
    return any(word in test.read_text() for word in words)


@cache
def _operators() -> tuple[str, ...]:
    """Return the changes that are tried; those that Python or a type refuses at once would be counted as found."""
    swaps = [f"ReplaceBinaryOperator_{one}_{other}" for one in _ARITHMETIC for other in _ARITHMETIC if one != other]
    orders = [f"ReplaceComparisonOperator_{one}_{other}" for one in _ORDER for other in _ORDER if one != other]
    words = ["AddNot", "NumberReplacer", "ReplaceAndWithOr", "ReplaceOrWithAnd", "ReplaceTrueWithFalse"]
    words += ["ReplaceFalseWithTrue", "ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "ZeroIterationForLoop"]
    words += [f"ReplaceUnaryOperator_Delete_{sign}" for sign in ("USub", "Not", "Invert")]
    words += ["ReplaceComparisonOperator_Is_IsNot", "ReplaceComparisonOperator_IsNot_Is"]
    return tuple(f"core/{name}" for name in [*words, *swaps, *orders])


def silent(tree: ast.Module) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Return the begin and end (line, column) of types and decorators, which no run can tell apart."""
    return [
        ((node.lineno, node.col_offset), (node.end_lineno or node.lineno, node.end_col_offset or 0))
        for parent in ast.walk(tree)
        for node in _unread(parent)
    ]


def _unread(node: ast.AST) -> Iterator[ast.expr]:
    """Yield what of a node only a type checker or a decorator reads."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        yield from node.decorator_list
    if isinstance(node, ast.FunctionDef) and node.returns is not None:
        yield node.returns
    if isinstance(node, ast.arg | ast.AnnAssign) and node.annotation is not None:
        yield node.annotation
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        yield node.test


def score(killed: int, tried: int) -> tuple[float, float, float]:
    """Return the share that was killed and its 95 % interval (Clopper, Pearson 1934, 10.1093/biomet/26.4.404)."""
    found = binomtest(killed, tried).proportion_ci(0.95, method="exact")
    return killed / tried, float(found.low), float(found.high)


def main(words: Sequence[str]) -> int:
    """Print what survives and the score of each room; return 1 where a score is below 85 %."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--places", type=int, default=100, help="how many places of each room")
    parser.add_argument("--seed", type=int, default=1, help="other places for another seed")
    parser.add_argument("--room", choices=ROOMS, help="only this room")
    parser.add_argument("--seconds", type=float, default=60, help="of a processor that the tests of a change may take")
    parser.add_argument("--own", action="store_true", help="only the room's own tests: sooner, and fewer notice")
    parser.add_argument("--again", action="store_true", help="try anew what survived; tests may have been added since")
    args = parser.parse_args(words)
    for name in _LOADED:
        import_module(name)
    low = False
    for room in ROOMS if args.room is None else (args.room,):
        tried = drawn(room, args.places, args.seed)
        covered = learnt(room, args.own)
        found = [_tried(mutant, covered, args.seconds, args.again, args.own) for mutant in tried]
        killers = sorted({said.removeprefix("killed by ") for said in found if said.startswith("killed by tests/")})
        wrong = first_failed(killers, SOURCES, 3600) if killers else None
        if wrong is not None:
            sys.exit(f"fails without any change when it is run among few: {wrong}")
        killed = sum(said.startswith("killed") for said in found)
        share, least, most = score(killed, len(tried))
        _say(f"| {room} | {len(tried)} | {killed} | {share:.1%} ({least:.0%} to {most:.0%}) |")
        low = low or share < 0.85
    return int(low)


def _tried(mutant: Mutant, covered: Covered, seconds: float, again: bool, own: bool) -> str:
    """Return what came of a change, and print it; what was found before on these sources is kept."""
    kept = Kept("mutants-own" if own else "mutants")
    find = partial(outcome, mutant, covered, seconds)
    found = str(kept.get(mutant.name, find))
    if again and found.startswith("survives"):
        found = str(kept.get(f"{mutant.name} again {state_of_sources(('tests',))[:12]}", find))
    _say(f"{mutant.name}: {found}")
    return found


def _say(line: str) -> None:
    """Print a line at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
