"""What a person may choose for an export.

New files beside what a control held while the machine was measured: on top of it, instead of it, or nobody knows.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from axiscal.description.campaign import CampaignDescription
from axiscal.document import shown
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.language.spoken import later, listed, said
from axiscal.machine.description import Machine
from axiscal.tables.effect import added_by
from axiscal.tables.loaded import Loaded, OldFile, read_old
from axiscal.tables.offer import Draft

_KINDS = "a table, backlash, pitch or sag compensation, a bed mesh or skew correction"
_BEGINNING = later(
    "Is a compensation active on the control while it is measured (a table, backlash, pitch or sag compensation, a bed "
    "mesh or skew correction)? Switch it off, or say so: compensation_active = false, = true or its files in "
    "campaign.toml. New tables go on top of what was active; until it is said they are written as if nothing was, and "
    "ask."
)
REPORTS = ("csv",)
"""What is read by people or other programs, not loaded in place of something."""
_QUESTION = (
    f"WAS A COMPENSATION ACTIVE WHILE MEASURING ({_KINDS})? campaign.toml does not say. If one was, these files loaded "
    "in its place bring back all that it took away: export again with --on-top-of OLD, the files that were active. If "
    "none was, write compensation_active = false into campaign.toml, and this question is gone."
)


def informed(options: ExportOptions, description: CampaignDescription, controller: str) -> ExportOptions:
    """Return options that know what the campaign says of a compensation that was active; raises ReadingError.

    Files that campaign.toml names lie beside it; others go before them. What is only read is not put on top of them.
    """
    said = description.compensation_active
    if said is None or isinstance(said, bool):
        return replace(options, active=said)
    if options.old_files or controller in REPORTS:
        return replace(options, active=True)
    return replace(options, active=True, old_files=read_old(said, Path(description.source).parent))


def unasked(description: CampaignDescription) -> str:
    """Return the question for whoever begins, "" where campaign.toml answers it."""
    return "" if description.compensation_active is not None else said(_BEGINNING)


def on_top(estimate: Estimate, draft: Draft, old: Loaded, options: ExportOptions) -> Draft:
    """Return a draft of old and new together, whose effect counts from what was active; raises TableError."""
    if options.active is False:
        what = "campaign.toml says that no compensation was active while measuring (compensation_active = false)"
        raise TableError(what, "leave --on-top-of out, or correct campaign.toml")
    held = old.control((draft.about or estimate).machine)
    names = ", ".join(dict.fromkeys(file.name for file in options.old_files))
    note = (
        f"These files hold what was active while measuring ({names}) and on top of it what was found: load them in its "
        "place, not beside it. The figures above count from the machine as it was measured, with the old compensation."
    )
    control, wanted = (added_by(whole, held) for whole in (draft.control, draft.wanted))
    return replace(draft, control=control, wanted=wanted, notes=(note, *draft.notes))


def asked_about(controller: str, draft: Draft, options: ExportOptions) -> Draft:
    """Return a draft with the question whether something was active, where nobody said.

    Raises TableError where something was and files would take its place.
    """
    if options.active and controller not in REPORTS:
        what = "a compensation was active while measuring (compensation_active), and these files would take its place"
        raise TableError(what, "give the files that were active: axiscal export ... --on-top-of OLD")
    if options.active:
        note = "The deviations are those that were left by the compensation that was active while measuring."
        return replace(draft, notes=(note, *draft.notes))
    return draft if options.active is False else replace(draft, notes=(_QUESTION, *draft.notes))


_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,30}")

_HASH = re.compile(r"[0-9a-f]{0,128}")
_LARGEST_MESH = 50
"""Points a side; more is a slip, for no probe of a printer takes them."""
_USUAL = "XYZABCUVWPQR"


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """Choices; a controller ignores those that it has no use for.

    spacing : distance of the points of linear axes, m, or of some axes by name, m or rad
    unit : of the machine, mm or in
    numbers : of the joints or of the machine axis of each axis, where the order of the letters is not theirs
    template : text of a file that the control saved, template_name : how it is called
    name : of a mesh or profile; mesh : points of a height map along each side, as many as the map that was read or the
    curves have where nobody says
    pivots : put location errors of rotary axes into the kinematics (linuxcnc) instead of the tables
    encoder : measuring system, 1 or 2
    flip : the control takes the values with the other sign, as a check at one point has shown
    old_files : of the compensation that was active while measuring; old : what they say, once they are read
    active : whether one was, None where nobody said; origin : hash of the record, "" where there is none
    Raises TableError for a name that is more than letters, digits, _ and -.
    """

    spacing: float | Mapping[str, float] | None = None
    unit: str = "mm"
    numbers: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    template: str | None = None
    template_name: str = "the template"
    name: str = "axiscal"
    mesh: int | None = None
    flip: bool = False
    pivots: bool = False
    encoder: int = 1
    old_files: tuple[OldFile, ...] = ()
    old: Loaded = field(default_factory=Loaded)
    active: bool | None = None
    origin: str = ""

    def numbered(self, machine: Machine, first: int = 1) -> dict[str, int]:
        """Return the number of each axis in the control: from `first` in the order X Y Z A B C … unless chosen.

        Raises TableError as `joints`, and for an axis that was given several numbers.
        """
        found = self.joints(machine, first)
        for name, numbers in found.items():
            if len(numbers) > 1:
                several = listed(said(" and "), list(map(str, numbers)))
                remedy = "This control takes one for each axis"
                raise TableError("{name} is given the numbers {numbers}", remedy, name=name, numbers=several)
        return {name: numbers[0] for name, numbers in found.items()}

    def joints(self, machine: Machine, first: int = 0) -> dict[str, tuple[int, ...]]:
        """Return the numbers of the joints of each axis, as in `coordinates = XYYZ`.

        An axis without a given number has the place behind those before it, in the order X Y Z A B C and so on.
        Raises TableError for a number that is there twice, and for an axis that the machine does not have.
        """
        for name in self.numbers:
            machine.index(name)
        found, place = dict[str, tuple[int, ...]](), first
        for name in sorted((a.name for a in machine.axes), key=lambda name: (_USUAL.index(name[0]), name)):
            found[name] = self.numbers.get(name, (place,))
            place += len(found[name])
        _refuse_twice(found)
        return found

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            remedy = "Take letters, digits, _ and -, 31 at most"
            raise TableError("{name} is not a name for a table", remedy, name=shown(self.name))
        if not _HASH.fullmatch(self.origin):
            raise TableError("{origin} is not the hash of a record", "Leave it out", origin=shown(self.origin))
        if self.unit not in ("mm", "in"):
            raise TableError("{unit} is not the unit of a machine", "It can be mm or in", unit=shown(self.unit))
        if self.mesh is not None and not 2 <= self.mesh <= _LARGEST_MESH:
            raise TableError("a mesh of {count} points a side", "Take 2 to {most}", count=self.mesh, most=_LARGEST_MESH)
        if self.encoder not in (1, 2):
            raise TableError("measuring system {number}", "An axis has measuring systems 1 and 2", number=self.encoder)
        if any(number < 0 for numbers in self.numbers.values() for number in numbers):
            raise TableError("numbers of axes are negative", "Count from 0 or 1 as the control does")


def _refuse_twice(found: Mapping[str, tuple[int, ...]]) -> None:
    """Raise TableError when two axes have the same number, or one has it twice."""
    owner = dict[int, str]()
    for name, numbers in found.items():
        for number in numbers:
            if number in owner:
                known = ", ".join(f"{axis}={each}" for axis, own in found.items() for each in own)
                what = "{name} is given twice the same number {number} (numbers are {known})"
                if owner[number] != name:
                    what = "{other} and {name} have the same number {number} (numbers are {known})"
                remedy = "Give each axis its own: --number X=0; an axis of two joints --number Y=1 --number Y=2"
                raise TableError(what, remedy, name=name, other=owner[number], number=number, known=known)
            owner[number] = name
