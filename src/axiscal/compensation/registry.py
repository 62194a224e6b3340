"""The controllers that tables can be made for, by the names that `axiscal export --to` takes."""

from __future__ import annotations

from importlib import import_module

from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.offer import Export, Maker, tried_out
from axiscal.document import nearest, shown
from axiscal.estimate.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.numerics.threads import one_thread

_ROOM = "axiscal.compensation.controllers"
CONTROLLERS = {
    "csv": ("plain_csv", "make"),
    "fanuc": ("fanuc.exporting", "make"),
    "heidenhain": ("heidenhain", "make"),
    "isg": ("isg.exporting", "make"),
    "isg-etalon": ("isg.exporting", "make_etalon"),
    "klipper": ("klipper", "make"),
    "linuxcnc": ("linuxcnc.exporting", "make"),
    "marlin": ("marlin", "make"),
    "reprapfirmware": ("reprapfirmware", "make"),
    "sinumerik": ("sinumerik.exporting", "make"),
}
"""Name -> module and function that writes the files."""


@one_thread()
def export(estimate: Estimate, controller: str, options: ExportOptions) -> Export:
    """Return the files for one controller, tried out; raises TableError for an unknown one, or what it cannot hold."""
    name = next((known for known in CONTROLLERS if known == controller.casefold()), controller)
    return tried_out(name, estimate, _maker(name)(estimate, options))


def _maker(controller: str) -> Maker:
    if controller not in CONTROLLERS:
        near = nearest(controller, CONTROLLERS)
        remedy = f"Perhaps {near} is meant" if near else f"Known are {', '.join(CONTROLLERS)}"
        raise TableError(f"{shown(controller)} is not a controller that tables can be made for", remedy)
    module, name = CONTROLLERS[controller]
    make: Maker = getattr(import_module(f"{_ROOM}.{module}"), name)
    return make
