"""The answer that a campaign gives, as a document of codes and numbers: um, urad, mm, deg, minutes; no sentence.

Terminal, page, PDF and JSON show this document, and look their words up by its codes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from operator import not_
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, SkipValidation, ValidationInfo

from axiscal.description.target import Kind
from axiscal.exceptions import SummaryError
from axiscal.planning.helping import Helping

_DIGITS = 6
"""Figures kept, so that the same campaign gives the same bytes on any processor."""


def _figure(value: float, info: ValidationInfo) -> float:
    """Return value at six significant digits; raises SummaryError if it is not finite."""
    if not math.isfinite(value):
        raise SummaryError(f"{info.field_name} is {value}; the report takes finite figures only.")
    return float(f"{value:.{_DIGITS}g}") + 0.0  # + 0.0 turns -0.0 into 0.0


Figure = Annotated[float, AfterValidator(_figure)]
"""A number as all surfaces have it; SummaryError, with its field, if it is not finite."""
Text = SkipValidation[str]
"""A sentence that can be said again in another language: otherwise nothing but its letters would be kept."""
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
    """An entry of `lines`: where a row holds."""

    setup: str = Field(description="the set-up that reads there, empty for none")
    axis: str = Field(description="the axis that moves")
    ends: tuple[float, float] = Field(description="from where to where, mm or deg")
    at: Mapping[str, float] = Field(description="where the other axes stand, mm or deg")
    places: Mapping[Literal["+", "-", "both"], int] = Field(description="places read from `+`, from `-`, from `both`")

    @property
    def read(self) -> int:
        """Number of places read."""
        return self.places["+"] + self.places["-"] - self.places["both"]


class PlannedRow(AnswerDocument):
    """How well a row is known, in `unit`, now or after a plan, at the sizes as learnt."""

    row: str = Field(description="such as `positioning X`, `volume`")
    kind: Kind = Field(description="`positioning`, `backlash`, `straightness` ... `volume`")
    axes: Sequence[str] = Field(description="the axes that it is about")
    unit: str = Field(description="um, urad or um/m")
    known_to: Figure = Field(description="U: 95 % of what is not known is smaller")
    known_before: Figure = Field(description="U before the first reading")
    floor: Figure = Field(description="U that endless readings would leave")
    limit: Figure | None = Field(description="what `known_to` is to be; null where `wants` gives none")
    reached: bool | None = Field(description="whether it is; null without a limit")
    measured: bool = Field(description="whether `known_to` is at most half of U without readings")
    lines: Sequence[AnswerLine] = Field(description="where it holds; empty of a volume that is more than a line")


class SignedNumber(AnswerDocument):
    """An entry of `signed`, in the unit of its row."""

    direction: str = Field(description="axis, both axes, or along or about which one")
    value: Figure = Field(description="as estimated")
    U: Figure = Field(description="± of it alone, 95 %")


class AnswerRow(PlannedRow):
    """An entry of `rows`, in `unit`."""

    found: Figure = Field(description="RMS of the error over its places, √(estimate² + u²)")
    signed: Sequence[SignedNumber] = Field(description="numbers with [signs](conventions.md#rows-with-a-sign)")
    largest: Figure = Field(description="the same where it is largest")
    left: Mapping[str, Figure] = Field(description="by control, what its tables leave, √(left² + u²)")


class Aim(AnswerDocument):
    """An entry of `aims`, in `unit`."""

    name: str = Field(description="`rms`, `worst` or `U` of the volume, or the row")
    now: Figure = Field(description="how well it is known")
    limit: Figure = Field(description="what that is to be")
    floor: Figure = Field(description="what endless readings would leave")
    measured: bool = Field(True, description="whether readings tell it")
    reachable: bool = Field(True, description="whether endless readings would reach it")
    unread: int = Field(0, description="lines that nobody has read")
    unit: str = Field("um", description="um or urad")

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
    """An entry of `steps`: what to do next."""

    code: StepCode = Field(description="`load verify export undo accept measure next finish`")
    control: str = Field("", description="whose tables are loaded")
    mistake: str = Field("", description="that is accepted")


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


class BoughtAccuracy(AnswerDocument):
    """What some minutes buy: U of the volume after them.  mark : which share of a plan's minutes they are"""

    minutes: float
    expanded_um: float
    mark: Literal["half", "asked", "double"] | None


