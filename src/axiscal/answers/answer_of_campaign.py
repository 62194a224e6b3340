"""From what is known to the answer: rows, what was asked for, and what is missing.

Let an accuracy be U after n readings, L as wanted, and F after endless readings. U² − F² falls with n, so about
n (U² − F²)/(L² − F²) readings reach L.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from axiscal.answers.answer import (
    Aim,
    AnswerLine,
    AnswerRow,
    NextStep,
    ResultAnswer,
    StepCode,
    Verdict,
    coordinate,
    number,
)
from axiscal.answers.answer_words import digits, row_name
from axiscal.answers.rows import AnsweredRow, answered
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import count_reached
from axiscal.estimation.accuracy.expanded import known_to
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.functional import AxisLine
from axiscal.estimation.functionals.known import KnownRow, known_rows
from axiscal.exceptions import ReadingError, TableError
from axiscal.language.spoken import listed, put, said
from axiscal.machine.axis import Axis
from axiscal.measurement.reading import Place, shown_pose
from axiscal.measurement.reading_rows import blank_readings
from axiscal.planning.promise import WantedAccuracy, asked
from axiscal.record.copies import file_name
from axiscal.tables.registry import exporter, offered_control
from axiscal.tables.surface import Control
from axiscal.units import to_unit

_COSTS = 1.01
"""By less than a percent more of the volume's U nothing is lost that is worth a sentence."""

_TARGETS = 5
"""Readings that a line asks for of which there are none: ISO 230-2 wants five targets at least."""


def answer_of(
    campaign: Campaign,
    known: Estimation,
    controls: Mapping[str, Control],
    *,
    written: bool = False,
    anyway: bool = False,
) -> ResultAnswer:
    """Return the answer.

    controls : what the tables of each control that is offered do; written : whether the results are, with these tables
    anyway : rows are there although readings contradict each other
    """
    rows = answered(known, controls)
    wanted = asked(known.stated.description.target, known.case.yardstick_as_sized)
    volume_known = known.case.yardstick, known.printed.belief
    volume = [aim_of_volume(each, known_to(each.name, *volume_known)) for each in wanted]
    lines = [aim_of(row) for row in rows if row.limit is not None and row.row.kind != "volume"]
    coming = campaign.state.coming if campaign.state.finished is None else ()
    verdict = _verdict(known, volume, lines, rows)
    more, minutes = _more(known, volume, lines) if verdict == "more" and not coming else (0, 0.0)
    if coming and verdict in ("measured", "unmeasured", "more"):
        verdict, more, minutes = "more", len(coming), to_unit(campaign.seconds(coming) - campaign.seconds(), "min")
    seconds = known.timed.seconds if campaign.state.clocked is None else campaign.state.clocked
    axes, withheld = known.stated.description.machine.axes, known.agreement.withheld and not anyway
    return ResultAnswer(
        verdict=verdict,
        rows=[] if withheld else [_row(row, axes) for row in rows],
        aims=[*volume, *lines],
        more=more,
        more_minutes=_digits(minutes),
        readings=len(known.readings),
        left_out=len(known.outliers),
        compared=known.agreement.count,
        agreeing=known.agreement.agreeing,
        minutes=_digits(to_unit(seconds, "min")),
        clocked=campaign.state.clocked is not None,
        withheld=withheld,
        steps=list(_steps(campaign, known, verdict, best_control(rows, list(controls)), written)),
    )


def standing_answer(campaign: Campaign) -> ResultAnswer:
    """Return the answer of a campaign as it stands, with what tables would leave that are made of it."""
    known = campaign.so_far()
    written = campaign.state.finished is not None and (results_of(campaign.path) / "result.json").exists()
    return answer_of(campaign, known, {} if known.agreement.withheld else dict(_controls(known)), written=written)


def advised_control(campaign: Campaign) -> str:
    """Return the control of the campaign whose tables leave the least, "csv" where it has none."""
    known = campaign.so_far()
    controls = dict(_controls(known))
    return best_control(answered(known, controls), list(controls)) or "csv"


def results_of(record: Path) -> Path:
    """Return the folder of the results of a record: the one that it lies in with them, else the one beside it."""
    return record.parent if record.with_name("result.json").exists() else results_beside(record)


