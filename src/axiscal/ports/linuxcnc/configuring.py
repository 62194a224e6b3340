"""An export into the owner's LinuxCNC configuration: checked against it, patched, started without motors, undoable.

The owner's patched files are started if HAL loads software only, with our program instead of his screen. If HAL loads
drivers of hardware, which is not here, a configuration with simulated drives is started. It has his axes, joints,
units, limits and kinematics.
"""

from __future__ import annotations

import re
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import ControlError
from axiscal.machine.description import Machine
from axiscal.ports.linuxcnc.lab import Joint, Session, Settings, available, can_load
from axiscal.ports.linuxcnc.volumetric import patching
from axiscal.ports.linuxcnc.volumetric.configured import (
    Configured,
    agreeing,
    configured,
    options_of,
    positions,
)
from axiscal.ports.linuxcnc.volumetric.patching import Configuration
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export

_WHOLE = "axiscal-volumetric.hal"


def export_into(ini: Path, estimate: Estimate, options: ExportOptions) -> Export:
    """Return the files of the component with those of a configuration; raises InputError, ControlError."""
    found = configured(ini)
    minded = agreeing(found, estimate.machine)
    offered = export(estimate, "linuxcnc-volumetric", options_of(found, estimate.machine, options))
    changed = found.patched()
    seen = started(found, changed, offered, estimate.machine)
    beside = [name for name in offered.files if name.endswith(".vcomp")]
    files = {name: text for name, text in offered.files.items() if name != _WHOLE}
    files |= changed.files | patching.scripts(found.files, changed, beside)
    lines = "line" if changed.tables == 1 else "lines"
    taken = f" {changed.tables} {lines} of COMP_FILE and BACKLASH taken out." if changed.tables else ""
    notes = (
        f"INTO YOUR CONFIGURATION: stop LinuxCNC, then sh {patching.APPLY} FOLDER (of {found.name}); back again: "
        f"sh {patching.UNDO} FOLDER. Both refuse where a file is not the one that was read. The files as they were are "
        f"kept in its folder before-axiscal.{taken} {seen}",
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
    r"^\s*(DISPLAY|HALUI|APP|POSTGUI_HALFILE|POSTGUI_HALCMD|TWOPASS|OPEN_FILE|INTRO_GRAPHIC)\s*=.*$", re.M
)
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
        session.move(["setp axiscal-vcomp.enable 1"])
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
    for name in changed.texts():
        for kind, module in _LOADED.findall(changed.files[name]):
            if kind == "usr" or not (module in _SPOKEN or module == "axiscal_vcomp" or _SOFT.fullmatch(module)):
                return False
    return len(changed.ini) > 0 and "LIB:" not in changed.files[changed.ini]


def _joints(found: Configured) -> list[Joint]:
    by_number = {n: axis for axis in found.machine.axes for n in axis.joints}
    own = (by_number[n] for n in sorted(by_number))
    return [Joint(a.letter, a.low, a.high, a.speed or 100.0, a.acceleration or 1000.0) for a in own]


def _settings(found: Configured, changed: Configuration, offered: Export, own: bool) -> Settings:
    build = found.machine.build
    whole = replace(Settings.loading(offered.files), kinematics=build.kinematics, unit=build.unit)
    if not own:
        return whole
    ini = _SCREEN.sub("", changed.files[changed.ini])
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
    pose = positions(found, shown, machine)
    ways = [np.full_like(pose, side) for side in (1.0, -1.0)]
    either = np.stack([offered.control(pose, way)[0] for way in ways])
    own = {axis.letter: axis for axis in found.machine.axes}
    for k, axis in enumerate(machine.axes):
        scale = {"mm": 1e3, "in": 1e3 / 25.4, "deg": float(np.degrees(1.0)), "rad": 1.0}[own[axis.name].unit]
        low, high = np.sort(either[:, k]) * scale
        for joint in own[axis.name].joints:
            if not low - _AWAY - 0.1 * (high - low) <= added[joint] <= high + _AWAY + 0.1 * (high - low):
                what = "joint {joint} of {axis} is moved by {moved:.6f}, {low:.6f} to {high:.6f} was foretold"
                remedy = "Do not load it: this is a defect of axiscal, please report it"
                raise ControlError(what, remedy, joint=joint, axis=axis.name, moved=added[joint], low=low, high=high)
