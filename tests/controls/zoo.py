"""Every control by its name: what it is given, and what it is seen to do."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from axiscal.numerics import Array
from tests.controls import duet, klipper_host
from tests.controls.fetched import MissingError, run
from tests.controls.known import BED, OWN, SQUARE, STRAIGHT, TURNS, Known, Row, known
from tests.controls.samples import counted
from tests.linuxcnc.lab import available, can_compile
from tests.linuxcnc.virtual import LinuxcncMachine

LOST = {f"E{axis}{axis}_reversal": "20 um" for axis in "XYZ"}


def by_name(machine: Known, added: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """Return what adds to axes in the order of the chain, of what adds to X, Y, Z."""
    order = order_of(machine)
    return lambda poses, ways: added(poses[:, np.argsort(order)], ways[:, np.argsort(order)])[:, order]


def order_of(machine: Known) -> list[int]:
    """Return where each axis of the chain stands in X, Y, Z."""
    return ["XYZ".index(axis.name) for axis in machine.estimate.machine.axes]


def klipper() -> Row:
    """Its mesh and its skew, by the steps of the motors."""
    machine = known(BED, SQUARE)
    export = machine.exported("klipper", mesh=25)
    config = klipper_host.config("[bed_mesh]\nmesh_min: 0, 0\nmesh_max: 300, 240\n[skew_correction]\n")
    codes = ["BED_MESH_PROFILE LOAD=axiscal", *export.files["skew.gcode"].splitlines()]
    files = {"printer.cfg": config + export.files["bed_mesh.cfg"]}
    added = by_name(machine, lambda poses, _: klipper_host.motors(files, codes, poses) - poses)
    ran = "bed_mesh and skew_correction, steps of the motors"
    return machine.row("Klipper", klipper_host.VERSION, ran, export, added, sides=False)


def reprapfirmware() -> Row:
    """Its map, compiled, behind the formulas of M556 and M425."""
    machine = known(BED, SQUARE, LOST)
    export = machine.exported("reprapfirmware", mesh=21)
    added = by_name(machine, lambda poses, ways: duet.added(export.files, poses, ways))
    ran = "Grid.cpp compiled; M556, M425 by their formulas"
    return machine.row("RepRapFirmware", duet.VERSION, ran, export, added, sides=True)


def linuxcnc() -> Row:
    """Tables and HAL text in the LinuxCNC that is installed."""
    return _on_linuxcnc("linuxcnc", "COMP_FILE and axiscal-cross.hal", known(OWN, LOST, STRAIGHT, SQUARE))


def linuxcnc_volumetric() -> Row:
    """The component in the LinuxCNC that is installed."""
    if not can_compile():
        raise MissingError("gcc and linuxcnc-uspace-dev are not installed")
    machine = known(OWN, LOST, STRAIGHT, SQUARE, TURNS, BED)
    return _on_linuxcnc("linuxcnc-volumetric", "axiscal_vcomp in the servo thread", machine)


def linuxcnc_samples(every: int = 1) -> Row:
    """Every so many-th sample configuration of the LinuxCNC that is here, from its INI to tables or to a reason."""
    found = counted(every)
    total, ended = sum(found.values()), found["loaded"] + found["refused"]
    ran = f"{total} samples: {found['loaded']} loaded, {found['refused']} refused"
    return Row("linuxcnc samples", debian(), ran, 100 * (total - ended) / total)


def _on_linuxcnc(controller: str, ran: str, machine: Known) -> Row:
    if not available():
        raise MissingError("linuxcnc-uspace is not installed")
    export = machine.exported(controller)
    with LinuxcncMachine(machine.truth, export.files) as running:
        row = machine.row(controller, debian(), ran, export, lambda p, w: running.sent(p, w) - p, sides=True)
        assert running.errors == ()
    return row


def debian() -> str:
    """Return the version of LinuxCNC that Debian has installed."""
    if shutil.which("dpkg-query") is None:
        return "installed"
    said = run(["dpkg-query", "-W", "-f", "${Version}", "linuxcnc-uspace"], Path("/"))
    return said.partition("~")[0]


CONTROLS: Mapping[str, Callable[[], Row]] = {
    "linuxcnc": linuxcnc,
    "linuxcnc-volumetric": linuxcnc_volumetric,
    "linuxcnc-samples": linuxcnc_samples,
    "klipper": klipper,
    "reprapfirmware": reprapfirmware,
}
