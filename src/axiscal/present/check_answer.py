"""The document of a check, `axiscal-verify/1`: codes and numbers, um; and its words for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from axiscal.evaluation.check import Check
from axiscal.evaluation.datums import GUARD
from axiscal.evaluation.table_checks import WORKS, Decision, Judgement, Verdict
from axiscal.language.spoken import WORDS, counted, listed, put, quoted, said
from axiscal.measurement.reading import Places, approach_text, place_text, shown_pose
from axiscal.numerics import Array
from axiscal.present.answer import TablesChecked
from axiscal.present.answer_words import VERDICTS, farthest_words, sizes_words, wrapped
from axiscal.present.row_words import row_name
from axiscal.units import digits, to_unit
from axiscal_core.ties import ALIKE, first_best

_NEAR = 0.3
"""Of the change that tables should make: this near to all, none or the opposite, it is called that."""

_ROUNDING = 1e-6
"""A figure below a picometre, in um."""


_DECISIONS: Mapping[Decision, str] = WORDS["check"]["decisions"]
_WHY: Mapping[Verdict, str] = WORDS["check"]["why"]
_COVERAGE = 2.0
"""k of the uncertainty that is stated beside a decision, as certificates do."""
_LINES = 12
"""Lines of a screen above what comes next."""


def tables_checked(judged: Judgement) -> TablesChecked:
    """Return what the last screen of a campaign says of a check."""
    found, left = plain(to_unit(judged.found, "um")), plain(to_unit(judged.left, "um"))
    away = np.sqrt(np.bincount(judged.of, left**2))
    worst, count = first_best(away, ALIKE), len(judged.places)
    return TablesChecked(
        places=count,
        found=float(np.sqrt(np.sum(found**2) / count)),
        left=float(np.sqrt(np.sum(left**2) / count)),
        expected=to_unit(float(np.sqrt(judged.coming / count)), "um"),
        farthest=float(away[worst]),
        at=judged.places[worst],
        verdict=judged.verdict,
    )


def _band(judged: Judgement) -> float:
    """Return U of a reading without its factor: the largest standard uncertainty of the as-left ones, um."""
    return float(to_unit(judged.std.max(), "um"))


def check_document(judged: Judgement) -> dict[str, object]:
    """Return all of a check, um; `U_um` with k = 2, null for a share that nobody knows."""
    over = tables_checked(judged)
    each = zip(*(plain(to_unit(some, "um")).tolist() for some in (judged.found, judged.left, judged.std)), strict=True)
    shares = [(share, bool(np.isfinite(share.std))) for share in judged.shares]
    return {
        "schema": "axiscal-verify/1",
        "verdict": judged.verdict,
        "decision": judged.decision,
        "U_um": _COVERAGE * _band(judged),
        "expected_um": to_unit(judged.promised, "um"),
        "tolerance_um": None if judged.tolerance is None else to_unit(judged.tolerance, "um"),
        "guard_band_um": GUARD * _band(judged),
        "places": over.places,
        "found_rms_um": over.found,
        "left_rms_um": over.left,
        "left_expected_um": over.expected,
        "promise_p": judged.agrees,
        "farthest_um": over.farthest,
        "farthest_at": over.at,
        "readings": [{"found_um": found, "left_um": left, "std_um": std} for found, left, std in each],
        "change_p": judged.changed,
        "change_share": judged.share,
        "tables_loaded": judged.loaded,
        "against_own_line": judged.lines,
        "against_own_tool": judged.tools,
        "set_up_still": judged.still,
        "tables": [
            {
                "table": share.name,
                "share": share.value if known else None,
                "share_std": share.std if known else None,
                "checked": share.checked,
                "works": share.works,
                "size": share.size,
            }
            for share, known in shares
        ],
        "not_checked": [share.name for share in judged.shares if not share.checked],
        "axes_not_checked": judged.idle,
        "set_up_off": [{"setup": datum.setup, "unknown": datum.unknown} for datum in judged.strained],
    }


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


def check_screen(judged: Judgement) -> list[str]:
    """Return what was judged in so few lines that a screen holds them, next to what comes next."""
    lines = [shown for line in check_sentences(judged) for shown in wrapped(line)]
    if len(lines) <= _LINES:
        return lines
    return [*lines[: _LINES - 1], said("The rest: --details.")]


def check_sentences(judged: Judgement) -> list[str]:
    """Return what was judged, the verdict first: promise, tables, a stated tolerance; and what was not checked."""
    checked, verdict = tables_checked(judged), said(VERDICTS[judged.verdict])
    tables = listed(", ", [share.name for share in judged.faulty])
    lines = [
        said("{verdict}: {why}.", verdict=verdict, why=said(_WHY[judged.verdict], tables=tables, p=judged.agrees)),
        put("{sizes}. {farthest}", sizes=sizes_words(checked), farthest=farthest_words(checked)),
    ]
    shown = sum(share.checked for share in judged.shares)
    if shown and not (judged.strained or judged.still or not judged.loaded or judged.faulty):
        lines.append(counted("The table that they show works.", "All {count} tables that they show work.", shown))
    if judged.tolerance is not None and judged.decision is not None:
        proved = "Tolerance of {tolerance:.3g} um (ISO 14253-1, guard band {guard:.3g} um): {decision}."
        sizes = {"tolerance": to_unit(judged.tolerance, "um"), "guard": GUARD * _band(judged)}
        lines.append(said(proved, decision=said(_DECISIONS[judged.decision]), **sizes))
    names = [row_name("positioning", [[name] for name in judged.idle])] if judged.idle else []
    open_ones = [share for share in judged.shares if not share.checked]
    names += [said("table {table} ({size} at most)", table=share.name, size=share.size) for share in open_ones]
    unchecked = [said("Not checked: {others}.", others=listed(", ", names))] if names else []
    return [*lines, *_warnings(judged), *unchecked]


def check_details(judged: Judgement) -> list[str]:
    """Return all that was judged in words, with what it proves."""
    known = "A reading has U = {u:.3g} um (k = 2); U = {promised:.3g} um (95 %) is to be expected over the volume."
    promised = to_unit(judged.promised, "um")
    return [*check_sentences(judged), said(known, u=_COVERAGE * _band(judged), promised=promised)]


def _warnings(judged: Judgement) -> Iterator[str]:
    words, causes = WORDS["check"]["warnings"], WORDS["check"]["causes"]
    for kind, names in (("line", judged.lines), ("tool", judged.tools)):
        yield from (said(words[kind], name=name) for name in names)
    for share in judged.faulty:
        cause = said(causes["wrong_sign" if share.value < -WORKS else "not_loaded"])
        yield said(words["table"], table=share.name, share=share.value, std=share.std, cause=cause)
    if not judged.loaded:
        times = judged.share
        changed = "" if times is None else said(words["changed"], share=times)
        yield said(words["tables"], p=judged.changed, share=changed, cause=said(causes[_cause(times)]))
    yield from (said(words["off"], unknown=datum.unknown, setup=datum.setup) for datum in judged.strained)
    yield from (said(words["still"], name=name) for name in judged.still)


def _cause(share: float | None) -> str:
    """Return the most probable cause.  share : change of the readings divided by what the tables take away"""
    if share is None:
        return "empty"
    return next((cause for near, cause in _NEAREST.items() if abs(share - near) < _NEAR), "other")


_NEAREST = {-1.0: "reversed", 0.0: "none", 1.0: "moved"}
"""By definition: the opposite of what tables take away, nothing of it, all of it."""
