"""The answer that a campaign gives, as a document of codes and numbers: um, urad, mm, deg, minutes; no sentence.

Terminal, page, PDF and JSON show this document, and look their words up by its codes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from axiscal.description.target import Kind
from axiscal.exceptions import SummaryError
from axiscal.planning.helping import Helping
from axiscal.planning.promise import Alike

_DIGITS = 6
"""Figures kept, so that the same campaign gives the same bytes on any processor."""


_DECIMALS = 9
"""Of a coordinate, mm or deg: what was commanded, as plans and programs have it, and far below a nanometre."""


def coordinate(value: float, what: str) -> float:
    """Return where an axis stood, at nine decimals; raises SummaryError if it is not finite."""
    return round(_refused_unless_finite(value, what), _DECIMALS) + 0.0


def number(value: float, what: str) -> float:
    """Return value at six significant digits; raises SummaryError if it is not finite."""
    return float(f"{_refused_unless_finite(value, what):.{_DIGITS}g}") + 0.0  # + 0.0 turns -0.0 into 0.0


def _refused_unless_finite(value: float, what: str) -> float:
    if not math.isfinite(value):
        raise SummaryError(f"{what} is {value}; the report takes finite figures only.")
    return value


def finite(value: float) -> float | None:
    """Return a value, None for one that is not finite."""
    return value if math.isfinite(value) else None


def rounded(values: Sequence[float], what: str) -> list[float]:
    """Return values at six significant digits; raises SummaryError if one is not finite."""
    return [number(value, what) for value in values]


Verdict = Literal["measured", "unmeasured", "reached", "more", "unreachable", "contradict", "nothing"]
"""Rows are measured, or not all; the target is reached; more readings would; none would; they contradict; none."""
PlanVerdict = Literal["planned", "reached", "short", "unreachable"]
"""Nothing is asked for; it is reached; more readings would; none of these set-ups would."""
StepCode = Literal["load", "verify", "export", "undo", "accept", "measure", "next", "finish", "start", "target"]
"""Load the tables of a control; check them; take the end back; accept a mistake; go on; end it; begin; give an end."""


class AnswerDocument(BaseModel):
    """A document: complete, with no other keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class AnswerLine(AnswerDocument):
    """Where a row holds: the axis that moves, between which ends, and the pose in which the others stand.

    places : number of places read from "+", from "-", and from "both"; setup : by which, "" for none
    """

    setup: str
    axis: str
    ends: tuple[float, float]
    at: Mapping[str, float]
    places: Mapping[Literal["+", "-", "both"], int]

    @property
    def read(self) -> int:
        """Number of places read."""
        return self.places["+"] + self.places["-"] - self.places["both"]


class PlannedRow(AnswerDocument):
    """How well a row is known, in `unit`: fields as of `estimation.known_rows.KnownRow`.

    lines : of the volume none, unless displacements of one axis are all that is described
    known_to, known_before : U now, or after a plan, and without readings, at the sizes as learnt
    """

    row: str
    kind: Kind
    axes: Sequence[str]
    unit: str
    known_to: float
    known_before: float
    floor: float
    limit: float | None
    reached: bool | None
    measured: bool
    lines: Sequence[AnswerLine]


class SignedNumber(AnswerDocument):
    """A number with its sign, in the unit of its row, and U of it alone.

    direction : the axis, both axes of a squareness, x, y or z of a centre, or about which of them, as A, B or C, a tilt
    """

    direction: str
    value: float
    U: float


class AnswerRow(PlannedRow):
    """A row, in `unit`: fields as of `AnsweredRow`.

    signed : its numbers where it is one number or one vector; one_more : U after one reading from the other side
    kelvin : by how much warmer than 20 °C a scale would be, were it no lead error; None where nobody can mistake it
    """

    found: float
    signed: Sequence[SignedNumber]
    largest: float
    left: Mapping[str, float]
    one_more: float | None = None
    kelvin: float | None = None


class Aim(AnswerDocument):
    """An accuracy that a person wants, in `unit`: name is "rms", "worst" or "U" of the volume, or that of a row.

    now : how well it is known; reachable : whether endless readings would reach it
    unread : lines that nobody has read, without which it is not measured
    """

    name: str
    now: float
    limit: float
    floor: float
    measured: bool = True
    reachable: bool = True
    unread: int = 0
    unit: str = "um"

    @property
    def reached(self) -> bool:
        """Whether it is known as well as asked for."""
        return self.measured and self.now <= self.limit

    @property
    def missing(self) -> float:
        """By which share of the readings taken there have to be more."""
        if self.reached:
            return 0.0
        return max((self.now**2 - self.floor**2) / (self.limit**2 - self.floor**2) - 1, 0.0)


