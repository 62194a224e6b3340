"""What is to compensate a machine while it is measured: nothing, anything, or files that `axiscal export` wrote."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from axiscal.exceptions import SourceError, TableError
from axiscal.tables import vcomp_file

_SWITCH_OFF = "Set axiscal-vcomp.enable to 0 and wait a second"
_SWITCH_ON = "Set axiscal-vcomp.enable to 1 and wait a second"


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
        for name, text in texts.items():
            if name.endswith(".vcomp"):
                whole = text.decode("ascii", "replace")
                vcomp_file.read(whole, str(folder / name))
                return cls(True, int(whole.split()[-1], 16), {name: digests[name]})
        tables = {name: digests[name] for name in texts if name.endswith(".comp") and not name.startswith("axiscal")}
        if not tables:
            what, remedy = "it holds no file for LinuxCNC", "Name the folder that axiscal export has written"
            raise TableError(what, remedy, folder)
        return cls(True, None, tables)

    def refuse(self, status: dict[str, Any]) -> None:
        """Raise SourceError where the machine is compensated by anything else.  status : as the agent says it"""
        joints = ", ".join(str(joint) for joint in status["compensated"])
        if not self.active:
            _refuse_any(joints, status)
        elif self.checksum is not None:
            self._refuse_other_file(joints, status)
        elif self.files:
            self._refuse_other_tables(status)
        elif not joints and not status["whole"]:
            what = "a compensation is to be in force, and neither COMP_FILE nor BACKLASH nor axiscal-vcomp.active is"
            raise SourceError(what, "Switch it on, or say compensation_active = false")

    def _refuse_other_file(self, joints: str, status: dict[str, Any]) -> None:
        if status["checksum"] is None:
            remedy = "Put the exported files in, and start it again"
            raise SourceError("axiscal-vcomp is not loaded in LinuxCNC", remedy)
        if int(status["checksum"], 0) != self.checksum:
            what = "axiscal-vcomp holds another file than the one that was exported (axiscal-vcomp.checksum)"
            raise SourceError(what, "Put the exported files in, and start LinuxCNC again")
        if not status["whole"]:
            raise SourceError("axiscal-vcomp.active is not true, and the correction is to be in force", _SWITCH_ON)
        if joints:
            what = "COMP_FILE or BACKLASH of joint {joints} is in force beside axiscal-vcomp"
            raise SourceError(what, "Take it out of the INI file", joints=joints)

    def _refuse_other_tables(self, status: dict[str, Any]) -> None:
        lacking = [name for name, digest in self.files.items() if digest not in status["tables"]]
        if lacking:
            what = "no joint has {lacking} as its COMP_FILE, as it was exported"
            raise SourceError(what, "Put the exported files in, and start LinuxCNC again", lacking=", ".join(lacking))
        if status["whole"]:
            raise SourceError("axiscal-vcomp.active is true beside the tables", _SWITCH_OFF)


def _refuse_any(joints: str, status: dict[str, Any]) -> None:
    if joints:
        what = "COMP_FILE or BACKLASH of joint {joints} is in force, and the campaign is measured without"
        raise SourceError(what, "Take it out of the INI file, or name its files in compensation_active", joints=joints)
    if status["whole"]:
        what = "axiscal-vcomp.active is true, and the campaign is measured without a compensation"
        raise SourceError(what, _SWITCH_OFF)
