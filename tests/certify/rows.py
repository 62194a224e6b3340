"""Whether U of each row holds the truth: virtual machines of two how-tos, of the stated sizes and of others."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation, expanded_uncertainty
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.known_rows import known_row
from axiscal.machine import load_machine
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.tables.offer import places as places_of_volume
from axiscal_core.theta import Kind

CLAIMED, SLACK = 0.95, 0.03
TIMES = (1.0, 0.5, 2.0)
"""The sizes of the machines over those that are stated: of their own, and of foreign ones."""
CAMPAIGNS = ("dial-and-square", "laser-on-a-mill")
_PAGES = Path(__file__).resolve().parents[2] / "docs" / "howto"


@dataclass(frozen=True, slots=True)
class Held:
    """A kind of row of one machine: share of its places at which U holds the truth."""

    kind: str
    share: float


@cache
def _planned(name: str) -> tuple[Case, tuple[Place, ...]]:
    """Return the campaign of a how-to, and the places of its plan."""
    text = (_PAGES / f"{name}.md").read_text(encoding="utf-8")
    found = re.search(r"```toml title=\"campaign.toml\"\n(.*?)```", text, re.DOTALL)
    assert found is not None
    machine = "three-axis-mill"
    case = Case(campaign_from_texts(found[1], "campaign.toml", load_machine(machine).text, machine))
    made = proposed(case, Limits(case.description.target.readings), 500).plan
    return case, tuple(placed(case, made))


def held(name: str, seed: int, times: float) -> list[Held]:
    """Return how well each row of a virtual machine is held.  times : its sizes over those that are stated"""
    case, places = _planned(name)
    sizes: dict[tuple[Kind, str], float] = {
        (size.kind, owner): times for size in case.sizes.of if size.kind == "std" for owner in size.owners
    }
    other = case.rescaled(sizes)
    truth, rng = Simulator(other.description.machine, case.description.setups).drawn(seed), np.random.default_rng(seed)
    setups = {setup.name: setup for setup in case.description.setups}
    readings = [
        Reading(
            at.setup, at.pose, at.approach, truth.read_all(setups[at.setup], at.pose, at.approach, rng)[0], number=n
        )
        for n, at in enumerate(places, start=1)
    ]
    return list(_rows(concluded(case, tuple(readings)), truth))


def _rows(known: Estimation, truth: VirtualMachine) -> Iterator[Held]:
    estimate, case, knowledge = known.estimate(), known.case, known.printed
    for asked in asked_rows(known.stated.description, known.readings):
        row = known_row(asked, case, knowledge.belief, read=True)
        if asked.map is None:
            poses, sides = places_of_volume(estimate)
            off = truth.deviation(poses, sides) - estimate.deviation(poses, sides)
            left = off - off.mean(axis=0) if estimate.alignment is None else estimate.alignment.left(poses, off)
            yield Held("volume", _share(left[:, list(estimate.counted)], expanded_uncertainty(known).space))
        elif row.measured:
            where = asked.map.poses, asked.map.sides
            if asked.map.angular:
                missed = asked.map.row(truth.does(*where).rotation) - asked.map.rows(case.errors) @ estimate.mean
            else:
                missed = asked.map.row(truth.deviation(*where) - estimate.deviation(*where))
            yield Held(row.row.kind, _share(missed.reshape(-1, asked.map.dimensions), row.known))


def _share(missed: Array, within: float) -> float:
    """Return the share of vectors (k, d) that are not longer than a size."""
    return float(np.mean(np.sqrt(np.sum(missed**2, axis=1)) <= within))
