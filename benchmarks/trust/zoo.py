"""The zoo of foreign truths, and width beside cover: U beside that of somebody who knows all sizes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from axiscal_core.threads import one_thread
from benchmarks.trust.kept import Found, Trial, Tried
from tests.zoo.animals import Animal, Interval, Judged, Slope
from tests.zoo.curves import FOREIGN
from tests.zoo.every import EVERY
from tests.zoo.right import CONDITIONS, PLACES, as_described, foreign, machine
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

WIDTHS_HEAD = """
## Width beside cover
An axis of 1 m as `axiscal init` describes it, with a lead error of 30 µm/m (one standard deviation), 24 readings. The
*oracle* knows every size of the machines. *Inside*: share of the truth inside U. *Score*: the interval score, width
plus forty times what lies outside. {machines} machines each. (`make trust PART=widths MACHINES={machines}`)

- *20 degC*: the default, and scale, air and 1 K are off as usual.
- *As read*: `refers_to = "as read"`, a laser without error; this row judges the model.

| refers to | places | machines | inside | oracle inside | U over the oracle's | score over the oracle's | U to reach |
|---|---|---|---|---|---|---|---|
"""

FOREIGN_HEAD = """
Foreign truths, as read: share inside U, U over where 95 % of the truth lie, score in µm; the share withheld, if any.

| truth | planned | even | even, three odd | random |
|---|---|---|---|---|
"""

_ANIMALS = {each.name: each for each in EVERY}
_FOREIGN = {each.kind: each for each in FOREIGN}


@one_thread()
def met(trial: Trial) -> dict[str, Any]:
    """Return what becomes of an animal.  trial : its name, and the machine's seed"""
    name, seed = trial
    return _figures(judged(_ANIMALS[name], seed))


@one_thread()
def described(trial: Trial) -> dict[str, Any]:
    """Return what becomes of a machine as described, and what an oracle knows.  trial : condition, places, seed"""
    condition, places, seed = trial
    found = _figures(judged(as_described(condition, places), seed))
    return found | {"oracle": asdict(machine(condition, places, seed).oracle())}


@one_thread()
def attacked(trial: Trial) -> dict[str, Any]:
    """Return what becomes of a foreign truth under perfect instruments.  trial : its kind, places, seed"""
    kind, places, seed = trial
    return _figures(judged(foreign(_FOREIGN[kind], places), seed))


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


def width_rows(machines: int, tried: Tried) -> Iterator[str]:
    """Yield a line for each condition and kind of places: what is promised beside what the oracle knows."""
    for condition in CONDITIONS:
        for places in PLACES:
            found = tried(described, [(condition, places, seed) for seed in range(machines)])
            told = [(Interval(**each["interval"]), Interval(**each["oracle"])) for each in found if each["interval"]]
            yield f"| {condition} | {places} | {_beside(told)} | {REACH.get((condition, places), '–')} |"


REACH = {("as read", "planned"): "1.5", ("as read", "even"): "2.0", ("as read", "random"): "1.3"}
"""U over the oracle's that is to be reached."""


def _beside(told: Sequence[tuple[Interval, Interval]]) -> str:
    """Return shares inside, both, and widths and scores over the oracle's."""
    inside = [f"{np.mean([pair[k].inside for pair in told]):.0%}" for k in (0, 1)]
    over = [
        f"{np.exp(np.mean(np.log([getattr(ours, name) / getattr(theirs, name) for ours, theirs in told]))):.2f}"
        for name in ("half", "score")
    ]
    return " | ".join([str(len(told)), *inside, *over])


def foreign_rows(machines: int, tried: Tried) -> Iterator[str]:
    """Yield a line for each foreign truth: share inside, and U over where 95 % of the truth lie, by places."""
    shares: dict[str, dict[str, float]] = {places: {} for places in PLACES}
    for kind in _FOREIGN:
        cells = []
        for places in PLACES:
            found = list(tried(attacked, [(kind, places, seed) for seed in range(machines)]))
            told = [Interval(**each["interval"]) for each in found if each["interval"]]
            if told:
                shares[places][kind] = float(np.mean([how.inside for how in told]))
            cells.append(_cell(told, len(found)))
        yield f"| {kind} | {' | '.join(cells)} |"
    yield ""
    for places, each in shares.items():
        worst = min(each, key=lambda kind: each[kind])
        yield f"- {places}: {np.mean(list(each.values())):.0%} inside in the mean, worst {each[worst]:.0%} ({worst})"


def _cell(told: Sequence[Interval], of: int) -> str:
    """Return share inside, U over the true 95 %, the score in um, and the share withheld, if any is."""
    if not told:
        return "withheld"
    over = np.exp(np.mean(np.log([how.half / how.far for how in told])))
    shown = f"{np.mean([how.inside for how in told]):.0%}, {over:.2f}, {np.mean([how.score for how in told]):.1f}"
    return shown if len(told) == of else f"{shown}, {1 - len(told) / of:.0%}"
