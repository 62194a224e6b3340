"""Old compensation of a SINUMERIK: `$AA_ENC_COMP` of the chosen measuring system, and `$AN_CEC`."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.compensation.controllers.sinumerik.read_back import read
from axiscal.compensation.controllers.sinumerik.writing import axis_names
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.old_files import OldFile
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine


def load(files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
    """Return what the files did; raises TableError."""
    names = axis_names(machine, options)
    lookups = []
    for file in files:
        try:
            lookups += read([file.text], names, machine, options.flip, options.encoder - 1)
        except TableError as fault:
            remedy = "give AX_EEC.INI and NC_CEC.INI as the control saved them"
            raise TableError(fault.what, remedy, file.name) from None
    return Loaded(tuple(lookups))
