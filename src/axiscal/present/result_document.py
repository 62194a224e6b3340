"""`result.json`: what a summary says, as the document `axiscal-result/1`.

All readings as a CSV file, for spreadsheets and where the report lists the first ones alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from hashlib import sha256
from typing import Any

from axiscal.answers.answer import coordinate, number
from axiscal.answers.answer_words import answer_text
from axiscal.answers.row_words import row_names
from axiscal.measurement.readers.csv_readings import FOUND
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.present.result_set import RECORD
from axiscal.present.sentences import axis_unit
from axiscal.present.summary import Summary, TableOffer, Written

READINGS = "readings.csv"
"""Its name."""


def readings_csv(summary: Summary) -> bytes:
    """Return the file of all readings, the same in every language; raises SummaryError for a figure not finite."""
    return csv_text(_readings(summary)).encode("utf-8", "replace")


def _readings(summary: Summary) -> Iterator[Sequence[str]]:
    """Yield the lines; what `axiscal data estimate` reads, and what was found beside it."""
    rows = [row for row in summary.history if row["position"] is not None]
    axes = list(dict.fromkeys(axis for row in rows for axis in row["position"]))
    values = list(dict.fromkeys(column for row in rows for column in row["columns"]))
    stds = list(dict.fromkeys(f"std_{row['unit']}" for row in rows if row["std"] is not None))
    clock = ["time"] if all(row["time"] is not None for row in rows) else []
    drawn = ["check"] if any(row["check"] for row in rows) else []
    columns = {axis: f"{axis}{'_radius' * (axis in summary.radii)}_{axis_unit(axis)}" for axis in axes}
    names = ["reading", "setup", *columns.values(), "approach", *values, *stds, *clock, *drawn]
    yield [*names, *FOUND]
    for row in rows:
        cells = {"reading": str(row["reading"]), "setup": row["setup"], "approach": row["approach"]}
        at = {axis: coordinate(each, "a position in a CSV file") for axis, each in row["position"].items()}
        cells |= {columns[axis]: f"{each:.12g}" for axis, each in at.items()}
        cells |= zip(row["columns"], map(_figure, (row["value"], *row["others"])), strict=True)
        cells |= {f"std_{row['unit']}": _figure(row["std"]), "time": f"{_figure(row['time'])} s"}
        cells |= {"check": "yes" * row["check"]}
        found = [*map(_figure, (row["innovation"], row["surprise"])), "no" if row["rejected"] else "yes"]
        yield [*(cells.get(name, "") for name in names), *found, *map(_figure, (row["rms_um"], row["minutes"]))]


def _figure(value: float | None) -> str:
    return "" if value is None else f"{number(value, 'a figure of a CSV file'):.6g}"


EFFECT = ("before_um", "after_um", "expected_um", "U_um")
"""Figures of a table."""
_HISTORY = (
    "reading setup approach position value others unit units innovation surprise rms_um worst_um minutes rejected by"
)
_REJECTED = "reading setup unit reason value position"
_WHO = "number customer laboratory place operator responsible temperature remarks maker serial"


def result_json(summary: Summary) -> dict[str, Any]:
    """Return the document `axiscal-result/1`; raises SummaryError for a number that is not finite."""
    taken = [row["reading"] for row in summary.history if row["value"] is not None]
    known = _figures(summary.expanded, "uncertainties") | _kept(summary, "rms_um worst_um")
    return {
        "schema": "axiscal-result/1",
        "identity": _identity(summary),
        "words": answered(summary),
        **_kept(summary, "machine readings minutes stopped_because setups"),
        "agreement": {
            **_kept(summary.agreement, "count agreeing c2 p", contradict=summary.agreement.contradicts),
            "explained": _figures(summary.mistakes, "a mistake"),
            "text": summary.agreement_words,
        },
        "checks": {
            **_kept(summary.checks, "as_promised s", count=len(summary.checks.each)),
            "each": [_kept(each, "z used", reading=taken[each.reading]) for each in summary.checks.each],
        },
        **(dict.fromkeys(known) if summary.answer.withheld else known),
        **_kept(summary, "unseen_rms_um budget", budget_smaller_um=summary.smaller_um),
        **_kept(summary, "nonlinearity target_rms_um target_worst_um", target_U_um=summary.target_u_um),
        "target_reached": summary.target_reached,
        "history": [_row(row, _HISTORY) for row in summary.history],
        **_kept(summary, "errors plane_errors volume constants iso230 observability questions"),
        "rejected": [_row(row, _REJECTED) for row in summary.history if row["rejected"]],
        "warnings": [_kept(each, "code error text") for each in summary.warnings],
        "answer": summary.answer.model_dump(mode="json", exclude={"rows", "aims"})
        | {"aims": [aim.model_dump(mode="json") | _kept(aim, "now limit floor") for aim in summary.answer.aims]},
        "rows": [row.model_dump(mode="json") for row in summary.answer.rows],
        "tables": [table for offer in summary.tables for table in _tables(offer, summary.answer.withheld)],
        "versions": dict(sorted(summary.versions.items())),
        "inputs": {**summary.checksums, f"data/{READINGS}": sha256(readings_csv(summary)).hexdigest()},
        **({"record": _kept(summary.record, "file event hash")} if summary.record else {}),
    }


def _identity(summary: Summary) -> dict[str, Any]:
    """Return whose machine it is, who measured when, and for whom, as far as somebody has said so."""
    known, taken = summary.particulars, _kept(summary, "chain campaign_file ended", begun=summary.date)
    artefacts = {
        name: _stated({"serial": each.serial, "certificate": each.certificate})
        for name, each in known.artefacts.items()
    }
    return _stated(taken | _kept(known, _WHO) | {"artefacts": artefacts})


def _stated(fields: dict[str, Any]) -> dict[str, Any]:
    """Return fields without the texts and tables that are empty."""
    return {name: value for name, value in fields.items() if value not in ("", {})}


def answered(summary: Summary) -> dict[str, Any]:
    """Return the answer as every surface says it: first line, rows as cells, sentences, names of rows."""
    record = RECORD if summary.record is None or summary.tables else summary.record.file  # with tables come copies
    signed = "" if summary.record is None else summary.record.signed
    told = answer_text(summary.answer, summary.agreement_words, record, evidence=signed)
    names = {row.row: row_names([row]) for row in summary.answer.rows}
    return {"first": told.first.parts, "rows": told.rows, "sentences": told.sentences, "names": names}


def _kept(what: object, fields: str, **named: Any) -> dict[str, Any]:
    """Return fields of a summary by their names, figures as they are written.  named : whose name is another"""
    found = {name: getattr(what, name) for name in fields.split()} | named
    whose = getattr(what, "name", type(what).__name__)
    return {name: _figures(value, f"{name} of {whose}") for name, value in found.items()}


def _figures(value: Any, what: str) -> Any:
    """Return a value of a summary as JSON has it; raises SummaryError for a figure that is not finite."""
    if isinstance(value, float):
        return number(value, what)
    if isinstance(value, Mapping):
        return {name: _figures(each, f"{name} of {what}") for name, each in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_figures(each, what) for each in value]
    return value


def _row(row: Written, names: str) -> dict[str, Any]:
    at = row["position"] and {axis: coordinate(each, f"position of {axis}") for axis, each in row["position"].items()}
    return {name: at if name == "position" else _figures(row[name], f"{name} of a reading") for name in names.split()}


def _tables(offer: TableOffer, withheld: bool) -> Iterator[dict[str, Any]]:
    """Yield each file of a control, or why there is none."""
    found = {**dict.fromkeys(EFFECT), **offer.effect, **({"U_um": None} if withheld else {})}
    for file, axis in (offer.axes or {"": ""}).items():
        named = {"axis": axis, "left_out": offer.left_out, "file": file if offer.effect else None}
        yield _kept(offer, "controller", **named, **found)