def results_beside(record: Path) -> Path:
    """Return the folder for the results of a record, beside it."""
    return (file := file_name(record)).with_name(f"{file.stem}-results")


def _controls(known: Estimation) -> Iterator[tuple[str, Control]]:
    """Yield each control of the campaign with what its tables do, those left out that cannot be made."""
    for name in known.case.description.controls if known.readings else ():
        with suppress(TableError, ReadingError):
            yield name, offered_control(known, name)


def best_control(rows: Sequence[AnsweredRow], names: Sequence[str]) -> str:
    """Return the control whose tables leave the least of all rows, to two digits; of equals the first, "" of none."""

    def share(name: str) -> float:
        return float(f"{sum(row.left[name] / row.found for row in rows if row.left and row.found):.1e}")

    return min(names, key=share, default="")


def _steps(campaign: Campaign, known: Estimation, verdict: Verdict, control: str, written: bool) -> Iterator[NextStep]:
    """Yield what to do next: read on or accept a mistake where that helps, else load tables and check, or end."""
    ended, described = campaign.state.finished is not None, known.case.description
    planned = verdict == "unreachable" and not ended and campaign.state.coming
    if planned or verdict in ("more", "contradict", "nothing"):
        if ended:
            yield NextStep(code="undo")
        explained = known.agreement.explained if verdict == "contradict" else ()
        full = count_reached(campaign.description.target, len(campaign.state.readings)) is not None
        reading: StepCode = "next" if full else "measure"
        yield NextStep(code="accept", mistake=explained[0].mistake) if explained else NextStep(code=reading)
    elif written:
        if control:
            yield NextStep(code="load", control=control)
        else:
            wanted = "--on-top-of" if described.compensation_active is True else "--template"
            control = next((name for name in described.controls if wanted in exporter(name).takes), "")
            if control:
                yield NextStep(code="export", control=control)
        yield NextStep(code="verify", control=control)
    else:
        yield NextStep(code="finish")


def _verdict(known: Estimation, volume: Sequence[Aim], lines: Sequence[Aim], rows: Sequence[KnownRow]) -> Verdict:
    """Return how it stands: of several accuracies of the volume one is enough, of rows all are wanted."""
    if not known.readings:
        return "nothing"
    if known.agreement.contradicts:
        return "contradict"
    if not (volume or lines):
        wanted = known.stated.description.target.wants
        return "unmeasured" if wanted and not all(row.measured for row in rows) else "measured"
    if all_reached(volume, lines):
        return "reached"
    return "unreachable" if unreachable(volume, lines) else "more"


def all_reached(volume: Sequence[Aim], lines: Sequence[Aim]) -> bool:
    """Return whether all rows are reached, and one of the accuracies of the volume if there are any."""
    return (not volume or any(aim.reached for aim in volume)) and all(aim.reached for aim in lines)


def unreachable(volume: Sequence[Aim], lines: Sequence[Aim]) -> list[Aim]:
    """Return what endless readings would not reach: of the volume the first, where none can be, and each such row."""
    hopeless = not any(aim.reached or aim.reachable for aim in volume)
    return [*(volume[:1] if hopeless else ()), *(aim for aim in lines if not aim.reachable)]


def _more(known: Estimation, volume: Sequence[Aim], lines: Sequence[Aim]) -> tuple[int, float]:
    """Return about how many readings are missing, and their minutes."""
    count = len(known.readings)
    left = [_share(aim) for aim in volume if aim.floor < aim.limit]
    shares = [min(left, default=0.0), *(_share(aim) for aim in lines if not aim.unread)]
    new = [aim.unread for aim in lines if aim.unread]
    readings = math.ceil(count * max(shares)) + _TARGETS * sum(new)
    each = float(np.median(np.diff([0.0, *known.timed.ends])))
    mounting = np.mean([setup.setup_time for setup in known.stated.description.setups])
    return readings, to_unit(readings * each + float(mounting) * sum(new), "min")


def _share(aim: Aim) -> float:
    """Return by which share of the readings taken there have to be more."""
    if aim.reached:
        return 0.0
    return max((aim.now**2 - aim.floor**2) / (aim.limit**2 - aim.floor**2) - 1, 0.0)


