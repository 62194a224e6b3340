"""The page of a study: which set-up pays, in words first; then accuracy against time, and every way in a table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from axiscal.answers.answer import number
from axiscal.ports.study.comparing import (
    ChoiceChange,
    Mean,
    MeasuringWay,
    Quartiles,
    changes,
    unbeaten,
    verdicts,
    ways_of,
)
from axiscal.ports.study.study_case import FIGURES, Done
from axiscal.ports.study.study_file import Study
from axiscal.present.drawing.svg_picture import SYMBOLS, Figure, axis_style, colour, layout, line_trace, shown
from axiscal.present.sentences import figure, page_of, short

_HEIGHT = 360
"""Pixels; a matter of taste."""
_MOST_FAILED = 50
"""Failed cases that the page names; the table has all."""
_SPREADS = ("readings", "minutes")
_TABLED = [name for name in FIGURES if name not in ("agreement", "said")]
"""Figures that a table of ways can show: numbers."""
_CHANGED = (*_SPREADS, "U", "rms", "true_rms")
_SHARES = ("within_U", "coverage_curves", "coverage_tcp", "reached")


def render(study: Study, found: Mapping[str, Done]) -> str:
    """Return the page as self-contained HTML.  found : what came of the cases, by their keys"""
    ways = ways_of(study, found)
    title = f"{FIGURES['U'].words} against {FIGURES['minutes'].words}"
    failed = [(key, done.error) for key, done in sorted(found.items()) if done.result is None]
    return page_of(
        "axiscal.ports.study",
        "study.html",
        title=f"Which set-up pays: {study.source.stem}",
        sentences=verdicts(study, ways),
        pictures=[{"title": title, "svg": shown(against(ways), title)}],
        legend=[{"name": way.name, "colour": colour(index)} for index, way in enumerate(ways)],
        columns=[_short_heading(name) for name in _TABLED],
        rows=[[way.name, *(_cell(way, name) for name in _TABLED)] for way in ways],
        changed=[_short_heading(name) for name in _CHANGED],
        changes=[_change_row(change) for change in changes(study, ways)],
        failed=failed[:_MOST_FAILED],
        more=max(0, len(failed) - _MOST_FAILED),
        missing=study.count - len(found),
    )


def against(ways: Sequence[MeasuringWay]) -> Figure:
    """Return one mark for each way: median of the minutes, mean and quartiles of U."""
    joined = sorted((at for way in unbeaten(ways) if (at := _at(way))), key=lambda at: at[0])
    traces = [line_trace([x for x, _ in joined], [y for _, y in joined], "var(--rule)", 1.5, "dot")]
    for index, way in enumerate(ways):
        spread, at = way.spread("U"), _at(way)
        if spread is None or at is None:
            continue
        x, y = at
        ends = [number(spread.low, "U"), number(spread.high, "U")]
        traces.append(line_trace([x, x], ends, colour(index), 1.2))
        marker = {"color": colour(index), "symbol": SYMBOLS[index % len(SYMBOLS)], "size": 9}
        points = {"x": [x], "y": [y], "text": [f"{way.name}\n{figure(x)}, {figure(y)}"]}
        traces.append({"type": "scatter", "mode": "markers", **points, "marker": marker})
    x_axis, y_axis = (axis_style(_heading(name), rangemode="tozero") for name in ("minutes", "U"))
    return {"data": traces, "layout": layout(x_axis, y_axis, _HEIGHT, margin=_MARGIN), "wide": True}


_MARGIN = {"l": 56, "r": 16, "t": 12, "b": 46}
"""Pixels; a matter of taste."""


def _at(way: MeasuringWay) -> tuple[float, float] | None:
    return None if way.place is None else (number(way.place[0], "minutes"), number(way.place[1], "U"))


def _heading(name: str) -> str:
    known = FIGURES[name]
    return f"{known.words}, {known.unit}" if known.unit else known.words


def _short_heading(name: str) -> str:
    unit = FIGURES[name].unit
    return f"{name.replace('_', ' ')}, {unit}" if unit else name.replace("_", " ")


def _cell(way: MeasuringWay, name: str) -> str:
    if name in _SPREADS:
        return _spread_text(way.spread(name))
    mean = way.mean(name)
    if mean is None:
        return "–"
    if name in _SHARES:
        return f"{100 * mean.value:.1f}{_error(mean, 100)} %"
    return f"{figure(mean.value)}{_error(mean)}"


def _error(mean: Mean, times: float = 1.0) -> str:
    return f" ± {figure(times * mean.error)}" if 0 < mean.error < math.inf else ""


def _spread_text(spread: Quartiles | None) -> str:
    if spread is None:
        return "–"
    quartiles = f" ({short(spread.low)} to {short(spread.high)})" if spread.low < spread.high else ""
    return f"{short(spread.middle)}{quartiles}"


def _change_row(change: ChoiceChange) -> list[str]:
    cells = [change.figures.get(name) for name in _CHANGED]
    return [change.words, *("–" if each is None else _signed(each) for each in cells)]


def _signed(mean: Mean) -> str:
    return f"{'+' if mean.value > 0 else ''}{figure(mean.value)}{_error(mean)}"
