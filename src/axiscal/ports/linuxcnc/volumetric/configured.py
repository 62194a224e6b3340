"""The owner's INI file beside the description: what has to agree, what follows from it, and his files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from axiscal.description.ini_file import IniFile, read_ini
from axiscal.description.ini_machine import IniAxis, IniMachine, machine_of
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.measurement.readers.text import read_text
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.volumetric import patching
from axiscal.tables.export_options import ExportOptions
from axiscal.units import format_quantity, from_unit

_APART = 1e-6
"""m: pivots nearer than a micrometre are one."""


@dataclass(frozen=True, slots=True)
class Configured:
    """A LinuxCNC as its files have it.

    machine : what the INI says; files : the INI and its HAL files by name, in the order in which they run
    """

    ini: IniFile
    machine: IniMachine
    files: Mapping[str, str]

    @property
    def name(self) -> str:
        """Name of the INI file."""
        return self.ini.path.name

    def patched(self) -> patching.Configuration:
        """Return the files with the component in them; raises TableError for what has to be done by hand."""
        return patching.patched(self.name, self.files, sorted(n for axis in self.machine.axes for n in axis.joints))


def configured(path: Path) -> Configured:
    """Return what stands in an INI file and in the HAL files beside it; raises InputError."""
    ini = read_ini(path)
    files = {path.name: _text(path)}
    for named in ini.all("HAL", "HALFILE"):
        name = named.text.split()[0] if named.text else ""
        if name.startswith("LIB:") or not name.endswith(".hal"):
            continue  # LinuxCNC's own, or programs: nothing in them is changed
        if Path(name).name != name:
            raise named.fail("{name} lies in another folder", "put it beside the INI file", name=name)
        files[name] = _text(path.parent / name)
    return Configured(ini, machine_of(ini), files)


def _text(path: Path) -> str:
    """Return a file to the last byte, since it is compared with what stands there when it is changed."""
    read_text(path)  # raises for what is no text
    try:
        return path.read_bytes().decode()
    except UnicodeDecodeError as fault:
        raise TableError("byte {place} is no UTF-8", "save the file as UTF-8", path, place=fault.start) from None


def options_of(found: Configured, machine: Machine, options: ExportOptions) -> ExportOptions:
    """Return options with the unit and the joints of the INI file; raises TableError where these were given as well."""
    if any(axis.unit == "rad" for axis in found.machine.axes):
        remedy = "set them to degree"
        raise TableError("ANGULAR_UNITS are radians, and the component counts degrees", remedy, found.ini.path)
    if options.numbers:
        raise TableError("--ini says which joints are whose", "leave --number and --coordinates out")
    return replace(options, unit=found.machine.build.unit, numbers={a.letter: a.joints for a in found.machine.axes})


def agreeing(found: Configured, machine: Machine) -> tuple[str, ...]:
    """Return what to mind; raises TableError where INI file and machine.toml describe different machines."""
    own, described = {axis.letter: axis for axis in found.machine.axes}, {axis.name: axis for axis in machine.axes}
    if set(own) != set(described):
        what = "the INI file has axes {own}, machine.toml {described}"
        remedy = "the component corrects the whole chain: describe all of them"
        raise TableError(what, remedy, found.ini.path, own=" ".join(sorted(own)), described=" ".join(sorted(described)))
    build, notes = found.machine.build, list[str]()
    for name, axis in described.items():
        against = name in build.reversed
        if build.sure and axis.rotary and against != axis.reversed:
            what = "{kinematics} turns {axis} by ISO 841, and machine.toml says the other way"
            if against:
                what = "{kinematics} turns {axis} against ISO 841, and machine.toml says the other way"
            remedy = "write direction = {way} in machine.toml, and evaluate the readings again"
            kinematics, way = build.kinematics, "reversed" if against else "iso"
            raise TableError(what, remedy, found.ini.path, kinematics=kinematics, axis=name, way=way)
        notes += _beyond(own[name], axis.travel, axis.unit, axis.cyclic)
        if build.sure and axis.rotary and name in build.origins:
            notes += _elsewhere(name, [float(from_unit(v, build.unit)) for v in build.origins[name]], axis.origin)
    return tuple(notes)


def _beyond(own: IniAxis, travel: tuple[float, float], unit: str, cyclic: bool) -> list[str]:
    low, high = (float(from_unit(end, own.unit)) for end in (own.low, own.high))
    if cyclic or (low >= travel[0] - _APART and high <= travel[1] + _APART):
        return []
    ends = " to ".join(format_quantity(end, unit) for end in (low, high))
    known = " to ".join(format_quantity(end, unit) for end in travel)
    return [
        f"{own.letter} may go {ends}, and was calibrated over {known}: beyond, the correction stays near that of the "
        "end."
    ]


def _elsewhere(name: str, pivot: list[float], origin: tuple[float, ...]) -> list[str]:
    if max(abs(a - b) for a, b in zip(pivot, origin, strict=True)) <= _APART:
        return []
    there, here = (", ".join(format_quantity(v, "mm", 6) for v in place) for place in (pivot, origin))
    return [
        f"WARNING: the kinematics turn {name} about ({there}), machine.toml about ({here}): one of them is not the "
        "machine that was measured."
    ]


def positions(found: Configured, shown: Mapping[int, float], machine: Machine) -> Array:
    """Return the pose (1, q), m or rad, of joints at positions in the units of the configuration."""
    own = {axis.letter: axis for axis in found.machine.axes}
    each = [float(from_unit(shown[own[a.name].joints[0]], own[a.name].unit)) for a in machine.axes]
    return np.array([each])
