"""Old pitch data of a FANUC, in the file that the control has punched."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.compensation.controllers.fanuc.data import read
from axiscal.compensation.controllers.fanuc.pitch import read_plans
from axiscal.compensation.controllers.fanuc.records import read_records
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.old_files import OldFile
from axiscal.machine.description import Machine


def load(files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
    """Return what the files did; raises TableError."""
    numbers, lookups = options.numbered(machine), []
    for file in files:
        records = read_records(file.text, file.name)
        plans = read_plans(records, file.name, machine, numbers)
        lookups += read(records, plans, numbers, -1 if options.flip else 1)
    return Loaded(tuple(lookups))
