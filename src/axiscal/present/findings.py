"""What a person has to be told about readings and an estimate: what does not fit, and what could not be seen.

Readings twice: a file that was added twice, a block that was pasted again, a frozen display. A value is shown once more
with a probability of at most p = q/(σ√2π), q the step of the values and σ the noise. L values in a row come again
somewhere among m by chance in at most m²/2 p^L files.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.errors.gauge import undescribed
from axiscal.errors.iso230 import words
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.intervals import as_shown
from axiscal.estimation.promise.agreement import AGREES
from axiscal.language.spoken import WORDS, capital, listed, put, said
from axiscal.measurement.reading import Reading, place_text, reading_unit, sense, units_of
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.displays import last_decimal
from axiscal.planning.unseen import FEWEST, hidden_of, seeing, sees, unseen_periods
from axiscal.present.beside import beside_the_tool, lagging
from axiscal.present.result import Finding
from axiscal.units import format_quantity, from_unit, said_quantity, to_unit
from axiscal_core.axes import Axis
from axiscal_core.theta import Kind

_BY_CHANCE = 1e-4
"""A right file is taken for one with copies once in ten thousand."""
_FEWEST = 3
"""Two values that are the same in a row are none, however fine they are: a place read again and its neighbour."""


def copies(readings: Sequence[Reading], setups: Sequence[Setup]) -> Iterator[Finding]:
    """Yield warnings of set-ups whose readings in a file show the same values, one by one, as others before them."""
    for setup in setups:
        mine = [reading for reading in readings if reading.setup == setup.name]
        if (found := repeated(mine, setup.noise)) is not None:
            *starts, size = found
            before, again = (_lines(mine, first, first + size - 1) for first in starts)
            yield Finding.of("copies", setup=setup.name, count=size, again=again, before=before)


def _lines(readings: Sequence[Reading], first: int, last: int) -> str:
    """Return where readings stand in their file, else among the readings of their set-up."""
    if readings[first].line is None or readings[last].line is None:
        return said("its readings {first} to {last}", first=first + 1, last=last + 1)
    return said("lines {first} to {last}", first=readings[first].line, last=readings[last].line)


def repeated(readings: Sequence[Reading], noise: float) -> tuple[int, int, int] | None:
    """Return the first readings of one set-up that come again so many in a row that it is no chance, if any do.

    noise : m or rad.  The result has the indices of the first, there and again, and how many they are
    """
    values = [reading.values for reading in readings]
    step = last_decimal(np.array([number for value in values for number in value]))
    same = step / (noise * math.sqrt(2 * math.pi)) if noise > 0 else math.inf
    if same >= 1 or not values:  # no number of values in a row would tell
        return None
    each, seen = len(values[0]) * math.log(same), dict[tuple[tuple[float, ...], ...], int]()
    length = max(_FEWEST, math.ceil((math.log(_BY_CHANCE) - math.log(len(values) ** 2 / 2)) / each))
    for at in range(len(values) - length + 1):
        start = seen.setdefault(tuple(values[at : at + length]), at)
        if at - start >= length:
            alike = [one == other for one, other in zip(values[start:at], values[at:], strict=False)]
            return start, at, [*alike, False].index(False)
    return None


def coarse_displays(readings: Sequence[Reading], setups: Sequence[Setup]) -> Iterator[Finding]:
    """Yield warnings of set-ups whose values move in coarse steps, by their own or those of their instrument."""
    for setup, shown in zip(setups, as_shown(setups, readings), strict=True):
        if shown is not setup:
            step, unit = shown.resolution, reading_unit(setup)
            steps = {"step": said_quantity(step, unit, 6), "written": format_quantity(step, unit)}
            yield Finding.of("resolution", setup=setup.name, times=step / setup.noise, **steps)


_FAR_FROM_STATED = 3.0
"""Factor from which on a size is not as stated."""
_WORDS: dict[Kind, str] = WORDS["sizes"]


_FAR, _MANY = 4.0, 0.1
_SHOWS, _AN_HOUR = 3.0, 3600.0
_MATTERS = 0.1


def observability(case: Case) -> list[str]:
    """Return what moves the tool point and no allowed reading can see, in sentences, and what is not in the model."""
    absent = undescribed(case.description.machine)
    return [*(part.text for part in hidden_of(case) if part.effect), *([absent] if absent else [])]


def findings(estimation: Estimation, *, ended: bool = True) -> list[Finding]:
    """Return the warnings of an estimate.  ended : the campaign is over, and no reading is asked for"""
    drifted = [list(_drift(estimation, setup)) for setup in estimation.stated.description.setups]
    return [
        *_unobservable(estimation),
        *coarse_displays(estimation.readings, estimation.stated.description.setups),
        *(each for warned in (beside_the_tool, lagging, turned_alike, once_over) for each in warned(estimation)),
        *_outliers(estimation, ended),
        *learnt_sizes(estimation),
        *(Finding(code="drift", text=listed(" ", found)) for found in drifted if found),
        *([Finding.of("prior-gone")] if estimation.stated.description.prior_gone else []),
    ]


OF_THE_READING = ("sign", "beside", "reversal", "lag", "resolution", "passes", "period")
"""Codes of warnings that other readings, or others in another order, would answer; what weighs most is first."""


def of_readings(readings: Sequence[Reading], setups: Sequence[Setup], axes: Sequence[Axis]) -> list[Finding]:
    """Return the warnings that readings of a file give before anything is estimated."""
    told = [*copies(readings, setups), *untimed(readings, setups), *unseen_signs(readings, setups)]
    return [*told, *regular_places(readings, setups, axes)]


def unseen_signs(readings: Sequence[Reading], setups: Sequence[Setup]) -> Iterator[Finding]:
    """Yield what no estimate can see: the sign of angles, the frame of a tracker."""
    told = set[str]()
    for setup in setups:
        meant = sense(setup).sign
        angles, framed = setup.reads == "angle", bool(setup.station) and len(setup.numbers) > 1
        if meant not in told and (angles or framed) and any(each.setup == setup.name for each in readings):
            told.add(meant)
            yield Finding.of("sign" if angles else "frame", code="sign", setup=setup.name, sign=meant)


def untimed(readings: Sequence[Reading], setups: Sequence[Setup]) -> list[Finding]:
    """Return warnings of set-ups whose zero may drift, where given readings do not tell when they were taken."""
    silent = {reading.setup for reading in readings if reading.time is None}
    drifting = [setup.name for setup in setups if setup.drift_said == "stated" and setup.name in silent]
    return [Finding.of("untimed", code="drift", setup=name) for name in drifting]


_WRITTEN = 1e-3
"""mm or deg."""


def regular_places(readings: Sequence[Reading], setups: Sequence[Setup], axes: Sequence[Axis]) -> Iterator[Finding]:
    """Yield a warning for each axis of a set-up whose places see no error of some period, with three that see it.

    Without where its raster has none.
    """
    more = 'Read three more, such as {places}, with "yes" in a column check: they judge the others.'
    for setup in setups:
        poses = np.array([reading.pose for reading in readings if reading.setup == setup.name]).reshape(-1, len(axes))
        for k in setup.moves if setup.chart is None else ():
            unit = axes[k].unit
            places = _WRITTEN * np.unique(np.round(to_unit(poses[:, k], unit) / _WRITTEN))
            if len(hidden := unseen_periods(places)):
                asked = seeing(places, to_unit(setup.raster[k], unit) or 100 * _WRITTEN)
                odd = [place_text(axes, [each] * len(axes), [k]) for each in from_unit(asked, unit).tolist()]
                seen = sees(np.append(places, asked), float(hidden[0]))
                others = said(more, places=listed(", ", odd)) if seen else said("Its raster has no others.")
                named = {"axis": axes[k].name, "period": f"{1 / hidden[0]:.4g} {unit}", "others": others}
                yield Finding.of("period", setup=setup.name, **named)


_ENDS = 0.05
"""Of the travel, beside the farthest places: who turns there has come as far at each place, from either side."""


def turned_alike(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning for each reversal that varies along its axis, where the way since a turn would look the same.

    Out and back over the whole travel, a place is reached by one way since the turn from each side.
    """
    errors, setups = estimation.case.errors, estimation.case.description.setups
    for term in errors.curves:
        axis = errors.axes[term.axis]
        if term.kind == "reversal" and term.spline.size > 1 and not axis.rotary:
            found = [_turns(estimation, setup, term.axis) for setup in setups if term.axis in setup.moves]
            inside = [np.minimum(turns - at.min(), at.max() - turns) for at, turns in found if len(at)]
            if all(np.all(far < _ENDS * axis.length) for far in inside):
                yield Finding.of("reversal", error=term.name, what=words(term.name))


