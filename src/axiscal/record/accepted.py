"""What a person found out: a mistake, with what it makes of the readings so far, or the sign of a control.

`undo` takes a mistake back; another bump changes the sign.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

import numpy as np

from axiscal.machine import machine_from_text
from axiscal.machine.kinematics import bed_in_workpiece
from axiscal.measurement.reading import Reading, Size
from axiscal_core.machine import Machine

_LARGEST_FACTOR = 1e4
"""Ten times what units differ by that are taken for each other."""


@dataclass(frozen=True, slots=True)
class Accepted:
    """A mistake of `estimation.promise.agreement` that a person accepted or, of a jump, told.

    mistake : one of `KNOWN`; setups : whose readings; last : number of the last one that is wrong, 0 for all later ones
    reading : number of the first one behind a jump, in another unit or stuck, 0 for all; behind a jump perhaps to come
        of backlash, of the first one behind the turn, which then counts as right
    name : of the set-up that those before a jump then belong to
    factor : the values are multiplied by it; of shifted ones, 1 to the place behind and −1 to the place before
    """

    mistake: str
    setups: tuple[str, ...]
    reading: int = 0
    factor: float = 1.0
    name: str = ""
    last: int = 0

    def __post_init__(self) -> None:
        count = max(len(self.setups), 1) if self.mistake == "stuck" else 1 + (self.mistake == "swapped")
        if self.mistake not in KNOWN or len(self.setups) != count or len({*self.setups}) != count:
            raise ValueError(f"{self.mistake!r} of {len(self.setups)} set-ups is no mistake that can be put right")
        factor = abs(self.factor)
        if not 1 / _LARGEST_FACTOR < factor < _LARGEST_FACTOR or (self.mistake == "shifted" and factor != 1):
            raise ValueError(f"{self.factor:g} is no factor of a mistake")
        if bool(self.name) != (self.mistake == "jump"):
            raise ValueError("a jump names another set-up, and nothing else does")


@dataclass(frozen=True, slots=True)
class Bumped:
    """By how much the bump in the tables of a control moved the tool, m, on a day; its latest one counts."""

    controller: str
    moved: Size
    day: str


def put_right(readings: Sequence[Reading], accepted: Accepted, machine: str = "") -> list[Reading]:
    """Return the readings without the mistake; raises ValueError where they cannot have it.

    machine : the text of machine.toml, which only another frame asks for
    """
    if accepted.mistake == "frame":
        return in_workpiece(machine_from_text(machine), readings, accepted.setups[0])
    mine = [[i for i, each in enumerate(readings) if each.setup == name] for name in accepted.setups]
    if not all(mine):
        raise ValueError("a mistake of readings that there are not")
    changed, found = MISTAKES[accepted.mistake](readings, mine, accepted), list[Reading]()
    for i, each in enumerate(readings):
        right = changed.get(i, each)
        found += [] if right is None else [_with_value_of(each, readings[right]) if isinstance(right, int) else right]
    return found


def in_workpiece(machine: Machine, readings: Sequence[Reading], setup: str) -> list[Reading]:
    """Return readings whose values along x, y and z of the machine are now along those of the workpiece.

    Raises ValueError for readings of a set-up that has one value, or none.
    """
    mine = [each for each in readings if each.setup == setup]
    if not mine or any(len(each.values) != _THREE for each in mine):
        raise ValueError("values of a frame that are not three")
    turned = bed_in_workpiece(machine, np.array([each.pose for each in mine]))
    values = (turned @ np.array([each.values for each in mine])[:, :, None])[:, :, 0].tolist()
    right = iter(replace(each, value=x, others=(y, z)) for each, (x, y, z) in zip(mine, values, strict=True))
    return [next(right) if each.setup == setup else each for each in readings]


_THREE = 3
"""Values of a touch, along x, y and z: a frame turns all of them together."""
_Changed = dict[int, Reading | int | None]
"""By index; the index of the reading whose values it gets, None for one that is left out."""
_Readings = Sequence[Reading]
_Mine = Sequence[Sequence[int]]


def _jump(readings: _Readings, mine: _Mine, accepted: Accepted) -> _Changed:
    number, later = accepted.reading, (i for i in mine[0] if readings[i].numbered(i) > accepted.reading)
    first = next((i for i in mine[0] if readings[i].number == number), next(later, len(readings)))
    if first == mine[0][0]:
        raise ValueError(f"no zero jumped before reading {accepted.reading}")
    return {i: replace(readings[i], setup=accepted.name) for i in mine[0] if i < first}


def _backlash(readings: _Readings, mine: _Mine, accepted: Accepted) -> _Changed:
    behind = {i: replace(readings[i], accepted=True) for i in mine[0] if readings[i].number == accepted.reading}
    if not behind:
        raise ValueError(f"there is no reading {accepted.reading} behind a turn")
    return {**behind}


def _between(readings: _Readings, mine: Sequence[int], accepted: Accepted) -> list[int]:
    """Return which readings of a set-up are wrong, by index."""
    last = accepted.last or max(readings[i].numbered(i) for i in mine)
    return [i for i in mine if accepted.reading <= readings[i].numbered(i) <= last]


def _each(right: Callable[[Reading, Accepted], Reading]) -> Callable[[_Readings, _Mine, Accepted], _Changed]:
    """Return a mistake that each wrong reading has by itself."""
    return lambda readings, mine, event: {i: right(readings[i], event) for i in _between(readings, mine[0], event)}


def _mirrored(readings: _Readings, mine: _Mine, accepted: Accepted) -> _Changed:
    wrong = _between(readings, mine[0], accepted)
    passes = [[*each] for _, each in groupby(wrong, key=lambda i: readings[i].approach)]
    return {i: j for each in passes for i, j in zip(each, each[::-1], strict=True)}


def _multiplied(reading: Reading, accepted: Accepted) -> Reading:
    value, *others = (accepted.factor * each for each in reading.values)
    std = None if reading.std is None else reading.std * abs(accepted.factor)
    return replace(reading, value=value, others=tuple(others), std=std)


def _swapped(readings: _Readings, mine: _Mine, accepted: Accepted) -> _Changed:
    one, other = mine
    if len(one) != len(other):
        raise ValueError(f"{len(one)} values of one set-up cannot be swapped with {len(other)} of another")
    return dict([*zip(one, other, strict=True), *zip(other, one, strict=True)])


def _shifted(readings: _Readings, mine: _Mine, accepted: Accepted) -> _Changed:
    step, last = int(accepted.factor), len(mine[0])
    return {i: mine[0][k - step] if 0 <= k - step < last else None for k, i in enumerate(mine[0])}


def _stuck(readings: _Readings, mine: _Mine, accepted: Accepted) -> _Changed:
    pairs = ((readings[before], readings[i], i) for each in mine for before, i in pairwise(each))
    return {i: None for one, two, i in pairs if two.numbered(i) >= accepted.reading and two.values == one.values}


def _with_value_of(reading: Reading, other: Reading) -> Reading:
    if len(reading.values) != len(other.values):
        raise ValueError("readings of one value and of three cannot be exchanged")
    return replace(reading, value=other.value, others=other.others, std=other.std)


MISTAKES: Mapping[str, Callable[[_Readings, _Mine, Accepted], _Changed]] = {
    "jump": _jump,
    "backlash": _backlash,
    "sign": _each(_multiplied),
    "unit": _each(_multiplied),
    "swapped": _swapped,
    "shifted": _shifted,
    "stuck": _stuck,
    "still": lambda _, mine, __: dict.fromkeys(mine[0]),
    "sides": _each(lambda reading, _: replace(reading, approach=tuple(-side for side in reading.approach))),
    "mirrored": _mirrored,
}
"""Mistakes that need nothing but the readings."""
KNOWN = (*MISTAKES, "frame")
