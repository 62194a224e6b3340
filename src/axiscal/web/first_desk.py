"""The desk where a first description is made: what there is to choose from, and the files of what was chosen.

First stand the JSON documents of its form: what goes over the wire.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Annotated

from pydantic import Field

from axiscal.answers.answer import AnswerDocument
from axiscal.description.first_campaign import OFFERED
from axiscal.description.first_files import Beginning, FirstFiles, first_files, of_builtin, of_ini, write_files
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import lacking_limits, machine_of
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine import builtin_names, load_machine

_Word = Annotated[str, Field(max_length=200)]
_Source = Annotated[int, Field(ge=0, description="The machine to begin with: its place in `sources`")]


class SourceShape(AnswerDocument):
    """A machine to begin with; file : the INI file of a LinuxCNC, "" for one that is built in."""

    name: str
    file: str


class OfferShape(AnswerDocument):
    """An instrument whose set-ups can be offered, and what it shows."""

    name: str
    what: str


class FormShape(AnswerDocument):
    """What there is to choose from; what somebody has named at the start is chosen already.

    folder : where the files will stand; chosen : the place of a source, -1 for none
    """

    folder: str
    sources: list[SourceShape]
    chosen: int
    chain: str
    instruments: list[OfferShape]
    taken: list[str]
    target: str


class SourceQuery(AnswerDocument):
    """A machine to begin with."""

    source: _Source


class LackingShape(AnswerDocument):
    """An axis whose limits the INI file leaves open, and the unit that it counts in."""

    axis: str
    unit: str


class MachineShape(AnswerDocument):
    """What a machine to begin with is; chain : "" where limits are lacking; sure : whether its kinematics say it."""

    chain: str
    sure: bool
    lacking: list[LackingShape]


class FirstRequest(AnswerDocument):
    """What was chosen; chain : "" for what is supposed; limits : lower and upper one, of axes that are lacking."""

    source: _Source
    chain: _Word = ""
    limits: Annotated[dict[_Word, tuple[_Word, _Word]], Field(max_length=9)] = Field(default_factory=dict)
    instruments: Annotated[list[_Word], Field(max_length=20)]
    target: _Word


class FilesShape(AnswerDocument):
    """Files that are written, or would be; look : what to look at in machine.toml; after : the commands to go on."""

    folder: str
    machine: str
    campaign: str
    setups: int
    look: list[str]
    after: list[str]


_MOST = 50
"""INI files that are offered; a matter of taste."""


@dataclass(frozen=True, slots=True)
class Preselection:
    """What was named when the form was opened; None and empty where nothing was."""

    machine: str | None = None
    ini: Path | None = None
    chain: str = ""
    instruments: tuple[str, ...] = ()
    target: str = ""


class FirstDesk:
    """The form of one folder.

    home : where the INI files of LinuxCNC are looked for
    Raises DescriptionError where what was chosen is not there.
    """

    def __init__(self, folder: Path, chosen: Preselection, home: Path) -> None:
        self._folder, self._chosen = folder, chosen
        found = sorted(home.glob("linuxcnc/configs/*/*.ini"))[:_MOST]
        own = [chosen.ini] if chosen.ini is not None else []
        self._sources: tuple[str | Path, ...] = (*own, *(file for file in found if file not in own), *builtin_names())
        if chosen.machine is not None:
            of_builtin(chosen.machine)  # refused before a page is opened
        self.written = False

    def form(self) -> FormShape:
        """Return what there is to choose from."""
        named = self._chosen.ini or self._chosen.machine
        return FormShape(
            folder=str(self._folder),
            sources=[_shape(source) for source in self._sources],
            chosen=-1 if named is None else self._sources.index(named),
            chain=self._chosen.chain,
            instruments=[OfferShape(name=name, what=what) for name, what in _shown_by()],
            taken=list(self._chosen.instruments),
            target=self._chosen.target,
        )

    def machine(self, source: int) -> MachineShape:
        """Return what a machine to begin with is; raises DescriptionError for a file that says none."""
        found = self._source(source)
        if isinstance(found, str):
            return MachineShape(chain=load_machine(found).chain, sure=True, lacking=[])
        ini = read_ini(found)
        lacking = [LackingShape(axis=axis, unit=unit) for axis, unit in lacking_limits(ini).items()]
        if lacking:
            return MachineShape(chain="", sure=False, lacking=lacking)
        build = machine_of(ini).build
        return MachineShape(chain=build.chain, sure=build.sure, lacking=[])

    def preview(self, request: FirstRequest) -> FilesShape:
        """Return the files of what was chosen, and write nothing; raises InputError where they cannot be."""
        return self._made(request)[1]

    def write(self, request: FirstRequest) -> FilesShape:
        """Write the files of what was chosen; raises InputError where they cannot be, or one of them is there."""
        files, shape = self._made(request)
        write_files(self._folder, files.texts)
        self.written = True
        return shape

    def _made(self, request: FirstRequest) -> tuple[FirstFiles, FilesShape]:
        begun = self._begun(request)
        files = first_files(begun, request.instruments, request.target.strip())
        machine, campaign = (self._folder / name for name in ("machine.toml", "campaign.toml"))
        shape = FilesShape(
            folder=str(self._folder),
            machine=files.texts["machine.toml"],
            campaign=files.texts["campaign.toml"],
            setups=files.setups,
            look=list(begun.look),
            after=[f"axiscal machine check {machine}", f"axiscal plan {campaign}", f"axiscal step start {campaign}"],
        )
        return files, shape

    def _begun(self, request: FirstRequest) -> Beginning:
        found = self._source(request.source)
        if isinstance(found, str):
            return of_builtin(found)
        read = machine_of(read_ini(found), _numbers(request.limits))
        return of_ini(read, found, self._folder, request.chain.strip() or None)

    def _source(self, number: int) -> str | Path:
        if number >= len(self._sources):
            raise DescriptionError(said("This machine is not offered"), said("Load the page again and choose one"))
        return self._sources[number]


def _shape(source: str | Path) -> SourceShape:
    if isinstance(source, str):
        return SourceShape(name=source, file="")
    return SourceShape(name=source.stem, file=str(source))


def _shown_by() -> Iterator[tuple[str, str]]:
    """Yield the instruments that are offered, each with what it shows."""
    what = {
        "interferometer": said("positions along an axis"),
        "ballbar": said("squareness, straightness and reversal of two axes together"),
        "straightedge": said("straightness of an axis"),
        "dial": said("straightness of an axis, along something straight that it touches"),
        "square": said("straightness and squareness of two axes, with a dial on both legs"),
        "sphere": said("where rotary axes lie and lean, by spheres that the machine touches"),
        "probe": said("the height of a printer's bed"),
    }
    yield from ((name, what[name]) for name in OFFERED)


def _numbers(limits: Mapping[str, Sequence[str]]) -> dict[str, tuple[float, float]]:
    found: dict[str, tuple[float, float]] = {}
    for axis, texts in limits.items():
        low, high = (_number(text, axis) for text in texts)
        found[axis] = low, high
    return found


def _number(text: str, axis: str) -> float:
    try:
        value = float(text.replace(",", ".").replace("\u2212", "-"))
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        what = said('"{text}" is no limit of {axis}', text=text.strip(), axis=axis)
        raise DescriptionError(what, said("Type a number in the unit that stands beside it"))
    return value
