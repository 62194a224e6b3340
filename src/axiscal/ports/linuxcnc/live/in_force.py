"""What is to compensate a machine while it is measured: nothing, anything, or the file that `axiscal export` wrote."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from axiscal.exceptions import SourceError, TableError
from axiscal.language.spoken import joined, later, said
from axiscal.tables.vcomp_file import refuse_changed

_REMEDY = later(
    "Set axiscal-vcomp.enable and wait a second; put the exported files in, or take COMP_FILE and BACKLASH out of the "
    "INI file, and start LinuxCNC again; or say in campaign.toml what is in force: compensation_active"
)


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
        found = [f"COMP_FILE or BACKLASH of joint {joint}" for joint in status["compensated"]]
        found += ["axiscal-vcomp"] * bool(status["whole"])
        other = self.checksum is not None and int(status["checksum"] or "0", 0) != self.checksum
        if other or (found != ["axiscal-vcomp"] if self.checksum is not None else bool(found) is not self.active):
            wanted = said("a compensation") if self.active else said("nothing")
            wanted = wanted if self.checksum is None else f"axiscal-vcomp, {self.checksum:#010x}"
            held, checksum = joined(found) or said("nothing"), status["checksum"] or "-"
            what = "in force is {found} (axiscal-vcomp.checksum: {checksum}), and it is to be {wanted}"
            raise SourceError(what, _REMEDY, found=held, checksum=checksum, wanted=wanted)
