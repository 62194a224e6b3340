"""The same plan everywhere: the last bits of rows and products, and the number of threads, move no reading."""

import ast
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

import axiscal.planning
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from tests.generators.designs import levered


@pytest.mark.long
def test_the_number_of_threads_does_not_count() -> None:
    found = []
    for threads in (1, 2):
        with threadpool_limits(threads):
            found.append(make_plan(levered(300), Limits(readings=9)))
    np.testing.assert_array_equal(found[0].places.poses, found[1].places.poses)


def test_nothing_that_plans_looks_at_a_clock() -> None:
    folder = Path(axiscal.planning.__path__[0])
    for file in folder.rglob("*.py"):
        imported = {
            name.partition(".")[0]
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
            for name in _imported(node)
        }
        assert not imported & {"time", "datetime", "signal", "resource"}, file.name


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [each.name for each in node.names]
    return [node.module or ""] if isinstance(node, ast.ImportFrom) else []
