"""The report of a machine that was made in Python: what the core knows of it, as a PDF, and its unknowns as a table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from axiscal import __version__
from axiscal.document.durable import write_whole
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.language.spoken import joined, said, speaking
from axiscal.present.drawing.svg_picture import paper_svg
from axiscal.present.rendering import PANEL, kept_in, printed, template
from axiscal.present.sentences import as_read, coordinate, figure, quantity, values_text, with_band
from axiscal.present.whose_language import named_language
from axiscal.python.estimated import Curve
from axiscal.units import to_unit
from axiscal_core import refusals
from axiscal_core.errors import Curved, Offset, Plane
from axiscal_core.known import Known
from axiscal_core.places import Readings
from axiscal_core.refusals import Array, one
from axiscal_core.units import like

UNITS = {"m": "um", "rad": "urad"}
"""In which a deviation is shown."""
_LARGER = 1.5
"""From here on a size is called larger than stated: of less a dozen readings say little."""


def report(known: Known, folder: str | Path, title: str = "Machine", language: str | None = None) -> Path:
    """Write report.pdf and unknowns.csv of what is known; return the former.

    title : the name of the machine; language : "en" or "de", AXISCAL_LANGUAGE or English where it is not said
    Raises axiscal_core.InputError where nothing was read, InputError for another language, OSError.
    """
    of = "`case.estimate(readings)` of a machine made in Python; that of `load_machine` has `report`"
    one("report", "known", known, Known, of)
    one("report", "folder", folder, (str, Path), 'such as "report"')
    one("report", "title", title, str, 'such as "Robot 7"')
    if known.readings is None:
        raise refusals.InputError("report", "known", "comes from no readings", "Give what `case.estimate` returns")
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    with speaking(named_language(language) or "en"):
        day = datetime.now(UTC).date()
        filled = partial(
            _filled, known, known.readings, {"title": title, "day": day, "version": f"axiscal {__version__}"}
        )
        write_whole(out / "report.pdf", printed(day, filled))
    lines = io.StringIO()
    table = known.table()
    csv.writer(lines, lineterminator="\n").writerows([[*table], *zip(*table.values(), strict=True)])
    write_whole(out / "unknowns.csv", lines.getvalue().encode())
    return out / "report.pdf"


def _filled(known: Known, readings: Readings, told: dict[str, Any], folder: Path) -> str:
    """Return the report as typst sets it; its pictures are written into a folder."""
    kept = kept_in(folder)
    values = {
        "figures": _figures(known),
        "sentences": [*_sentences(known)],
        "curves": [(name, kept(paper_svg(curve.line(), PANEL))) for name, curve in _curves(known)],
        "found": [[said("error"), said("estimate, ± 95 %"), said("before, 95 %")], *_found(known)],
        "instruments": _instruments(known),
        "readings": _rows(known, readings),
    }
    return template("own_report.typ").render(told | values)


def _figures(known: Known) -> list[list[str]]:
    """Return what is known of the tool point over the volume."""
    root = known.case.volume.root
    before = float(np.sqrt(known.case.volume.value(known.case.prior.covariance)))
    sizes = [float(np.linalg.norm(root @ known.mean)), known.U, known.rms, before]
    heads = [said("found"), said("U (95 %)"), said("RMS"), said("RMS before")]
    return [heads, [quantity(to_unit(size, "um"), "um") for size in sizes]]


def _sentences(known: Known) -> Iterator[str]:
    """Give what a reader has to know beside the figures."""
    yield said("U: with 95 % the error that is left after correcting is not larger, over the volume.")
    if known.bad:
        yield said("Not believed: readings {numbers}.", numbers=joined([str(i + 1) for i in known.bad]))
    if known.case.causes:
        yield said("What no reading shows counts in U: {causes}.", causes=joined(known.case.causes))
    if large := [(name, size) for name, size in known.sizes.items() if size > _LARGER]:
        shown = [f"{name} × {figure(size, 2)}" for name, size in large]
        yield said("Readings show sizes larger than stated: {sizes}.", sizes=joined(shown))


def _curves(known: Known) -> Iterator[tuple[str, Curve]]:
    """Give the curves of several control values, as they are drawn."""
    for k, term in known.case.machine.curves:
        if term.spline.size > 1:
            own, axis = known[term.name], known.case.machine.axes[term.at]
            curve = Curve.of(own.spline, own.known)
            curve.name, curve.rest, curve.position_unit = term.name, term.rest, "deg" if axis.rotary else "mm"
            curve.unit = UNITS[_unit(known.case.machine.terms[k])]
            yield term.name, curve


def _unit(term: object) -> str:
    """Return "m" or "rad", what a number of an error is; "" of a basis of one's own, which does not say."""
    if isinstance(term, Curved):
        return "m" if term.error.component < 3 else "rad"
    basis = getattr(term, "basis", None)
    if isinstance(basis, Offset):
        return "rad" if basis.twist[3:].any() else "m"
    return ("m" if basis.name[1] in "XYZ" else "rad") if isinstance(basis, Plane) else ""


