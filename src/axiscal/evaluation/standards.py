"""Positioning of one axis evaluated by ISO 230-2: accuracy A, deviation E, repeatability R, reversal B, mean range M.

`_up` is the approach in the positive direction, `_down` in the negative one; a figure that needs a direction that was
not measured is None.  No figure holds a coverage factor of ours: the standard's own ±2s is part of A and R.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.evaluation.circles import CircleFigures, circular
from axiscal.exceptions import EvaluationError, ReadingError
from axiscal.language.spoken import joined, said
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.readers.files import Recognised
from axiscal.numerics import Array
from axiscal.units import said_quantity, to_unit

COVERAGE_FACTOR = 2.0
_DRAWS = 1000
"""Tests drawn at random: their scatter is known to two percent of itself."""
FIGURES = ("A", "A_up", "A_down", "E", "E_up", "E_down", "R", "R_up", "R_down", "B", "B_mean", "M")
"""The figures of an axis, as `Positioning` names them."""
_OF_TARGET = ("mean_up", "mean_down", "s_up", "s_down", "B_i", "mean", "R_up_i", "R_down_i", "R_i")
_AtTarget = Mapping[str, float | None]
"""The figures of one target position by name, m or rad, None where not measured."""


@dataclass(frozen=True, slots=True, eq=False)
class PositioningTest:
    """Deviations of one axis, m or rad: targets (n,), up and down (n, runs), None for a direction not measured.

    rotary : targets are angles; angular : deviations are, as they are of a rotary axis
    """

    targets: Array
    up: Array | None
    down: Array | None
    rotary: bool = False
    file: str | None = None
    left_out: str = ""
    angular: bool = False

    @property
    def value_unit(self) -> str:
        """In which deviations are said."""
        return "arcsec" if self.rotary or self.angular else "um"

    @property
    def measured(self) -> dict[str, Array]:
        """The runs (n, runs) of each direction that was measured, "up" and "down"."""
        return {name: runs for name, runs in (("up", self.up), ("down", self.down)) if runs is not None}


@dataclass(frozen=True, slots=True)
class Positioning:
    """The figures of one axis, m or rad, with what falls short of the standard's test in plain words.

    figures : of `FIGURES`, those that were measured, with repeats where they need them
    unit, target_unit : in which deviations and targets are shown
    uncertainty : expanded (k = 2), of each figure that was measured
    """

    figures: Mapping[str, float]
    per_target: tuple[_AtTarget, ...]
    unit: str
    target_unit: str
    warnings: tuple[str, ...]
    uncertainty: Mapping[str, float]

    def as_json(self) -> dict[str, object]:
        """Return the document `axiscal-iso230/1`: figures in um, or arcsec of angles; targets in mm or deg."""
        unit, target_unit = self.unit, self.target_unit
        figures = {name: _shown(self.figures.get(name), unit) for name in FIGURES}
        per_target = [
            {name: _shown(value, target_unit if name == "target" else unit) for name, value in row.items()}
            for row in self.per_target
        ]
        head: dict[str, object] = {"schema": "axiscal-iso230/1", "unit": unit, "target_unit": target_unit}
        uncertainty = {name: _shown(value, unit) for name, value in self.uncertainty.items()}
        tail = {"uncertainty": uncertainty, "coverage_factor": COVERAGE_FACTOR}
        return head | figures | tail | {"per_target": per_target, "warnings": list(self.warnings)}


@dataclass(frozen=True, slots=True, eq=False)
class _Direction:
    """One direction of approach: mean and standard deviation (n,) at each target, number of runs."""

    mean: Array
    s: Array
    runs: int


_Sides = Mapping[str, _Direction]
"""The directions that were measured, by name."""


def positioning_test(read: Recognised) -> PositioningTest:
    """Return the test of one axis that a file holds; raises ReadingError where two targets are not whole, or for none.

    The best-fit line of a straightness test is taken off: it is how the optics stand.
    """
    readings, seen = read.found.readings, dict[float, set[tuple[int, int]]]()
    if readings[0].test is None:
        what = "this is {title}, and no test of an axis or a circle"
        raise ReadingError(what, "`axiscal data estimate` evaluates readings", read.file, title=said(read.title))
    if len(axes := {reading.axis for reading in readings}) > 1:
        what = "the file holds tests of the axes {axes}"
        raise ReadingError(what, "give a file for each axis", read.file, axes=joined(sorted(axes)))
    rotary, angular = readings[0].target_dimension == "angle", readings[0].dimension == "angle"
    for reading in readings:
        seen.setdefault(reading.position[""], set()).add((reading.approach[""], reading.run))
    missing = [target for target in sorted(seen) if seen[target] != set().union(*seen.values())]
    if len(seen) - len(missing) < min(2, len(seen)):
        what = "fewer than two targets have a reading in every run"
        raise ReadingError(what, "add the readings, or take out the run that was cut off", read.file)
    targets, places = sorted(seen.keys() - missing), [said_quantity(at, "deg" if rotary else "mm") for at in missing]
    if readings[0].test == "straightness" and len(seen) > 1:
        at, values = np.array([(each.position[""], each.value) for each in readings]).T
        slope = float(np.polyfit(at, values, 1)[0])
        readings = tuple(replace(each, value=each.value - slope * each.position[""]) for each in readings)
    up, down = (_passes(readings, targets, direction) for direction in (1, -1))
    return PositioningTest(np.array(targets), up, down, rotary, read.file, joined(places), angular)


def evaluate(test: PositioningTest, noise: float = 0.0) -> Positioning:
    """Compute the figures of ISO 230-2, those of the means alone where a direction was run once.

    noise : m or rad, standard uncertainty of the instrument that all runs at a target share
    """
    sides = {name: _direction(runs) for name, runs in test.measured.items()}
    if not sides:
        raise EvaluationError("there are no readings", "measure at least one direction twice", test.file)
    found = _figures({name: (side.mean[None], side.s[None]) for name, side in sides.items()})
    figures = {name: float(found[name][0]) for name in FIGURES if name in found and np.isfinite(found[name][0])}
    per_target = tuple(_at_target(test, sides, i) for i in range(len(test.targets)))
    warnings = tuple(_shortfalls(test, min(side.runs for side in sides.values())))
    units, uncertainty = (test.value_unit, "deg" if test.rotary else "mm"), _uncertainty(sides, noise)
    return Positioning(figures, per_target, *units, warnings, uncertainty)


def _figures(sides: Mapping[str, tuple[Array, Array]]) -> dict[str, Array]:
    """Return the figures of tests, (k,) each, of the directions that were measured.

    A is the spread of mean ± 2s over the targets, E that of the means, R the largest of the targets' own. B and B_mean
    are the largest and the mean reversal. M is the range of the mean of both directions.

    sides : up and down, means and standard deviations at the targets, (k, n) each
    """
    found = dict[str, Array]()
    for name, (mean, s) in sides.items():
        found |= {f"A_{name}": _spread(mean + 2 * s, mean - 2 * s), f"E_{name}": _spread(mean, mean)}
        found[f"R_{name}"] = np.max(4 * s, axis=1)
    if len(sides) < 2:
        return found
    (up, s_up), (down, s_down) = sides["up"], sides["down"]
    reversal, middle = up - down, (up + down) / 2
    high, low = np.maximum(up + 2 * s_up, down + 2 * s_down), np.minimum(up - 2 * s_up, down - 2 * s_down)
    return found | {
        "A": _spread(high, low),
        "E": _spread(np.maximum(up, down), np.minimum(up, down)),
        "R": np.max(_repeatability(up, s_up, down, s_down), axis=1),
        "B": np.max(np.abs(reversal), axis=1),
        "B_mean": np.mean(reversal, axis=1),
        "M": _spread(middle, middle),
    }


def _repeatability(up: Array, s_up: Array, down: Array, s_down: Array) -> Array:
    """R_i = max(2s_up + 2s_down + |B_i|, 4s_up, 4s_down), of means and standard deviations of one shape."""
    found: Array = np.maximum(2 * s_up + 2 * s_down + np.abs(up - down), 4 * np.maximum(s_up, s_down))
    return found


def _uncertainty(sides: _Sides, noise: float) -> dict[str, float]:
    """Expanded uncertainty (k = 2) of each figure: how it scatters when the same test is repeated on this machine.

    Means scatter by s/√runs, standard deviations as √(χ²/(runs − 1)) of normal readings. The common part of all runs at
    a target is the instrument's (ISO/TR 230-9: device, repeatability of the set-up). Simulated, always the same draws.
    """
    if min(side.runs for side in sides.values()) < 2:
        return {}
    rng = np.random.default_rng(0)
    offset = noise * rng.standard_normal((_DRAWS, len(next(iter(sides.values())).mean)))
    drawn = dict[str, tuple[Array, Array]]()
    for name, side in sides.items():
        mean = side.mean + offset + side.s / np.sqrt(side.runs) * rng.standard_normal(offset.shape)
        drawn[name] = mean, side.s * np.sqrt(rng.chisquare(side.runs - 1, offset.shape) / (side.runs - 1))
    found = _figures(drawn)
    return {name: COVERAGE_FACTOR * float(np.std(found[name])) for name in FIGURES if name in found}


def _spread(high: Array, low: Array) -> Array:
    spread: Array = np.max(high, axis=1) - np.min(low, axis=1)
    return spread


def _at_target(test: PositioningTest, sides: _Sides, i: int) -> _AtTarget:
    row: dict[str, float | None] = {"target": float(test.targets[i]), **dict.fromkeys(_OF_TARGET)}
    for name, side in sides.items():
        mean, s = float(side.mean[i]), float(side.s[i])
        row |= {f"mean_{name}": mean, f"s_{name}": s, f"R_{name}_i": 4 * s}
    if len(sides) == 2:
        up, down = sides["up"], sides["down"]
        row |= {"B_i": float(up.mean[i] - down.mean[i]), "mean": float(up.mean[i] + down.mean[i]) / 2}
        row["R_i"] = float(_repeatability(up.mean, up.s, down.mean, down.s)[i])
    return row


def _direction(runs: Array) -> _Direction:
    """Mean and standard deviation (n - 1) of each target over the runs (n, runs), nan of a single run."""
    s = np.std(runs, axis=1, ddof=1) if runs.shape[1] > 1 else np.full(len(runs), np.nan)
    return _Direction(np.mean(runs, axis=1), s, runs.shape[1])


def _passes(readings: Sequence[RawReading], targets: Sequence[float], direction: int) -> Array | None:
    """Return one direction as (targets, runs), None if not measured."""
    found = {(each.run, each.position[""]): each.value for each in readings if each.approach[""] == direction}
    runs = list(dict.fromkeys(run for run, _ in found))
    return np.array([[found[run, target] for run in runs] for target in targets]) if runs else None


def _shortfalls(test: PositioningTest, runs: int) -> Iterable[str]:
    """Say what ISO 230-2 asks for and this test does not have."""
    n, asked = len(test.targets), _targets_asked(test)
    if test.left_out:
        yield said("Left out, because a run has no reading there: {places}.", places=test.left_out)
    if n < asked:
        yield said("ISO 230-2 asks for {asked} targets on this travel; there are {count}.", asked=asked, count=n)
    if runs < 2:
        yield said("A direction was run once: A, R and all ± need repeats and are withheld.")
    if runs < 5 and not _is_long(test):
        yield said("ISO 230-2 asks for five runs in each direction; there are {runs}.", runs=runs)
    if len(test.measured) < 2:
        yield said("Only one direction was measured: reversal and the bidirectional figures are not known.")
    gaps = np.diff(test.targets)
    if n > 2 and np.ptp(gaps) < 1e-6 * np.max(gaps):
        yield said("The targets are equally spaced: an error that repeats with this spacing stays unseen.")


def _is_long(test: PositioningTest) -> bool:
    return not test.rotary and bool(np.ptp(test.targets) > 2.0)


def _targets_asked(test: PositioningTest) -> int:
    """Number of targets by ISO 230-2: 5 per metre and 5 in all; each 250 mm beyond 2 m; rotary 3, 5, 8."""
    span = float(np.ptp(test.targets)) * (1 - 1e-9)
    if test.rotary:
        return 3 if span <= np.pi / 2 else 5 if span <= np.pi else 8
    return int(np.ceil(span / 0.25)) + 1 if _is_long(test) else max(5, int(np.ceil(5 * span)))


def _shown(value: float | None, unit: str) -> float | None:
    return None if value is None or not np.isfinite(value) else round(to_unit(value, unit), 9)


def figures_of(read: Recognised) -> Positioning | CircleFigures:
    """Return the figures of the test that a file holds; raises ReadingError, EvaluationError."""
    if (found := read.found.readings)[0].test == "circle":
        rows = np.array([(each.position[""], each.value, each.approach[""]) for each in found])
        return circular(rows.T, read.file)
    return evaluate(positioning_test(read))
