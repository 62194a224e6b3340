"""docs/result.md and docs/result.schema.json: every field of `result.json`.  `python -m tests.docs.result` writes both.

The models are the one description: the tests read documents with them, and a field that is not here is refused.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE, SCHEMA = DOCS / "result.md", DOCS / "result.schema.json"
_HEAD = """\
# `result.json`

The document `axiscal-result/1`, which `--out DIR` receives and `--json` prints; its JSON schema is
[result.schema.json](result.schema.json). `make docs` makes both from the models by which the tests read it. Every
`std` is one standard deviation. Fields may be added; those here keep their meaning.
"""


class Fields(BaseModel):
    """A table in which every field is known."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class Milestone(Fields):
    """A row of `history`; reading 0 is the prior."""

    reading: int = Field(description="number of the reading, 0 for the prior")
    setup: str | None = Field(description="name of the set-up")
    position: dict[str, float] | None = Field(description="coordinate by axis, mm or deg")
    value: float | None = Field(description="what was read, in `unit`")
    others: list[float] = Field(description="further numbers of a reading that has several, as of a sphere")
    unit: str | None = Field(description="um or urad")
    rms_um: float = Field(description="RMS standard deviation of the tool point over the volume after it")
    worst_um: float = Field(description="largest standard deviation in the volume after it")
    minutes: float = Field(description="machine time until then")
    rejected: bool = Field(description="it is kept and not relied on")


class ErrorCurve(Fields):
    """An entry of `errors`; all lists have the length of `position`."""

    axis: str = Field(description="the axis along which it changes")
    position: list[float] = Field(description="coordinates, in `position_unit`")
    mean: list[float] = Field(description="the estimate, in `value_unit`")
    std: list[float] = Field(description="whole standard deviation, the rest that no spline follows included")
    position_unit: str = Field(description="mm or deg")
    value_unit: str = Field(description="um, urad or arcsec")
    std_seen: list[float] = Field(description="the same without what no allowed reading can see")
    prior_std: list[float] = Field(description="before any reading, as stated")
    from_readings: float = Field(
        description="share of the variance at the sizes as learnt that readings took away, 0 to 1"
    )


class PlaneMap(Fields):
    """An entry of `plane_errors`; every map has a row for each position of the first axis."""

    axes: list[str] = Field(description="the two axes that act together")
    position: list[list[float]] = Field(description="coordinates of both, in `position_unit`")
    mean: list[list[float]] = Field(description="the estimate of what they do beside their own curves, in `value_unit`")
    std: list[list[float]] = Field(description="its whole standard deviation, the rest of the plane included")
    position_unit: list[str] = Field(description="mm or deg, of each axis")
    value_unit: str = Field(description="um or urad")
    prior_std: list[list[float]] = Field(description="before any reading, as stated")
    whole_mean: list[list[float]] = Field(
        description="with the curves of both axes as the tool shows them, its mean taken off"
    )
    whole_std: list[list[float]] = Field(description="its whole standard deviation")
    from_readings: float = Field(
        description="share of the variance at the sizes as learnt that readings took away, 0 to 1"
    )


class ConstantValue(Fields):
    """An entry of `constants`: a location error, a constant reversal, an unknown of a set-up."""

    mean: float = Field(description="the estimate, in `unit`")
    std: float = Field(description="its standard deviation")
    unit: str = Field(description="um or urad")
    prior_std: float = Field(description="before any reading, as stated")
    seen: bool = Field(description="whether an allowed reading bears on it")


class RejectedReading(Fields):
    """An entry of `rejected`."""

    reading: int = Field(description="its number")
    setup: str = Field(description="name of the set-up")
    position: dict[str, float] = Field(description="coordinate by axis, mm or deg")
    value: float = Field(description="what was read, in `unit`")
    unit: str = Field(description="um or urad")
    reason: str = Field(description="why it is not believed, in words")


class Warning(Fields):
    """An entry of `warnings`."""

    code: str = Field(description="accepted, prior-misfit, drift, outlier, unobservable, …")
    error: str | None = Field(description="the error it is about")
    text: str = Field(description="in words")


class MistakeValue(Fields):
    """An entry of `explained`: a mistake that explains readings that contradict each other, the likeliest first."""

    mistake: str = Field(description="jump, sign, unit, swapped or shifted")
    odds: float = Field(description="beside no mistake")
    setups: list[str] = Field(description="whose readings")
    text: str = Field(description="in words, with what to do about it")


class AgreementValue(Fields):
    """`agreement`: each reading is left out and expected from the others."""

    count: int = Field(description="readings that were compared")
    agreeing: int = Field(description="of them within three standard deviations of what the others say")
    c2: float = Field(description="mean square of what readings are off, in standard deviations")
    p: float = Field(description="probability of readings that agree no better")
    contradict: bool = Field(description="whether `p` is below 0.001")
    explained: list[MistakeValue] = Field(description="mistakes that are named")
    text: str = Field(description="in a sentence; empty before the first reading")


