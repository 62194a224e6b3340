"""From a campaign to its summary, the base of `result.json` and the report.

ISO 230-2 as blocks of the report: a finished test, and readings of a campaign that happen to be one.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from hashlib import sha256
from pathlib import Path

import numpy as np

from axiscal.answers.answer import ResultAnswer, TablesChecked
from axiscal.answers.answer_of_campaign import answer_of
from axiscal.answers.budget import BudgetShare, budget
from axiscal.campaign.agreement_words import agreement_words, change_words, mistake_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import because_text, reaches
from axiscal.campaign.evidence import evidence_words
from axiscal.campaign.possible import versions
from axiscal.description.campaign import CampaignDescription, Equipment
from axiscal.estimation.accuracy.expanded import LEVEL
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation, Linearity, Moment, expanded_uncertainty, linearity, path
from axiscal.estimation.functionals.functional import seen_by, stand_of
from axiscal.evaluation.standards import Positioning, PositioningTest, evaluate
from axiscal.language.spoken import WORDS, later, listed, resaid, said, speaking
from axiscal.language.stages import stage
from axiscal.machine.axis import letter_direction
from axiscal.machine.kinematics import in_frame
from axiscal.machine.questions import questions, which_way
from axiscal.measurement.reading import (
    Reading,
    approach_text,
    by_text,
    direction_text,
    shown_pose,
    units_of,
    value_columns,
)
from axiscal.measurement.setup import Setup
from axiscal.measurement.type_b import Distribution
from axiscal.numerics import Array
from axiscal.present.conditions import conditions, counted_along
from axiscal.present.curves import constants, errors
from axiscal.present.findings import findings, observability
from axiscal.present.schematic import read_schematics
from axiscal.present.sentences import cause_words
from axiscal.present.summary import (
    Finding,
    RecordState,
    Summary,
    TableOffer,
    Written,
)
from axiscal.present.volume_error import bent_volume, planes, volume_error
from axiscal.tables.offer import Export
from axiscal.units import said_quantity, to_unit
from axiscal_core.ties import ALIKE, ranked

_FEWEST_TARGETS, _FEWEST_RUNS = 5, 2
"""ISO 230-2 asks for five targets at least; a standard deviation needs two runs."""
_SAME = 1e-6
"""m or rad: targets nearer to each other are one."""


def iso230_blocks(
    description: CampaignDescription, readings: Sequence[Reading], doubted: Collection[int] = ()
) -> list[Written]:
    """Return the figures of each axis whose readings in one set-up are a test after ISO 230-2.

    doubted : readings, counted from 0, that were not believed: their runs are left out
    """
    blocks = []
    for setup in description.setups:
        mine = [(number, reading) for number, reading in enumerate(readings) if reading.setup == setup.name]
        wrong = [reading.numbered(number) for number, reading in mine if number in doubted]
        kept = [replace(reading, value=np.nan) if number in doubted else reading for number, reading in mine]
        test = _test(description, setup, kept)
        if test is not None:
            axis = description.machine.axes[setup.moves[0]]
            blocks.append(iso230_block(axis.name, evaluate(test, setup.noise), wrong))
    return blocks


def _test(description: CampaignDescription, setup: Setup, readings: Sequence[Reading]) -> PositioningTest | None:
    """Return a set-up's readings as a test; None where they are none: each target as often from each side.

    Deviations are those along, or about, the way in which the axis counts, wherever the instrument looks.
    A reading of nan takes its run out, the n-th reading of every target from its side.
    """
    stands = stand_of(setup, readings)
    if (seen := seen_by(setup, description.machine, stands)) is None:
        return None
    axis, own = setup.moves[0], description.machine.axes[setup.moves[0]]
    if seen != ("angle" if own.rotary else "length", letter_direction(own.letter)):
        return None
    way = np.array(own.direction) @ in_frame(description.machine, axis, stands)
    along = 1.0 if way @ np.array(setup.direction) > 0 else -1.0
    found: dict[tuple[int, int], list[float]] = {}
    for reading in readings:
        target = round(reading.pose[axis] / _SAME)
        found.setdefault((target, reading.approach[axis]), []).append(along * reading.value)
    targets = sorted({target for target, _ in found})
    sides = [_runs(found, targets, side) for side in (1, -1)]
    if len(targets) < _FEWEST_TARGETS or any(side == 0 for _, side in found) or all(side is None for side in sides):
        return None
    if any(side is None and any(way == sign for _, way in found) for side, sign in zip(sides, (1, -1), strict=True)):
        return None
    positions = np.array(targets) * _SAME
    return PositioningTest(positions, sides[0], sides[1], own.rotary)


def _runs(found: dict[tuple[int, int], list[float]], targets: Sequence[int], side: int) -> Array | None:
    """Return the readings of one direction, (targets, runs); None where not every target was read as often."""
    rows = [found.get((target, side), []) for target in targets]
    if len({len(row) for row in rows}) > 1:
        return None
    whole = np.array(rows)[:, ~np.any(np.isnan(rows), axis=0)]
    return whole if whole.shape[1] >= _FEWEST_RUNS else None


def iso230_block(axis: str, found: Positioning, left_out: Sequence[int] = ()) -> Written:
    """Return the figures of one axis.  left_out : readings that were not believed; the test is without their runs"""
    kinds = {"figures": found.figures, "U": found.uncertainty}  # U : expanded (k = 2)
    shown = {kind: {name: to_unit(x, found.unit) for name, x in each.items()} for kind, each in kinds.items()}
    return {"axis": axis, "unit": found.unit, **shown, "left_out": [*left_out]}


_WORDS = WORDS["sources"]
_DISTRIBUTIONS: dict[Distribution, str] = {"normal": later("normal"), "rectangular": later("rectangular")}


@dataclass(frozen=True, eq=False, slots=True)
class Extras:
    """What a campaign itself does not know: tables that were written, a finished standard test.

    warnings : about what was given, besides those of the estimate
    anyway : tables and uncertainties are written although readings contradict each other; each page says that they do
    checked : what a check of the tables on the machine found; best : the files that leave least
    answer : with what tables leave; None where none are made
    spoken : language of whoever ends the campaign, for a report that states none; language : that is wanted
    """

    tables: Sequence[TableOffer] = ()
    iso230: Sequence[Written] = ()
    warnings: Sequence[Finding] = ()
    anyway: bool = False
    checked: TablesChecked | None = None
    best: Export | None = None
    answer: ResultAnswer | None = None
    spoken: str = "en"
    language: str | None = None


@stage("the summary")
def summarise(campaign: Campaign, estimation: Estimation, extras: Extras) -> Summary:
    """Return the summary of a campaign, in English; `resaid` says it in another language.

    estimation : after all its readings
    """
    with speaking("en"):
        return resaid(_summary(campaign, estimation, extras))


def _summary(campaign: Campaign, estimation: Estimation, extras: Extras) -> Summary:
    case, description, best = estimation.case, campaign.description, extras.best
    controller, control = ("", None) if best is None else (best.controller, best.control)
    answer = extras.answer or answer_of(campaign, estimation, {}, anyway=extras.anyway)
    rows = _history(campaign, estimation)
    linear, found, stated = linearity(estimation), expanded_uncertainty(estimation), estimation.stated
    space, worst, x, y, z = (to_unit(each, "um") for each in (found.space, found.worst, *found.axes))
    factor, (sources, smaller) = found.factor(estimation.accuracy.rms), budget_rows(estimation)
    target = description.target
    changes = [said("A person accepted: {change}.", change=change_words(each)) for each in campaign.state.accepted]
    accepted, over = [Finding("accepted", None, change) for change in changes], campaign.state.finished is not None
    names = [setup.name for setup in description.setups]
    times = [reading.time for reading in campaign.state.readings if reading.time is not None]
    last = datetime.fromisoformat(campaign.begun) + timedelta(seconds=max(times, default=0.0))
    return Summary(
        machine=description.machine.name,
        chain=description.machine.chain,
        radii=[axis.name for axis in description.machine.axes if axis.diameters],
        campaign_file=description.source,
        date=datetime.fromisoformat(campaign.begun).date().isoformat(),
        setups=[_setup_use(setup, campaign) for setup in description.setups],
        stopped_because=because_text(campaign.state.finished or "not finished"),
        readings=len(campaign.state.readings),
        minutes=rows[-1]["minutes"],
        rms_um=rows[-1]["rms_um"],
        worst_um=rows[-1]["worst_um"],
        unseen_rms_um=to_unit(case.yardstick_as_sized.unseen_rms, "um"),
        history=rows,
        expanded={
            "U_um": space,
            "U_worst_um": worst,
            "U_level": LEVEL,
            "k": factor,
            "U_axis_um": {"x": x, "y": y, "z": z},
            "U_holds_for": conditions(stated),
            "U_along": counted_along(stated),
        },
        answer=answer.model_copy(update={"checked": extras.checked}),
        errors=errors(estimation, campaign.state.readings),
        constants=constants(estimation),
        plane_errors=planes(estimation),
        observability=observability(case),
        questions=[
            *questions(description.machine),
            *which_way(description.machine),
            *(each.words for each in description.unsourced),
        ],
        warnings=[*extras.warnings, *accepted, *findings(estimation, ended=over), *not_gaussian(linear)],
        tables=extras.tables,
        target_rms_um=None if target.rms is None else to_unit(target.rms, "um"),
        target_worst_um=None if target.worst is None else to_unit(target.worst, "um"),
        target_u_um=None if target.expanded is None else to_unit(target.expanded, "um"),
        target_reached=reaches(target, estimation),
        iso230=extras.iso230 or iso230_blocks(description, campaign.state.readings, estimation.left_out),
        versions=versions(),
        record=record_state(campaign),
        agreement=estimation.agreement,
        checks=estimation.checks,
        agreement_words=agreement_words(estimation) if estimation.readings else "",
        mistakes=[
            {"mistake": each.mistake, "odds": each.odds, "setups": [names[k] for k in each.setups], "text": words}
            for each in estimation.agreement.explained
            for words in [mistake_words(each, estimation)]
        ],
        volume=volume_error(estimation, controller, control) if campaign.state.readings else None,
        bent=bent_volume(estimation, controller, control) if campaign.state.readings else None,
        schematics=read_schematics(description, [reading.place for reading in campaign.state.readings]),
        budget=sources,
        smaller_um=smaller,
        particulars=description.particulars,
        checksums=_checksums(campaign),
        ended=last.date().isoformat(),
        nonlinearity=linear.largest,
    )


def _checksums(campaign: Campaign) -> dict[str, str]:
    """Return the SHA-256 of what the campaign was described by, and the hash of its record."""
    described = campaign.description
    texts = {
        Path(described.source).name: described.text,
        Path(described.machine_source).name: described.machine.text,
        said("the earlier campaign"): described.prior_text,
    }
    sums = {name: sha256(text.encode("utf-8", "surrogateescape")).hexdigest() for name, text in texts.items() if text}
    return sums | {campaign.path.name: campaign.state.name}


def record_state(campaign: Campaign) -> RecordState:
    """Return from which state of which record figures and tables are made."""
    return RecordState(campaign.path.name, campaign.state.last, campaign.state.name, evidence_words(campaign))


def _history(campaign: Campaign, estimation: Estimation) -> list[Written]:
    """Return how well the machine was known after each reading, and how much each surprised, or was not believed."""
    doubts = {doubt.reading: doubt for doubt in estimation.outliers}
    first, *moments = path(estimation)
    rows = [_row(estimation.case, None, 0, first)]
    for index, (reading, moment) in enumerate(zip(campaign.state.readings, moments, strict=True)):
        row = _row(estimation.case, reading, reading.numbered(index), moment)
        if index in doubts:
            away = float(doubts[index].surprise)
            reason = said("{away:.1f} standard deviations from what the other readings say", away=away)
            row |= {"rejected": True, "reason": reason, "surprise": math.copysign(away, row["innovation"])}
        rows.append(row)
    return rows


def _row(case: Case, reading: Reading | None, number: int, moment: Moment) -> Written:
    """Return a reading, None of the prior, and the accuracy after it."""
    rms, worst = (to_unit(each, "um") for each in (moment.accuracy.rms, moment.accuracy.worst))
    known = {"rms_um": rms, "worst_um": worst, "minutes": to_unit(moment.seconds, "min"), "rejected": False}
    blank = dict.fromkeys(("setup", "position", "value", "unit", "innovation", "surprise", "std", "time"))
    row = {"reading": number, **blank, "approach": "", "by": "", "others": (), "units": (), "columns": (), **known}
    if reading is None or (last := moment.innovations) is None:
        return row
    setup, axes = case.description.setup(reading.setup), case.description.machine.axes
    units = units_of(setup)
    value, *others = (to_unit(x, own) for x, own in zip((reading.value, *reading.others), units, strict=True))
    return row | {
        "setup": reading.setup,
        "position": shown_pose(axes, reading.pose),
        "value": value,
        "unit": units[0],
        "others": others,
        "units": [column.rpartition("_")[2] for column in value_columns(setup)],
        "innovation": to_unit(float(last.value[0]), units[0]),
        "surprise": float(last.value[0] / last.std[0]),
        "approach": approach_text(axes, reading.approach),
        "by": by_text(reading),
        "columns": value_columns(setup),
        "std": None if reading.std is None else to_unit(reading.std, units[0]),
        "time": reading.time,
        "check": reading.check,
    }


def _setup_use(setup: Setup, campaign: Campaign) -> Written:
    axes = campaign.description.machine.axes
    count = sum(reading.setup == setup.name for reading in campaign.state.readings)
    moves = [axes[k].name for k in setup.moves]
    noises = zip(setup.noise / setup.scales, units_of(setup), strict=True)
    noise = listed(", ", [*dict.fromkeys(said_quantity(float(each), unit) for each, unit in noises)])
    of = campaign.description.particulars.setups.get(setup.name, Equipment())
    named = len(setup.names) > 1 or setup.written
    along = " ".join(setup.names) if named else direction_text(setup)
    along = along if setup.length is None else said("the bar")
    own = {"name": setup.name, "instrument": said(setup.title), "along": along, "moves": moves, "noise": noise}
    grown = said("{growth:.3g} um/m against 20 degC", growth=float(setup.growth * 1e6)) if setup.growth else ""
    told = {"serial": of.serial, "certificate": of.certificate, "temperature": grown}
    return {**own, "readings": count, **{name: text for name, text in told.items() if text}}


def not_gaussian(found: Linearity) -> Iterator[Finding]:
    """Yield a warning where a reading is so far from linear that the posterior is no Gaussian."""
    if found.gaussian or found.reading is None:
        return
    text = (
        "Reading {reading} is not linear within what is left open: its second order is {times:.2g} times its noise, "
        "so the bands are only about right. State stations or location errors nearer to the truth, or read more."
    )
    yield Finding("not-gaussian", None, said(text, reading=found.reading, times=float(found.largest)))


WORTH = 5e-4
"""Shares of the square below have no row of their own: they would show as nought."""


def budget_rows(known: Estimation) -> tuple[list[Written], float]:
    """Return the sources of the standard uncertainty, the largest first, and the RMS of those without a row, um."""
    shares = budget(known)
    whole = sum(share.rms**2 for share in shares) or 1.0
    counted = [share for share in shares if share.rms**2 >= WORTH * whole]
    smaller = math.sqrt(sum(share.rms**2 for share in shares if share.rms**2 < WORTH * whole))
    rows = []
    for share in (counted[k] for k in ranked(np.array([share.rms**2 / whole for share in counted]), ALIKE)):
        row = {"rms_um": to_unit(share.rms, "um"), "share": share.rms**2 / whole, "source": _words(share)}
        spread = "" if share.cause is None else said(_DISTRIBUTIONS[share.cause.row.distribution])
        rows.append({**row, "kind": "B" if share.cause else "A", "distribution": spread})  # GUM 4.2, 4.3
    return rows, to_unit(smaller, "um")


def _words(share: BudgetShare) -> str:
    if share.kind == "instrument":
        return said('Instrument: noise of the readings of "{setup}"', setup=share.setup)
    if share.cause is not None:
        row, owner = share.cause.row, share.cause.owner
        what = cause_words(row.name, owner)
        if share.cause.stated:
            return said("{what}, as stated", what=what)
        return said("{what}, {size} as is usual", what=what, size=said_quantity(row.size, row.unit))
    return said(_WORDS[share.kind])
