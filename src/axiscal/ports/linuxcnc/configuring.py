"""An export into the owner's LinuxCNC configuration: checked against it, patched, started without motors, undoable.

The owner's patched files are started if HAL loads software only, with our program instead of his screen. If HAL loads
drivers of hardware, which is not here, a configuration with simulated drives is started. It has his axes, joints,
units, limits and kinematics.

`configured` holds his INI file beside the description: what has to agree, what follows from it, and his files.
"""

from __future__ import annotations

import re
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from axiscal.description.ini_file import IniFile, expanded, read_ini
from axiscal.description.ini_machine import IniAxis, IniMachine, machine_of
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import ControlError, TableError
from axiscal.machine.description import Machine
from axiscal.measurement.readers.text_file import read_text
from axiscal.ports.linuxcnc import patching
from axiscal.ports.linuxcnc.lab import Joint, Session, Settings, available, can_load
from axiscal.ports.linuxcnc.patching import Configuration
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.units import format_quantity, from_unit, to_unit

_WHOLE = "axiscal-volumetric.hal"
LIBRARY = Path("/usr/share/linuxcnc/hallib")
"""Of HAL files: of Debian's package, in which a file is looked for that lies not beside the INI file."""


def export_into(ini: Path, estimate: Estimate, options: ExportOptions) -> Export:
    """Return the files of the component with those of a configuration; raises InputError, ControlError."""
    found = configured(ini)
    minded = agreeing(found, estimate.machine)
    offered = export(estimate, "linuxcnc-volumetric", options_of(found, options))
    changed = found.patched()
    seen = started(found, changed, offered, estimate.machine)
    beside = [name for name in offered.files if name.endswith(".vcomp")]
    files = {name: text for name, text in offered.files.items() if name != _WHOLE}
    before = {name: text for name, text in found.files.items() if name not in found.library}
    placed = {name: text for name, text in changed.files.items() if text != found.files.get(name) or name in before}
    files |= placed | patching.scripts(before, placed, beside)
    lines = "line" if changed.tables == 1 else "lines"
    taken = f" {changed.tables} {lines} of COMP_FILE and BACKLASH taken out." if changed.tables else ""
    copied = "".join(f" {name} is a copy out of LinuxCNC's library." for name in placed if name in found.library)
    notes = (
        f"INTO YOUR CONFIGURATION: stop LinuxCNC, then sh {patching.APPLY} FOLDER (of {found.name}); back again: "
        f"sh {patching.UNDO} FOLDER. Both refuse where a file is not the one that was read. The files as they were are "
        f"kept in its folder before-axiscal.{taken}{copied} {seen}",
        *minded,
    )
    kept = [line for line in offered.readme.split("\n") if not line.startswith(f"- Put {beside[0]} and ")]
    text = "\n".join(kept).replace(
        "\nThese files hold ", "".join(f"\n{note}" for note in notes) + "\nThese files hold ", 1
    )
    return replace(offered, files=files, readme=text)


_SOFT = re.compile(
    r"\w*kins|motmod|tpmod|homemod|pid|sum2|mux\d*|mult2|limit\d|lincurve|hypot|ddt|comp|minmax|scale|offset|abs|sampler|"
    r"and2|or2|xor2|not|estop_latch|toggle|conv_\w+|constant|near|wcomp|lowpass|integ|bitslice|select8|sim_\w+|threads"
)
"""LinuxCNC's components that need no hardware."""
_LOADED = re.compile(r"^\s*load(rt|usr)\s+(?:-\S+\s+)*(\S+)", re.MULTILINE)
_COMMAND = re.compile(r"^\s*HALCMD\s*=\s*(load|source)", re.M | re.I)
_PROGRAM = re.compile(r"^[ \t]*HALFILE[ \t]*=(?![ \t]*\S+\.hal(?:\s|$))", re.M | re.I)
"""What would load more than is looked at here."""
_SPOKEN = {"[KINS]KINEMATICS", "[EMCMOT]EMCMOT", "[TRAJ]TPMOD", "[EMCMOT]HOMEMOD"}
_SCREEN = re.compile(
    r"^\s*(DISPLAY|HALUI|APP|POSTGUI_HALFILE|POSTGUI_HALCMD|TWOPASS|OPEN_FILE|INTRO_GRAPHIC|ON_ABORT_COMMAND)\s*=.*$",
    re.M,
)
"""Screens, and programs that are not here."""
_AWAY = 1e-6
"""mm, inch or deg: what the component may add more or less than was foretold."""
_GAIN, _FAULT = "axiscal-vcomp.gain", "axiscal-vcomp.fault-code"
_COMING = 15.0
"""s within which the correction, which takes one, has to be there."""


