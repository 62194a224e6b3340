"""Tables over one axis where all others move: each row holds the mean over them, planes and whole turns counted once.

Against means over places that fill the volume evenly.
"""

import numpy as np
import pytest
from scipy.stats import qmc

from axiscal.machine import load_machine, machine_from_text
from axiscal.tables.conditional import mean_along, turned
from tests.generators.planes import BED, TABLE
from tests.generators.texts import machine_text

HEAD = machine_text(
    "w-b-X-Z-B-t",
    {"X": (0, 300), "Z": (0, 200), "B": (-90, 270)},
    {
        "EBX EBZ": 'std = "60 urad", knots = 7, length = "100 mm"',
        "EZX": 'std = "60 um", knots = 5, length = "100 mm"',
        "EXB": 'std = "20 um", knots = 9, length = "60 deg"',
    },
    tool=80,
)
LATER = '["-90 deg", "270 deg"]'  # a turn that does not begin at nought
MACHINES = {
    "dmu60": load_machine("dmu60").text,
    "bed": BED,
    "table": TABLE.replace('["0 deg", "360 deg"]', LATER),
    "head": HEAD,
}


@pytest.mark.parametrize(
    ("machine", "over", "moved", "part"),
    [
        ("dmu60", "X", "XZ", 0.7),
        ("dmu60", "Z", "YX", 0.7),
        ("bed", "X", "Z", 0.5),
        ("bed", "Y", "Z", 0.5),
        ("table", "X", "XZ", 1.0),
        ("head", "Z", "XZ", 1.0),
    ],
)
def test_rows_are_the_mean_over_all_other_axes(machine: str, over: str, moved: str, part: float) -> None:
    """From either side, over a part of the travel, or all of it around a turn that begins anywhere."""
    model = machine_from_text(MACHINES[machine])
    travels = [axis.travel for axis in model.axes]
    box = tuple((high - part * (high - low), high) for low, high in travels)
    low, high = np.array(box).T
    index, axes = model.index(over), [model.index(name) for name in moved]
    own = np.ones(model.size, dtype=bool)
    for turning in (f for f in model.curves if f.name.partition("_")[0] in ("EBB", "ECC")):
        own[turning.columns] = False  # what a rotary axis turns too far is in its own table
    at = np.linspace(low[index], high[index], 3)
    spread = low + (high - low) * qmc.Sobol(len(low), rng=1).random(2**13)
    for side in (1, -1):
        found = np.stack([mean_along(model, box, axis, index, at, side) for axis in axes])
        for number, position in enumerate(at):
            spread[:, index] = position
            sides = np.zeros_like(spread)
            sides[:, index] = side
            seen, turns = model.rows_at(spread, sides), model.frames(spread).rotations
            for n, axis in enumerate(axes):
                ways = turns[axis] @ np.array(model.axes[axis].direction)
                mean = np.einsum("mcn,mc->mn", seen, ways).mean(axis=0)
                size = 1e-3 * np.abs(mean).max()
                assert found[n, number, own] == pytest.approx(mean[own], abs=size)


def test_what_a_rotary_axis_turns_too_far_needs_no_plane() -> None:
    model = machine_from_text(TABLE)
    box = tuple(axis.travel for axis in model.axes)
    rows = turned(model, box, 0, np.linspace(0, 6, 5), 1)
    assert rows.shape == (5, model.size)
    assert not np.any(rows[:, model.planes[0].columns])