class NextStep(AnswerDocument):
    """What to do next.  control : whose tables are loaded; mistake : that is accepted"""

    code: StepCode
    control: str = ""
    mistake: str = ""


class PlannedSetup(AnswerDocument):
    """A set-up as it is mounted: the axes that move, its readings, and the minutes that passed after the last."""

    setup: str
    instrument: str
    moves: Sequence[str]
    readings: int
    minutes: float


class ReachAnswer(AnswerDocument):
    """Accuracies that endless readings would miss, and the change that would help; None if nothing usual would."""

    missed: Sequence[Aim]
    helps: Helping | None


class LargestCause(AnswerDocument):
    """What no reading shows and is most of an uncertainty: its name, whose it is, and its share of the variance.

    measurable : it is the temperature, and nobody has measured that
    """

    cause: str
    owner: str
    share: float
    measurable: bool


class BoughtAccuracy(AnswerDocument):
    """What some minutes buy: U of the volume after them.  mark : which share of a plan's minutes they are"""

    minutes: float
    expanded_um: float
    mark: Literal["half", "asked", "double"] | None


class PlannedAnswer(AnswerDocument):
    """What is known after readings to come.

    rows, aims : after them, with all that a result counts; setups : in the order in which they are mounted
    bought : a curve, what a quarter of the minutes up to twice as many buy
    alike : a set-up whose zero these places cannot tell from a curve; allowed : readings, None for any number
    checks : of the readings, drawn at random
    """

    verdict: PlanVerdict
    rows: Sequence[PlannedRow]
    aims: Sequence[Aim]
    reach: ReachAnswer | None
    mostly: LargestCause | None = None
    alike: Alike | None = None
    setups: Sequence[PlannedSetup]
    steps: Sequence[NextStep]
    readings: int
    checks: int = 0
    allowed: int | None
    minutes: float
    budget_minutes: float | None
    bought: Sequence[BoughtAccuracy] = ()


class TablesChecked(AnswerDocument):
    """A check of the tables on the machine; um.

    places : how many were read; found, left : RMS there, without the tables and with them
    expected : RMS with them that is to be expected, with the noise of the readings
    farthest : largest deviation left, at a place (mm and deg by axis)
    """

    places: int
    found: float
    left: float
    expected: float
    farthest: float
    at: Mapping[str, float]
    verdict: Literal["promised", "worse", "faulty", "undecided"]


class ScrewTurn(AnswerDocument):
    """A screw under the bed.  turns : clockwise from above, U : of them, 95 %"""

    screw: str
    turns: float
    U: float


class ResultAnswer(AnswerDocument):
    """aims : what is asked for, the accuracies of the volume first

    more : readings that would reach it, and more_minutes their machine time; 0 where none are missing
    readings : taken; left_out : of them not used; compared : of the others with each other; agreeing : of these
    minutes : of the clock where clocked, else of the plan
    withheld : readings contradict each other, and no mistake explains it: there are no rows
    checked : None where nobody has checked the tables
    offset : um, 95 %, by which U grows for each 100 mm beside the line that was read; None where the volume is known
    checks : readings drawn at random; as_promised : of these
    half_read : from where to where axes were read, mm or deg, half of the volume or less; left out where none was
    screws : under the bed, all but the first, which stays; left out where nobody states them
    overruled : set-ups that were read although the test at their mounting failed; left out where none was
    asks : a step may be a zero set anew, and nobody has said so; left out where nothing is asked
    """

    verdict: Verdict
    rows: Sequence[AnswerRow]
    aims: Sequence[Aim]
    more: int
    more_minutes: float
    readings: int
    left_out: int
    compared: int
    agreeing: int
    checks: int = 0
    as_promised: int = 0
    minutes: float
    clocked: bool
    withheld: bool
    steps: Sequence[NextStep]
    checked: TablesChecked | None = None
    offset: float | None = None
    half_read: Mapping[str, tuple[float, float]] = Field(default_factory=dict, exclude_if=lambda axes: not axes)
    screws: Sequence[ScrewTurn] = Field(default=(), exclude_if=lambda screws: not screws)
    overruled: Sequence[str] = Field(default=(), exclude_if=lambda names: not names)
    asks: bool = Field(default=False, exclude_if=lambda asks: not asks)
