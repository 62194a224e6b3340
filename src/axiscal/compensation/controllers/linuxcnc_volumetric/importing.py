"""What an old file of the component did."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.compensation.controllers.linuxcnc_volumetric import applying, vcomp_reading
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.old_files import OldFile
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine


def load(files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
    """Return what the file did; raises TableError."""
    own = [file for file in files if file.name.lower().endswith(".vcomp")]
    if not own:
        names = ", ".join(dict.fromkeys(file.name for file in files))
        raise TableError(f"{names} is no file of the component", "give axiscal.vcomp")
    return Loaded(others=tuple(applying.control(vcomp_reading.read(file.text, file.name), machine) for file in own))