def started(found: Configured, changed: Configuration, offered: Export, machine: Machine) -> str:
    """Start it, switch the component on, and return what was seen in a sentence; raises ControlError."""
    if not available():
        return "It was not started here: Debian's linuxcnc-uspace is not installed."
    if not can_load("axiscal_vcomp"):
        return "It was not started here: Debian's linuxcnc-uspace-dev and gcc are not installed."
    own = software_only(changed)
    with Session(_joints(found), _settings(found, changed, offered, own)) as session:
        session.set("axiscal-vcomp.enable", "1")
        end = time.monotonic() + _COMING
        while session.read([_GAIN]) < (1.0,):
            if time.monotonic() > end:
                (code,) = session.read([_FAULT])
                raise ControlError("the correction did not come, fault {code:.0f}", "Do not load it", code=code)
            time.sleep(0.1)
        _refuse_others(session, found, offered, machine)
        if session.errors:
            raise ControlError("LinuxCNC says {message!r}", "Do not load it", message=session.errors[0])
    what = (
        "the patched files themselves" if own else "a configuration of these axes with simulated drives, not your HAL"
    )
    return f"Started here without motors: {what}; homed, switched on, and every joint was corrected as foretold."


def software_only(changed: Configuration) -> bool:
    """Return whether the HAL files, and the commands of the INI file, load nothing that needs hardware or a screen."""
    if _COMMAND.search(changed.files[changed.ini]) or _PROGRAM.search(changed.files[changed.ini]):
        return False
    loaded = [each for name in changed.texts() for each in _LOADED.findall(changed.files[name])]
    known = _SPOKEN | {"axiscal_vcomp"}
    return all(kind == "rt" and (module in known or _SOFT.fullmatch(module)) for kind, module in loaded)


def _joints(found: Configured) -> list[Joint]:
    by_number = {n: axis for axis in found.machine.axes for n in axis.joints}
    own = (by_number[n] for n in sorted(by_number))
    return [Joint(a.letter, a.low, a.high, a.speed or 100.0, a.acceleration or 1000.0) for a in own]


def _settings(found: Configured, changed: Configuration, offered: Export, own: bool) -> Settings:
    build = found.machine.build
    whole = replace(Settings.loading(offered.files), kinematics=build.kinematics, unit=build.unit)
    if not own:
        return whole
    ini = _SCREEN.sub("", expanded(found.ini.path, changed.files[changed.ini]))
    ini = re.sub(r"^\s*\[\s*DISPLAY\s*\].*$", "[DISPLAY]\nDISPLAY = ./driver.py", ini, count=1, flags=re.M)
    if "./driver.py" not in ini:
        ini += "\n[DISPLAY]\nDISPLAY = ./driver.py\n"
    files = {name: changed.files[name] for name in changed.texts()}
    return replace(whole, hal="", beside={**whole.beside, **files, "machine.ini": ini})


def _refuse_others(session: Session, found: Configured, offered: Export, machine: Machine) -> None:
    """Raise ControlError where a joint is not corrected as the file says, the mean of both sides after homing."""
    joints = sorted(n for axis in found.machine.axes for n in axis.joints)
    shown = dict(zip(joints, session.read([f"axiscal-vcomp.pos-{n}" for n in joints]), strict=True))
    added = dict(zip(joints, session.read([f"axiscal-vcomp.correction-{n}" for n in joints]), strict=True))
    own = {axis.letter: axis for axis in found.machine.axes}
    pose = np.array([[from_unit(shown[own[a.name].joints[0]], own[a.name].unit) for a in machine.axes]])
    ways = [np.full_like(pose, side) for side in (1.0, -1.0)]
    either = np.stack([offered.control(pose, way)[0] for way in ways])
    for k, axis in enumerate(machine.axes):
        low, high = to_unit(np.sort(either[:, k]), own[axis.name].unit)
        for joint in own[axis.name].joints:
            if not low - _AWAY - 0.1 * (high - low) <= added[joint] <= high + _AWAY + 0.1 * (high - low):
                what = "joint {joint} of {axis} is moved by {moved:.6f}, {low:.6f} to {high:.6f} was foretold"
                remedy = "Do not load it: this is a defect of axiscal, please report it"
                raise ControlError(what, remedy, joint=joint, axis=axis.name, moved=added[joint], low=low, high=high)


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

    @property
    def name(self) -> str:
        """Name of the INI file."""
        return self.ini.path.name

    def patched(self) -> patching.Configuration:
        """Return the files with the component in them; raises TableError for what has to be done by hand."""
        joints = {number: axis.letter for axis in self.machine.axes for number in axis.joints}
        return patching.patched(self.ini, self.files, joints)


def configured(path: Path) -> Configured:
    """Return what stands in an INI file and in the HAL files beside it; raises InputError."""
    ini = read_ini(path)
    files, library = {path.name: _text(path)}, set[str]()
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
        files[name] = _text((LIBRARY if name in library else path.parent) / name)
    return Configured(ini, machine_of(ini), files, frozenset(library))


def _text(path: Path) -> str:
    """Return a file to the last byte, since it is compared with what stands there when it is changed."""
    read_text(path)  # raises for what is no text
    try:
        return path.read_bytes().decode()
    except UnicodeDecodeError as fault:
        raise TableError("byte {place} is no UTF-8", "save the file as UTF-8", path, place=fault.start) from None


def options_of(found: Configured, options: ExportOptions) -> ExportOptions:
    """Return options with the unit and the joints of the INI file; raises TableError where these were given as well."""
    if any(axis.unit == "rad" for axis in found.machine.axes):
        remedy = "set them to degree"
        raise TableError("ANGULAR_UNITS are radians, and the component counts degrees", remedy, found.ini.path)
    if {"--number", "--unit"} & set(options.given):
        raise TableError("--ini says the unit and which joints are whose", "leave --unit, --number, --coordinates out")
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
