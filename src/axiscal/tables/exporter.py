"""What a control is for tables: its limits as data, what writes its files, and what reads them.

Whoever writes for a control writes a class with these. Sampling the estimate, adding what was active, reading back and
comparing are the same for all, here and in `offer`. One reader serves twice: for the files just written and for those
that were active while the machine was measured.

`ExportOptions` are what a person may choose, also beside what a control held while the machine was measured: new files
go on top of it, instead of it, or nobody knows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.document import shown
from axiscal.document.ports import of_class, rendered
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.language.spoken import joined, later, said
from axiscal.numerics import Array
from axiscal.tables.loaded import Loaded, OldFile, read_old, refuse_long_numbers
from axiscal.tables.sampling import MOST_POINTS, Multiples, axis_tables, cross_tables
from axiscal.tables.surface import Control, remainder
from axiscal.tables.table import CompensationTable
from axiscal_core.machine import Machine

REPORTS = ("csv",)
"""What is read by people or other programs, not loaded in place of something."""
OFF = later("measure again with the compensation of the control switched off")
"""In place of old files, for controls whose files are not added to."""
_BEGINNING = later(
    "Is a compensation active on the control while it is measured (a table, backlash, pitch or sag compensation, a bed "
    "mesh or skew correction)? Switch it off, or say so: compensation_active = false, = true or its files in "
    "campaign.toml. Tables of linuxcnc and sinumerik go on top of what was active; until it is said all are written as "
    "if nothing was, and ask."
)
_QUESTION = (
    "WAS A COMPENSATION ACTIVE WHILE MEASURING (a table, backlash, pitch or sag compensation, a bed mesh or skew "
    "correction)? campaign.toml does not say. If one was, these files loaded in its place bring back all that it took "
    "away: {way}. If none was, write compensation_active = false into campaign.toml, and this question is gone."
)
_ON_TOP = later("give the files that were active: axiscal export ... --on-top-of OLD")
_LARGEST_MESH = 50
"""Points a side; more is a slip, for no probe of a printer takes them."""
_USUAL = "XYZABCUVWPQR"
_OPTIONS = {name: f"--{name}" for name in ("spacing", "unit", "template", "mesh", "zero")}
_OPTIONS |= {"numbers": "--number", "encoder": "--measuring-system", "old_files": "--on-top-of"}
"""Field of the choices -> option of the command line, as `Exporter.takes` names it."""


def informed(options: ExportOptions, description: CampaignDescription, controller: str) -> ExportOptions:
    """Return options that know what the campaign says of the control's sign, and of a compensation that was active.

    Files that campaign.toml names lie beside it; others go before them. What is only read is not put on top of them.
    Where the printer has its zero the campaign says, unless the options do.
    Raises ReadingError.
    """
    if (bump := description.bump_of(controller)) is not None:
        options = replace(options, flip=bump.moved > 0, sign_day=bump.day)
    options, active = replace(options, zero=options.zero or description.zero_at), description.compensation_active
    if active is None or isinstance(active, bool):
        return replace(options, active=active)
    if not options.old_files and controller not in REPORTS:
        options = replace(options, old_files=read_old(active, Path(description.source).parent))
    return replace(options, active=True)


def sign_said(options: ExportOptions, text: str) -> tuple[str]:
    """Return the sentence of README.txt on the sign: when a bump showed it, or that no text of the maker states it.

    text : what the nearest one states
    """
    if options.sign_day:
        way = "the other way round" if options.flip else "as supposed"
        return (f"SIGN MEASURED ON {options.sign_day}: the control takes its values {way}, and so they are written.",)
    return (
        f"WHICH WAY DOES THE CONTROL TAKE THESE VALUES? No text of its maker that we know says so: {text}. Before "
        "these files load those of axiscal export --probe-sign, take their two readings, and give them to axiscal "
        "verify --bump. Then export again: the files follow the sign that you have measured.",
    )


def paragraphs(package: str, template: str, **values: object) -> tuple[str, ...]:
    """Return what README.txt is to say, by a template of a package: its paragraphs, each a line."""
    text = rendered(package, template, **values)
    return tuple(" ".join(each.split()) for each in text.split("\n\n") if each.strip())


def unasked(description: CampaignDescription) -> str:
    """Return the question for whoever begins, "" where campaign.toml answers it."""
    return "" if description.compensation_active is not None else said(_BEGINNING)


def on_top(estimate: Estimate, draft: Written, old: Loaded, options: ExportOptions) -> Written:
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
    control, wanted = (remainder(whole, held) for whole in (draft.control, draft.wanted))
    return replace(draft, control=control, wanted=wanted, notes=(note, *draft.notes))


def asked_about(controller: str, control: Exporter, draft: Written, options: ExportOptions) -> Written:
    """Return a draft with the question whether something was active, where nobody said.

    Raises TableError where something was and files would take its place.
    """
    adds = "--on-top-of" in control.takes
    if options.active and controller not in REPORTS:
        what = "a compensation was active while measuring (compensation_active), and these files would take its place"
        raise TableError(what, _ON_TOP if adds else OFF)
    if options.active is False:
        return draft
    again = "export again with --on-top-of OLD, the files that were active"
    note = "The deviations are those that were left by the compensation that was active while measuring."
    note = note if options.active else _QUESTION.format(way=again if adds else OFF)
    return replace(draft, notes=(note, *draft.notes))


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """Choices; a controller refuses those that it does not take.

    spacing : distance of the points of linear axes, m, or of some axes by name, m or rad
    unit : of the control, mm or in; "" for that of the travels in machine.toml
    numbers : of the joints or of the machine axis of each axis, where the order of the letters is not theirs
    template : text of a file that the control saved, template_name : how it is called
    mesh : points of a height map along each side, as many as the map that was read or the
    curves have where nobody says; zero : X and Y at which it adds nothing, m, None for the middle
    encoder : measuring system, 1 or 2
    flip : the control takes the values with the other sign, which a bump has shown on sign_day; "" if none has
    old_files : of the compensation that was active while measuring; old : what they say, once they are read
    active : whether one was, None where nobody said; origin : hash of the record, "" where there is none
    Raises TableError for what no control could mean.
    """

    spacing: float | Mapping[str, float] | None = None
    unit: str = ""
    numbers: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    template: str | None = None
    template_name: str = "the template"
    mesh: int | None = None
    zero: tuple[float, float] | None = None
    flip: bool = False
    sign_day: str = ""
    encoder: int = 1
    old_files: tuple[OldFile, ...] = ()
    old: Loaded = field(default_factory=Loaded)
    active: bool | None = None
    origin: str = ""

    def __post_init__(self) -> None:
        if self.unit not in ("", "mm", "in"):
            raise TableError("{unit} is not the unit of a machine", "It can be mm or in", unit=shown(self.unit))
        if self.mesh is not None and not 2 <= self.mesh <= _LARGEST_MESH:
            raise TableError("a mesh of {count} points a side", "Take 2 to {most}", count=self.mesh, most=_LARGEST_MESH)
        if self.encoder not in (1, 2):
            raise TableError("measuring system {number}", "An axis has measuring systems 1 and 2", number=self.encoder)

    @property
    def sign(self) -> int:
        """-1 where the control takes the values with the other sign."""
        return -1 if self.flip else 1

    def unit_of(self, machine: Machine) -> str:
        """Return the unit in which the control counts lengths."""
        return self.unit or machine.unit

    def saved(self, controller: str) -> str:
        """Return the text of the file that the control saved; raises TableError where there is none."""
        if self.template is None:
            what = "{controller} files are made from one of your control"
            raise TableError(what, "give it: --template FILE", controller=controller)
        refuse_long_numbers(self.template, self.template_name)
        return self.template

    @property
    def given(self) -> list[str]:
        """The options of the command line that are other than usual."""
        usual = ExportOptions()
        return [option for name, option in _OPTIONS.items() if getattr(self, name) != getattr(usual, name)]

    def numbered(self, machine: Machine) -> dict[str, int]:
        """Return the number of each axis in the control: from 1 in the order X Y Z A B C … unless chosen.

        Raises TableError as `joints`, and for an axis that was given several numbers.
        """
        found = self.joints(machine, 1)
        if several := next((name for name, numbers in found.items() if len(numbers) > 1), ""):
            what, remedy = "{name} is given the numbers {numbers}", "This control takes one for each axis"
            raise TableError(what, remedy, name=several, numbers=joined(list(map(str, found[several]))))
        return {name: numbers[0] for name, numbers in found.items()}

    def joints(self, machine: Machine, first: int = 0) -> dict[str, tuple[int, ...]]:
        """Return the numbers of the joints of each axis, as in `coordinates = XYYZ`.

        An axis without a given number has the place behind those before it, in the order X Y Z A B C and so on.
        Raises TableError for a number that is there twice or below `first`, and for an axis that is not there.
        """
        found, place, owner = dict[str, tuple[int, ...]](), first, dict[int, str]()
        for name, numbers in self.numbers.items():
            machine.index(name)
            if min(numbers) < first:
                what, remedy = "{name} is given the number {number}", "This control counts its axes from {first}"
                raise TableError(what, remedy, name=name, number=min(numbers), first=first)
        for name in sorted((a.name for a in machine.axes), key=lambda name: (_USUAL.index(name[0]), name)):
            found[name] = self.numbers.get(name, (place,))
            place += len(found[name])
        known = ", ".join(f"{name}={number}" for name, numbers in found.items() for number in numbers)
        for name, number in ((name, number) for name, numbers in found.items() for number in numbers):
            if (other := owner.setdefault(number, name)) != name or found[name].count(number) > 1:
                what = "{other} and {name} have the same number {number} (numbers are {known})"
                remedy = "Give each axis its own: --number X=3; an axis of two joints --number Y=1 --number Y=2"
                raise TableError(what, remedy, name=name, other=other, number=number, known=known)
        return found


def _nothing_added(poses: Array, approaches: Array) -> Array:
    return np.zeros_like(poses)


@dataclass(frozen=True, eq=False, slots=True)
class Written:
    """Files with what to know of them.

    files : text by name; steps : what rounding may leave of each axis, m or rad; notes : how to load the files
    holds, left_out : instead of those of the control, where the files decide
    first : what whoever loads them reads before anything else
    control : what the control does with them, as they are read back; wanted : what they are meant to do
    tables : what the files hold, for the figures; tried : whether a real control of this kind has been seen to take
    them; about : the estimate they were made of, where it is not the one that was given
    """

    files: Mapping[str, str]
    steps: Mapping[str, float]
    notes: tuple[str, ...]
    holds: str = ""
    left_out: str = ""
    first: tuple[str, ...] = ()
    control: Control = _nothing_added
    wanted: Control = _nothing_added
    tables: tuple[CompensationTable, ...] = ()
    tried: bool = False
    about: Estimate | None = None


class Exporter(ABC):
    """A control that files are written for.

    holds, left_out : what its files hold, and what not, each a sentence for README.txt
    tried : whether a real control of this kind has been seen to take them
    takes : options of the command line that it has a use for
    unstated : tables whose sign no source states, "own" of an axis itself, "across" of one axis over another
    """

    holds: ClassVar[str]
    left_out: ClassVar[str]
    tried: ClassVar[bool] = False
    takes: ClassVar[frozenset[str]] = frozenset()
    unstated: ClassVar[str] = ""

    @abstractmethod
    def make(self, estimate: Estimate, options: ExportOptions) -> Written:
        """Return the files before they are tried; raises TableError."""

    @abstractmethod
    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the control makes of files; raises TableError, ReadingError."""

    def draft(
        self,
        written: Written,
        wanted: Control,
        machine: Machine,
        options: ExportOptions,
        tables: tuple[CompensationTable, ...] = (),
    ) -> Written:
        """Return files that were just written, read back, beside what they are meant to do."""
        name = type(self).__name__
        of_class(f"the result of {name}.write", written, Written)
        for what in ("holds", "left_out"):
            own = getattr(written, what) or getattr(self, what, None)
            written = replace(written, **{what: of_class(f"{name}.{what}", own, str)})
        loaded = self.load([OldFile(*file) for file in written.files.items()], machine, options)
        held = of_class(f"the result of {name}.load", loaded, Loaded).control(machine)
        return replace(written, control=held, wanted=wanted, tables=tables, tried=self.tried)


class TableFormat(Exporter):
    """A control whose files are tables of positions with what each axis is off by there.

    points : that a table holds; grid : of its positions, m and rad, by the decimals that are written
    across : it moves an axis over another one; both_ways : that has a direction
    """

    points: ClassVar[int] = MOST_POINTS
    grid: ClassVar[Multiples] = (None, None)
    across: ClassVar[bool] = True
    both_ways: ClassVar[bool] = False
    takes = frozenset({"--spacing"})

    @abstractmethod
    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files for tables; raises TableError for what they cannot hold."""

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return what the files are to hold; raises TableError."""
        own = axis_tables(estimate, options.spacing, self.points, self.grid)
        over = cross_tables(estimate, options.spacing, self.points, self.grid[0]) if self.across else ()
        return (*own, *(over if self.both_ways else (table.averaged() for table in over)))

    def make(self, estimate: Estimate, options: ExportOptions) -> Written:
        """Return the files with their tables; raises TableError."""
        machine, tables = estimate.machine, self.tables(estimate, options)
        written = self.write(tables, machine, options)
        return self.draft(written, Loaded(tables).control(machine), machine, options, tables)
