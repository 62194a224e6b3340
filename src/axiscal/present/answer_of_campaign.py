"""From what is known to the answer: rows, what was asked for, and what is missing.

Let an accuracy be U after n readings, L as wanted, F after endless ones. About n (U² − F²)/(L² − F²) readings reach L,
no more than places spread evenly do. A backlash that one side was read of begins with U after one from the other.

A row is found and left as √(estimate² + u²) and √((what the tables leave)² + u²), both RMS over its places.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.evidence import overruled
from axiscal.estimation.accuracy.expanded import asked, known_to
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import AskedRow, asked_rows, offset_each
from axiscal.estimation.functionals.functional import AxisLine
from axiscal.estimation.known_rows import KnownRow, known_row, known_rows
from axiscal.exceptions import ReadingError, TableError
from axiscal.language.spoken import listed, put, said
from axiscal.measurement.reading import shown_pose
from axiscal.measurement.reading_rows import blank_readings
from axiscal.numerics import Array
from axiscal.present.answer import (
    Aim,
    AnswerLine,
    AnswerRow,
    NextStep,
    Outcome,
    SignedNumber,
    StepCode,
    TablesChecked,
    Verdict,
)
from axiscal.present.bed_screws import screw_turns
from axiscal.present.row_words import one_sided, row_name
from axiscal.tables.offer import places
from axiscal.tables.registry import controllers, exporter, offered
from axiscal.tables.surface import Control, left_by, turned_by
from axiscal.units import digits, to_unit
from axiscal_core.axes import Axis
from axiscal_core.normal import Normal
from axiscal_core.threads import one_thread

_COSTS = 1.01
"""By less than a percent more of the volume's U nothing is lost that is worth a sentence."""

_TARGETS = 5
"""Readings that a line asks for of which there are none: ISO 230-2 wants five targets at least."""


Answered = Sequence[tuple[KnownRow, AnswerRow]]
"""How well each row is known, and what is said of it."""


@one_thread()
def answered(known: Estimation, controls: Mapping[str, Control]) -> Answered:
    """Return the rows of a campaign.  controls : what the tables of each control that is offered do"""
    described, prior = known.stated.description, known.without_readings
    asked = asked_rows(described, known.readings, whole=bool(described.target.lines))
    belief, read = known.printed.belief, bool(known.readings)
    found = [(each, known_row(each, known.case, belief, read, prior)) for each in asked]
    return [(row, _answered(each, row, known, controls)) for each, row in found if row.described]


def _answered(asked: AskedRow, row: KnownRow, known: Estimation, controls: Mapping[str, Control]) -> AnswerRow:
    """Return a row along lines, or that of the volume."""
    estimate, errors, belief, functional = known.estimate(), known.case.errors, known.printed.belief, asked.own
    shown: Callable[[Array], Array]
    if functional is None:
        where, dimensions = places(estimate), sum(estimate.counted)
        variances, shown = np.array(estimate.unknown.rms**2), partial(estimate.counting, where[0])
    else:
        where, dimensions, shown = (functional.poses, functional.sides), functional.dimensions, functional.row
        variances = functional.spectra(errors, belief.factor).sum(axis=1)
    if functional is not None and functional.angular:
        at, left = functional.rows(errors) @ estimate.mean, dict[str, Array]()
        if row.row.kind in ("positioning", "backlash"):  # which tables of the axis itself take away
            turns = partial(turned_by, estimate.machine, estimate.rotation)
            left = {name: shown(turns(each, *where)) for name, each in controls.items()}
    else:
        after = partial(left_by, estimate.machine, estimate.deviation)
        at = shown(estimate.deviation(*where))
        left = {name: shown(after(each, *where)) for name, each in controls.items()}

    def size(values: Array, of: Callable[[Array], Any]) -> float:
        """Return the mean or largest size of vectors of a row, with what is not known of it, as the row is shown."""
        squares = np.sum(values.reshape(-1, dimensions) ** 2, axis=1) + variances
        return to_unit(float(np.sqrt(of(squares))), row.unit)

    signed = () if functional is None else functional.signed(at, errors, belief)
    return AnswerRow(
        **known_figures(row, known.stated.description.machine.axes),
        found=size(at, np.mean),
        largest=size(at, np.max),
        left={name: size(each, np.mean) for name, each in left.items()},
        signed=[
            SignedNumber(direction=name, value=to_unit(value, row.unit), U=to_unit(u, row.unit))
            for name, value, u in signed
        ],
    )


