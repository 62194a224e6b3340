"""The document of a check, `axiscal-verify/1`: codes and numbers, um; and its words for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from pydantic import Field

from axiscal.answers.answer import AnswerDocument, TablesChecked, finite
from axiscal.answers.answer_words import VERDICTS, farthest_words, sizes_words, wrapped
from axiscal.answers.row_words import row_name
from axiscal.evaluation.check import Check
from axiscal.evaluation.datums import GUARD
from axiscal.evaluation.table_checks import WORKS, Decision, Judgement, Verdict
from axiscal.language.spoken import counted, later, listed, put, quoted, said
from axiscal.measurement.reading import Places, approach_text, place_text, shown_pose
from axiscal.numerics import Array
from axiscal.units import digits, to_unit
from axiscal_core.ties import ALIKE, first_best

_NEAR = 0.3
"""Of the change that tables should make: this near to all, none or the opposite, it is called that."""

_ROUNDING = 1e-6
"""A figure below a picometre, in um."""


_DECISIONS: Mapping[Decision, str] = {
    "conform": later("kept: every deviation lies inside, with its uncertainty"),
    "not conform": later("not kept: a deviation lies outside, with all of its uncertainty"),
    "neither": later("undecided: a deviation lies nearer to it than the readings can tell"),
}
_WHY: Mapping[Verdict, str] = {
    "promised": later("the readings lie no farther from the estimate than its uncertainty and their noise explain"),
    "worse": later(
        "the readings lie farther from the estimate than its uncertainty and their noise explain (p = {p:.2g}): the "
        "machine has changed, or it was known less well than stated"
    ),
    "faulty": later("not as exported: {tables}"),
    "undecided": later(
        "the readings contradict what is said of the tables or the set-ups: see the warning, and read again"
    ),
}
_COVERAGE = 2.0
"""k of the uncertainty that is stated beside a decision, as certificates do."""
_LINES = 12
"""Lines of a screen above what comes next."""


class CheckedValue(AnswerDocument):
    """One value of a reading: without the tables, with them, and the standard uncertainty of the latter."""

    found_um: float
    left_um: float
    std_um: float


class TableShare(AnswerDocument):
    """How much of a table the readings show, None where they cannot tell; size : what it corrects at most, as text."""

    table: str
    share: float | None
    share_std: float | None
    checked: bool
    works: bool
    size: str


class SetupOff(AnswerDocument):
    """A set-up and the unknown of it that is farther off than stated."""

    setup: str
    unknown: str


class CheckAnswer(AnswerDocument):
    """What a check says; fields as of `evaluation.table_checks.Judgement`.

    decision : what the as-left readings prove of the tolerance, by ISO 14253-1, None without one
    U_um : largest of theirs, k = 2
    expected_um : U over the volume with the tables loaded; tolerance_um : None where nobody states one
    places : how many were read, each without the tables and with them
    found_rms_um, left_rms_um : over the places, in space where a reading has three values
    left_expected_um : the latter as promised, with the noise of the readings
    promise_p : probability of readings at least as far from the promise as these
    farthest_um, farthest_at : the largest deviation left, and where, in mm and deg by axis
    """

    kind: Literal["axiscal-verify/1"] = Field("axiscal-verify/1", alias="schema")
    verdict: Verdict
    decision: Decision | None
    U_um: float
    expected_um: float
    tolerance_um: float | None
    guard_band_um: float
    places: int
    found_rms_um: float
    left_rms_um: float
    left_expected_um: float
    promise_p: float
    farthest_um: float
    farthest_at: Mapping[str, float]
    readings: Sequence[CheckedValue]
    change_p: float
    change_share: float | None
    tables_loaded: bool
    against_own_line: Sequence[str]
    against_own_tool: Sequence[str]
    set_up_still: Sequence[str]
    tables: Sequence[TableShare]
    not_checked: Sequence[str]
    axes_not_checked: Sequence[str]
    set_up_off: Sequence[SetupOff]

    @property
    def faulty(self) -> list[TableShare]:
        """The tables that are missing, or loaded with the wrong sign."""
        return [each for each in self.tables if each.checked and not each.works]

    @property
    def working(self) -> bool:
        """Whether the readings show a table, each that they show works, and nothing contradicts them."""
        contradicted = self.set_up_off or self.set_up_still or not self.tables_loaded or self.faulty
        return not contradicted and any(each.checked for each in self.tables)

    @property
    def summary(self) -> TablesChecked:
        """What the last screen of a campaign says of it."""
        return TablesChecked(
            places=self.places,
            found=self.found_rms_um,
            left=self.left_rms_um,
            expected=self.left_expected_um,
            farthest=self.farthest_um,
            at=self.farthest_at,
            verdict=self.verdict,
        )


def check_answer(judgement: Judgement, places: Sequence[Mapping[str, float]], promised: float) -> CheckAnswer:
    """Return what was judged as a document.

    places : where was read each way; promised : U with the tables, m
    """
    figures = (judgement.found, judgement.left, judgement.std)
    found, left, std = (plain(to_unit(values, "um")) for values in figures)
    rows = zip(found.tolist(), left.tolist(), std.tolist(), strict=True)
    away = np.sqrt(np.bincount(judgement.of, left**2))
    worst = first_best(away, ALIKE)
    return CheckAnswer(
        verdict=judgement.verdict,
        decision=judgement.decision,
        U_um=_COVERAGE * float(std.max()),
        expected_um=to_unit(promised, "um"),
        tolerance_um=None if judgement.tolerance is None else to_unit(judgement.tolerance, "um"),
        guard_band_um=GUARD * float(std.max()),
        places=len(places),
        found_rms_um=float(np.sqrt(np.sum(found**2) / len(places))),
        left_rms_um=float(np.sqrt(np.sum(left**2) / len(places))),
        left_expected_um=to_unit(float(np.sqrt(judgement.coming / len(places))), "um"),
        promise_p=judgement.agrees,
        farthest_um=float(away[worst]),
        farthest_at=places[worst],
        readings=[CheckedValue(found_um=f, left_um=after, std_um=s) for f, after, s in rows],
        change_p=judgement.changed,
        change_share=judgement.share,
        tables_loaded=judgement.loaded,
        against_own_line=judgement.lines,
        against_own_tool=judgement.tools,
        set_up_still=judgement.still,
        tables=[
            TableShare(
                table=share.name,
                share=share.value if np.isfinite(share.std) else None,
                share_std=finite(share.std),
                checked=share.checked,
                works=share.works,
                size=share.size,
            )
            for share in judgement.shares
        ],
        not_checked=[share.name for share in judgement.shares if not share.checked],
        axes_not_checked=judgement.idle,
        set_up_off=[SetupOff(setup=datum.setup, unknown=datum.unknown) for datum in judgement.strained],
    )


def plain(micrometres: Array) -> Array:
    """Return figures with mere rounding as 0 (and never as −0)."""
    return np.where(np.abs(micrometres) < _ROUNDING, 0.0, micrometres)


def check_plan(check: Check, places: Places) -> tuple[dict[str, object], list[str]]:
    """Return places with what each is expected to show, as a document; in words what each set-up shows at the most.

    plan : of each place, three figures where a reading has three values
    passed_over, read_again : set-ups of the campaign without new places, not read or read where the campaign has
    """
    setups, axes = check.description.setups, check.description.machine.axes
    predicted = [[plain(to_unit(values, "um")) for values in each] for each in check.predicted(places)]
    listed_places, rows = places.listed(setups), list[dict[str, object]]()
    for place, *figures in zip(listed_places, *predicted, strict=True):
        found, left = (each.tolist() if len(each) > 1 else float(each[0]) for each in figures)
        rows.append(
            {
                "setup": place.setup,
                "place": place_text(axes, place.pose, check.description.setup(place.setup).moves),
                "position": shown_pose(axes, place.pose),
                "approach": approach_text(axes, place.approach),
                "found_um": found,
                "left_um": left,
            }
        )
    lines, planned = [counted("{count} PLACE TO CHECK", "{count} PLACES TO CHECK", len(rows))], list[str]()
    for setup in dict.fromkeys(place.setup for place in listed_places):
        mine = [n for n, place in enumerate(listed_places) if place.setup == setup]
        found, left = (digits(max(float(np.abs(each[n]).max()) for n in mine)) for each in predicted)
        read = counted("{count} place", "{count} places", len(mine))
        words = '"{setup}": {places}, predicted up to {found} um as found, {left} um as left'
        lines.append(said(words, setup=setup, places=read, found=found, left=left))
        planned.append(setup)
    used = {reading.setup for reading in check.used}
    unread = [setup.name for setup in setups if setup.name in used and setup.name not in planned]
    again = [setup.name for setup in setups if setup.name in check.exhausted.intersection(planned)]
    missing, same = (listed(", ", [quoted(name) for name in names]) for names in (unread, again))
    if unread:
        lines.append(said("Not checked, for want of new places: {setups}.", setups=missing))
    if again:
        words = "Read again at the same places, for want of new ones: {setups}. This tells whether the tables work."
        lines.append(said(words, setups=same))
    return {"plan": rows, "passed_over": unread, "read_again": again}, lines


def check_screen(answer: CheckAnswer) -> list[str]:
    """Return what was judged in so few lines that a screen holds them, next to what comes next."""
    lines = [shown for line in check_sentences(answer) for shown in wrapped(line)]
    if len(lines) <= _LINES:
        return lines
    return [*lines[: _LINES - 1], said("The rest: --details.")]


def check_sentences(answer: CheckAnswer) -> list[str]:
    """Return what was judged, the verdict first: promise, tables, a stated tolerance; and what was not checked."""
    tables, verdict = listed(", ", [each.table for each in answer.faulty]), said(VERDICTS[answer.verdict])
    lines = [
        said("{verdict}: {why}.", verdict=verdict, why=said(_WHY[answer.verdict], tables=tables, p=answer.promise_p)),
        put("{sizes}. {farthest}", sizes=sizes_words(answer.summary), farthest=farthest_words(answer.summary)),
    ]
    if answer.working:
        shown = sum(each.checked for each in answer.tables)
        lines.append(counted("The table that they show works.", "All {count} tables that they show work.", shown))
    if answer.tolerance_um is not None and answer.decision is not None:
        proved = "Tolerance of {tolerance:.3g} um (ISO 14253-1, guard band {guard:.3g} um): {decision}."
        sizes = {"tolerance": answer.tolerance_um, "guard": answer.guard_band_um}
        lines.append(said(proved, decision=said(_DECISIONS[answer.decision]), **sizes))
    axes = answer.axes_not_checked
    names = [row_name("positioning", [[name] for name in axes])] if axes else []
    open_ones = [each for each in answer.tables if not each.checked]
    names += [said("table {table} ({size} at most)", table=each.table, size=each.size) for each in open_ones]
    unchecked = [said("Not checked: {others}.", others=listed(", ", names))] if names else []
    return [*lines, *_warnings(answer), *unchecked]


def check_details(answer: CheckAnswer) -> list[str]:
    """Return all that was judged in words, with what it proves."""
    known = "A reading has U = {u:.3g} um (k = 2); U = {promised:.3g} um (95 %) is to be expected over the volume."
    return [*check_sentences(answer), said(known, u=answer.U_um, promised=answer.expected_um)]


def _warnings(answer: CheckAnswer) -> list[str]:
    own_line = '"{name}" is judged against its own line: its slope is not known to the tolerance.'
    own_tool = (
        '"{name}" is judged with its tool where the readings put it: nobody knows to the tolerance where it sits, and '
        "what looks like a tool that sits elsewhere is not judged."
    )
    shown = "WARNING: of the table {table} the readings show {share:.2f} ({std:.2f}) times what it takes away: {cause}."
    off = (
        'WARNING: the {unknown} of "{setup}" would have to be far larger than its std says: the set-up moved, or the '
        "machine has an error that looks like it."
    )
    still = (
        'WARNING: all as-left readings of "{name}" are one and the same number: the instrument does not move, or its '
        "resolution is coarser than its noise."
    )
    lines = [said(own_line, name=name) for name in answer.against_own_line]
    lines += [said(own_tool, name=name) for name in answer.against_own_tool]
    for each in answer.faulty:
        share, wrong = each.share or 0.0, "it was loaded with the wrong sign"
        cause = said(wrong if share < -WORKS else "it was not loaded")
        lines.append(said(shown, table=each.table, share=share, std=each.share_std or 0.0, cause=cause))
    if not answer.tables_loaded:
        found = answer.change_share
        changed = "" if found is None else said(", they changed by {share:.2f} times that", share=found)
        lines.append(
            said(
                "WARNING: as found minus as left is not what the tables take away (p = {p:.2g}{share}): {cause}.",
                p=answer.change_p,
                share=changed,
                cause=said(_cause(found)),
            )
        )
    lines += [said(off, unknown=datum.unknown, setup=datum.setup) for datum in answer.set_up_off]
    return [*lines, *(said(still, name=name) for name in answer.set_up_still)]


def _cause(share: float | None) -> str:
    """Return the most probable cause.  share : change of the readings divided by what the tables take away"""
    if share is None:
        return later("the tables hold nothing here, and yet the readings changed")
    if abs(share + 1) < _NEAR:
        return later("the tables were loaded with the wrong sign, or the files of before and after are swapped")
    if abs(share) < _NEAR:
        return later("the tables were not loaded, or it is another machine")
    if abs(share - 1) < _NEAR:
        return later("the machine or a set-up moved between the two, or single values are wrong")
    return later("the tables were not loaded, loaded with the wrong sign or unit, or it is another machine")