def aim_of_volume(wanted: WantedAccuracy, now: float) -> Aim:
    """Return an accuracy of the volume.  now : how well it is known, m"""
    now, limit, floor = (to_unit(size, "um") for size in (now, wanted.limit, wanted.floor))
    return Aim(name=wanted.name, now=now, limit=limit, floor=floor, reachable=floor <= limit)


def aim_of(row: KnownRow) -> Aim:
    """Return a row with a limit."""
    now, limit, floor = (to_unit(size, _unit(row)) for size in (row.known, row.limit or 0.0, row.floor))
    return Aim(
        name=row.row.name,
        now=now,
        limit=limit,
        floor=floor,
        measured=row.measured,
        reachable=row.reachable,
        unread=sum(not line.read for line in row.lines),
        unit=_unit(row),
    )


def _unit(row: KnownRow) -> str:
    return "urad" if row.angular else "um"


def _digits(value: float) -> float:
    return number(value, "a figure of the answer")


def known_figures(row: KnownRow, before: float) -> dict[str, Any]:
    """Return the figures of `PlannedRow`.  before : U before the first reading, m or rad"""
    sizes = {"known_to": row.known, "known_before": before, "floor": row.floor, "limit": row.limit}
    return {
        "row": row.row.name,
        "kind": row.row.kind,
        "axes": row.row.axes,
        "unit": _unit(row),
        **{name: None if size is None else _shown(row, size) for name, size in sizes.items()},
        "reached": row.reached,
        "measured": row.measured,
    }


def _shown(row: KnownRow, size: float) -> float:
    return _digits(to_unit(size, _unit(row)))


def _row(row: AnsweredRow, axes: Sequence[Axis]) -> AnswerRow:
    return AnswerRow(
        **known_figures(row, row.stated),
        found=_shown(row, row.found),
        largest=_shown(row, row.largest),
        left={name: _shown(row, size) for name, size in row.left.items()},
        one_more=None if row.then is None else _shown(row, row.then),
        lines=list(_lines(row.lines, axes)),
    )


def _lines(lines: Sequence[AxisLine], axes: Sequence[Axis]) -> Iterator[AnswerLine]:
    for line in lines:
        first, last = (shown_pose(axes, tuple(pose)) for pose in line.poses[[0, -1]].tolist())
        name = axes[line.axis].name
        first, last = ({each: coordinate(at, "an end of a row") for each, at in end.items()} for end in (first, last))
        yield AnswerLine(
            setup=line.setup,
            axis=name,
            ends=(first.pop(name), last[name]),
            at=first,
            places={"+": len(line.plus), "-": len(line.minus), "both": len(line.both)},
        )


def cost_words(campaign: Campaign, *, rest: bool) -> str:
    """Return what is lost, "" where nothing is: rows that stay unmeasured, and U of the volume with and without.

    rest : nothing more is read in the set-up that is asked for; else the one reading is left out
    """
    pending, planned = campaign.state.pending, campaign.state.coming
    if pending is None:
        return ""
    kept = tuple(place for place in planned[1:] if not (rest and place.setup == pending.place.setup))
    with_it, without = (_rows(campaign, places) for places in (planned, kept))
    lost = [row for row, after in zip(with_it, without, strict=True) if row.measured and not after.measured]
    names = [row_name(row.row.kind, [row.row.axes]) for row in lost]
    parts = [said("leaves {rows} unmeasured", rows=listed(", ", names))] if names else []
    volume = next((n for n, row in enumerate(with_it) if row.row.kind == "volume"), None)
    if volume is not None and without[volume].known > _COSTS * with_it[volume].known:
        sizes = (to_unit(rows[volume].known, "um") for rows in (with_it, without))
        before, after = (digits(size) for size in sizes)
        parts.append(said("volume {before} → {after} um", before=before, after=after))
    return listed("; ", parts) if parts else ""


def cost_sentence(words: str) -> str:
    """Return what is said before it is done.  words : of `cost_words`"""
    return put("{words}.", words=words) if words else said("By the plan as it stands this costs nothing.")


def _rows(campaign: Campaign, places: Sequence[Place]) -> tuple[KnownRow, ...]:
    """Return how well rows will be known after these places."""
    known = campaign.estimate()
    coming = blank_readings(known.case.description.setups, places)
    return known_rows(known.case, known.printed.read(coming), [*known.readings, *coming])
