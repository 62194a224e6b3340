"""What is to compensate a machine while it is measured: nothing, anything, or the file that `axiscal export` wrote."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from axiscal.exceptions import SourceError, TableError
from axiscal.language.spoken import later
from axiscal.tables.vcomp_file import refuse_changed

_SWITCH = later("Set axiscal-vcomp.enable to {to} and wait a second")


@dataclass(frozen=True, slots=True)
class InForce:
    """What is to compensate.

    active : whether anything is; checksum : of the file that axiscal-vcomp is to hold, None where it is to hold none
    """

    active: bool = False
    checksum: int | None = None

    @classmethod
    def from_folder(cls, folder: Path) -> InForce:
        """Return that of the files in a folder, as `axiscal export` wrote them; raises TableError, OSError."""
        names = sorted(path.name for path in folder.iterdir() if path.suffix in (".vcomp", ".comp"))
        if not names:
            what, remedy = "it holds no file for LinuxCNC", "Name the folder that axiscal export has written"
            raise TableError(what, remedy, folder)
        whole = next((folder / name for name in names if name.endswith(".vcomp")), None)
        if whole is None:
            return cls(True)
        text = whole.read_bytes().decode("ascii", "replace")
        refuse_changed(text, str(whole))
        return cls(True, int(text.split()[-1], 16))

    def refuse(self, status: dict[str, Any]) -> None:
        """Raise SourceError where the machine is compensated by anything else.  status : as the agent says it"""
        joints, whole = ", ".join(str(joint) for joint in status["compensated"]), status["whole"]
        held, wanted = status["checksum"], self.checksum is not None
        if not self.active and joints:
            what = "COMP_FILE or BACKLASH of joint {joints} is in force, and the campaign is measured without"
            remedy = "Take it out of the INI file, or name its files in compensation_active"
        elif not self.active and whole:
            what, remedy = "axiscal-vcomp.active is true, and the campaign is measured without a compensation", _SWITCH
        elif wanted and held is None:
            what, remedy = "axiscal-vcomp is not loaded in LinuxCNC", "Put the exported files in, and start it again"
        elif wanted and int(held, 0) != self.checksum:
            what = "axiscal-vcomp holds another file than the one that was exported (axiscal-vcomp.checksum)"
            remedy = "Put the exported files in, and start LinuxCNC again"
        elif wanted and not whole:
            what, remedy = "axiscal-vcomp.active is not true, and the correction is to be in force", _SWITCH
        elif wanted and joints:
            what = "COMP_FILE or BACKLASH of joint {joints} is in force beside axiscal-vcomp"
            remedy = "Take it out of the INI file"
        elif self.active and not (wanted or joints or whole):
            what = "a compensation is to be in force, and neither COMP_FILE nor BACKLASH nor axiscal-vcomp.active is"
            remedy = "Switch it on, or say compensation_active = false"
        else:
            return
        raise SourceError(what, remedy, joints=joints, to=int(wanted))
