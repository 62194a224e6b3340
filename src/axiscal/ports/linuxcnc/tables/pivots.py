"""Places of the rotary axes of a swivelling table: settings of LinuxCNC's `xyzac-trt-kins` and `xyzbc-trt-kins`.

These kinematics turn about a point (x-, y-, z-rot-point) and know how far the swivel lies from it (y- or x-offset,
z-offset). Location errors of the rotary axes belong there: no table of an axis can hold them at all angles.

A drive that counts up turns the workpiece by the right hand about the positive direction: against ISO 841. Newer
sources than LinuxCNC 2.9 have a pin `conventional-directions` that makes it ISO 841: it must be known which is meant.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import TableError
from axiscal.language.spoken import listed, said
from axiscal.numerics import Array
from axiscal.tables.surface import Control
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine
from axiscal_core.rigid import about

_SETP = re.compile(r"setp (xyz[ab]c-trt-kins)\.([xyz]-(?:rot-point|offset)|conventional-directions) (-?[\d.]+)")
_CONVENTIONAL = "conventional-directions"
_SWIVELS = {"A": 1, "B": 0}
"""Which axis of x, y a swivelling table is displaced along: geometry."""
_TABLE = 2
"""The table C turns about z."""
_ASK = (
    'the xyzac- and xyzbc-trt-kins of LinuxCNC 2.9 turn against ISO 841: write direction = "reversed", or "iso" where '
    "the pin conventional-directions is set, in [axes.{first}]"
)
_HEAD = "# Made by axiscal: where the rotary axes lie; in place of your own lines for these pins."


@dataclass(frozen=True, slots=True)
class Pivots:
    """Settings of the kinematics, m.

    swivel : A or B; point : about which the table C turns, and the height about which the swivel turns
    offset : of the swivel's line from the table's, along y (A) or x (B)
    conventional : whether drives count as ISO 841 says
    """

    swivel: str
    point: tuple[float, float, float]
    offset: float
    conventional: bool = False

    @property
    def kinematics(self) -> str:
        """Name of the module."""
        return f"xyz{self.swivel.lower()}c-trt-kins"


def swivel_of(machine: Machine) -> str:
    """Return A or B, the axis that carries the table C; raises TableError for another build of machine."""
    rotary = [axis.name for axis in machine.axes if axis.rotary and axis.workpiece_side]
    built = sorted(axis.name for axis in machine.axes)
    if rotary not in (["C", "A"], ["C", "B"]) or built != sorted(["C", rotary[1], "X", "Y", "Z"]):
        raise TableError("{chain} has no table C on a swivel A or B", "leave --pivots out", chain=machine.chain)
    against = [axis.name for axis in machine.axes if axis.reversed and not axis.rotary]
    if against:
        remedy = "these kinematics cannot: leave --pivots out"
        raise TableError("{axes} counts against ISO 841", remedy, axes=listed(said(" and "), against))
    return rotary[1]


def conventional(machine: Machine) -> bool:
    """Return whether both rotary axes count as ISO 841 says.

    Raises TableError where it is not said, or not alike: Debian's LinuxCNC turns them the other way, newer sources
    either way, and settings made for the wrong one make the machine worse.
    """
    rotary = {axis.name: axis.counting for axis in machine.axes if axis.rotary}
    unsaid = [name for name, counting in rotary.items() if counting is None]
    if unsaid:
        what = "machine.toml does not say which way {axes} count"
        what = what if len(unsaid) > 1 else "machine.toml does not say which way {axes} counts"
        raise TableError(what, _ASK, axes=listed(said(" and "), unsaid), first=unsaid[0])
    if len(set(rotary.values())) > 1:
        what = "{axes} count in different ways, and these kinematics know one for both"
        raise TableError(what, "leave --pivots out, or state both alike", axes=listed(said(" and "), list(rotary)))
    return "iso" in rotary.values()


def names(machine: Machine) -> tuple[str, ...]:
    """Return the location errors that the settings hold."""
    swivel = swivel_of(machine)
    across = "XYZ"[_SWIVELS[swivel]]
    return ("X0C", "Y0C", f"{across}0{swivel}", f"Z0{swivel}")


def pivots(machine: Machine, errors: Mapping[str, float]) -> Pivots:
    """Return where the axes lie with these location errors, m; what the swivel's line does, the table does as well."""
    swivel = swivel_of(machine)
    across, along = _SWIVELS[swivel], "X" if swivel == "A" else "Y"  # where the line lies along itself does not matter
    line, table = (np.array(machine.axis(name).origin) for name in (swivel, "C"))
    line = line + np.array([errors.get(f"{d}0{swivel}", 0.0) if d != along else 0.0 for d in "XYZ"])
    point = table + np.array([errors.get("X0C", 0.0), errors.get("Y0C", 0.0), 0.0])
    point[across] += line[across] - machine.axis(swivel).origin[across]
    place = (float(point[0]), float(point[1]), float(line[2]))
    return Pivots(swivel, place, float(line[across] - point[across]), conventional(machine))


