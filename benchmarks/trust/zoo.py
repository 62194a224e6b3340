"""The zoo of foreign truths: whether U holds them, and whether the cause is named."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from axiscal_core.threads import one_thread
from benchmarks.trust.kept import Found, Trial, Tried
from tests.zoo.animals import Animal, Interval, Judged, Slope
from tests.zoo.every import EVERY
from tests.zoo.running import judged
from tests.zoo.verdict import Kind, faults, kinds

ZOO_HEAD = """
## A zoo of foreign truths
Truths of plain numpy and of rigid motion written out by hand, told by the files of `axiscal init` and what a stranger
states ([tests/zoo](../../tests/zoo/every.py)). Machines of each animal: {machines}.

- *Slope kept*: the least share of the slope that was read, in the table; 95 % are asked.
- *Inside*: share of the truth inside U with the tables, where the cause is not named; 85 % are asked, 92 % in the mean.
- *Named*: share whose cause the answer names or asks for. *Holds*: share with right figures, or the cause named.

`make trust PART=zoo MACHINES={machines}`

| kind | answers | slope kept | inside | named | holds |
|---|---|---|---|---|---|
"""

_ANIMALS = {each.name: each for each in EVERY}


@one_thread()
def met(trial: Trial) -> dict[str, Any]:
    """Return what becomes of an animal.  trial : its name, and the machine's seed"""
    name, seed = trial
    return _figures(judged(_ANIMALS[name], seed))


def _figures(found: Judged) -> dict[str, Any]:
    return {
        "interval": found.interval and asdict(found.interval),
        "kept": found.kept and asdict(found.kept),
        "named": found.named,
    }


def _again(animal: Animal, seed: int, found: Found) -> Judged:
    """Return an outcome as it was before it was kept."""
    interval, kept = found["interval"], found["kept"]
    return Judged(animal, seed, interval and Interval(**interval), kept and Slope(**kept), found["named"])


def zoo_rows(machines: int, tried: Tried) -> Iterator[str]:
    """Yield a line for each kind of animal, and what falls short."""
    trials = [(name, seed) for name in _ANIMALS for seed in range(machines)]
    found = [
        _again(_ANIMALS[name], seed, figures) for (name, seed), figures in zip(trials, tried(met, trials), strict=True)
    ]
    yield from map(_kind_row, kinds(found))
    shares = [kind.inside for kind in kinds(found) if kind.inside is not None]
    short = f"Falling short: {len(faults(found))} (`python -m tests.zoo` names them)."
    yield f"\n{np.mean(shares):.0%} inside U in the mean of the kinds. {short}"


def _kind_row(kind: Kind) -> str:
    kept = "–" if kind.least_kept is None else f"{kind.least_kept:.0%}"
    inside = "–" if kind.inside is None else f"{kind.inside:.0%}"
    held = np.mean([each.holds for each in kind.found])
    return f"| {kind.name} | {len(kind.found)} | {kept} | {inside} | {kind.named:.0%} | {held:.0%} |"
