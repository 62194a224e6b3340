"""The report of what the core knows of a machine, as a PDF."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np

from axiscal import __version__
from axiscal.document.durable import write_whole
from axiscal.language.spoken import LANGUAGES, WORDS, joined, listed, put, said, speaking
from axiscal.present.answer import AnswerDocument, Outcome
from axiscal.present.curves import constant_figures, curve_figures
from axiscal.present.rendering import pdf
from axiscal.present.result import AgreementFigures, ConstantFigures, HistoryRow, Result, ResultWords, SetupUse
from axiscal.present.row_words import said_row
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
_Document = TypeVar("_Document", bound=AnswerDocument)
_LARGER, _FAR_LARGER = 1.5, 6.0
"""From the first on a size is called larger than stated, for a dozen readings say little of less; then a mistake."""


def report(known: Known, folder: str | Path, title: str = "Machine", language: str | None = None) -> Path:
    """Write report.pdf of what is known and return it.

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
        write_whole(out / "report.pdf", pdf(result_of(known, title), {}))
    return out / "report.pdf"


def result_of(known: Known, title: str) -> Result:
    """Return what is known as a result, as far as a machine that was made in Python has its parts."""
    machine, now, before = known.case.machine, known.normal, known.case.prior
    drawn = [(term, machine.axes[term.axis]) for term in machine.curves if term.spline.size > 1]
    first, no_row = [said(WORDS["verdicts"]["measured"])], dict[str, str]()
    return _part(
        Result,
        machine=title,
        identity={"begun": datetime.now(UTC).date().isoformat()},
        agreement=_part(AgreementFigures, contradict=False, text=""),
        answer=_part(Outcome, verdict="measured"),
        words=ResultWords(first=first, rows=_figures(known), sentences=[*_sentences(known)], names=no_row),
        setups=[*_instruments(known)],
        errors={
            term.name: curve_figures(term, axis, now, before, np.zeros((term.spline.size, 0))) for term, axis in drawn
        },
        constants=dict(_constants(known)),
        history=[] if known.readings is None else [*_history(known, known.readings)],
        versions={"axiscal": __version__},
    )


def _part(of: type[_Document], **own: Any) -> _Document:
    """Return a document of which nobody here knows the rest."""
    return cast("_Document", of.model_construct(**own))


def _figures(known: Known) -> list[list[str]]:
    """Return what is known of the tool point over the volume."""
    root = known.case.volume.root
    before = float(np.sqrt(known.case.volume.value(known.case.prior.covariance)))
    sizes = [float(np.linalg.norm(root @ known.mean)), known.U, known.rms, before]
    heads = ["", said("found"), said("U (95 %)"), said("RMS"), said("RMS before")]
    return [heads, [said_row("volume"), *(said_quantity(size, "um") for size in sizes)]]


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
    if large := {name.partition(" "): size for name, size in known.sizes.items() if size > _LARGER}:
        shown = [
            f"{owner} ({said(WORDS['sizes'][kind])}) × {put('{size:.2g}', size=size)}"
            for (kind, _, owner), size in large.items()
        ]
        yield said("Readings show sizes larger than stated: {sizes}.", sizes=joined(shown))
    if max(known.sizes.values(), default=0.0) > _FAR_LARGER:
        yield said("Sizes that much larger contradict what is stated: look at the unit of the readings first.")


def _constants(known: Known) -> Iterator[tuple[str, ConstantFigures]]:
    """Give each unknown that is on no curve with its standard deviation, now and before."""
    now, before, size = known.normal.std, known.case.prior.std, known.case.machine.size
    for i, (name, unit) in enumerate(_columns(known)):
        if unit is not None and (i < size or before[i] > 0):
            yield name, constant_figures("", UNITS.get(unit, ""), known.mean[i], now[i], before[i])


def _columns(known: Known) -> Iterator[tuple[str, str | None]]:
    """Give the name of each unknown and its unit: "" of a basis of one's own, which does not say, None on a curve."""
    for part in known.case.machine.parts:
        unit: str | None = ""
        count, basis = part.columns.stop - part.columns.start, getattr(part, "basis", None)
        if isinstance(part, Term):
            unit = None if part.spline.size > 1 else "rad" if part.angular else "m"
        elif isinstance(basis, Offset):
            unit = "rad" if basis.twist[3:].any() else "m"
        yield from ((part.name if count == 1 else f"{part.name}[{i}]", unit) for i in range(count))
    for each in known.case.instruments:
        for name in each.own:
            of = like(type(each).unknowns.get(name))
            yield f"{each.name}.{name}", of[0] if len(of) == 1 else ""


def _instruments(known: Known) -> Iterator[SetupUse]:
    """Give what was mounted, what it moves, how finely it reads and how often it did."""
    read = [] if known.readings is None else [*known.readings.places.instruments]
    for each in known.case.instruments:
        noise = [
            put("{name} {size}", name=name, size=said_quantity(sigma, UNITS[unit]))
            for name, sigma, unit in zip(each.names, each.sigma.tolist(), each.units, strict=True)
        ]
        yield SetupUse(
            name=each.name,
            instrument=type(each).__name__,
            along="",
            moves=[*each.moves],
            noise=listed(", ", noise),
            readings=read.count(each.name),
        )


def _history(known: Known, readings: Readings) -> Iterator[HistoryRow]:
    """Give where was read, what it was, and how far that is from what the others expect."""
    case, places = known.case, readings.places
    of, axes = case.numbers(readings).place, case.machine.axes
    shown_by = case.values(readings, "report")
    for i, (name, pose) in enumerate(zip(places.instruments, places.poses, strict=True)):
        units = [UNITS[unit] for unit in case.instruments[case.setups.index(name)].units]
        value, *others = (to_unit(x, unit) for x, unit in zip(shown_by[of == i].tolist(), units, strict=True))
        came = (f"{a.name}{'+' if side > 0 else '-'}" for a, side in zip(axes, places.sides[i], strict=True) if side)
        yield _part(
            HistoryRow,
            reading=i + 1,
            setup=name,
            position={a.name: to_unit(x, a.unit) for a, x in zip(axes, pose.tolist(), strict=True)},
            approach=" ".join(came),
            rejected=i in known.bad,
            value=value,
            others=others,
            units=units,
            surprise=known.z.get(i),
        )
