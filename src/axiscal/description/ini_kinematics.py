"""How a LinuxCNC machine is built, as far as its kinematics say: the chain, which way axes count, where they turn."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import NamedTuple

from axiscal.description.ini_file import IniFile
from axiscal.exceptions import AxiscalError, DescriptionError
from axiscal.measurement.readers.text import read_text

Point = tuple[float, float, float]
_TRT = re.compile(r"xyz([ab])c-trt-kins")
_SETP = re.compile(r"(?:setp\s+)?([\w.:-]+?)\.([\w-]+)\s+=?\s*(\S+)")
_NET = re.compile(r"(?:net|newsig|linksp)\s+(\S+)\s+(.*)")
_SETS = re.compile(r"sets\s+(\S+)\s+(\S+)")
_ELSEWHERE = re.compile(r"\[(\w+)\](\w+)")
_OTHERS = "trivkins, xyzac-trt-kins, xyzbc-trt-kins, maxkins and 5axiskins are read"


@dataclass(frozen=True, slots=True)
class IniBuild:
    """chain : ISO 10791-6; sure : whether the kinematics say so, and not only what such machines usually are

    reversed : axes that count against ISO 841; origins : of rotary axes, in the machine's unit; unit : mm or in
    kinematics : name of the module; said : a person has said the chain, who says nothing of where axes turn by that
    """

    chain: str
    sure: bool
    kinematics: str
    unit: str
    reversed: tuple[str, ...] = ()
    origins: Mapping[str, Point] = field(default_factory=dict)
    said: bool = False


def build_of(ini: IniFile, letters: Sequence[str], doubled: Sequence[str], unit: str) -> IniBuild:
    """Return how a machine is built; raises DescriptionError for kinematics that are no chain of axes.

    letters : of its axes; doubled : of those that two joints move
    """
    stated = ini.get("KINS", "KINEMATICS")
    name = stated.text.split()[0] if stated is not None and stated.text else "trivkins"
    linear, rotary = [each for each in letters if each not in "ABC"], [each for each in letters if each in "ABC"]
    if name in ("trivkins", "gantrykins"):
        chain = _plain(linear, rotary, doubled)
        return IniBuild(chain, False, name, unit, origins=dict.fromkeys(rotary, (0.0, 0.0, 0.0)))
    if found := _TRT.fullmatch(name):
        return _swivelling(ini, name, found[1].upper(), letters, unit)
    if name == "maxkins" and set("BC") <= set(letters):
        pins = _pins(ini, name)
        pivot, known = pins.values.get("pivot-length", 0.0), "pivot-length" in pins.values
        against = () if pins.values.get("conventional-directions", 0.0) else ("B",)
        places = {"B": (0.0, 0.0, pivot), "C": (0.0, 0.0, 0.0)}
        return IniBuild("w-C'-X'-Y'-b-Z-B-t", known and pins.clear, name, unit, against, places)
    if name == "5axiskins" and set("BC") <= set(letters):
        pins = _pins(ini, name)
        pivot, known = pins.values.get("pivot-length", 0.0), "pivot-length" in pins.values
        places = {"B": (0.0, 0.0, pivot), "C": (0.0, 0.0, pivot)}
        return IniBuild("w-b-X-Y-Z-C-B-t", known and pins.clear, name, unit, ("B",), places)
    what, remedy = f"{name} is no chain of axes that can be read here", f"Write machine.toml by hand; {_OTHERS}"
    raise stated.fail(what, remedy) if stated is not None else DescriptionError(what, remedy, ini.path)


def _plain(linear: Sequence[str], rotary: Sequence[str], doubled: Sequence[str]) -> str:
    """Return what machines of these axes usually are: a bridge where two joints move one axis, a lathe, a mill."""
    tables = "".join(f"-{letter}'" for letter in reversed(rotary))
    late = [letter for letter in linear if letter not in "XYZ"]
    if doubled or set(linear) == {"X", "Z"}:  # the bridge, or the saddle of a lathe, carries the others
        first = [letter for letter in doubled if letter in linear] or ["Z"]
        carried = first + [letter for letter in linear if letter not in (*first, *late)]
        return f"w{tables}-b-{'-'.join(carried + late)}-t"
    moved = "".join(f"-{letter}'" for letter in linear if letter in "XY")
    head = "".join(f"-{letter}" for letter in linear if letter == "Z" or letter in late)
    return f"w{tables}{moved}-b{head}-t"


def _swivelling(ini: IniFile, name: str, swivel: str, letters: Sequence[str], unit: str) -> IniBuild:
    stated = ini.needed("KINS", "KINEMATICS", name)
    if not {"X", "Y", "Z", "C", swivel} <= set(letters):
        raise stated.fail(f"{name} has axes X, Y, Z, {swivel} and C", "Name them in [TRAJ] COORDINATES")
    read = _pins(ini, name)
    pins = read.values
    x, y, z = (pins.get(f"{way}-rot-point", 0.0) for way in "xyz")
    z += pins.get("z-offset", 0.0)
    line = (x, y + pins.get("y-offset", 0.0), z) if swivel == "A" else (x + pins.get("x-offset", 0.0), y, z)
    against = () if pins.get("conventional-directions", 0.0) else (swivel, "C")
    return IniBuild(f"w-C'-{swivel}'-X'-Y'-b-Z-t", read.clear, name, unit, against, {swivel: line, "C": (x, y, z)})


class _Pins(NamedTuple):
    """values : by pin; clear : whether every pin that says where axes turn, or which way, was understood"""

    values: Mapping[str, float]
    clear: bool


def _pins(ini: IniFile, module: str) -> _Pins:
    """Return the numbers that HAL sets at pins of a module, straight or by a signal: HALCMD lines and files at hand."""
    signals, joined, found = dict[str, float | None](), dict[str, str](), dict[str, float | None]()
    for line in _hal(ini):
        if (given := _SETS.fullmatch(line)) is not None:
            signals[given[1]] = _value(ini, given[2])
        elif (net := _NET.match(line)) is not None:
            ends = [word.removeprefix(f"{module}.") for word in net[2].split() if word.startswith(f"{module}.")]
            joined |= dict.fromkeys(ends, net[1])
        elif (pin := _SETP.fullmatch(line)) is not None and pin[1] == module:
            found[pin[2]] = _value(ini, pin[3])
    said = {pin: signals.get(signal) for pin, signal in joined.items()} | found
    values = {pin: value for pin, value in said.items() if value is not None}
    return _Pins(values, not any(_PLACES.fullmatch(pin) for pin in said.keys() - values.keys()))


_PLACES = re.compile(r"[xyz]-rot-point|[xyz]-offset|pivot-length|conventional-directions")
"""Pins that say where axes turn, or which way."""


def _hal(ini: IniFile) -> list[str]:
    lines = [each.text for each in ini.all("HAL", "HALCMD")]
    for named in (*ini.all("HAL", "HALFILE"), *ini.all("HAL", "POSTGUI_HALFILE")):
        path = ini.path.parent / Path(named.text.split()[0]) if named.text else ini.path
        if path.suffix == ".hal" and path.is_file():  # those of the library, and programs, set no pivots
            try:
                lines += [line.partition("#")[0].strip() for line in read_text(path).lines]
            except AxiscalError as failure:
                raise named.fail(str(failure), "Check the name, or take the line out") from failure
    return lines


def _value(ini: IniFile, text: str) -> float | None:
    """Return what HAL makes of a word: a number, TRUE or FALSE, or what stands in the INI file; None for another."""
    if (named := _ELSEWHERE.fullmatch(text)) is not None:
        stands = ini.get(named[1], named[2])
        text = stands.text if stands is not None else ""
    if text.upper() in ("TRUE", "FALSE"):
        return float(text.upper() == "TRUE")
    try:
        value = float(text)
    except ValueError:
        return None
    return value if isfinite(value) else None
