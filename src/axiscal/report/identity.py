"""What was calibrated, by whom and with what, as rows of a table."""

from __future__ import annotations

from axiscal.description.particulars import Equipment
from axiscal.report.sentences import spelt
from axiscal.report.summary import Summary

_UNSAID = "not stated"


def pairs(summary: Summary) -> list[tuple[str, str]]:
    """Return what is said of machine and people, each with its name; what nobody said is left out."""
    said = summary.particulars
    ended = f" to {summary.ended}" if summary.ended and summary.ended != summary.date else ""
    rows = [
        ("Machine", ", ".join(each for each in (summary.machine, said.maker) if each)),
        ("Serial number", said.serial),
        ("Chain of axes", summary.chain),
        ("Customer", said.customer),
        ("Laboratory", said.laboratory),
        ("Place", said.place),
        ("Operator", said.operator),
        ("Responsible", said.responsible),
        ("Temperature", spelt(said.temperature)),
        ("Measured", f"{summary.date}{ended}"),
        ("Remarks", said.remarks),
    ]
    artefacts = [(name, _equipment(each)) for name, each in said.artefacts.items()]
    return [(name, text) for name, text in (*rows, *artefacts) if text]


def _equipment(each: Equipment) -> str:
    certificate = f"certificate {each.certificate}" if each.certificate else ""
    return ", ".join(part for part in (each.serial, certificate) if part)


def setup_rows(summary: Summary) -> list[list[str]]:
    """Return a row for each set-up: name, instrument, serial number, certificate, along, moves, noise, readings."""
    return [
        [
            use.name,
            use.instrument,
            use.serial or _UNSAID,
            use.certificate or _UNSAID,
            use.direction,
            " ".join(use.moves),
            spelt(use.noise),
            str(use.readings),
        ]
        for use in summary.setups
    ]
