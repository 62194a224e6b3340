"""What was calibrated, by whom and with what, as rows of a table."""

from __future__ import annotations

from axiscal.description.particulars import Equipment
from axiscal.language.spoken import later, said
from axiscal.report.sentences import spelt
from axiscal.report.summary import Summary

UNSAID = later("not stated")


def pairs(summary: Summary) -> list[tuple[str, str]]:
    """Return what is said of machine and people, each with its name; what nobody said is left out."""
    known, measured = summary.particulars, summary.date
    if summary.ended and summary.ended != summary.date:
        measured = said("{begun} to {ended}", begun=summary.date, ended=summary.ended)
    rows = [
        (said("Machine"), ", ".join(each for each in (summary.machine, known.maker) if each)),
        (said("Serial number"), known.serial),
        (said("Chain of axes"), summary.chain),
        (said("Customer"), known.customer),
        (said("Laboratory"), known.laboratory),
        (said("Place"), known.place),
        (said("Operator"), known.operator),
        (said("Responsible"), known.responsible),
        (said("Temperature"), spelt(known.temperature)),
        (said("Measured"), measured),
        (said("Remarks"), known.remarks),
    ]
    artefacts = [(said("Artefact {name}", name=name), _equipment(each)) for name, each in known.artefacts.items()]
    return [(name, text) for name, text in (*rows, *artefacts) if text]


def _equipment(each: Equipment) -> str:
    certificate = said("certificate {number}", number=each.certificate) if each.certificate else ""
    return ", ".join(part for part in (each.serial, certificate) if part)


def setup_rows(summary: Summary) -> list[list[str]]:
    """Return a row for each set-up: name, instrument, serial number, certificate, along, moves, noise, readings."""
    return [
        [
            use.name,
            use.instrument,
            use.serial or said(UNSAID),
            use.certificate or said(UNSAID),
            use.direction,
            " ".join(use.moves),
            spelt(use.noise),
            str(use.readings),
        ]
        for use in summary.setups
    ]
