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

Written = dict[str, Any]
"""A part of `result.json` as it stands there, its figures not rounded yet (docs/result.schema.json)."""


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
    history : each reading and the accuracy after it, the prior first, with what the file of readings has beside
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
    history: Sequence[Written]
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
