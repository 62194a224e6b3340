"""An export into the owner's LinuxCNC configuration: checked against it, patched, undoable.

`configured` holds his INI file beside the description: what has to agree, what follows from it, and his files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from axiscal.description.ini_file import IniFile, read_ini
from axiscal.description.ini_machine import BELTS, IniAxis, IniMachine, machine_of
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.measurement.readers.text_file import exact_text
from axiscal.ports.linuxcnc import patching
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.units import format_quantity, from_unit
from axiscal_core.machine import Machine

_WHOLE = "axiscal-volumetric.hal"
LIBRARY = Path("/usr/share/linuxcnc/hallib")
"""Of HAL files: of Debian's package, in which a file is looked for that lies not beside the INI file."""


def export_into(ini: Path, estimate: Estimate, options: ExportOptions) -> Export:
    """Return the files of the component with those of a configuration; raises InputError."""
    found = configured(ini)
    minded = agreeing(found, estimate.machine)
    offered = export(estimate, "linuxcnc-volumetric", options_of(found, options))
    changed = found.patched()
    beside = [name for name in offered.files if name.endswith(".vcomp")]
    files = {name: text for name, text in offered.files.items() if name != _WHOLE}
    before = {name: text for name, text in found.files.items() if name not in found.library}
    placed = {name: text for name, text in changed.files.items() if text != found.files.get(name) or name in before}
    files |= placed | patching.scripts(before, placed, beside)
    lines = "line" if changed.tables == 1 else "lines"
    taken = f" {changed.tables} {lines} of COMP_FILE and BACKLASH taken out." if changed.tables else ""
    copied = "".join(f" {name} is a copy out of LinuxCNC's library." for name in placed if name in found.library)
    notes = (
        f"INTO YOUR CONFIGURATION: stop LinuxCNC, then sh {patching.APPLY} FOLDER (of {ini.name}); back again: "
        f"sh {patching.UNDO} FOLDER. Both refuse where a file is not the one that was read. The files as they were are "
        f"kept in its folder before-axiscal.{taken}{copied}",
        *minded,
    )
    kept = [line for line in offered.readme.split("\n") if not line.startswith(f"- Put {beside[0]} and ")]
    text = "\n".join(kept).replace(
        "\nThese files hold ", "".join(f"\n{note}" for note in notes) + "\nThese files hold ", 1
    )
    return replace(offered, files=files, readme=text)


_APART = 1e-6
"""m: pivots nearer than a micrometre are one."""


@dataclass(frozen=True, slots=True)
class Configured:
    """A LinuxCNC as its files have it.

    machine : what the INI says; files : the INI and its HAL files by name, in the order in which they run
    library : names of those that lie in LinuxCNC's library alone
    """

    ini: IniFile
    machine: IniMachine
    files: Mapping[str, str]
    library: frozenset[str]

    def patched(self) -> patching.Configuration:
        """Return the files with the component in them; raises TableError for what has to be done by hand."""
        joints = {number: axis.letter for axis in self.machine.axes for number in axis.joints}
        return patching.patched(self.ini, self.files, joints, self.machine.build.kinematics == BELTS)


def configured(path: Path) -> Configured:
    """Return what stands in an INI file and in the HAL files beside it; raises InputError."""
    ini = read_ini(path)
    files, library = {path.name: exact_text(path)}, set[str]()
    for named in ini.all("HAL", "HALFILE"):
        word = named.text.split()[0] if named.text else ""
        name = word.removeprefix(patching.LIB)
        if not name.endswith(".hal"):
            continue  # programs: nothing in them is changed
        if Path(name).name != name:
            raise named.fail("{name} lies in another folder", "put it beside the INI file", name=name)
        if word != name or not (path.parent / name).exists():  # as LinuxCNC looks for it
            library.add(name)
            if not (LIBRARY / name).exists():
                what, remedy = "{name} lies neither here nor in LinuxCNC's library", "put it beside the INI file"
                raise named.fail(what, remedy, name=name)
        files[name] = exact_text((LIBRARY if name in library else path.parent) / name)
    return Configured(ini, machine_of(ini), files, frozenset(library))


def options_of(found: Configured, options: ExportOptions) -> ExportOptions:
    """Return options with the unit and the joints of the INI file; raises TableError where these were given as well."""
    if any(axis.unit == "rad" for axis in found.machine.axes):
        remedy = "set them to degree"
        raise TableError("ANGULAR_UNITS are radians, and the component counts degrees", remedy, found.ini.path)
    if {"--number", "--unit"} & set(options.given):
        raise TableError("--ini says the unit and which joints are whose", "leave --unit and --number out")
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
