"""The zoo of foreign truths: whether U holds them, and whether the cause is named."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from axiscal_core.threads import one_thread
from benchmarks.trust.kept import Found, Trial, Tried
from benchmarks.trust.verdict import Kind, faults, kinds
from benchmarks.zoo.animals import Animal, Interval, Judged, Slope
from benchmarks.zoo.every import EVERY
from benchmarks.zoo.running import judged

ZOO_HEAD = """
## A zoo of foreign truths
Truths of plain numpy, told by the files of `axiscal init` and what a stranger states
([the zoo](../../benchmarks/zoo/every.py)). Kinds that fall short. *Slope kept*: least share of the slope that was read;
95 % are asked. *Inside*: share of the truth inside U; 85 % are asked. *Named*: the answer names the cause.
*Holds*: right figures, or the cause named. (`make trust PART=zoo MACHINES={machines}`)

| kind | answers | slope kept | inside | named | holds |
|---|---|---|---|---|---|
"""

_FEWEST = 0.95
"""Share inside U below which a kind has a row of its own: what is promised."""
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
    short = [kind for kind in kinds(found) if _held(kind) < 1 or (kind.inside or 1.0) < _FEWEST]
    yield from map(_kind_row, short)
    shares = [kind.inside for kind in kinds(found) if kind.inside is not None]
    of = f"{np.mean(shares):.0%} inside U in the mean of {len(kinds(found))} kinds."
    yield f"\nThe other {len(kinds(found)) - len(short)} kinds hold. {of} Falling short: {len(faults(found))}."


def _held(kind: Kind) -> float:
    return float(np.mean([each.holds for each in kind.found]))


def _kind_row(kind: Kind) -> str:
    kept = "–" if kind.least_kept is None else f"{kind.least_kept:.0%}"
    inside = "–" if kind.inside is None else f"{kind.inside:.0%}"
    return f"| {kind.name} | {len(kind.found)} | {kept} | {inside} | {kind.named:.0%} | {_held(kind):.0%} |"
