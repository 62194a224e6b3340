"""What readings take and what any more would: the same as the time of each order, found anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.measurement.reading import Places
from axiscal.planning.plan.order import seconds_along
from axiscal.planning.plan.run import Run, Ways
from axiscal.planning.plan.task import Task
from tests.generators.designs import levered


def beginning(mounted: bool) -> tuple[Task, Run]:
    """Return an empty run of the first set-up, with the machine there or not."""
    asked = levered(40)
    here = replace(asked, here=asked.lattice.within(asked.lattice.setups == 0).single(3)) if mounted else asked
    return here, Run(Ways(here, here.lattice), 0)


@pytest.mark.parametrize("mounted", [True, False])
@pytest.mark.parametrize("begun", [0, 5])
def test_a_run_takes_what_its_order_takes_and_knows_what_each_change_would(mounted: bool, begun: int) -> None:
    asked, run = beginning(mounted)
    mine, rng = asked.lattice.within(asked.lattice.setups == 0), np.random.default_rng(begun)
    if begun:
        poses = mine.poses[:begun] + 0.01
        run = run.through(np.arange(begun), replace(mine.within(slice(begun)), poses=poses))
    for slot in range(begun, 14):
        at, candidate = int(rng.integers(len(run.slots) + 1)), int(rng.integers(len(mine)))
        promised = float(run.gaps()[at, candidate]) + run.reading + run.seconds
        run.insert(at, slot, candidate)
        assert run.seconds == pytest.approx(promised)
        assert run.seconds == pytest.approx(seconds_along(asked, run.places))
        if slot % 3 == 0 and len(run.slots) > 1:
            leaving = int(rng.integers(len(run.slots)))
            promised, before = run.seconds - float(run.saved()[leaving]), run.places
            run = run.without(leaving)
            assert run.places.same_as(before.without(leaving))
            assert run.seconds == pytest.approx(promised)
            assert run.seconds == pytest.approx(seconds_along(asked, run.places))


def test_a_shorter_order_keeps_the_readings() -> None:
    asked, run = beginning(mounted=True)
    for slot in range(10):
        run.insert(slot, slot, (7 * slot) % 20)
    places, before = run.places, run.seconds
    run.shorten()
    assert run.places.same_as(places)
    assert run.seconds < before
    assert run.seconds == pytest.approx(seconds_along(asked, run.places))
    assert Places.joined([run.places.within(np.argsort(run.slots))]).same_as(places)