def _found(known: Known) -> Iterator[list[str]]:
    """Give each unknown with its 95 %, now and before; of a curve that is drawn, and of a plane, all of it as a root
    mean square.
    """
    before, now = known.case.prior.std, known.normal.std
    machine = known.case.machine
    for term, columns in zip(machine.terms, machine.columns, strict=True):
        unit = _unit(term)
        if columns.stop - columns.start == 1 or not unit:
            for i in range(columns.start, columns.stop):
                yield _line(known.names[i].removesuffix("[0]"), known.mean[i], now[i], before[i], unit)
        else:
            mean, half, prior = (_root_mean_square(each[columns]) for each in (known.mean, now, before))
            yield _line(said("{name}, on average", name=term.name), mean, half, prior, unit)
    own = ((each, name) for each in known.case.instruments for name in each.own)
    for i, (each, name) in enumerate(own, machine.size):
        if before[i] > 0:
            of = like(type(each).unknowns.get(name))
            yield _line(known.names[i], known.mean[i], now[i], before[i], of[0] if len(of) == 1 else "")


def _root_mean_square(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _line(name: str, mean: float, now: float, before: float, unit: str) -> list[str]:
    """Return a row: estimate ± 95 %, and ± 95 % before."""
    shown = UNITS.get(unit, "")
    value, half, prior = (to_unit(each, shown) if shown else each for each in (mean, BAND * now, BAND * before))
    return [name, with_band(value, half, shown), f"± {quantity(prior, shown) if shown else figure(prior)}"]


def _instruments(known: Known) -> list[list[str]]:
    """Return what was mounted, what it moves and how finely it reads."""
    rows = [[said("set-up"), said("instrument"), said("moves"), said("noise")]]
    for each in known.case.instruments:
        noise = [
            f"{name} {quantity(to_unit(sigma, UNITS[unit]), UNITS[unit])}"
            for name, sigma, unit in zip(each.names, each.sigma.tolist(), each.units, strict=True)
        ]
        rows.append([each.name, type(each).__name__, " ".join(each.moves), ", ".join(noise)])
    return rows


def _heading(known: Known) -> str:
    """Return what stands above positions."""
    turning = {axis.rotary for axis in known.case.machine.axes}
    if turning == {True}:
        return said("position, °")
    return said("position, mm and °") if True in turning else said("position, mm")


def _rows(known: Known, readings: Readings) -> list[list[str]]:
    """Return where was read, what it was, and how far that is from what the others expect."""
    case, places = known.case, readings.places
    of, axes = case.numbers(readings).place, case.machine.axes
    shown_by = case.values(readings, "report")
    rows = [[said("no."), said("set-up"), _heading(known), said("value"), said("surprise")]]
    for i, (name, pose) in enumerate(zip(places.instruments, places.poses, strict=True)):
        instrument = case.instruments[[each.name for each in case.instruments].index(name)]
        at = zip(axes, pose.tolist(), strict=True)
        shown = (f"{axis.name} {coordinate(to_unit(x, 'deg' if axis.rotary else 'mm'))}" for axis, x in at)
        units = [UNITS[unit] for unit in instrument.units]
        pairs = zip(shown_by[of == i].tolist(), units, strict=True)
        values = values_text([to_unit(value, unit) for value, unit in pairs], *units)
        surprise = as_read(known.z[i]) if i in known.z else ""
        rows.append([f"{i + 1}{' ×' if i in known.bad else ''}", name, " · ".join(shown), values, surprise])
    return rows
