"""The report of what the core knows of a machine, as a PDF, and its unknowns as a table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from axiscal import __version__
from axiscal.answers.row_words import said_row
from axiscal.document.durable import write_whole
from axiscal.language.spoken import LANGUAGES, WORDS, joined, put, said, speaking
from axiscal.present.rendering import printed
from axiscal.present.sentences import spelt
from axiscal.present.whose_language import named_language
from axiscal.units import said_quantity, to_unit
from axiscal_core import refusals
from axiscal_core.errors import Offset
from axiscal_core.known import Known
from axiscal_core.places import Readings
from axiscal_core.refusals import named, one, one_of
from axiscal_core.terms import Term
from axiscal_core.units import like

UNITS = {"m": "um", "rad": "urad"}
"""In which a deviation is shown."""
_POSITIONS = 101
"""Points of a drawn curve; a matter of taste."""
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
        write_whole(out / "report.pdf", printed(document_of(known, title), {}))
    lines = io.StringIO()
    table = known.table()
    csv.writer(lines, lineterminator="\n").writerows([[*table], *zip(*table.values(), strict=True)])
    write_whole(out / "unknowns.csv", lines.getvalue().encode())
    return out / "report.pdf"


def document_of(known: Known, title: str) -> dict[str, Any]:
    """Return what is known as the result document has it, as far as a machine that was made in Python has it."""
    drawn = [term for term in known.case.machine.curves if term.spline.size > 1]
    words = {"first": [said(WORDS["verdicts"]["measured"])], "rows": _figures(known), "sentences": [*_sentences(known)]}
    return {
        "machine": title,
        "identity": {"begun": datetime.now(UTC).date().isoformat()},
        "agreement": {"contradict": False, "text": ""},
        "answer": {"verdict": "measured"},
        "words": words,
        "setups": [*_instruments(known)],
        "errors": {term.name: _error(known, term) for term in drawn},
        "constants": dict(_constants(known, drawn)),
        "history": [] if known.readings is None else [*_history(known, known.readings)],
        "versions": {"axiscal": __version__},
    }


def _figures(known: Known) -> list[list[str]]:
    """Return what is known of the tool point over the volume."""
    root = known.case.volume.root
    before = float(np.sqrt(known.case.volume.value(known.case.prior.covariance)))
    sizes = [float(np.linalg.norm(root @ known.mean)), known.U, known.rms, before]
    heads = ["", said("found"), said("U (95 %)"), said("RMS"), said("RMS before")]
    return [heads, [said_row("volume"), *(spelt(said_quantity(size, "um")) for size in sizes)]]


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
        shown = [
            f"{owner} ({said(WORDS['sizes'][kind])}) × {put('{size:.2g}', size=size)}" for (kind, owner), size in kinds
        ]
        yield said("Readings show sizes larger than stated: {sizes}.", sizes=joined(shown))
    if max(known.sizes.values(), default=0.0) > _FAR_LARGER:
        yield said("Sizes that much larger contradict what is stated: look at the unit of the readings first.")


def _error(known: Known, term: Term) -> dict[str, Any]:
    """Return an error over its axis."""
    machine = known.case.machine
    axis, columns, unit = machine.axes[term.axis], term.columns, UNITS[_unit(term)]
    at = np.linspace(term.spline.knots[0], term.spline.knots[-1], _POSITIONS)
    position_unit = "deg" if axis.rotary else "mm"
    rows = term.spline.rows(at)
    spreads = (rows @ each.covariance[columns, columns] @ rows.T for each in (known.normal, known.case.prior))
    now, before = (to_unit(np.sqrt(np.diagonal(each) + term.rest**2), unit) for each in spreads)
    return {
        "axis": axis.name,
        "words": "",
        "position": to_unit(at, position_unit).tolist(),
        "mean": to_unit(rows @ known.mean[columns], unit).tolist(),
        "std": now.tolist(),
        "std_seen": now.tolist(),
        "prior_std": before.tolist(),
        "from_readings": 1.0 - float(np.sum(now**2) / np.sum(before**2)),
        "position_unit": position_unit,
        "value_unit": unit,
        "read": {"position": [], "value": []},
    }


def _unit(term: object) -> str:
    """Return "m" or "rad", what a number of an error is; "" of a basis of one's own, which does not say."""
    if isinstance(term, Term):
        return "rad" if term.angular else "m"
    basis = getattr(term, "basis", None)
    if isinstance(basis, Offset):
        return "rad" if basis.twist[3:].any() else "m"
    return ""


def _constants(known: Known, drawn: Sequence[Term]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Give each unknown that is on no curve with its standard deviation, now and before."""
    machine, now, before = known.case.machine, known.normal.std, known.case.prior.std
    names = dict(enumerate(known.names))
    units = dict[int, str]()
    for term in machine.parts:
        columns = term.columns
        if term not in drawn:
            units |= dict.fromkeys(range(columns.start, columns.stop), _unit(term))
            names |= {columns.start: term.name} if columns.stop - columns.start == 1 else {}
    own = ((each, name) for each in known.case.instruments for name in each.own)
    for i, (each, name) in enumerate(own, machine.size):
        of = like(type(each).unknowns.get(name))
        if before[i] > 0:
            units[i] = of[0] if len(of) == 1 else ""
    for i, unit in units.items():
        shown = UNITS.get(unit, "")
        sizes = (to_unit(float(size), shown) if shown else float(size) for size in (known.mean[i], now[i], before[i]))
        yield names[i], {"words": "", "unit": shown} | dict(zip(("mean", "std", "prior_std"), sizes, strict=True))


def _instruments(known: Known) -> Iterator[dict[str, Any]]:
    """Give what was mounted, what it moves and how finely it reads."""
    for each in known.case.instruments:
        noise = [
            f"{name} {spelt(said_quantity(sigma, UNITS[unit]))}"
            for name, sigma, unit in zip(each.names, each.sigma.tolist(), each.units, strict=True)
        ]
        mounted = {"name": each.name, "instrument": type(each).__name__, "along": "", "moves": [*each.moves]}
        yield {**mounted, "noise": ", ".join(noise)}


def _history(known: Known, readings: Readings) -> Iterator[dict[str, Any]]:
    """Give where was read, what it was, and how far that is from what the others expect."""
    case, places = known.case, readings.places
    of, axes = case.numbers(readings).place, case.machine.axes
    shown_by = case.values(readings, "report")
    for i, (name, pose) in enumerate(zip(places.instruments, places.poses, strict=True)):
        units = [UNITS[unit] for unit in case.instruments[case.setups.index(name)].units]
        value, *others = (to_unit(x, unit) for x, unit in zip(shown_by[of == i].tolist(), units, strict=True))
        came = (f"{a.name}{'+' if side > 0 else '-'}" for a, side in zip(axes, places.sides[i], strict=True) if side)
        at = {a.name: to_unit(x, "deg" if a.rotary else "mm") for a, x in zip(axes, pose.tolist(), strict=True)}
        where = {
            "reading": i + 1,
            "setup": name,
            "position": at,
            "approach": " ".join(came),
            "rejected": i in known.bad,
        }
        yield {**where, "value": value, "others": others, "units": units, "surprise": known.z.get(i)}
