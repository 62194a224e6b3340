"""The report as a PDF that carries everything it needs, and no font of the system."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import UTC, date, datetime
from functools import cache, partial
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal

from markupsafe import Markup

from axiscal.answers.answer import number, rounded
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.exceptions import PrintingError
from axiscal.language.spoken import joined, resaid, said
from axiscal.present import sentences
from axiscal.present.drawing.svg_picture import (
    Figure,
    axis_style,
    band,
    finite_range,
    layout,
    line_trace,
    paper_svg,
)
from axiscal.present.found_and_left import found_and_left_drawing
from axiscal.present.result_document import listed
from axiscal.present.sentences import U_OF_TABLES, UNSAID, axis_unit, environment, figure, quantity, unit_text
from axiscal.present.statement import answered, statement
from axiscal.present.summary import CurveSummary, HistoryRow, Summary
from axiscal.present.volume_error import PlaneSummary

if TYPE_CHECKING:
    from jinja2 import Template


def report_values(summary: Summary) -> dict[str, Any]:
    """Return what the report is filled with, in the language that is spoken."""
    listed_rows, others_words = listed(summary)
    first_number = said("A reading with several numbers shows the first of them.")
    return {
        "s": summary,
        "groups": groups(summary.curves, summary.chain),
        "reversal_groups": groups(summary.reversals, summary.chain),
        "planes": [(plane, _maps(plane, summary.history)) for plane in summary.planes],
        "constants": sentences.constant_rows(summary),
        **answered(summary)._asdict(),
        "stated": statement(summary),
        "unsaid": said(UNSAID),
        "u_of_tables": said(U_OF_TABLES),
        "volume_words": sentences.volume_words(summary),
        "first_number": first_number if any(row.others for row in summary.history) else "",
        "listed_rows": listed_rows,
        "others_words": others_words,
    }


_MAP_HEIGHT = 290
"""Pixels; a matter of taste."""
_EITHER_WAY = [[0, "#0b5c8a"], [0.5, "#f4f1e8"], [1, "#c2491d"]]
"""From low to high about nought; a matter of taste."""
_WIDER = [[0, "#f4f1e8"], [1, "#5a3d7a"]]
"""From known to unknown; a matter of taste."""

Grid = Sequence[Sequence[float]]

_HEIGHT, _HEIGHT_ALONE = 210, 360
"""Pixels; a matter of taste."""


Panel = tuple[CurveSummary, Figure]
"""A curve and its picture."""


def groups(curves: Sequence[CurveSummary], chain: str = "") -> list[tuple[str, str, list[list[Panel]]]]:
    """Return each axis in order of appearance, what has to be known of all its curves, and these in rows of one unit.

    chain : of the machine
    """
    height, found = _HEIGHT_ALONE if len(curves) == 1 else _HEIGHT, dict[str, list[list[Panel]]]()
    for axis in dict.fromkeys(curve.axis for curve in curves):
        own = [curve for curve in curves if curve.axis == axis]
        for unit in sorted({curve.value_unit for curve in own}, key=lambda unit: (unit != "um", unit)):
            row = [curve for curve in own if curve.value_unit == unit]
            shared = finite_range([value for curve in row for value in _content(curve)])
            found.setdefault(axis, []).append([(curve, panel_figure(curve, shared, height)) for curve in row])
    # curves name what the carriage does (ISO 230-1), and have then not the sign of their readings
    turned = "{axis} carries the workpiece: these curves say what the table does, readings show it with the other sign."
    carried = {axis for axis in found if f"{axis}'" in chain.split("-")}
    return [(axis, said(turned, axis=axis) if axis in carried else "", rows) for axis, rows in found.items()]


def _content(curve: CurveSummary) -> list[float]:
    size = len(curve.position)
    means = rounded(curve.mean, f"mean of {curve.name}", size)
    halves = [BAND * std for std in rounded(curve.std, f"std of {curve.name}", size)]
    edges = [mean + sign * half for mean, half in zip(means, halves, strict=True) for sign in (1, -1)]
    truth = [] if curve.truth is None else list(curve.truth[1])
    return [*edges, *truth, *(point.value for point in curve.points if not point.rejected), 0.0]


def panel_figure(curve: CurveSummary, shared: list[float], height: int) -> Figure:
    """Return one panel.  shared : the range upwards of its row"""
    size, positions = len(curve.position), rounded(curve.position, f"position of {curve.name}")
    mean = rounded(curve.mean, f"mean of {curve.name}", size)
    prior, whole, seen = (
        [BAND * std for std in rounded(stds, f"{what} of {curve.name}", size)]
        for what, stds in (("prior_std", curve.prior_std), ("std", curve.std), ("std_seen", curve.std_seen))
    )
    truth = []
    if curve.truth is not None:
        at, value = (rounded(values, f"truth of {curve.name}") for values in curve.truth)
        truth = [line_trace(at, value, "var(--truth)", 1.6, "4px,3px")]
    traces = [
        band(positions, [0.0] * size, prior, "var(--prior)"),
        band(positions, mean, whole, "var(--whole)"),
        band(positions, mean, seen, "var(--seen)"),
        *truth,
        line_trace(positions, mean, "var(--accent)", 1.8),
        *_points(curve),
    ]
    low, high = min(positions, default=0.0), max(positions, default=1.0)
    pad = 0.02 * (high - low) or 1.0
    span = max(curve.position, default=0.0) - min(curve.position, default=0.0)
    x = axis_style(
        f"{curve.axis}, {unit_text(curve.position_unit)}",
        range=rounded([low - pad, high + pad], "range"),
        nticks=6,
        **{"dtick": 90} if axis_unit(curve.axis) == "deg" and 180 < span <= 540 else {},
    )
    y = axis_style(unit_text(curve.value_unit), range=shared, nticks=6, zeroline=True, zerolinecolor="var(--rule)")
    return {"data": traces, "layout": layout(x, y, height), "wide": height == _HEIGHT_ALONE}


def _points(curve: CurveSummary) -> list[Figure]:
    low, high = finite_range(_content(curve))
    near, found = [point for point in curve.points if low <= point.value <= high], list[Figure]()
    dot = {"color": "var(--ink)", "line": {"color": "var(--card)", "width": 0.6}}
    ring = {"color": "var(--card)", "line": {"color": "var(--alarm)", "width": 1.5}, "hollow": True}
    for rejected, look in ((False, dot), (True, ring)):
        points = [point for point in near if point.rejected is rejected]
        bars = {"array": [number(BAND * p.std, "std of a point") for p in points], "color": "var(--whisker)"}
        names = [f"{said('reading {number}', number=point.reading)}, {point.setup}" for point in points]
        sizes = [f"{figure(point.value)} ± {quantity(BAND * point.std, curve.value_unit)}" for point in points]
        text = [f"{name}\n{size}" for name, size in zip(names, sizes, strict=True)]
        data = {"x": rounded([p.position for p in points], "points"), "y": rounded([p.value for p in points], "points")}
        style = {"type": "scatter", "mode": "markers", "marker": look | {"size": 5.0, "round": True}}
        found += [{**data, **style, "error_y": bars, "text": text}] if points else []
    return found


def _maps(plane: PlaneSummary, rows: Sequence[HistoryRow]) -> list[tuple[Figure, str]]:
    """Return the maps of a plane, each with the words under it."""
    unit = unit_text(plane.value_unit)
    bands = [[BAND * value for value in row] for row in plane.whole_std]
    alone = [[plane.sign * value for value in row] for row in plane.mean]
    names = joined(plane.axes)
    whole = _map(plane, plane.whole_mean, _EITHER_WAY, both=True)
    first, second = plane.axes
    read = [row.position for row in rows if row.position and {first, second} <= set(row.position)]
    at = {name: rounded([position[axis] for position in read], axis)
          for name, axis in (("x", first), ("y", second))}  # fmt: skip
    marker = {"size": 4, "color": "#1c1b18", "line": {"color": "#f4f1e8", "width": 0.8}}
    whole["data"].append({"type": "scatter", "mode": "markers", **at, "marker": marker, "cliponaxis": False})
    return [
        (whole, said("The tool over {axes}, their curves included, {unit}; dots: readings", axes=names, unit=unit)),
        (_map(plane, bands, _WIDER, both=False), said("95 % of it: ± so many {unit}", unit=unit)),
        (_map(plane, alone, _EITHER_WAY, both=True), said("Of it, what no sum of two curves holds, {unit}", unit=unit)),
    ]


def _map(plane: PlaneSummary, values: Grid, colours: Sequence[Sequence[object]], both: bool) -> Figure:
    """Return a map with the first axis to the right.  both : whether values lie on both sides of 0"""
    first, second = (rounded(at, f"position of {plane.name}") for at in plane.position)
    heights = [rounded(row, f"map of {plane.name}", len(first)) for row in zip(*values, strict=True)]
    largest = number(max(abs(value) for row in heights for value in row) or 1.0, plane.name)
    trace = {
        "type": "heatmap",
        "x": first,
        "y": second,
        "z": heights,
        "colorscale": colours,
        "zmin": -largest if both else 0.0,
        "zmax": largest,
        "colorbar": True,
    }
    x, y = (axis_style(f"{axis}, {unit_text(unit)}", nticks=6, showgrid=False, range=[at[0], at[-1]])
            for axis, unit, at in zip(plane.axes, plane.position_unit, (first, second), strict=True))  # fmt: skip
    return {"data": [trace], "layout": layout(x, y, _MAP_HEIGHT, margin={"l": 46, "r": 8, "t": 8, "b": 42})}


_PAPER = 840
"""Pixels that the picture of the volume is drawn in: its words are then as large as the notes under it."""
_WIDE, PANEL = 340, 230
"""Pixels that the picture of a curve alone, and one of many, are drawn in; a matter of taste."""
_ESCAPED = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r", "\t": r"\t"})


def pdf(summary: Summary) -> bytes:
    """Return the report in the language that is spoken, as PDF/A-2b where letters hold all of its signs.

    Raises SummaryError for an infinite figure.
    """
    return printed(date.fromisoformat(summary.date), partial(filled, summary))


def printed(day: date, filled: Callable[[Path], str]) -> bytes:
    """Return a document of a day as a PDF; the same one has the same bytes.

    filled : given a folder for its pictures, what typst sets
    """
    with TemporaryDirectory(prefix="axiscal-", ignore_cleanup_errors=True) as name:
        file = Path(name) / "report.typ"
        file.write_bytes(filled(Path(name)).encode("utf-8", "replace"))
        return _set(file, int(datetime(day.year, day.month, day.day, tzinfo=UTC).timestamp()))


def kept_in(folder: Path) -> Callable[[str], str]:
    """Return what writes one picture after another into a folder, and returns the name of its file."""
    numbers = count(1)

    def kept(svg: str) -> str:
        file = f"figure-{next(numbers)}.svg"
        (folder / file).write_bytes(svg.encode("utf-8", "replace"))
        return file

    return kept


def filled(summary: Summary, folder: Path) -> str:
    """Return the report as typst sets it, in the language that is spoken; its pictures are written into a folder."""
    summary, kept = resaid(summary), kept_in(folder)
    drawn = {
        "draw": lambda figure: kept(paper_svg(figure, _WIDE if figure.get("wide") else PANEL)),
        "picture": "" if summary.bent is None else kept(found_and_left_drawing(summary.bent, _PAPER).on_paper()),
        "day": date.fromisoformat(summary.date),
    }
    return template("report.typ").render(report_values(summary) | drawn)


@cache
def template(name: str) -> Template:
    """Return a template of the report: where it ends in .typ, values become literals of typst."""
    return environment(_literal if name.endswith(".typ") else None).get_template(name)


def _literal(value: object) -> Markup:
    """Return a value as typst writes it in code: a text in quotes, an array, a number."""
    if isinstance(value, Markup):  # of a macro, whose values are literals already
        return value
    if isinstance(value, str):
        return Markup(f'"{value.translate(_ESCAPED)}"')
    if isinstance(value, list | tuple):
        return Markup(f"({''.join(f'{_literal(each)},' for each in value)})")
    return Markup(value)


def _set(file: Path, moment: int) -> bytes:
    """Return what typst makes of a file beside its pictures.

    The system's fonts give the signs that its own fonts lack. A sign in no font becomes a box, and the PDF is then
    none for archives, which forbid boxes.
    """
    import typst

    reason = ""
    tries: tuple[tuple[bool, Literal["a-2b"] | None], ...] = ((False, "a-2b"), (True, "a-2b"), (True, None))
    for system, standard in tries:
        fonts = typst.Fonts(include_system_fonts=system)
        compiler = typst.Compiler(str(file), root=str(file.parent), font_paths=fonts)
        try:
            made = compiler.compile(pdf_standards=standard, timestamp=moment)
            assert isinstance(made, bytes)  # one document, in one file
            return made
        except typst.TypstError as failure:
            reason = str(failure).splitlines()[0][:200]
    what = "report.pdf could not be set: {reason}"
    remedy = "result.json beside it says the same; please report this defect of axiscal"
    raise PrintingError(what, remedy, reason=reason)
