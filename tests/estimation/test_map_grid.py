"""The grid of a bed map against a count of its nodes written out, and each of its limits met exactly."""

import itertools
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.estimation.machine_estimate import map_grid
from axiscal.machine import load_machine
from axiscal.measurement.instruments.displacement import Probe
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup

MACHINE = load_machine("three-axis-mill")


def probing(direction: tuple[float, float, float] = (0.0, 0.0, 1.0), moves: tuple[int, ...] = (0, 1)) -> Setup:
    """Return a set-up along a direction while axes move."""
    return Probe("bed", MACHINE, direction, moves, (0.0,) * 3, 1e-6, (), 0.0, 0.0, 1.0, (0.0,) * 3, "+")


def at(places: Sequence[tuple[float, float]], setup: str = "bed") -> list[Reading]:
    """Return a reading at each place."""
    return [Reading(setup, (x, y, 0.1), (1, 1, 1), 0.0) for x, y in places]


def full(columns: Sequence[float], rows: Sequence[float]) -> list[tuple[float, float]]:
    """Return every node of a grid."""
    return list(itertools.product(columns, rows))


@given(st.integers(2, 6), st.integers(2, 6), st.floats(0.01, 0.08), st.floats(0.01, 0.08), st.data())
def test_a_grid_is_what_has_three_columns_and_rows_and_half_of_its_nodes(
    many: int, more: int, dx: float, dy: float, data: st.DataObject
) -> None:
    nodes = full([0.02 + dx * i for i in range(many)], [0.03 + dy * j for j in range(more)])
    kept = data.draw(st.lists(st.sampled_from(nodes), unique=True, max_size=len(nodes)))
    found = map_grid(MACHINE, [probing()], at(data.draw(st.permutations([*kept, *kept[:2]]))))
    x, y = (sorted({place[side] for place in kept}) for side in (0, 1))
    even = all(len(side) < 3 or np.ptp(np.diff(side)) < 1e-6 for side in (x, y))
    grid = min(len(x), len(y)) >= 3 and even and 2 * len(kept) >= len(x) * len(y)
    assert (found is not None) == grid
    if found is not None:
        assert (found[0].tolist(), found[1].tolist()) == (x, y)


@pytest.mark.parametrize(
    ("setup", "grid"),
    [
        (probing((0.0, 0.0, -1.0)), True),
        (probing((0.0, 0.14, 0.9902)), True),
        (probing((0.0, 0.1411, 0.99)), False),
        (probing((1.0, 0.0, 0.0)), False),
        (probing(moves=(0, 1, 2)), True),
        (probing(moves=(0,)), False),
        (probing(moves=(1, 2)), False),
    ],
)
def test_a_bed_is_probed_along_z_while_x_and_y_move(setup: Setup, grid: bool) -> None:
    nodes = full((0.1, 0.2, 0.3), (0.1, 0.2, 0.3))
    assert (map_grid(MACHINE, [setup], at(nodes)) is not None) == grid
    other = [(0.11 + 0.01 * n, 0.4 - 0.013 * n) for n in range(20)]
    assert (map_grid(MACHINE, [setup], at(nodes) + at(other, "a laser")) is not None) == grid
