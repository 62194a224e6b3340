"""What goes over the wire while a first description is made: the JSON documents of its form."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from axiscal.web.shapes import Shape

_Word = Annotated[str, Field(max_length=200)]
_Source = Annotated[int, Field(ge=0, description="The machine to begin with: its place in `sources`")]


class SourceShape(Shape):
    """A machine to begin with; file : the INI file of a LinuxCNC, "" for one that is built in."""

    name: str
    file: str


class OfferShape(Shape):
    """An instrument whose set-ups can be offered, and what it shows."""

    name: str
    what: str


class FormShape(Shape):
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


class SourceQuery(Shape):
    """A machine to begin with."""

    source: _Source


class LackingShape(Shape):
    """An axis whose limits the INI file leaves open, and the unit that it counts in."""

    axis: str
    unit: str


class MachineShape(Shape):
    """What a machine to begin with is; chain : "" where limits are lacking; sure : whether its kinematics say it."""

    chain: str
    sure: bool
    lacking: list[LackingShape]


class FirstRequest(Shape):
    """What was chosen; chain : "" for what is supposed; limits : lower and upper one, of axes that are lacking."""

    source: _Source
    chain: _Word = ""
    limits: Annotated[dict[_Word, tuple[_Word, _Word]], Field(max_length=9)] = Field(default_factory=dict)
    instruments: Annotated[list[_Word], Field(max_length=20)]
    target: _Word


class FilesShape(Shape):
    """Files that are written, or would be; look : what to look at in machine.toml; after : the commands to go on."""

    folder: str
    machine: str
    campaign: str
    setups: int
    look: list[str]
    after: list[str]
