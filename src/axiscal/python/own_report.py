"""The report of what the core knows of a machine, as a PDF, and its unknowns as a table."""

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
from axiscal.language.spoken import LANGUAGES, WORDS, joined, said, speaking
from axiscal.present.drawing.svg_picture import paper_svg
from axiscal.present.rendering import PANEL, kept_in, printed, template
from axiscal.present.sentences import as_read, figure, heading_in, position_text, quantity, values_text, with_band
from axiscal.present.whose_language import named_language
from axiscal.python.curve_pictures import DrawnCurve, drawn
from axiscal.units import to_unit
from axiscal_core import refusals
from axiscal_core.errors import Offset
from axiscal_core.known import Known
from axiscal_core.places import Readings
from axiscal_core.refusals import named, one, one_of
from axiscal_core.terms import Term
from axiscal_core.units import like

UNITS = {"m": "um", "rad": "urad"}
"""In which a deviation is shown."""
_LARGER, _FAR_LARGER = 1.5, 6.0
"""From the first on a size is called larger than stated, for a dozen readings say little of less; then a mistake."""


def report(known: Known, folder: str | Path, title: str = "Machine", language: str | None = None) -> Path:
    """Write report.pdf and unknowns.csv of what is known; return the former.

    title : the name of the machine; language : "en" or "de", AXISCAL_LANGUAGE or English where it is not said
    Raises axiscal_core.InputError where nothing was read, InputError for another language, OSError.
    """
    one("report", "known", known, Known, "what `case.estimate` returns")
    one("report", "folder", folder, (str, Path), 'such as "report"')
    named("report", "title", title)
    if language is not None:
        one_of("report", "language", language, [*LANGUAGES])
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
    kept, normal, machine = kept_in(folder), known.normal, known.case.machine
    curves = [drawn(machine, term, normal) for term in machine.curves if term.spline.size > 1]
    values = {
        "figures": _figures(known),
        "sentences": [*_sentences(known)],
        "curves": [(each.name, kept(paper_svg(each.figure(), PANEL))) for each in curves],
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
    yield said("U: in 95 % of such machines the RMS that is left over the volume after correcting is not larger.")
    if known.case.aligned:
        yield said("A shift or turn of the whole volume counts as no error.")
    if known.bad:
        numbers = joined([str(i + 1) for i in sorted(known.bad)])
        yield said("Not believed, marked ×: readings {numbers}.", numbers=numbers)
    if known.case.causes:
        yield said("What no reading shows counts in U: {causes}.", causes=joined(known.case.causes))
    if large := [(name, size) for name, size in known.sizes.items() if size > _LARGER]:
        kinds = [(name.split(" ", 1), size) for name, size in large]
        shown = [f"{owner} ({said(WORDS['sizes'][kind])}) × {figure(size, 2)}" for (kind, owner), size in kinds]
        yield said("Readings show sizes larger than stated: {sizes}.", sizes=joined(shown))
    if max(known.sizes.values(), default=0.0) > _FAR_LARGER:
        yield said("Sizes that much larger contradict what is stated: look at the unit of the readings first.")


def _unit(term: object) -> str:
    """Return "m" or "rad", what a number of an error is; "" of a basis of one's own, which does not say."""
    if isinstance(term, Term):
        return "rad" if term.angular else "m"
    basis = getattr(term, "basis", None)
    if isinstance(basis, Offset):
        return "rad" if basis.twist[3:].any() else "m"
    return ""


def _found(known: Known) -> Iterator[list[str]]:
    """Give each unknown with its 95 %, now and before; of a curve that is drawn its range, and both on average."""
    machine, both = known.case.machine, (known.normal, known.case.prior)
    now, before = (each.std for each in both)
    for term in machine.parts:
        unit, columns = _unit(term), term.columns
        if (count := columns.stop - columns.start) > 1 and isinstance(term, Term) and not term.error.sides:
            yield _range(*(drawn(machine, term, each) for each in both))
            continue
        for i in range(columns.start, columns.stop):
            name = term.name if count == 1 else known.names[i]
            yield _line(name, known.mean[i], now[i], before[i], unit)
    own = ((each, name) for each in known.case.instruments for name in each.own)
    for i, (each, name) in enumerate(own, machine.size):
        if before[i] > 0:
            of = like(type(each).unknowns.get(name))
            yield _line(known.names[i], known.mean[i], now[i], before[i], of[0] if len(of) == 1 else "")


def _range(now: DrawnCurve, before: DrawnCurve) -> list[str]:
    """Return the row of a curve: from where to where it goes, ± 95 % on average along the axis, now and before."""
    values = to_unit(now.mean, now.unit)
    low, high = (quantity(float(end), now.unit) for end in (values.min(), values.max()))
    half, prior = (BAND * to_unit(float(np.sqrt(np.mean(each.std**2))), now.unit) for each in (now, before))
    found = said("{low} to {high}", low=low, high=high)
    return [now.name, f"{found} ± {figure(half)}", f"± {quantity(prior, now.unit)}"]


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


def _rows(known: Known, readings: Readings) -> list[list[str]]:
    """Return where was read, what it was, and how far that is from what the others expect."""
    case, places = known.case, readings.places
    of, axes = case.numbers(readings).place, case.machine.axes
    shown_by = case.values(readings, "report")
    shown = ["deg" if axis.rotary else "mm" for axis in axes]
    rows = [[said("no."), said("set-up"), heading_in(shown), said("approach"), said("value"), said("surprise")]]
    for i, (name, pose) in enumerate(zip(places.instruments, places.poses, strict=True)):
        instrument = case.instruments[case.setups.index(name)]
        at = {axis.name: to_unit(x, unit) for axis, x, unit in zip(axes, pose.tolist(), shown, strict=True)}
        came = (f"{a.name}{'+' if side > 0 else '−'}" for a, side in zip(axes, places.sides[i], strict=True) if side)
        units = [UNITS[unit] for unit in instrument.units]
        pairs = zip(shown_by[of == i].tolist(), units, strict=True)
        values = values_text([to_unit(value, unit) for value, unit in pairs], *units)
        surprise = as_read(known.z[i]) if i in known.z else ""
        number = f"{i + 1}{' ×' if i in known.bad else ''}"
        rows.append([number, name, position_text(at), " ".join(came), values, surprise])
    return rows