def once_over(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning for each set-up that went along its axis once, or once out and back: there time is place."""
    described, axes = estimation.case.description, estimation.case.description.machine.axes
    for setup in described.setups:
        alone = described.usual and setup.drift_said == "nothing" and len(setup.names) == 1
        for k in setup.moves if alone or setup.drift_said == "usual" else ():
            at, turns = _turns(estimation, setup, k)
            if len(set(at.tolist())) >= FEWEST and len(turns) <= 1:
                again = np.quantile(at, (0.0, 0.5, 1.0), method="nearest").tolist()
                places = listed(", ", [place_text(axes, [each] * len(axes), [k]) for each in again])
                yield Finding.of("passes", setup=setup.name, axis=axes[k].name, places=places)


def _turns(estimation: Estimation, setup: Setup, k: int) -> tuple[Array, Array]:
    """Return where an axis stood in the readings of a set-up, in their order, and where it turned, m or rad."""
    mine = [reading for reading in estimation.readings if reading.setup == setup.name]
    at = np.array([reading.pose[k] for reading in sorted(mine, key=lambda reading: reading.time or 0.0)])
    moved = at[np.diff(at, prepend=np.inf) != 0]
    ways = np.sign(np.diff(moved))
    return at, moved[1:-1][ways[1:] != ways[:-1]]


def _unobservable(estimation: Estimation) -> Iterator[Finding]:
    unseen = estimation.case.yardstick_as_sized.unseen_rms
    if unseen > _MATTERS * estimation.accuracy.rms:
        yield Finding.of("unobservable", size=said_quantity(unseen, "um"))


def _outliers(estimation: Estimation, ended: bool) -> Iterator[Finding]:
    """Say which readings do not count, and which do although they do not agree; of very many it is not the readings."""
    for doubt in estimation.outliers:
        words = "outlier_ended" if ended else "outlier"
        yield Finding.of(words, code="outlier", objection=capital(estimation.objection_to(doubt)))
    left = {} if estimation.posterior is None else estimation.posterior.left_out
    far = [index for index, each in left.items() if each.z > AGREES and index not in estimation.left_out]
    for index in far if len(far) <= max(2.0, _MANY * len(left)) else ():
        if not estimation.readings[index].accepted:
            reading, away = capital(estimation.name_of(index)), float(left[index].z)
            yield Finding.of("outlier_used", code="outlier", reading=reading, away=away)


def _drift(estimation: Estimation, setup: Setup) -> Iterator[str]:
    """Yield by how much a zero has drifted that may, and whether that is more than stated; nothing if it hardly has."""
    apart = len(setup.names) > 1 and not setup.stations
    for number, path in enumerate(estimation.history.drifts(setup.name)):
        unit = units_of(setup)[number if apart else 0]
        worst = int(np.argmax(np.abs(path.mean)))
        far, std = float(path.mean[worst]), float(path.std[worst])
        if abs(far) > _SHOWS * std:
            zero = f" {setup.names[number]}" if apart else f" {number + 1}" if setup.stations else ""
            moved, spread = float(to_unit(far, unit)), float(to_unit(std, unit))
            seconds = float(path.times[worst] - path.times[0])
            yield said(
                'The zero of "{setup}" had moved by {size} after {time}; the estimate takes that off.',
                setup=setup.name + zero,
                size=put("{moved:.2g} ± {spread:.2g} {unit}", moved=moved, spread=spread, unit=unit),
                time=said_quantity(seconds, "h" if seconds >= _AN_HOUR else "min", 2),
            )
            if abs(far) > _FAR * path.prior[worst]:
                rate = abs(far) / max(seconds, 60.0)
                usual = "That is more than is usual: state drift = {rate}."
                stated = "That is more than is stated: drift = {rate} would be."
                written = f'"{to_unit(rate * _AN_HOUR, unit):.2g} {unit}/h"'
                yield said(usual if setup.drift_said == "usual" else stated, rate=written)


def learnt_sizes(estimation: Estimation) -> Iterator[Finding]:
    """Yield a sentence for each group of alike sizes that readings find far from what was stated."""
    found = estimation.posterior
    if found is None:
        return
    for size in estimation.stated.sizes.of:
        times, alone = found.sizes[size.kind, size.owners[0]], size.owners[0] if len(size.owners) == 1 else ""
        if not 1 / _FAR_FROM_STATED < times < _FAR_FROM_STATED:
            named = {"names": ", ".join(size.owners), "what": said(_WORDS[size.kind])}
            yield Finding.of(
                "prior-misfit", error=alone if alone in estimation.case.errors.by_name else None, times=times, **named
            )
