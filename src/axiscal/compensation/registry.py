"""The controllers that tables can be made for, by the names that `axiscal export --to` takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib import import_module

import numpy as np

from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.offer import Export, Maker, tried_out
from axiscal.compensation.old_files import OldFile
from axiscal.compensation.on_top import asked_about, on_top
from axiscal.document import nearest, shown
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import AxiscalError, TableError
from axiscal.machine.description import Machine
from axiscal.numerics.stages import stage
from axiscal.numerics.threads import one_thread

_ABSURD = 1.0
"""m or rad: no compensation is as large; any value above what a machine can be off by would do."""
Importer = Callable[[Sequence[OldFile], Machine, ExportOptions], Loaded]
"""(files, machine, options) -> what the control made of them."""
_ROOM = "axiscal.compensation.controllers"
CONTROLLERS = {
    "csv": ("plain_csv", "make"),
    "fanuc": ("fanuc.exporting", "make"),
    "heidenhain": ("heidenhain", "make"),
    "isg": ("isg.exporting", "make"),
    "isg-etalon": ("isg.exporting", "make_etalon"),
    "klipper": ("klipper", "make"),
    "linuxcnc": ("linuxcnc.exporting", "make"),
    "linuxcnc-volumetric": ("linuxcnc_volumetric.exporting", "make"),
    "marlin": ("marlin", "make"),
    "reprapfirmware": ("reprapfirmware", "make"),
    "sinumerik": ("sinumerik.exporting", "make"),
}
"""Name -> module and function that writes the files."""
IMPORTERS = {
    "csv": "plain_csv",
    "fanuc": "fanuc.importing",
    "heidenhain": "heidenhain",
    "isg": "isg.importing",
    "isg-etalon": "isg.importing",
    "klipper": "klipper",
    "linuxcnc": "linuxcnc.importing",
    "linuxcnc-volumetric": "linuxcnc_volumetric.importing",
    "marlin": "marlin",
    "reprapfirmware": "reprapfirmware",
    "sinumerik": "sinumerik.importing",
}
"""Name -> module whose `load` reads an old compensation of this control."""


@one_thread()
@stage("tables")
def export(estimate: Estimate, controller: str, options: ExportOptions) -> Export:
    """Return the files for one controller, tried out; raises TableError for an unknown one, or what it cannot hold."""
    name = next((known for known in CONTROLLERS if known == controller.casefold()), controller)
    make = _maker(name)
    for axis in options.spacing if isinstance(options.spacing, Mapping) else ():
        estimate.machine.index(axis)
    if not options.old_files:
        return tried_out(name, estimate, asked_about(name, make(estimate, options), options))
    old = loaded(name, estimate.machine, options)
    return tried_out(name, estimate, on_top(estimate, make(estimate, replace(options, old=old)), old, options))


def loaded(controller: str, machine: Machine, options: ExportOptions) -> Loaded:
    """Return what the old files of a control did; raises TableError, ReadingError."""
    load: Importer = import_module(f"{_ROOM}.{IMPORTERS[controller]}").load
    names = ", ".join(dict.fromkeys(file.name for file in options.old_files))
    try:
        found = load(options.old_files, machine, options)
    except AxiscalError:
        raise
    except (LookupError, ArithmeticError, ValueError) as fault:
        what = f"a number that {controller} needs is missing, or is none ({fault})"
        raise TableError(what, "give the files as the control saved them", names) from fault
    for table in found.lookups:
        if not np.all(np.abs(table.added) < _ABSURD):
            what = f"the table of {table.axis} over {table.over} moves it by a metre, or a radian, or more"
            raise TableError(what, "give the files as the control saved them, and the unit of the machine", names)
    return found


def _maker(controller: str) -> Maker:
    if controller not in CONTROLLERS:
        near = nearest(controller, CONTROLLERS)
        remedy = f"Perhaps {near} is meant" if near else f"Known are {', '.join(CONTROLLERS)}"
        raise TableError(f"{shown(controller)} is not a controller that tables can be made for", remedy)
    module, name = CONTROLLERS[controller]
    make: Maker = getattr(import_module(f"{_ROOM}.{module}"), name)
    return make
