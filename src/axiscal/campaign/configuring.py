"""An export into the owner's LinuxCNC configuration: checked against it, patched, started without motors, undoable."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from axiscal.campaign.headless import started
from axiscal.compensation.controllers.linuxcnc_volumetric import patching
from axiscal.compensation.controllers.linuxcnc_volumetric.configured import agreeing, configured, options_of
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.offer import Export
from axiscal.compensation.registry import export
from axiscal.estimation.machine_estimate import Estimate

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
