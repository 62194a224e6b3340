"""Conditions of the first move of somebody's machine, each a refusal in one sentence."""

from __future__ import annotations

from typing import Any

from axiscal.exceptions import SourceError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.ports.linuxcnc.live.in_force import InForce
from axiscal.units import format_quantity, from_unit

_SAME = 1e-6
"""mm or deg: rounding of a position that is shown twice."""
_CLOSE = 1e-6
"""m or rad: a limit in inches has so many digits."""


def scale(status: dict[str, Any], rotary: bool) -> float:
    """Return m or rad of one of the machine's units."""
    if rotary:
        return float(from_unit(1.0, "deg")) / float(status["angular"])
    return float(from_unit(1.0, "mm")) / float(status["scale"])


def refuse(status: dict[str, Any], machine: Machine, in_force: InForce) -> None:
    """Raise SourceError for the first thing that is not as it has to be."""
    if amiss := [each for each in _standing(status) if each[0]]:
        raise SourceError(amiss[0][1], amiss[0][2])
    _refuse_other_machine(status, machine)
    in_force.refuse(status)
    if machine.tool <= 0:
        what = "the length of the tool is not known: [tool] length of machine.toml is 0"
        raise SourceError(what, "Write how far the middle of the stylus' ball is from the spindle nose")


def _standing(status: dict[str, Any]) -> list[tuple[bool, str, str]]:
    apart = any(abs(at - status["position"][axis]) > _SAME for axis, at in status["joints"])
    offsets = any(abs(each) > _SAME for each in status["offsets"])
    return [
        (status["estop"], said("LinuxCNC is in emergency stop"), said("Release it")),
        (not status["enabled"], said("the machine is not switched on"), said("Switch it on")),
        (not status["homed"], said("not every joint is homed"), said("Home the machine")),
        (not status["idle"], said("a program is running or waiting"), said("Let it end, or stop it")),
        (status["spindle"], said("the spindle turns"), said("Stop it: a probe is to be in it")),
        (
            not status["feed_heeded"],
            said("the feed override is switched off (M48, M49)"),
            said("Switch it on: a person must be able to slow down"),
        ),
        (status["feed"] > 1.0, said("the feed override is above 100 %"), said("Turn it down")),
        (offsets, said("a tool length offset is in force"), said("Give G49")),
        (
            abs(status["rotation"]) > _SAME,
            said("the coordinate system is turned (G10 R)"),
            said("Set its rotation to zero"),
        ),
        (
            apart or status["tip"],
            said("the kinematics are not in their identity mode"),
            said("Leave TCP mode, as by M429"),
        ),
        (status["probe"], said("the probe is closed"), said("Look at the stylus and at motion.probe-input")),
    ]


def _refuse_other_machine(status: dict[str, Any], machine: Machine) -> None:
    """Raise SourceError where axes or limits are not those of machine.toml."""
    own, described = set(status["axes"]), {axis.name for axis in machine.axes}
    if own != described:
        what = "LinuxCNC has axes {own}, machine.toml {described}"
        remedy = "Describe the machine that runs: axiscal init DIR --from machine.ini"
        raise SourceError(what, remedy, own=" ".join(sorted(own)), described=" ".join(sorted(described)))
    for axis in machine.axes:
        unit = scale(status, axis.rotary)
        low, high = (float(end) * unit for end in status["axes"][axis.name])
        if axis.travel[0] < low - _CLOSE or axis.travel[1] > high + _CLOSE:
            low_text, high_text = (format_quantity(end, axis.unit) for end in (low, high))
            ends = said("{low} to {high}", low=low_text, high=high_text)
            what = "LinuxCNC lets {axis} go from {ends}, and machine.toml says {travel}"
            remedy = "Keep the travel within the limits of the INI file; or its units are others"
            raise SourceError(what, remedy, axis=axis.name, ends=ends, travel=axis.travel_text)
