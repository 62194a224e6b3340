"""From a campaign to its result."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from datetime import datetime, timedelta
from typing import Any

import numpy as np

from axiscal.campaign.agreement_words import agreement_words, change_words, mistake_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import because_text
from axiscal.campaign.evidence import evidence_words
from axiscal.campaign.possible import versions
from axiscal.description.campaign import Equipment
from axiscal.estimation.budget import BudgetShare, budget
from axiscal.estimation.estimation import Estimation, Moment, expanded_uncertainty, linearity, path
from axiscal.language.spoken import WORDS, listed, resaid, said, speaking
from axiscal.language.stages import stage
from axiscal.machine.questions import which_way
from axiscal.measurement.reading import (
    approach_text,
    direction_text,
    shown_pose,
    units_of,
    value_columns,
)
from axiscal.measurement.setup import Setup
from axiscal.present.answer import Outcome
from axiscal.present.answer_words import answer_text
from axiscal.present.axis_tests_read import iso230_blocks
from axiscal.present.conditions import conditions, counted_along
from axiscal.present.curves import constants, errors
from axiscal.present.findings import findings, observability
from axiscal.present.result import (
    AgreementFigures,
    BudgetSource,
    ChecksFigures,
    Finding,
    HistoryRow,
    NamedMistake,
    OneCheck,
    RecordState,
    RejectedReading,
    Result,
    ResultWords,
    SetupUse,
    TableFile,
)
from axiscal.present.row_words import row_names
from axiscal.present.sentences import cause_words
from axiscal.present.volume_error import planes, volume_error
from axiscal.record.accepted import Accepted
from axiscal.tables.offer import Export
from axiscal.units import said_quantity, to_unit
from axiscal_core.ties import ALIKE, ranked

_WORDS, _DISTRIBUTIONS = WORDS["sources"], WORDS["distributions"]


@stage("the summary")
def result_of(
    campaign: Campaign,
    known: Estimation,
    answer: Outcome,
    *,
    tables: Sequence[TableFile] = (),
    best: Export | None = None,
    warnings: Sequence[Finding] = (),
) -> Result:
    """Return the result of a campaign, in English; `resaid` says it in another language.

    known : after all its readings; tables : that were written; best : the files that leave least
    warnings : about what was given, besides those of the estimate
    """
    with speaking("en"):
        case, described, readings = known.case, campaign.description, campaign.state.readings
        controller, control = ("", None) if best is None else (best.controller, best.control)
        agreement = agreement_words(known) if readings else ""
        words = answer_text(answer, agreement, evidence_words(campaign.log))
        history, linear = _history(campaign, known), linearity(known)
        numbers = [reading.numbered(index) for index, reading in enumerate(known.readings)]
        sources, smaller = budget_rows(known)
        changes = [Finding.of("accepted", change=change_words(each)) for each in campaign.state.told(Accepted)]
        found = findings(known, ended=campaign.state.finished is not None)
        if linear.reading is not None and not linear.gaussian:
            found.append(Finding.of("not-gaussian", reading=linear.reading, times=float(linear.largest)))
        made = Result(
            identity=_identity(campaign),
            words=ResultWords(**dict(words), names={row.row: row_names([row]) for row in answer.rows}),
            machine=described.machine.name,
            readings=len(readings),
            minutes=history[-1].minutes,
            stopped_because=because_text(campaign.state.finished or "not finished"),
            setups=[_setup_use(setup, campaign) for setup in described.setups],
            agreement=_agreement(known, agreement),
            checks=ChecksFigures(
                count=len(known.checks.each),
                as_promised=known.checks.as_promised,
                s=known.checks.s,
                each=[OneCheck(reading=numbers[each.reading], z=each.z, used=each.used) for each in known.checks.each],
            ),
            **_uncertainties(known, history[-1], withheld=answer.withheld),
            unseen_rms_um=to_unit(case.yardstick_as_sized.unseen_rms, "um"),
            budget=sources,
            budget_smaller_um=smaller,
            nonlinearity=linear.largest,
            history=history,
            errors=errors(known, readings),
            plane_errors=planes(known),
            volume=volume_error(known, controller, control) if readings else None,
            constants=constants(known),
            iso230=iso230_blocks(described, readings, known.left_out),
            observability=observability(case),
            questions=[*which_way(described.machine)],
            rejected=list(_rejected(history)),
            warnings=[*warnings, *changes, *found],
            answer=answer,
            rows=answer.rows,
            tables=tables,
            versions=dict(sorted(versions().items())),
            record=record_state(campaign),
        )
        return resaid(made)


def _uncertainties(known: Estimation, last: HistoryRow, *, withheld: bool) -> dict[str, Any]:
    """Return standard and expanded uncertainties and what they hold for; None each where they are withheld."""
    found, stated = expanded_uncertainty(known), known.stated
    space, worst, *axes = (to_unit(each, "um") for each in (found.space, found.worst, *found.axes))
    figures = {
        "U_um": space,
        "U_axis_um": dict(zip("xyz", axes, strict=True)),
        "U_worst_um": worst,
        "k": found.factor(known.accuracy.rms),
        "U_holds_for": conditions(stated),
        "U_along": counted_along(stated),
        "rms_um": last.rms_um,
        "worst_um": last.worst_um,
    }
    return dict.fromkeys(figures) if withheld else figures


_WHO = ("number", "customer", "laboratory", "place", "operator", "responsible", "temperature", "remarks", "maker",
        "serial")  # fmt: skip


def _identity(campaign: Campaign) -> dict[str, str | dict[str, dict[str, str]]]:
    """Return whose machine it is, who measured when, and for whom, as far as somebody has said so."""
    described, begun = campaign.description, datetime.fromisoformat(campaign.begun)
    last = max((reading.time for reading in campaign.state.readings if reading.time is not None), default=0.0)
    artefacts = {
        name: {kind: text for kind in ("serial", "certificate") if (text := getattr(each, kind))}
        for name, each in described.particulars.artefacts.items()
    }
    said_of = {
        "chain": described.machine.chain,
        "campaign_file": described.source,
        "begun": begun.date().isoformat(),
        "ended": (begun + timedelta(seconds=last)).date().isoformat(),
        **{name: getattr(described.particulars, name) for name in _WHO},
        "artefacts": {name: each for name, each in artefacts.items() if each},
    }
    return {name: each for name, each in said_of.items() if each}


def _agreement(known: Estimation, words: str) -> AgreementFigures:
    found, names = known.agreement, [setup.name for setup in known.case.description.setups]
    return AgreementFigures(
        count=found.count,
        agreeing=found.agreeing,
        c2=found.c2,
        p=found.p,
        contradict=found.contradicts,
        explained=[
            NamedMistake(
                mistake=each.mistake,
                odds=each.odds,
                setups=[names[k] for k in each.setups],
                text=mistake_words(each, known),
            )
            for each in found.explained
        ],
        text=words,
    )


def record_state(campaign: Campaign) -> RecordState:
    """Return from which state of which record figures and tables are made."""
    return RecordState(file=campaign.path.name, event=campaign.state.last, hash=campaign.state.name)


def _history(campaign: Campaign, known: Estimation) -> list[HistoryRow]:
    """Return how well the machine was known after each reading, and how much each surprised, or was not believed."""
    doubts = {doubt.reading: float(doubt.surprise) for doubt in known.outliers}
    first, *moments = path(known)
    rows = [HistoryRow(reading=0, **_accuracy(first))]
    for index, (reading, moment) in enumerate(zip(campaign.state.readings, moments, strict=True)):
        setup = known.case.description.setup(reading.setup)
        assert moment.surprise is not None  # which it is before the first alone
        units = units_of(setup)
        value, *others = (to_unit(x, own) for x, own in zip((reading.value, *reading.others), units, strict=True))
        (innovation, std), away = moment.surprise, doubts.get(index)
        surprise = innovation / std if away is None else math.copysign(away, innovation)
        rows.append(
            HistoryRow(
                reading=reading.numbered(index),
                setup=reading.setup,
                position=shown_pose(known.case.description.machine.axes, reading.pose),
                value=value,
                unit=units[0],
                others=others,
                units=[column.rpartition("_")[2] for column in value_columns(setup)],
                innovation=to_unit(innovation, units[0]),
                surprise=surprise,
                approach=approach_text(known.case.description.machine.axes, reading.approach),
                rejected=away is not None,
                **_accuracy(moment),
            )
        )
    return rows


def _accuracy(moment: Moment) -> dict[str, float]:
    """Return the accuracy after a reading, and the minutes until then."""
    rms, worst = (to_unit(each, "um") for each in (moment.accuracy.rms, moment.accuracy.worst))
    return {"rms_um": rms, "worst_um": worst, "minutes": to_unit(moment.seconds, "min")}


def _rejected(history: Sequence[HistoryRow]) -> Iterator[RejectedReading]:
    """Yield the readings that are not believed, with the reason."""
    for row in (each for each in history if each.rejected):
        away = abs(row.surprise or 0.0)
        reason = said("{away:.1f} standard deviations from what the other readings say", away=away)
        yield RejectedReading(**row.model_dump(include={*RejectedReading.model_fields}), reason=reason)


def _setup_use(setup: Setup, campaign: Campaign) -> SetupUse:
    axes = campaign.description.machine.axes
    noises = zip(setup.noise / setup.scales, units_of(setup), strict=True)
    of = campaign.description.particulars.setups.get(setup.name, Equipment())
    named = len(setup.names) > 1 or setup.written
    along = " ".join(setup.names) if named else direction_text(setup)
    return SetupUse(
        name=setup.name,
        instrument=said(setup.title),
        along=along if setup.length is None else said("the bar"),
        moves=[axes[k].name for k in setup.moves],
        noise=listed(", ", [*dict.fromkeys(said_quantity(float(each), unit) for each, unit in noises)]),
        readings=sum(reading.setup == setup.name for reading in campaign.state.readings),
        serial=of.serial,
        certificate=of.certificate,
    )


WORTH = 5e-4
"""Shares of the square below have no row of their own: they would show as nought."""


def budget_rows(known: Estimation) -> tuple[list[BudgetSource], float]:
    """Return the sources of the standard uncertainty, the largest first, and the RMS of those without a row, um."""
    shares = budget(known)
    whole = sum(share.rms**2 for share in shares) or 1.0
    counted = [share for share in shares if share.rms**2 >= WORTH * whole]
    smaller = math.sqrt(sum(share.rms**2 for share in shares if share.rms**2 < WORTH * whole))
    rows = [
        BudgetSource(
            source=_source(share),
            kind="A" if share.cause is None else "B",
            distribution="" if share.cause is None else said(_DISTRIBUTIONS[share.cause.row.distribution]),
            rms_um=to_unit(share.rms, "um"),
            share=share.rms**2 / whole,
        )
        for share in (counted[k] for k in ranked(np.array([share.rms**2 / whole for share in counted]), ALIKE))
    ]
    return rows, to_unit(smaller, "um")


def _source(share: BudgetShare) -> str:
    if share.kind == "instrument":
        return said('Instrument: noise of the readings of "{setup}"', setup=share.setup)
    if share.cause is not None:
        row, owner = share.cause.row, share.cause.owner
        what = cause_words(row.name, owner)
        if share.cause.stated:
            return said("{what}, as stated", what=what)
        return said("{what}, {size} as is usual", what=what, size=said_quantity(row.size, row.unit))
    return said(_WORDS[share.kind])
