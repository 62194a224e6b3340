"""What is to compensate a machine while it is measured: nothing, anything, or files that `axiscal export` wrote."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from axiscal.exceptions import SourceError, TableError
from axiscal.language.spoken import later
from axiscal.tables import vcomp_file

_SWITCH = later("Set axiscal-vcomp.enable to {to} and wait a second")
_AGAIN = later("Put the exported files in, and start LinuxCNC again")


@dataclass(frozen=True, slots=True)
class InForce:
    """What is to compensate.

    active : whether anything is; checksum : of the file that axiscal-vcomp is to hold, None where it is to hold none
    files : SHA-256 of that file, or of the COMP_FILEs that joints are to have, by name; none for any
    """

    active: bool = False
    checksum: int | None = None
    files: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def from_folder(cls, folder: Path) -> InForce:
        """Return that of the files in a folder, as `axiscal export` wrote them; raises TableError, OSError."""
        texts = {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}
        digests = {name: hashlib.sha256(text).hexdigest() for name, text in texts.items()}
        if (whole := next((name for name in texts if name.endswith(".vcomp")), None)) is not None:
            text = texts[whole].decode("ascii", "replace")
            vcomp_file.refuse_changed(text, str(folder / whole))
            return cls(True, int(text.split()[-1], 16), {whole: digests[whole]})
        tables = {name: digests[name] for name in texts if name.endswith(".comp") and not name.startswith("axiscal")}
        if not tables:
            what, remedy = "it holds no file for LinuxCNC", "Name the folder that axiscal export has written"
            raise TableError(what, remedy, folder)
        return cls(True, None, tables)

    def refuse(self, status: dict[str, Any]) -> None:
        """Raise SourceError where the machine is compensated by anything else.  status : as the agent says it"""
        joints, whole = ", ".join(str(joint) for joint in status["compensated"]), status["whole"]
        held = None if status["checksum"] is None else int(status["checksum"], 0)
        lacking = ", ".join(name for name, digest in self.files.items() if digest not in status["tables"])
        what = remedy = ""
        if not self.active and joints:
            what = "COMP_FILE or BACKLASH of joint {joints} is in force, and the campaign is measured without"
            remedy = "Take it out of the INI file, or name its files in compensation_active"
        elif not self.active and whole:
            what, remedy = "axiscal-vcomp.active is true, and the campaign is measured without a compensation", _SWITCH
        elif self.checksum is not None and held is None:
            what, remedy = "axiscal-vcomp is not loaded in LinuxCNC", "Put the exported files in, and start it again"
        elif self.checksum is not None and held != self.checksum:
            what = "axiscal-vcomp holds another file than the one that was exported (axiscal-vcomp.checksum)"
            remedy = _AGAIN
        elif self.checksum is not None and not whole:
            what, remedy = "axiscal-vcomp.active is not true, and the correction is to be in force", _SWITCH
        elif self.checksum is not None and joints:
            what = "COMP_FILE or BACKLASH of joint {joints} is in force beside axiscal-vcomp"
            remedy = "Take it out of the INI file"
        elif self.checksum is None and lacking:
            what, remedy = "no joint has {lacking} as its COMP_FILE, as it was exported", _AGAIN
        elif self.checksum is None and self.files and whole:
            what, remedy = "axiscal-vcomp.active is true beside the tables", _SWITCH
        elif self.active and not (self.files or joints or whole):
            what = "a compensation is to be in force, and neither COMP_FILE nor BACKLASH nor axiscal-vcomp.active is"
            remedy = "Switch it on, or say compensation_active = false"
        if what:
            to = int(self.checksum is not None)
            raise SourceError(what, remedy, joints=joints, lacking=lacking, to=to)
