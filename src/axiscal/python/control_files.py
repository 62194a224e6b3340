"""From what the core knows of a machine to the files of a control."""

from __future__ import annotations

from pathlib import Path

from axiscal.errors.volume import Alignment, even_poses, whole_travel
from axiscal.estimation.machine_estimate import Estimate, LeftUnknown, where_read
from axiscal.machine.axis import LINEAR_LETTERS, ROTARY_LETTERS
from axiscal.present.delivery import write_files
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import POSES
from axiscal_core import refusals
from axiscal_core.eigen import unique_root
from axiscal_core.known import Known
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from axiscal_core.refusals import one


def export(known: Known, control: str, folder: str | Path) -> list[Path]:
    """Write the files of a control with their README.txt and return them.

    control : as `axiscal export --to` names it
    Raises axiscal_core.InputError for a machine that no table describes, TableError for what a control cannot hold.
    """
    one("export", "known", known, Known, "what `case.estimate` returns")
    one("export", "control", control, str, 'such as "linuxcnc"')
    one("export", "folder", folder, (str, Path), 'such as "tables"')
    _refuse_untabled(known.case.machine)
    offered = registry.export(_estimate(known), control, ExportOptions())
    write_files(offered, Path(folder))
    return [Path(folder) / name for name in (*offered.files, "README.txt")]


def _refuse_untabled(machine: Machine) -> None:
    """Raise InputError for errors, or axes, that no table is of."""
    own = ", ".join(part.name for part in machine.parts[len(machine.terms) :])
    letters = {True: ROTARY_LETTERS, False: LINEAR_LETTERS}
    foreign = ", ".join(axis.name for axis in machine.axes if axis.name[0] not in letters[axis.rotary])
    what = f"has errors of its own basis ({own}), and no table holds them" if own else ""
    what = f"has the axes {foreign}, which no control has" if foreign else what
    if what:
        raise refusals.InputError("export", "known", what, "Correct poses by known.deviation(poses)")


def _estimate(known: Known) -> Estimate:
    """Return what tables are made of: the machine's part of what is known, over all its travels."""
    machine, size = known.case.machine, known.case.machine.size
    box = whole_travel(machine)
    sample = even_poses(box, POSES)
    places = known.case.lattice(1).at([]) if known.readings is None else known.readings.places
    mounted = [known.case.instruments[known.case.setups.index(name)] for name in places.instruments]
    moves = [[machine.index(axis) for axis in each.moves] for each in mounted]
    return Estimate(
        machine,
        Normal(known.mean[:size], known.covariance[:size, :size]),
        box,
        sample=sample,
        alignment=Alignment(machine, sample) if known.case.aligned else None,
        read=where_read(machine, zip(moves, places.poses.tolist(), strict=True)),
        open=unique_root(known.alone[:size, :size]),
        unknown=LeftUnknown(known.rms, known.U),
    )