class PlannedAnswer(AnswerDocument):
    """What is known after readings to come.

    rows, aims : after them, with all that a result counts; setups : in the order in which they are mounted
    bought : a curve, what a quarter of the minutes up to twice as many buy
    allowed : readings, None for any number; checks : of the readings, drawn at random
    """

    verdict: PlanVerdict
    rows: Sequence[PlannedRow]
    aims: Sequence[Aim]
    reach: ReachAnswer | None
    setups: Sequence[PlannedSetup]
    steps: Sequence[NextStep]
    readings: int
    checks: int = 0
    allowed: int | None
    minutes: float
    budget_minutes: float | None
    bought: Sequence[BoughtAccuracy] = ()


class TablesChecked(AnswerDocument):
    """`checked`: a check of the tables on the machine; um."""

    places: int = Field(description="how many were read")
    found: Figure = Field(description="RMS of the deviation without them")
    left: Figure = Field(description="RMS with them")
    expected: Figure = Field(description="RMS to be expected, noise included")
    farthest: Figure = Field(description="largest deviation left")
    at: Mapping[str, float] = Field(description="where")
    verdict: Literal["promised", "worse", "faulty", "undecided"] = Field(description="of the tables")


class ScrewTurn(AnswerDocument):
    """An entry of `screws`: a screw under the bed."""

    screw: str = Field(description="its name")
    turns: Figure = Field(description="clockwise from above")
    U: Figure = Field(description="± of it, 95 %")


class Outcome(AnswerDocument):
    """`answer`: what became of what was asked for."""

    verdict: Verdict = Field(
        description="`measured`, `unmeasured` a wanted row without a limit is not, `reached`, `more` readings would "
        "reach it, `unreachable`, `contradict`, `nothing` was read"
    )
    aims: Sequence[Aim] = Field(description="what is asked for, the volume first")
    more: int = Field(description="readings that would reach it")
    more_minutes: Figure = Field(description="their machine time")
    readings: int = Field(description="taken")
    left_out: int = Field(description="of them not used")
    compared: int = Field(description="with each other")
    agreeing: int = Field(description="of these within three standard deviations of what the others say")
    checks: int = Field(0, description="drawn at random")
    as_promised: int = Field(0, description="of these")
    minutes: Figure = Field(description="of the clock, else of the plan")
    clocked: bool = Field(description="whether they are of the clock")
    withheld: bool = Field(description="readings contradict each other and no mistake explains it")
    steps: Sequence[NextStep] = Field(description="what to do next")
    checked: TablesChecked | None = Field(None, description="null where nobody has checked the tables")
    offset: Figure | None = Field(None, description="um by which U grows each 100 mm beside the one line; else null")
    half_read: Mapping[str, tuple[Figure, Figure]] = Field(
        default_factory=dict, exclude_if=not_, description="ends of axes of which half or less was read; else left out"
    )
    screws: Sequence[ScrewTurn] = Field((), exclude_if=not_, description="left out where none are stated")
    overruled: Sequence[str] = Field(
        (), exclude_if=not_, description="set-ups that were read although their test failed; else left out"
    )
    asks: bool = Field(False, exclude_if=not_, description="a zero may be new; else left out")
    rows: Sequence[AnswerRow] = Field((), exclude=True, description="`rows` of the result")


class AnswerWords(AnswerDocument):
    """An answer, or a plan, as it is laid out: terminal, page and PDF say these words, and no other figures."""

    first: Sequence[Text] = Field(description="first line, in parts")
    rows: Sequence[Sequence[Text]] = Field(description="heading and cells")
    sentences: Sequence[Text] = Field(description="below them")
