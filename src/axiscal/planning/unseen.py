"""What the unseen is as a whole: a common scale of X, Y and Z, how the part lies, and what an unmeasured tool hides.

Unseen deviations at poses p are X = H F. They split along S = p − p̄, a uniform strain, and along the turns −(p − p̄)×.
Both are orthogonal to each other and to shifts, since S·(ω × S) = 0. A tool that nobody measured is no part of the
machine: where it turns with the axes it acts as a rotary axis that lies elsewhere.

Regular places do not see periods: the spectral window |mean exp(2πi x/p)| is 1 where a wave of period p is one value.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.gauge import Hidden, hidden, unseen_factor
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.estimation.case import Case
from axiscal.language.spoken import joined, later, said
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.units import said_quantity
from axiscal_core import rigid
from axiscal_core.instrument import TOOL

_EITHER = later("{first} or {last}")
_SAID = 0.3
"""Share of what cannot be seen from which it is said by itself."""
_LEAST = 1e-8
"""m; less is rounding."""


def hidden_of(case: Case) -> tuple[Hidden, ...]:
    """Return the errors that the allowed readings cannot see, in words."""
    tool = tool_doubt(case.observation, case.yardstick, case.prior.factor, case.allowed_rows()[0])
    whole = seen_as_one(case.yardstick)
    return (*tool, *whole, *hidden(case.errors, case.yardstick.unseen, case.yardstick.volume))


def seen_as_one(yardstick: Yardstick) -> Iterator[Hidden]:
    """Yield what the unseen is as a whole, where it is a good part of it: the common scale, and how the part lies."""
    unseen = yardstick.unseen_rms
    if not all(yardstick.counted):
        return
    if unseen < _LEAST or len({axis.letter for axis in yardstick.errors.axes} & set("XYZ")) < 3:
        return
    scale, turn = uniform_parts(yardstick)
    if scale > _SAID * unseen:
        text = (
            "Your instruments cannot see the common scale of X, Y and Z: a bar of known length, or a laser, shows it. "
            "It makes {size} of the {whole} that cannot be seen."
        )
        yield Hidden(said(text, **_part(scale, unseen)), scale)
    if turn > _SAID * unseen and yardstick.volume.alignment is None:
        text = (
            "Your instruments cannot see how the part lies: it is aligned by probing, which aligned = true takes off. "
            "It makes {size} of the {whole} that cannot be seen."
        )
        yield Hidden(said(text, **_part(turn, unseen)), turn)


def uniform_parts(yardstick: Yardstick) -> tuple[float, float]:
    """Return what a common scale and a turn of the whole make of the unseen, RMS over the volume, m."""
    poses = yardstick.volume.inside
    machine, sides = yardstick.errors, np.zeros_like(poses)
    rows = yardstick.errors.rows_at(poses, sides)
    if yardstick.volume.alignment is not None:
        rows = rows - yardstick.volume.alignment.taken_off(poses)
    hidden = rows.reshape(-1, yardstick.errors.size) @ yardstick.unseen
    away = machine.frames(poses).tcp
    away = away - away.mean(axis=0)
    turned = np.asarray(-rigid.skew(away), dtype=np.float64).reshape(-1, 3)
    return _rms(away.reshape(-1, 1), hidden), _rms(turned, hidden)


def _rms(shape: Array, hidden: Array) -> float:
    """Return the RMS of what of hidden (3 m, r) is of a shape (3 m, k), m."""
    basis = np.linalg.qr(shape).Q
    return float(np.sqrt(3 * np.sum((basis.T @ hidden) ** 2) / len(shape)))


def _part(size: float, whole: float) -> dict[str, str]:
    return {"size": said_quantity(size, "um", 2), "whole": said_quantity(whole, "um", 2)}


_OF_TOOL = 0.1
"""Share of the variance that cannot be seen from which it is said."""


def tool_doubt(observation: Observation, yardstick: Yardstick, factor: Array, rows: Array) -> Iterator[Hidden]:
    """Yield what of the unseen an exactly known tool would show, where that is a good part of it.

    factor : (n, n) of the prior covariance; rows : (m, n) readings spread over all that is allowed, over their noise
    """
    columns = [yardstick.errors.size + n for n, unknown in enumerate(observation.unknowns) if unknown.name in TOOL]
    if not columns:
        return
    known = factor.copy()
    known[columns] = 0.0
    whole = yardstick.unseen_rms
    left = replace(yardstick, unseen=unseen_factor(known, rows)[: yardstick.errors.size]).unseen_rms
    hides = float(np.sqrt(max(whole**2 - left**2, 0.0)))
    if hides**2 > _OF_TOOL * whole**2:
        text = "{tool}; that makes {size} of the {whole} that cannot be seen. {remedy}"
        words = {"tool": _subject(observation), "remedy": _remedy(observation)}
        yield Hidden(said(text, **words, **_part(hides, whole)), hides)


def _subject(observation: Observation) -> str:
    """Say how well it is known how long tools are, and how far aside they sit."""
    *across, along = TOOL
    kinds = ([along], later("of another length (known to {std})")), (across, later("that sits aside (known to {std})"))
    stds = [([u.std for u in observation.unknowns if u.name in names], text) for names, text in kinds]
    tools = [said(text, std=said_quantity(max(found), "um", 3)) for found, text in stds if found]
    return said("A tool {kinds} looks like rotary axes that lie elsewhere", kinds=joined(tools, form=_EITHER))


def _remedy(observation: Observation) -> str:
    owned = any(unknown.name in TOOL and unknown.owner == "tool" for unknown in observation.unknowns)
    return said(
        'Measure the tool and state how well it is known, tool_length = "5 um" and tool_eccentricity; write "0 um" if '
        "the zeros were set with this tool."
        if owned
        else "Measure the tool and state how well it is known, tool_x, tool_y, tool_z under unknowns, such as "
        'tool_z = "5 um".'
    )


FEWEST = 5
"""Places of a standard test at least (ISO 230-2)."""
_PERIODS, _FINE, _SOME = (2.0, 100.0), 32, 50
"""mm or deg, of screws and worms; frequencies in one over the range, places that judge first: more find no other."""
_ONE, _BY_FEW, _FEW = 1.0, 3.5, 12
"""A period is not seen by less than one place; of fewer than 12 by so much less that it seldom comes by chance."""
_ODD = (0.2, 0.5, 0.8)
"""Shares of the range about which places are asked for: any that are spread."""


def seeing(places: Array, raster: float) -> Array:
    """Return the three places of a raster, of some drawn, that see most of what those that are there do not, (3,)."""
    least, drawn = _enough(len(places) + 3), np.random.default_rng(0).uniform(-0.1, 0.1, (6 * _SOME, 3)) + _ODD
    hard = _seen_by_less(least, places)
    tried = raster * np.round((places[0] + np.ptp(places) * drawn) / raster)
    added = _waves(tried.ravel(), hard).reshape(*tried.shape, -1).sum(axis=1)
    size = np.abs(_waves(places, hard).sum(axis=0) + added)
    short = np.maximum(size - (len(places) + 3 - least), 0.0)
    return np.asarray(tried[np.argmin(short.sum(axis=1))])


def unseen_periods(places: Array) -> Array:
    """Return the frequencies of errors that places do not see, rising, the first where they see it least, (f,).

    There |Σ exp(2πi f x)|, the spectral window, is nearly their number: all but less than one see the same.
    places : (m,) rising
    """
    found = _seen_by_less(_enough(len(places)), places)
    if len(found):
        step = 1 / (_FINE * np.ptp(places))
        close = np.linspace(found[0] - step, found[0] + step * _FINE / 2, 100 * _SOME)
        found[0] = close[np.argmax(np.abs(_waves(places, close).sum(axis=0)))]
    return found


def sees(places: Array, frequency: float) -> bool:
    """Return whether places see an error of a frequency.  places : (m,)"""
    return bool(len(places) - np.abs(_waves(places, np.array([frequency])).sum()) >= _enough(len(places)))


def _enough(count: int) -> float:
    """Return by how many of so many places a period is seen."""
    return min(_ONE, count / 10 * 10 ** (min(count - _FEW, 0) / _BY_FEW))


def _seen_by_less(than: float, places: Array) -> Array:
    """Return the frequencies that so few places see otherwise than the others, (f,): of some of them no more do."""
    most = min(_PERIODS[1], np.ptp(places) / 2) if len(places) >= FEWEST else 0.0
    if most <= _PERIODS[0]:
        return np.zeros(0)
    found = np.arange(1 / most, 1 / _PERIODS[0], 1 / (_FINE * np.ptp(places)))
    for some in (places[:: -(-len(places) // _SOME)], places):
        found = found[len(some) - np.abs(_waves(some, found).sum(axis=0)) < than]
    return found


def _waves(places: Array, frequencies: Array) -> NDArray[np.complex128]:
    """Return exp(2πi f x), (m, f)."""
    return np.asarray(np.exp(2j * np.pi * np.outer(places, frequencies)))