class Aims(NamedTuple):
    """What is asked for: accuracies of the volume, of which one is enough, and limits of lines, which all count."""

    volume: list[Aim]
    lines: list[Aim]

    @classmethod
    def from_case(cls, case: Case, belief: Normal, endless: Yardstick, rows: Sequence[KnownRow]) -> Aims:
        """Return what the target asks for and how well a belief knows it.  endless : what readings without end leave"""
        volume = list[Aim]()
        for name, *sizes in asked(case.description.target, endless):
            limit, floor, now = (to_unit(size, "um") for size in (*sizes, known_to(name, case.yardstick, belief)))
            volume.append(Aim(name=name, now=now, limit=limit, floor=floor, reachable=floor <= limit))
        lines = [_aim(row, row.limit) for row in rows if row.limit is not None and row.row.kind != "volume"]
        return cls(volume, lines)

    @property
    def met(self) -> bool:
        """Whether all rows are reached, and one of the accuracies of the volume if there are any."""
        return (not self.volume or any(aim.reached for aim in self.volume)) and all(aim.reached for aim in self.lines)

    @property
    def hopeless(self) -> list[Aim]:
        """What endless readings would not reach: of the volume the first, where none can be, and each such row."""
        hopeless = not any(aim.reached or aim.reachable for aim in self.volume)
        return [*(self.volume[:1] if hopeless else ()), *(aim for aim in self.lines if not aim.reachable)]


def _aim(row: KnownRow, most: float) -> Aim:
    now, limit, floor = (to_unit(size, row.unit) for size in (row.known, most, row.floor))
    return Aim(
        name=row.row.name,
        now=now,
        limit=limit,
        floor=floor,
        measured=row.measured,
        reachable=row.reachable,
        unread=sum(not line.read for line in row.lines),
        unit=row.unit,
    )


def answer_of(
    campaign: Campaign,
    known: Estimation,
    controls: Mapping[str, Control],
    *,
    written: bool = False,
    anyway: bool = False,
    checked: TablesChecked | None = None,
) -> Outcome:
    """Return the answer.

    controls : what the tables of each control that is offered do; written : whether the results are, with these tables
    anyway : rows are there although readings contradict each other; checked : what a check of them found
    """
    found = answered(known, controls)
    rows, shown = [row for row, _ in found], [row for _, row in found]
    aims = Aims.from_case(known.case, known.printed.belief, known.case.yardstick_as_sized, rows)
    coming = campaign.state.coming if campaign.state.finished is None else ()
    verdict = _verdict(known, aims, rows)
    more, minutes = missing_readings(known, aims, found) if verdict == "more" and not coming else (0, 0.0)
    if verdict == "more" and not coming and not more:
        verdict = "unreachable"
    if coming and verdict in ("measured", "unmeasured", "more"):
        verdict, more, minutes = "more", len(coming), to_unit(campaign.seconds(coming) - campaign.seconds(), "min")
    seconds = known.timed.seconds if campaign.state.clocked is None else campaign.state.clocked
    offset = offset_each(known.stated.description)
    withheld = known.agreement.withheld and not anyway
    parts = () if withheld or verdict in ("more", "nothing") else known.estimate().half_read
    return Outcome(
        verdict=verdict,
        rows=[] if withheld else shown,
        aims=[*aims.volume, *aims.lines],
        more=more,
        more_minutes=minutes,
        readings=len(known.readings),
        left_out=len(known.outliers),
        compared=known.agreement.count,
        agreeing=known.agreement.agreeing,
        checks=len(known.checks.each),
        as_promised=known.checks.as_promised,
        minutes=to_unit(seconds, "min"),
        clocked=campaign.state.clocked is not None,
        withheld=withheld,
        checked=checked,
        steps=list(_steps(campaign, known, verdict, best_control(shown, list(controls)), written)),
        offset=None if offset is None else to_unit(offset, "um"),
        half_read={axis.name: (to_unit(ends[0], axis.unit), to_unit(ends[1], axis.unit)) for axis, ends in parts},
        screws=[] if withheld else screw_turns(known),
        overruled=overruled(campaign.state.notes),
        asks=bool(known.agreement.explained) and not known.agreement.contradicts,
    )


def standing_answer(campaign: Campaign) -> Outcome:
    """Return the answer of a campaign as it stands, with what tables would leave that are made of it."""
    known = campaign.so_far()
    written = campaign.state.finished is not None and (results_of(campaign.path) / "result.json").exists()
    return answer_of(campaign, known, {} if known.agreement.withheld else dict(_controls(known)), written=written)


def advised_control(campaign: Campaign) -> str:
    """Return the control of the campaign whose tables leave the least, "csv" where it has none."""
    known = campaign.so_far()
    controls = dict(_controls(known))
    return best_control([row for _, row in answered(known, controls)], list(controls)) or "csv"


def results_of(record: Path) -> Path:
    """Return the folder of the results of a record: the one that it lies in with them, else the one beside it."""
    return record.parent if record.with_name("result.json").exists() else results_beside(record)


def results_beside(record: Path) -> Path:
    """Return the folder for the results of a record, beside it."""
    return record.with_name(f"{record.stem}-results")


