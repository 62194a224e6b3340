"""`make mutants`: the source changed by a word, one place at a time, and whether a test fails that did not fail before.

Places are drawn at random from all of a room (cosmic-ray finds and changes them; `.venv-mutants` has it), and one
change at each. A test of the changed room, or one that names the module, has to fail. Types and decorators are left
alone: no run can tell them apart.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from tests.certify.kept import HOUSE, Kept

ROOMS = ("numerics", "estimation", "compensation")
PACKAGE = HOUSE / "src" / "axiscal"
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
        return f"{self.path.relative_to(PACKAGE)}:{self.line} {self.operator} {self.occurrence}"


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


def drawn(room: str, number: int) -> list[Mutant]:
    """Return so many places of a room, drawn at random, and a change drawn at each: the same ones at each call."""
    places = [changes for path in sorted((PACKAGE / room).rglob("*.py")) for changes in mutants(path).values()]
    dice = random.Random(f"{room} {len(places)}")
    return [dice.choice(changes) for changes in dice.sample(places, min(number, len(places)))]


def outcome(mutant: Mutant) -> str:
    """Return `killed` by which step of tests, or `survives`."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    changed = mutate_code(mutant.path.read_text(), get_operator(mutant.operator)(), mutant.occurrence)
    with tempfile.TemporaryDirectory() as name:
        sources = Path(name) / "src"
        shutil.copytree(HOUSE / "src", sources)
        (sources / mutant.path.relative_to(HOUSE / "src")).write_text(changed)
        for step, files in enumerate(steps_of(mutant.path)):
            if files and _fails(files, sources):
                return f"killed by step {step + 1}"
    return "survives"


def _fails(files: Sequence[str], sources: Path) -> bool:
    """Return whether a test fails, or takes ten times the processor time that is usual, on these sources."""
    limit = 20 + 3 * _usual_seconds(tuple(files))
    return _run(files, sources, int(limit)).returncode != 0


@cache
def _usual_seconds(files: tuple[str, ...]) -> float:
    """Return the processor seconds of tests on the sources as they are; a failure there ends the run."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = _run(files, HOUSE / "src", 3600)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if run.returncode != 0:
        sys.exit(f"the tests fail without any change: {' '.join(files)}\n{run.stdout[-2000:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _run(files: Sequence[str], sources: Path, seconds: int) -> subprocess.CompletedProcess[str]:
    """Run tests on sources in a process that may use so many seconds of a processor."""
    call = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *files]
    surroundings = {**os.environ, "PYTHONPATH": str(sources), "PYTHONDONTWRITEBYTECODE": "1"}
    bound = partial(resource.setrlimit, resource.RLIMIT_CPU, (seconds, seconds))
    return subprocess.run(
        call, cwd=HOUSE, env=surroundings, preexec_fn=bound, capture_output=True, text=True, check=False
    )


@cache
def steps_of(path: Path) -> tuple[tuple[str, ...], ...]:
    """Return what is run for a changed module, step by step: tests that name it, then the rest of its room."""
    module = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
    room, _, word = module.rpartition(".")
    naming = (f"import {module}", f"from {module} import", f"from {room} import {word}")
    tests = sorted((HOUSE / "tests").rglob("test_*.py"))
    named = [test for test in tests if test.name == f"test_{path.stem}.py" or _says(test, naming)]
    rest = [test for test in sorted((HOUSE / "tests" / module.split(".")[1]).rglob("test_*.py")) if test not in named]
    return tuple(tuple(str(test.relative_to(HOUSE)) for test in step) for step in (named, rest))


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
    """Return the share that was killed and its 95 % interval (Wilson 1927, 10.1080/01621459.1927.10502953)."""
    z, share = 1.959964, killed / tried
    middle = (share + z * z / (2 * tried)) / (1 + z * z / tried)
    half = z / (1 + z * z / tried) * (share * (1 - share) / tried + z * z / (4 * tried * tried)) ** 0.5
    return share, middle - half, middle + half


def main(words: Sequence[str]) -> int:
    """Print what survives and the score of each room; return 1 where a score is below 85 %."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--places", type=int, default=100, help="how many places of each room")
    parser.add_argument("--room", choices=ROOMS, help="only this room")
    args = parser.parse_args(words)
    kept, low = Kept("mutants"), False
    for room in ROOMS if args.room is None else (args.room,):
        tried = drawn(room, args.places)
        killed = 0
        for number, mutant in enumerate(tried, 1):
            found = kept.get(mutant.name, partial(outcome, mutant))
            killed += found != "survives"
            _say(f"{room} {number}/{len(tried)}: {mutant.name}: {found}")
        share, least, most = score(killed, len(tried))
        _say(f"| {room} | {len(tried)} | {killed} | {share:.1%} ({least:.0%} to {most:.0%}) |")
        low = low or share < 0.85
    return int(low)


def _say(line: str) -> None:
    """Print a line at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
