"""`result.json`: what a campaign came to, as one document below all screens.

Positions in mm and deg; deviations in um, urad or arcsec (the unit stands beside the value); time in minutes.
Every `std`, `rms` and `worst` is one standard deviation; `U` and the bands that the report draws hold 95 %.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from operator import not_
from typing import Literal, Self

from pydantic import Field

from axiscal.language.spoken import WORDS, said
from axiscal.present.answer import AnswerDocument, AnswerRow, AnswerWords, Figure, Outcome, Text


class HistoryRow(AnswerDocument):
    """A row of `history`; reading 0 is the prior."""

    reading: int = Field(description="its number")
    setup: str | None = Field(None, description="name of the set-up")
    approach: str = Field("", description="sides, such as X+ Y-")
    position: Mapping[str, float] | None = Field(None, description="coordinate by axis, mm or deg")
    value: Figure | None = Field(None, description="what was read, in `unit`")
    others: Sequence[Figure] = Field((), description="further numbers of a reading")
    unit: str | None = Field(None, description="um or urad")
    units: Sequence[str] = Field((), description="of each number")
    innovation: Figure | None = Field(None, description="less what was expected")
    surprise: Figure | None = Field(None, description="in standard deviations")
    rms_um: Figure = Field(description="RMS over the volume after it")
    worst_um: Figure = Field(description="largest standard deviation after it")
    minutes: Figure = Field(description="machine time until then")
    rejected: bool = Field(False, description="it is kept and not relied on")


class RejectedReading(AnswerDocument):
    """An entry of `rejected`."""

    reading: int = Field(description="its number")
    setup: str = Field(description="name of the set-up")
    position: Mapping[str, float] = Field(description="coordinate by axis, mm or deg")
    value: Figure = Field(description="what was read, in `unit`")
    unit: str = Field(description="um or urad")
    reason: Text = Field(description="why it is not believed, in words")


class ReadPoints(AnswerDocument):
    """Readings of an error."""

    position: Sequence[Figure] = Field(description="of each")
    value: Sequence[Figure] = Field(description="of each")


class CurveFigures(AnswerDocument):
    """An entry of `errors`; all lists have the length of `position`."""

    axis: str = Field(description="the axis along which it changes")
    words: Text = Field(description="what it is")
    position: Sequence[Figure] = Field(description="coordinates, in `position_unit`")
    mean: Sequence[Figure] = Field(description="the estimate, in `value_unit`")
    std: Sequence[Figure] = Field(description="standard deviation, the rest that no spline follows included")
    position_unit: str = Field(description="mm or deg")
    value_unit: str = Field(description="um, urad or arcsec")
    std_seen: Sequence[Figure] = Field(description="the same without what no allowed reading can see")
    prior_std: Sequence[Figure] = Field(description="before any reading, as stated")
    from_readings: Figure = Field(description="share of the variance that readings took away")
    read: ReadPoints = Field(description="readings, less the rest of the model")


PlaneFigures = Sequence[Sequence[Figure]]
"""A row for each position of the first axis."""


class PlaneMap(AnswerDocument):
    """An entry of `plane_errors`; every map has a row for each position of the first axis."""

    axes: Sequence[str] = Field(description="the two axes that act together")
    words: Text = Field(description="what it is")
    position: Sequence[Sequence[Figure]] = Field(description="coordinates of both, in `position_unit`")
    mean: PlaneFigures = Field(description="beside their own curves, in `value_unit`")
    std: PlaneFigures = Field(description="its whole standard deviation, the rest of the plane included")
    position_unit: Sequence[str] = Field(description="mm or deg, of each axis")
    value_unit: str = Field(description="um or urad")
    whole_mean: PlaneFigures = Field(description="with the curves of both axes, its mean taken off")
    whole_std: PlaneFigures = Field(description="its whole standard deviation")
    sign: int = Field(description="as the tool shows it")


class ConstantFigures(AnswerDocument):
    """An entry of `constants`."""

    words: Text = Field(description="what it is")
    mean: Figure = Field(description="the estimate, in `unit`")
    std: Figure = Field(description="its standard deviation")
    unit: str = Field(description="um or urad")
    prior_std: Figure = Field(description="before any reading, as stated")
    seen: bool = Field(True, description="whether an allowed reading bears on it")


class VolumeFigures(AnswerDocument):
    """`volume`: its error at places spread over it, one shift taken off."""

    axes: Sequence[str] = Field(description="that move from place to place")
    counts: Sequence[int] = Field(description="places along each of them, the last of which moves first")
    parked: Text = Field(description="where the others stand")
    tcp_mm: Sequence[Sequence[Figure]] = Field(description="places of the tool point, workpiece frame")
    found_um: Sequence[Sequence[Figure]] = Field(description="deviation along x, y, z, mean of both sides")
    half_um: Sequence[Sequence[Figure]] = Field(description="± of it, 95 %")
    left_um: Sequence[Sequence[Figure]] = Field(
        description="with the tables of `controller`, as estimated; empty without tables"
    )
    controller: str = Field(description="the control whose tables these are")


class SetupUse(AnswerDocument):
    """A set-up."""

    name: str = Field(description="its name")
    instrument: Text = Field(description="its kind")
    along: Text = Field(description="what it reads along or about")
    moves: Sequence[str] = Field(description="axes")
    noise: Text = Field(description="of a reading")
    readings: int = Field(description="count")
    serial: str = Field("", exclude_if=not_, description="if stated")
    certificate: str = Field("", exclude_if=not_, description="if stated")


class NamedMistake(AnswerDocument):
    """An entry of `explained`, the likeliest first."""

    mistake: str = Field(description="such as jump, sign, unit")
    odds: Figure = Field(description="beside no mistake")
    setups: Sequence[str] = Field(description="whose readings")
    text: Text = Field(description="in words, with what to do about it")


class AgreementFigures(AnswerDocument):
    """`agreement`: each reading is left out and expected from the others."""

    count: int = Field(description="readings that were compared")
    agreeing: int = Field(description="of them within three standard deviations of what the others say")
    c2: Figure = Field(description="mean square of that, in standard deviations")
    p: Figure = Field(description="probability of readings that agree no better")
    contradict: bool = Field(description="whether `p` is below 0.001")
    explained: Sequence[NamedMistake] = Field((), description="mistakes that are named")
    text: Text = Field(description="in a sentence; empty before the first reading")


class OneCheck(AnswerDocument):
    """An entry of `each` of `checks`."""

    reading: int = Field(description="its number")
    z: Figure = Field(description="standard deviations from what the others promise")
    used: bool = Field(description="whether the estimate takes it")


class ChecksFigures(AnswerDocument):
    """`checks`: readings drawn at random, beside what all others promise."""

    count: int = Field(0, description="taken")
    as_promised: int = Field(0, description="of these, used and within three standard deviations")
    s: Figure | None = Field(None, description="RMS of `z` without slips; above 1 it multiplies every uncertainty")
    each: Sequence[OneCheck] = Field((), description="one by one")


class BudgetSource(AnswerDocument):
    """An entry of `budget`, the largest first."""

    source: Text = Field(description="in words")
    kind: Literal["A", "B"] = Field(description="A or B (GUM 4.2, 4.3)")
    distribution: Text = Field(description="of type B")
    rms_um: Figure = Field(description="squares add up to that of `rms_um`")
    share: Figure = Field(description="of that square, 0 to 1; sources below 0.0005 are left out")


class Iso230Figures(AnswerDocument):
    """A test after ISO 230-2."""

    axis: str = Field(description="name")
    unit: str = Field(description="of the figures")
    figures: Mapping[str, Figure] = Field(description="by name")
    U: Mapping[str, Figure] = Field(description="k = 2, where known")
    left_out: Sequence[int] = Field((), description="readings without their runs")


class Finding(AnswerDocument):
    """An entry of `warnings`."""

    code: str = Field(description="such as drift, outlier, unobservable")
    error: str | None = Field(None, description="the error it is about")
    text: Text = Field(description="in words")

    @classmethod
    def of(cls, words: str, *, code: str = "", error: str | None = None, **values: object) -> Self:
        """Return a warning.  words : its key in the table of warnings; code : where it is that of several sentences"""
        return cls(code=code or words, error=error, text=said(WORDS["warnings"][words], **values))


class TableFile(AnswerDocument):
    """An entry of `tables`; effects are of all files of the control together."""

    controller: str = Field(description="name of the control")
    file: str | None = Field(None, description="in the folder; null where none was written")
    axis: str = Field("", description="what it moves")
    before_um: Figure | None = Field(None, description="RMS of the estimate, its mean taken off")
    after_um: Figure | None = Field(None, description="what the files leave of it")
    expected_um: Figure | None = Field(None, description="standard uncertainty with them")
    U_um: Figure | None = Field(None, description="U with the files loaded")
    left_out: Text = Field(description="what they leave, or why there are none, in words")


class RecordState(AnswerDocument):
    """`record`: what all figures come from."""

    file: str = Field(description="of the record")
    event: int = Field(description="its last one")
    hash: str = Field(description="of what it holds")


class ResultWords(AnswerWords):
    """`words`: the answer as all surfaces say it."""

    names: Mapping[str, Text] = Field(description="of rows")


class Result(AnswerDocument):
    """The document."""

    kind: Literal["axiscal-result/1"] = Field(
        "axiscal-result/1", alias="schema", description="name and version of the document"
    )
    identity: Mapping[str, str | Mapping[str, Mapping[str, str]]] = Field(
        description="`[report]` as stated, `maker`, `serial`, `chain`, `campaign_file`, `begun`, `ended`, `artefacts`"
    )
    words: ResultWords = Field(description="the answer as all surfaces say it")
    machine: str = Field(description="name of the machine")
    readings: int = Field(description="how many were taken")
    minutes: Figure = Field(description="machine time")
    stopped_because: Text = Field(description="why the campaign ended, in words")
    setups: Sequence[SetupUse] = Field(description="set-ups")
    agreement: AgreementFigures = Field(description="whether the readings agree with each other")
    checks: ChecksFigures = Field(description="readings drawn at random")
    U_um: Figure | None = Field(
        description="expanded uncertainty in space over the volume, 95 %; null down to `worst_um` where withheld"
    )
    U_axis_um: Mapping[str, Figure] | None = Field(description="the same along x, y, z")
    U_worst_um: Figure | None = Field(description="the same at the worst place")
    k: Figure | None = Field(description="coverage factor, `U_um` over `rms_um`")
    U_holds_for: Text | None = Field(description="what they hold for, in words")
    U_along: str | None = Field(description="directions that count")
    rms_um: Figure | None = Field(description="standard uncertainty of the tool point, RMS over the volume (k = 1)")
    worst_um: Figure | None = Field(description="largest standard deviation in the volume")
    unseen_rms_um: Figure = Field(description="what no allowed reading can take away")
    budget: Sequence[BudgetSource] = Field(description="where the uncertainty comes from")
    budget_smaller_um: Figure = Field(description="of sources without a line")
    nonlinearity: Figure | None = Field(description="largest non-linearity of a reading; above 0.3 no Gaussian")
    history: Sequence[HistoryRow] = Field(description="how well the machine was known after each reading")
    errors: Mapping[str, CurveFigures] = Field(description="by ISO 230-1 name, reversals among them")
    plane_errors: Mapping[str, PlaneMap] = Field(description="errors of two axes together by name, such as EZXY")
    volume: VolumeFigures | None = Field(description="the error of the volume; null before the first reading")
    constants: Mapping[str, ConstantFigures] = Field(description="location errors and constant reversals")
    iso230: Sequence[Iso230Figures] = Field(description="tests after ISO 230-2")
    observability: Sequence[Text] = Field(description="what cannot be seen")
    questions: Sequence[Text] = Field(description="what nobody has said")
    rejected: Sequence[RejectedReading] = Field(description="readings not believed, and why")
    warnings: Sequence[Finding] = Field(description="what is to be minded")
    answer: Outcome = Field(description="what became of what was asked for")
    rows: Sequence[AnswerRow] = Field(description="the answer, row by row; empty where no uncertainty is printed")
    tables: Sequence[TableFile] = Field(description="files that were written for controls, and what they leave")
    versions: Mapping[str, str] = Field(description="of axiscal and of what it computes with")
    record: RecordState = Field(description="what all of it is made from")