def _controls(known: Estimation) -> Iterator[tuple[str, Control]]:
    """Yield each control of the campaign with what its tables do, those left out that cannot be made."""
    for name in known.case.description.controls if known.readings else ():
        with suppress(TableError, ReadingError):
            yield name, offered(known, name).control


def best_control(rows: Sequence[AnswerRow], names: Sequence[str]) -> str:
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
        full = campaign.description.target.taken(len(campaign.state.readings)) is not None
        reading: StepCode = "next" if full else "measure"
        yield NextStep(code="accept", mistake=explained[0].mistake) if explained else NextStep(code=reading)
    elif written:
        if control:
            yield NextStep(code="load", control=control)
        else:
            wanted = "--on-top-of" if described.compensation_active is True else "--template"
            known_here = (name for name in described.controls if name in controllers())
            control = next((name for name in known_here if wanted in exporter(name).takes), "")
            if control:
                yield NextStep(code="export", control=control)
        with suppress(TableError, ReadingError):  # without a table there is nothing to check
            if not control:
                offered(known, "csv")
            yield NextStep(code="verify", control=control)
    else:
        yield NextStep(code="finish")


def _verdict(known: Estimation, aims: Aims, rows: Sequence[KnownRow]) -> Verdict:
    """Return how it stands: of several accuracies of the volume one is enough, of rows all are wanted."""
    target = known.stated.description.target
    if not known.readings:
        return "nothing"
    if known.agreement.contradicts:
        return "contradict"
    if not any(aims):
        return "unmeasured" if target.wants and not all(row.measured for row in rows) else "measured"
    if aims.met and not (target.lines and any(row.open for row in rows)):
        return "reached"
    return "unreachable" if aims.hopeless else "more"


def missing_readings(known: Estimation, aims: Aims, rows: Answered) -> tuple[int, float]:
    """Return about how many readings are missing, one at least, and their minutes; noughts where no number helps."""
    count = len(known.readings)
    left = [aim.missing for aim in aims.volume if aim.floor < aim.limit]
    turned = {row.row for _, row in rows if one_sided(row) and aims.lines}  # one reading from the other side does
    lines = (aim.missing for aim in aims.lines if not aim.unread and aim.name not in turned)
    shares = [min(left, default=0.0), *lines]
    new = sum(not line.read for row, _ in rows if row.open for line in row.lines) if aims.lines else 0
    readings = max(math.ceil(count * max(shares)) + _TARGETS * new + len(turned), 1)
    if readings > count:
        from axiscal.planning.enough import evenly_until_reached  # whoever is nearly there need not load it

        readings = evenly_until_reached(known.case, known.readings, readings)
    described, ends = known.stated.description, known.timed.ends
    mounted = described.setup(known.readings[0].setup).setup_time
    each = float(np.median(np.diff([min(mounted, ends[0]), *ends])))
    mounting = np.mean([setup.setup_time for setup in described.setups])
    return readings, to_unit(readings * each + float(mounting) * new, "min") if readings else 0.0


def known_figures(row: KnownRow, axes: Sequence[Axis]) -> dict[str, Any]:
    """Return the figures of `PlannedRow`.  axes : of the machine"""
    sizes = {"known_to": row.known, "known_before": row.before, "floor": row.floor, "limit": row.limit}
    return {
        "row": row.row.name,
        "kind": row.row.kind,
        "axes": row.row.axes,
        "unit": row.unit,
        **{name: None if size is None else to_unit(size, row.unit) for name, size in sizes.items()},
        "reached": row.reached,
        "measured": row.measured,
        "lines": [_line(line, axes) for line in row.lines],
    }


def _line(line: AxisLine, axes: Sequence[Axis]) -> AnswerLine:
    name, ends = axes[line.axis].name, (shown_pose(axes, tuple(pose)) for pose in line.poses[[0, -1]].tolist())
    first, last = ends
    places = {"+": len(line.plus), "-": len(line.minus), "both": len(line.both)}
    return AnswerLine(setup=line.setup, axis=name, ends=(first.pop(name), last[name]), at=first, places=places)


def cost_words(campaign: Campaign, *, rest: bool) -> str:
    """Return what is lost, "" where nothing is: rows that stay unmeasured, and U of the volume with and without.

    rest : nothing more is read in the set-up that is asked for; else the one reading is left out
    """
    pending, planned = campaign.state.pending, campaign.state.coming
    if pending is None:
        return ""
    kept = tuple(place for place in planned[1:] if not (rest and place.setup == pending.place.setup))
    known = campaign.estimate()
    blanks = (blank_readings(known.case.description.setups, places) for places in (planned, kept))
    with_it, without = (known_rows(known.case, known.printed.read(each), [*known.readings, *each]) for each in blanks)
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