def write(found: Pivots, unit: str) -> str:
    """Return the HAL text; unit : of the machine."""
    x, y, z = (float(to_unit(value, unit)) for value in found.point)
    pins = {"x-rot-point": x, "y-rot-point": y, "z-rot-point": z}
    pins[f"{'xy'[_SWIVELS[found.swivel]]}-offset"] = float(to_unit(found.offset, unit))
    pins["z-offset"] = 0.0
    lines = [f"setp {found.kinematics}.{pin} {round(value, 7) + 0.0:.7f}" for pin, value in pins.items()]
    lines += [f"setp {found.kinematics}.{_CONVENTIONAL} 1"] if found.conventional else []
    return "\n".join([_HEAD, *lines, ""])


def read(text: str, unit: str) -> Pivots:
    """Return what the kinematics make of the settings; raises TableError when they are not whole."""
    settings = {(kins, pin): float(value) for kins, pin, value in _SETP.findall(text)}
    kinds = {kins for kins, _ in settings}
    ways = [settings.pop((kins, _CONVENTIONAL), 0.0) != 0.0 for kins in kinds]
    if len(kinds) != 1 or len(settings) != 5:
        raise TableError("the settings of the kinematics are not whole", "this is a defect of axiscal")
    kins = kinds.pop()
    found = {pin: float(from_unit(value, unit)) for (_, pin), value in settings.items()}
    swivel = kins[3].upper()
    x, y, z = (found[f"{d}-rot-point"] for d in "xyz")
    return Pivots(swivel, (x, y, z + found["z-offset"]), found[f"{'xy'[_SWIVELS[swivel]]}-offset"], ways[0])


def joint_shift(machine: Machine, nominal: Pivots, found: Pivots) -> Control:
    """Return how much further the joints go to the same place on the workpiece when the axes lie elsewhere.

    Unless they are told otherwise the kinematics turn the workpiece by the right hand when a drive counts up, and ISO
    841 turns the tool: what the kinematics do with an angle they do with minus that angle where it counts as ISO 841.
    """
    linear = [machine.index(name) for name in "XYZ"]
    swivel, table = machine.index(found.swivel), machine.index("C")
    way = -1.0 if found.conventional else 1.0

    def added(poses: Array, approaches: Array) -> Array:
        angles = way * poses[:, swivel], way * poses[:, table]
        tip = poses[:, linear] - np.array([0.0, 0.0, machine.tool_length])
        result = np.zeros_like(poses)
        result[:, linear] = joints_at(found, place_at(nominal, tip, *angles), *angles) - tip
        return result

    return added


def place_at(at: Pivots, joints: Array, swivel: Array, table: Array) -> Array:
    """Return the place on the workpiece that joints (m, 3) reach, (m, 3)."""
    line, point = _centres(at)
    turned = about("ABC".index(at.swivel), joints - line, -swivel) + line
    return about(_TABLE, turned - point, -table) + point


def joints_at(at: Pivots, place: Array, swivel: Array, table: Array) -> Array:
    """Return the joints (m, 3) that reach a place on the workpiece."""
    line, point = _centres(at)
    back = about(_TABLE, place - point, table) + point
    return about("ABC".index(at.swivel), back - line, swivel) + line


def _centres(at: Pivots) -> tuple[Array, Array]:
    point = np.array(at.point)
    line = point.copy()
    line[_SWIVELS[at.swivel]] += at.offset
    return line, point