class BudgetSource(Fields):
    """An entry of `budget`: where the uncertainty comes from, the largest first."""

    source: str = Field(description="in words")
    rms_um: float = Field(
        description="its standard uncertainty, RMS over the volume; squares add up to that of `rms_um`"
    )
    share: float = Field(description="of that square, 0 to 1; sources below 0.0005 are left out")


class VolumeValue(Fields):
    """`volume`: the error of the volume at places spread over it, one shift of all of them taken off."""

    axes: list[str] = Field(description="that move from place to place")
    parked: str = Field(description="where the others stand")
    tcp_mm: list[list[float]] = Field(description="places of the tool point, workpiece frame")
    found_um: list[list[float]] = Field(description="deviation along x, y, z, as estimated, of both sides the mean")
    half_um: list[list[float]] = Field(description="± of it, 95 %")
    left_um: list[list[float]] = Field(
        description="with the tables of `controller`, as estimated; empty without tables"
    )
    controller: str = Field(description="the control whose tables these are")


class TableValue(Fields):
    """An entry of `tables`; effects are of all files of the control together."""

    controller: str = Field(description="name of the control")
    file: str | None = Field(description="where it stands in the folder; null where none was written")
    axis: str = Field(description="what it moves")
    before_um: float | None = Field(description="RMS of the deviation as estimated, its mean taken off")
    after_um: float | None = Field(description="what the files leave of it")
    expected_um: float | None = Field(description="standard uncertainty to be expected with the files loaded")
    U_um: float | None = Field(
        description="95 % of the deviations over the volume lie within it with the files loaded, with 95 % probability"
    )
    left_out: str = Field(description="what they leave, or why there are none, in words")


class RowLine(Fields):
    """An entry of `lines`: where a row holds."""

    setup: str = Field(description="the set-up that reads there, empty for none")
    axis: str = Field(description="the axis that moves")
    ends: list[float] = Field(description="from where to where, mm or deg")
    at: dict[str, float] | None = Field(description="where the other axes stand, mm or deg")
    places: dict[str, int] = Field(description="places read from `+`, from `-` and from `both`")


class RowValue(Fields):
    """An entry of `rows`: what was found of the machine, how well it is known, and what tables leave; in `unit`."""

    row: str = Field(description="such as `positioning X`, `squareness XY`, `volume`")
    kind: str = Field(description="`positioning`, `backlash`, `straightness` ... `volume`")
    axes: list[str] = Field(description="the axes that it is about")
    unit: str = Field(description="um or urad")
    found: float = Field(description="RMS of the error over its places, √(estimate² + u²)")
    largest: float = Field(description="the same at the place where it is largest")
    known_to: float = Field(description="U: 95 % of what is not known is smaller")
    known_before: float = Field(description="U before the first reading, of the machine as stated: as the plan says it")
    floor: float = Field(description="U that endless readings would leave")
    left: dict[str, float] = Field(description="by control, what its tables leave, √(left² + u²)")
    limit: float | None = Field(description="what `known_to` is to be; null where `wants` gives none")
    reached: bool | None = Field(description="whether it is; null without a limit")
    measured: bool = Field(
        description="whether `known_to` is at most half of U without readings at these sizes; a volume that was read"
    )
    one_more: float | None = Field(description="`known_to` after one reading from the other side, of a backlash")
    lines: list[RowLine] = Field(description="where it holds; empty of the volume")


class AimValue(Fields):
    """An entry of `aims`: what is asked for, in `unit`."""

    name: str = Field(description="`rms`, `worst` or `U` of the volume, or the row")
    now: float = Field(description="how well it is known")
    limit: float = Field(description="what that is to be")
    floor: float = Field(description="what endless readings would leave")
    measured: bool = Field(description="whether readings tell it")
    reachable: bool = Field(description="whether endless readings would reach it")
    unread: int = Field(description="lines of it that nobody has read")
    unit: str = Field(description="um or urad")


class StepValue(Fields):
    """An entry of `steps`: what to do next."""

    code: str = Field(description="`load verify undo accept measure next finish`")
    control: str = Field(description="whose tables are loaded")
    mistake: str = Field(description="that is accepted")


class CheckedValue(Fields):
    """`checked`: a check of the tables on the machine."""

    places: int = Field(description="how many were read, without the tables and with them")
    found: float = Field(description="RMS of the deviation without them, um")
    left: float = Field(description="RMS with them, um")
    tolerance: float = Field(description="largest deviation allowed, um")
    verdict: str = Field(description="`pass`, `fail` or `undecided`")


