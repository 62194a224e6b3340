"""Positioning of one axis evaluated by ISO 230-2: accuracy A, deviation E, repeatability R, reversal B, mean range M.

`_up` is the approach in the positive direction, `_down` in the negative one; a figure that needs a direction that was
not measured is None.  No figure holds a coverage factor of ours: the standard's own ±2s is part of A and R.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.evaluation.circles import CircleFigures, circular
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import joined, said
from axiscal.measurement.readers.csv_readings import Found, RawReading
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
        units = dict.fromkeys(_OF_TARGET, self.unit) | {"target": self.target_unit}
        return {
            "schema": "axiscal-iso230/1",
            "unit": self.unit,
            "target_unit": self.target_unit,
            **{name: _shown(self.figures.get(name), self.unit) for name in FIGURES},
            "uncertainty": {name: _shown(value, self.unit) for name, value in self.uncertainty.items()},
            "coverage_factor": COVERAGE_FACTOR,
            "per_target": [
                {name: _shown(value, units[name]) for name, value in row.items()} for row in self.per_target
            ],
            "warnings": list(self.warnings),
        }


_Sides = Mapping[str, tuple[Array, Array]]
"""Means and standard deviations at the targets, (k, n) each of k tests, of the directions that were measured."""


def positioning_test(read: Found) -> PositioningTest:
    """Return the test of one axis that a file holds; raises ReadingError where two targets are not whole, or for none.

    The best-fit line of a straightness test is taken off: it is how the optics stand.
    """
    readings, seen = read.readings, dict[float, set[tuple[int, int]]]()
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
    if not test.measured:
        raise ReadingError("there are no readings", "measure at least one direction twice", test.file)
    single = np.full((1, len(test.targets)), np.nan)
    sides = {
        name: (runs.mean(axis=1)[None], np.std(runs, axis=1, ddof=1)[None] if runs.shape[1] > 1 else single)
        for name, runs in test.measured.items()
    }
    at, runs = _of_targets(sides), {name: each.shape[1] for name, each in test.measured.items()}
    found = _figures(at)
    figures = {name: float(found[name][0]) for name in FIGURES if name in found and np.isfinite(found[name][0])}
    per_target = tuple(
        {"target": float(target), **{name: float(at[name][0, i]) if name in at else None for name in _OF_TARGET}}
        for i, target in enumerate(test.targets)
    )
    units, warnings = (test.value_unit, "deg" if test.rotary else "mm"), tuple(_shortfalls(test, min(runs.values())))
    return Positioning(figures, per_target, *units, warnings, _uncertainty(sides, runs, noise))


def _of_targets(sides: _Sides) -> dict[str, Array]:
    """Return the figures of each target, (k, n), R_i = max(2s_up + 2s_down + |B_i|, 4s_up, 4s_down) among them."""
    found = dict[str, Array]()
    for name, (mean, s) in sides.items():
        found |= {f"mean_{name}": mean, f"s_{name}": s, f"R_{name}_i": 4 * s}
    if len(sides) == 2:
        (up, s_up), (down, s_down) = sides["up"], sides["down"]
        found |= {"B_i": up - down, "mean": (up + down) / 2}
        found["R_i"] = np.maximum(2 * s_up + 2 * s_down + np.abs(up - down), 4 * np.maximum(s_up, s_down))
    return found


def _figures(at: Mapping[str, Array]) -> dict[str, Array]:
    """Return the figures of tests, (k,) each, of the directions that were measured.

    A is the spread of mean ± 2s over the targets, E that of the means, R the largest of the targets' own. B and B_mean
    are the largest and the mean reversal. M is the range of the mean of both directions.  at : as of `_of_targets`
    """
    found = dict[str, Array]()
    for name, ways in (("_up", ["up"]), ("_down", ["down"]), ("", ["up", "down"])):
        if all(f"s_{way}" in at for way in ways):
            mean, s = (np.concatenate([at[f"{of}_{way}"] for way in ways], axis=1) for of in ("mean", "s"))
            found[f"A{name}"] = np.max(mean + 2 * s, axis=1) - np.min(mean - 2 * s, axis=1)
            found |= {f"E{name}": np.ptp(mean, axis=1), f"R{name}": np.max(at[f"R{name}_i"], axis=1)}
    if "B_i" in at:
        found |= {"B": np.max(np.abs(at["B_i"]), axis=1), "B_mean": np.mean(at["B_i"], axis=1)}
        found["M"] = np.ptp(at["mean"], axis=1)
    return found


def _uncertainty(sides: _Sides, runs: Mapping[str, int], noise: float) -> dict[str, float]:
    """Expanded uncertainty (k = 2) of each figure: how it scatters when the same test is repeated on this machine.

    Means scatter by s/√runs, standard deviations as √(χ²/(runs − 1)) of normal readings. The common part of all runs at
    a target is the instrument's (ISO/TR 230-9: device, repeatability of the set-up). Simulated, always the same draws.
    """
    if min(runs.values()) < 2:
        return {}
    rng, drawn = np.random.default_rng(0), dict[str, tuple[Array, Array]]()
    offset = noise * rng.standard_normal((_DRAWS, next(iter(sides.values()))[0].shape[1]))
    for name, (mean, s) in sides.items():
        scattered = mean + offset + s / np.sqrt(runs[name]) * rng.standard_normal(offset.shape)
        drawn[name] = scattered, s * np.sqrt(rng.chisquare(runs[name] - 1, offset.shape) / (runs[name] - 1))
    found = _figures(_of_targets(drawn))
    return {name: COVERAGE_FACTOR * float(np.std(found[name])) for name in FIGURES if name in found}


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


def figures_of(read: Found) -> Positioning | CircleFigures:
    """Return the figures of the test that a file holds; raises ReadingError."""
    if (found := read.readings)[0].test == "circle":
        rows = np.array([(each.position[""], each.value, each.approach[""]) for each in found])
        return circular(rows.T, read.file)
    return evaluate(positioning_test(read))
