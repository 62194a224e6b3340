"""Whether tables keep their promise on machines whose errors are measured curves, with details finer than the knots.

Every error motion of a mill is a measured curve of another machine: a part of it, as often turned round and upside
down, stretched to the travel. Its RMS about its mean is that of the prior, give or take a third.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.machine import load_machine
from axiscal.measurement.simulation import Simulator, TruthCurve
from axiscal.numerics import Array
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import places
from axiscal.tables.surface import left_by
from axiscal_core.machine import Machine
from benchmarks.trust.curves import CASES
from benchmarks.trust.kept import Keeping, Trial
from benchmarks.trust.virtual import READINGS, SETUPS, read_evenly

MACHINE = "three-axis-mill"
CONTROLS = ("linuxcnc", "linuxcnc-volumetric")
TRUTHS = ("measured", "drawn")
"""Curves that are carried over; those of the prior, for which the model is right."""
_ALIKE, _PART, _POINTS = 1 / 3, 0.5, 2000
"""Of the logarithm of sizes; the shortest part of a curve that is carried over; points of one that is carried over."""


@cache
def scans() -> tuple[Array, ...]:
    """Return the measured curves, (2, n): positions from 0 to 1, and values of mean 0 and RMS 1."""
    cases = (make() for make in CASES)
    return tuple(_alike(case.places[:, 0], case.truth) for case in cases if case.places.shape[1] == 1)


def _alike(positions: Array, values: Array) -> Array:
    level = values - np.interp(np.linspace(positions[0], positions[-1], _POINTS), positions, values).mean()
    return np.stack([(positions - positions[0]) / np.ptp(positions), level / level.std()])


def carried_over(machine: Machine, rng: np.random.Generator) -> dict[str, TruthCurve]:
    """Return a curve for each error of a machine, in the mean of the prior's size; constants are drawn from it."""
    found = {}
    for entry, function in ((term.error, term) for term in machine.curves):
        if entry.kind != "motion":
            found[entry.name] = TruthCurve(np.zeros(1), np.array([entry.std * rng.standard_normal()]))
            continue
        positions, values = scans()[int(rng.integers(len(scans())))]
        width = rng.uniform(_PART, 1.0)
        at = rng.uniform(0.0, 1.0 - width) + width * np.linspace(0.0, 1.0, _POINTS)[:: int(rng.choice([1, -1]))]
        _, part = _alike(np.linspace(0.0, 1.0, _POINTS), np.interp(at, positions, values))
        along = np.linspace(*machine.axis(entry.axis).travel, _POINTS)
        size = _about_its_mean(function.rows(along), function.covariance) * float(
            np.exp(_ALIKE * rng.standard_normal() - _ALIKE**2)
        )
        found[entry.name] = TruthCurve(along, size * float(rng.choice([1, -1])) * part)
    return found


def _about_its_mean(rows: Array, covariance: Array) -> float:
    """Return the RMS of curves of a covariance about their own mean.  rows : (n, k)"""
    about = rows - rows.mean(axis=0)
    return float(np.sqrt(np.mean(np.sum((about @ covariance) * about, axis=1))))


@cache
def _case() -> Case:
    text = f'machine = "{MACHINE}"\n[target]\nreadings = 1\n{SETUPS[MACHINE]}'
    return Case(campaign_from_texts(text, "campaign.toml", load_machine(MACHINE).text, MACHINE))


def kept_promise(trial: Trial) -> dict[str, float]:
    """Return, of the tables of each control, the share of the volume inside U, and what 95 % keep over U.

    trial : truth and seed
    """
    kind, seed = trial
    case, rng = _case(), np.random.default_rng((seed, 17))
    machine, setups = case.description.machine, case.description.setups
    made = Simulator(machine, setups)
    truth = made.with_curves(carried_over(machine, rng), seed) if kind == "measured" else made.drawn(seed)
    known = concluded(case, tuple(read_evenly(case, truth, rng, READINGS[MACHINE])))
    estimate = known.estimate()
    poses, sides = places(estimate)
    found = dict[str, float]()
    for control in CONTROLS:
        tables = registry.export(estimate, control, ExportOptions())
        left = left_by(estimate.machine, truth.deviation, tables.control, poses, sides)
        off = left - left.mean(axis=0) if estimate.alignment is None else estimate.alignment.left(poses, left)
        sizes = np.linalg.norm(off[:, list(estimate.counted)], axis=1)
        found[f"{control} inside"] = float(np.mean(sizes <= tables.certain))
        found[f"{control} over"] = float(np.quantile(sizes, 0.95)) / tables.certain
        found[f"{control} um"] = 1e6 * tables.certain
    return found


def table_rows(machines: int, keeping: Keeping) -> Iterator[str]:
    """Yield a line for each kind of truth and control."""
    for kind in TRUTHS:
        found = keeping(kept_promise, [(kind, seed) for seed in range(machines)])
        for control in CONTROLS:
            figures = (np.array([each[f"{control} {name}"] for each in found]) for name in ("inside", "over", "um"))
            inside, over, promised = figures
            cells = f"{inside.mean():.1%} | {np.mean(over <= 1):.0%} | {np.median(over):.2f} | {over.max():.2f}"
            yield f"| {control} | {kind} | {np.median(promised):.3g} µm | {cells} |"