class AnswerValue(Fields):
    """`answer`: what became of what was asked for; its rows are `rows` of the document."""

    verdict: str = Field(
        description="`measured`, `unmeasured` a wanted row without a limit is not, `reached`, `more` readings would "
        "reach it, `unreachable`, `contradict`, `nothing` was read"
    )
    aims: list[AimValue] = Field(description="what is asked for, the volume first")
    more: int = Field(description="readings that would reach it")
    more_minutes: float = Field(description="their machine time")
    readings: int = Field(description="taken")
    left_out: int = Field(description="of them not used")
    compared: int = Field(description="with each other")
    agreeing: int = Field(description="of these within three standard deviations of what the others say")
    minutes: float = Field(description="of the clock, else of the plan")
    clocked: bool = Field(description="whether they are of the clock")
    withheld: bool = Field(description="readings contradict each other and no mistake explains it")
    steps: list[StepValue] = Field(description="what to do next")
    checked: CheckedValue | None = Field(description="null where nobody has checked the tables")


class Result(Fields):
    """The document."""

    kind: Literal["axiscal-result/1"] = Field(alias="schema", description="name and version of the document")
    machine: str = Field(description="name of the machine")
    readings: int = Field(description="how many were taken")
    minutes: float = Field(description="machine time")
    stopped_because: str = Field(description="why the campaign ended, in words")
    agreement: AgreementValue = Field(description="whether the readings agree with each other")
    U_um: float | None = Field(
        description="expanded uncertainty of the tool point in space over the volume, 95 %. Down to `worst_um` null if "
        "readings contradict each other and no mistake explains it"
    )
    U_axis_um: dict[str, float] | None = Field(description="the same along x, y and z of the workpiece frame")
    U_worst_um: float | None = Field(description="the same in space at the worst place of the volume")
    U_level: float | None = Field(description="the probability that they hold: 0.95")
    k: float | None = Field(description="coverage factor, `U_um` over `rms_um`")
    U_holds_for: str | None = Field(
        description="tool, volume, temperature and errors that they were evaluated for, in words"
    )
    rms_um: float | None = Field(description="standard uncertainty of the tool point, RMS over the volume (k = 1)")
    worst_um: float | None = Field(description="largest standard deviation in the volume")
    unseen_rms_um: float = Field(description="what no allowed reading can take away")
    budget: list[BudgetSource] = Field(description="where the uncertainty comes from")
    nonlinearity: float | None = Field(
        description="largest index of non-linearity of a reading; above 0.3 it is no Gaussian"
    )
    target_rms_um: float | None = Field(description="the RMS asked for")
    target_worst_um: float | None = Field(description="the worst asked for")
    target_u: float | None = Field(alias="target_U_um", description="the expanded uncertainty asked for")
    target_reached: bool | None = Field(
        None,
        description="whether one of these is reached, with what no reading can see; null where none is set",
    )
    history: list[Milestone] = Field(description="how well the machine was known after each reading")
    errors: dict[str, ErrorCurve] = Field(description="error motions by ISO 230-1 name, reversals among them")
    plane_errors: dict[str, PlaneMap] = Field(description="errors of two axes together by name, such as EZXY")
    volume: VolumeValue | None = Field(description="the error of the volume; null before the first reading")
    constants: dict[str, ConstantValue] = Field(description="location errors, reversals, unknowns of set-ups")
    observability: list[str] = Field(description="what cannot be seen, in plain sentences")
    rejected: list[RejectedReading] = Field(description="readings not believed, and why")
    warnings: list[Warning] = Field(description="what is to be minded")
    answer: AnswerValue = Field(description="what became of what was asked for")
    rows: list[RowValue] = Field(description="the answer, row by row; empty where no uncertainty is printed")
    tables: list[TableValue] = Field(description="files that were written for controls, and what they leave")
    versions: dict[str, str] = Field(description="of axiscal and of what it computes with")
    record: dict[str, int | str] | None = Field(
        None, description="`event`, the last one of the record, and `hash`, the name of what it holds up to there"
    )


def page() -> str:
    """Return the page: a list for each kind of object."""
    models = (Result, Milestone, ErrorCurve, PlaneMap, ConstantValue, RejectedReading, AgreementValue)
    return "\n".join(
        [
            _HEAD,
            *(
                _fields(each)
                for each in (
                    *models,
                    MistakeValue,
                    BudgetSource,
                    VolumeValue,
                    Warning,
                    AnswerValue,
                    AimValue,
                    StepValue,
                    CheckedValue,
                    RowValue,
                    RowLine,
                    TableValue,
                )
            ),
        ]
    )


def _fields(model: type[Fields]) -> str:
    rows = [f"- `{field.alias or name}`: {field.description}" for name, field in model.model_fields.items()]
    title = " ".join((model.__doc__ or "").rstrip(".").split())
    return "\n".join([f"## {title}", *rows]) + "\n"


def schema() -> dict[str, Any]:
    """Return the JSON schema; fields that are added later do not break it."""
    found = Result.model_json_schema(by_alias=True)
    for each in (found, *found["$defs"].values()):
        each.pop("additionalProperties", None)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found}


def write() -> None:
    """Write page and schema."""
    PAGE.write_text(page(), encoding="utf-8")
    SCHEMA.write_text(json.dumps(schema(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write()
