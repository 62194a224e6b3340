"""From a campaign to what is said of it: the summary behind `result.json` and the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.campaign.calibration import Calibration
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.problem import Problem
from axiscal.campaign.versions import versions
from axiscal.campaign.what_if import traditional
from axiscal.machine.kinematics import frames
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.measurement.wording import approach_text, direction_text, reading_unit, shown_pose
from axiscal.report.curves import constants, curves
from axiscal.report.findings import findings, observability, residual_check
from axiscal.report.summary import Curve, HistoryRow, Iso230, Rejection, SetupUse, Summary, TableOffer, TruthCheck
from axiscal.simulation import VirtualMachine
from axiscal.units import to_unit


@dataclass(frozen=True, eq=False, slots=True)
class Extras:
    """What a campaign itself does not know: tables that were written, a truth that is known, a finished standard
    test.

    compared : whether the traditional way, with as many readings, is drawn beside the accuracy
    """

    tables: Sequence[TableOffer] = ()
    truth: VirtualMachine | None = None
    truth_check: TruthCheck | None = None
    iso230: Sequence[Iso230] = ()
    files: Sequence[str] = ()
    compared: bool = False


def summarise(campaign: Campaign, calibration: Calibration, extras: Extras) -> Summary:
    """Return the summary of a campaign.

    calibration : after all its readings
    """
    problem, description = calibration.problem, campaign.description
    rows = _history(campaign, calibration)
    if extras.compared:
        usual = traditional(problem, len(campaign.state.readings)).rms
        pairs = zip(rows, usual, strict=True)
        rows = [replace(row, traditional_rms_um=to_unit(rms, "um")) for row, rms in pairs]
    target, drawn = description.target, curves(calibration, campaign.state.readings, extras.truth)
    return Summary(
        title=f"Calibration of {description.machine.name}",
        machine=description.machine.name,
        chain=description.machine.chain,
        campaign_file=description.source,
        date=campaign.begun[:10],
        setups=[_setup_use(setup, campaign) for setup in description.setups],
        stopped_because=campaign.state.finished or "not finished",
        readings=len(campaign.state.readings),
        minutes=rows[-1].minutes,
        rms_um=rows[-1].rms_um,
        worst_um=rows[-1].worst_um,
        unseen_rms_um=to_unit(problem.yardstick.unseen_rms, "um"),
        history=rows,
        curves=[curve for curve in drawn if not _reversal(curve)],
        reversals=[curve for curve in drawn if _reversal(curve)],
        constants=constants(calibration, extras.truth),
        observability=observability(problem),
        rejected=_rejections(calibration, rows),
        warnings=findings(calibration),
        tables=extras.tables,
        target_rms_um=None if target.rms is None else to_unit(target.rms, "um"),
        target_worst_um=None if target.worst is None else to_unit(target.worst, "um"),
        truth=extras.truth_check,
        iso230=extras.iso230,
        reading_residual=residual_check(calibration),
        versions=versions(),
        files=extras.files,
    )


def _reversal(curve: Curve) -> bool:
    return curve.name.endswith("_reversal")


def _history(campaign: Campaign, calibration: Calibration) -> list[HistoryRow]:
    """Replay the readings: how well the machine was known after each, and how much each surprised."""
    readings = campaign.state.readings
    replay = calibration.replay()
    rows = [_row(replay, None, 0, 0.0)]
    for number, reading in enumerate(readings, start=1):
        replay.absorb(reading)
        rows.append(_row(replay, reading, number, replay.seconds))
    refused = {doubt.reading + 1 for doubt in calibration.doubts if doubt.rejected}
    return [replace(row, rejected=row.reading in refused) for row in rows]


def _rejections(calibration: Calibration, rows: Sequence[HistoryRow]) -> list[Rejection]:
    """Return the readings that were not believed."""
    return [
        Rejection(
            doubt.reading + 1,
            row.setup or "",
            row.position or {},
            row.value_um or 0.0,
            f"{doubt.surprise:.3g} standard deviations from what the other readings say",
            row.unit,
        )
        for doubt in calibration.doubts
        if doubt.rejected and (row := rows[doubt.reading + 1])
    ]


def _row(replay: Calibration, reading: Reading | None, number: int, seconds: float) -> HistoryRow:
    known = replay.accuracy()
    rms, worst, minutes = to_unit(known.rms, "um"), to_unit(known.worst, "um"), to_unit(seconds, "min")
    if reading is None:
        return HistoryRow(number, None, None, None, None, None, rms, worst, minutes)
    description, last = replay.problem.description, replay.innovations[-1]
    unit, axes = reading_unit(description.setup(reading.setup)), description.machine.axes
    return HistoryRow(
        reading=number,
        setup=reading.setup,
        position=shown_pose(axes, reading.pose),
        value_um=to_unit(reading.value, unit),
        innovation=to_unit(float(last.value[0]), unit),
        innovation_std=to_unit(float(last.std[0]), unit),
        rms_um=rms,
        worst_um=worst,
        minutes=minutes,
        unit=unit,
        tcp_mm=_tool_point(replay.problem, reading),
        approach=approach_text(axes, reading.approach),
    )


def _tool_point(problem: Problem, reading: Reading) -> tuple[float, float, float]:
    x, y, z = (to_unit(float(v), "mm") for v in frames(problem.description.machine, np.array([reading.pose])).tcp[0])
    return x, y, z


def _setup_use(setup: Setup, campaign: Campaign) -> SetupUse:
    axes = campaign.description.machine.axes
    taken = sum(reading.setup == setup.name for reading in campaign.state.readings)
    moves = [axes[k].name for k in setup.moves]
    unit = reading_unit(setup)
    noise = f"{to_unit(setup.noise, unit):.3g} {unit}"
    return SetupUse(setup.name, setup.instrument, direction_text(setup), moves, noise, taken)
