"""The result of a campaign as plain data in display units: the only source of the report and of `result.json`.

Positions in mm and deg; deviations in um, urad or arcsec (the unit stands beside the value); time in minutes.
Every `std`, `rms` and `worst` is one standard deviation; `expanded` and the bands that the report draws hold 95 %.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from axiscal.answers.answer import ResultAnswer
from axiscal.description.campaign import NOTHING_SAID, Particulars
from axiscal.estimation.promise.agreement import NOTHING_READ, Agreement, Checks
from axiscal.present.schematic import Schematic
from axiscal.present.volume_error import BentVolume

Position = Mapping[str, float]
"""Axis name to coordinate, mm or deg."""
Written = dict[str, Any]
"""A part of `result.json` as it stands there, its figures not rounded yet (docs/result.schema.json)."""


@dataclass(frozen=True, slots=True)
class HistoryRow:
    """One reading and the accuracy after it; reading 0 is the prior and has no position, value or innovation.

    unit : of `value_um` and `innovation`: "um" except for angle readings
    surprise : innovation in standard deviations; of one that was not believed, by what all others say
    others : the further numbers of a reading that has several, such as a sphere's along y and z
    reason : why it was not believed, "" where it was
    columns : of its values in a file of readings; std : of the reading's own, in `unit`; time : by the clock, s
    check : its place was drawn at random; by : who took it, as `by_text` says it
    """

    reading: int
    setup: str | None
    position: Position | None
    value_um: float | None
    innovation: float | None
    surprise: float | None
    rms_um: float
    worst_um: float
    minutes: float
    unit: str = "um"
    approach: str = ""
    others: tuple[float, ...] = ()
    reason: str = ""
    columns: Sequence[str] = ("value_um",)
    std: float | None = None
    time: float | None = None
    check: bool = False
    by: str = ""

    @property
    def rejected(self) -> bool:
        """Whether it was not believed."""
        return self.reason != "" and self.value_um is not None

    @property
    def values(self) -> tuple[float, ...]:
        """All numbers of the reading, each in its unit of `units`; none of the prior."""
        return () if self.value_um is None else (self.value_um, *self.others)

    @property
    def units(self) -> tuple[str, ...]:
        """The unit of each number, which its column ends with."""
        return tuple(column.rpartition("_")[2] for column in self.columns)


@dataclass(frozen=True, slots=True)
class Finding:
    """A warning: `code` is one of accepted prior-misfit drift outlier unobservable copies …"""

    code: str
    error: str | None
    text: str


@dataclass(frozen=True, slots=True)
class TableOffer:
    """Compensation files for a control, and what they leave uncorrected in words (empty: nothing).

    axes : of each file, by its path; none where none could be made
    effect : of all files of the control together on the tool point over the volume, um, as `result.json` names it: RMS
    before and after, of the deviation as estimated; expected, with what is not known; U of the export
    """

    controller: str
    axes: Mapping[str, str]
    left_out: str = ""
    effect: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RecordState:
    """What all figures come from: a record's file, the number of its last event, the hash up to there.

    signed : who answers for it, in a sentence, "" for nobody
    """

    file: str
    event: int
    hash: str
    signed: str = ""


@dataclass(frozen=True, slots=True)
class Summary:
    """Everything the report shows.

    expanded : expanded uncertainties over the volume, 95 %, and what they hold for
    answer : what is said first; without what tables leave until they are made
    agreement_words : whether the readings agree, in a sentence, "" before the first
    radii : the axes whose displays show diameters; smaller_um : of the sources that are too small for a row
    mistakes : what explains readings that contradict, the likeliest first
    """

    machine: str
    chain: str
    campaign_file: str
    date: str
    setups: Sequence[Written]
    stopped_because: str
    readings: int
    minutes: float
    rms_um: float
    worst_um: float
    unseen_rms_um: float
    history: Sequence[HistoryRow]
    expanded: Written
    answer: ResultAnswer
    errors: Mapping[str, Written] = field(default_factory=dict)
    constants: Mapping[str, Written] = field(default_factory=dict)
    plane_errors: Mapping[str, Written] = field(default_factory=dict)
    observability: Sequence[str] = ()
    questions: Sequence[str] = ()
    warnings: Sequence[Finding] = ()
    tables: Sequence[TableOffer] = ()
    target_rms_um: float | None = None
    target_worst_um: float | None = None
    target_u_um: float | None = None
    target_reached: bool | None = None
    iso230: Sequence[Written] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    record: RecordState | None = None
    agreement: Agreement = NOTHING_READ
    checks: Checks = field(default_factory=Checks)
    agreement_words: str = ""
    mistakes: Sequence[Written] = ()
    volume: Written | None = None
    bent: BentVolume | None = None
    schematics: Sequence[Schematic] = ()
    budget: Sequence[Written] = ()
    smaller_um: float = 0.0
    particulars: Particulars = NOTHING_SAID
    checksums: Mapping[str, str] = field(default_factory=dict)
    ended: str = ""
    nonlinearity: float | None = None
    radii: Sequence[str] = ()

    @property
    def rejected(self) -> Sequence[HistoryRow]:
        """The readings that were not believed."""
        return [row for row in self.history if row.rejected]
