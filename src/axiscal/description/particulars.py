"""Who measured what with which instruments: what a report is signed for, and no figure depends on."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import LANGUAGES
from axiscal.machine import Machine

if TYPE_CHECKING:
    from axiscal.description.artefact_schema import ArtefactTable
    from axiscal.description.campaign_schema import CampaignTable, SetupTable

_LONGEST = 500
"""Characters: a paragraph; a matter of taste."""


@dataclass(frozen=True, slots=True)
class Equipment:
    """What was read with, or read at: serial number and calibration certificate, "" where nobody said."""

    serial: str = ""
    certificate: str = ""


@dataclass(frozen=True, slots=True)
class Particulars:
    """What campaign.toml says under [report], and of its instruments and artefacts; "" where nothing is said.

    number : of the report; language : that it is written in; country : two letters (ISO 3166-1);
    temperature : of machine and room, in words
    maker, serial : of the machine; setups, artefacts : by name
    """

    number: str = ""
    operator: str = ""
    responsible: str = ""
    laboratory: str = ""
    place: str = ""
    country: str = ""
    customer: str = ""
    temperature: str = ""
    remarks: str = ""
    language: str = ""
    maker: str = ""
    serial: str = ""
    setups: Mapping[str, Equipment] = field(default_factory=dict)
    artefacts: Mapping[str, Equipment] = field(default_factory=dict)


NOTHING_SAID = Particulars()


def read_particulars(table: CampaignTable, machine: Machine, document: Document) -> Particulars:
    """Return who measured with what; raises DescriptionError for a text that no report could show."""
    said = table.report.model_dump()
    for key, text in said.items():
        _refuse_odd(text, document, "report", key)
    if said["country"] and not (len(said["country"]) == 2 and said["country"].isascii() and said["country"].isalpha()):
        fault = DescriptionError(f"{shown(said['country'])} is no country of two letters", 'Such as country = "DE"')
        raise document.fault(fault, "report", "country")
    if said["language"] and said["language"] not in LANGUAGES:
        known = ", ".join(f'language = "{short}" ({long})' for short, long in LANGUAGES.items())
        fault = DescriptionError(f"{shown(said['language'])} is no language of reports", f"There are {known}")
        raise document.fault(fault, "report", "language")
    built = tomllib.loads(machine.text)
    said |= {key: str(built.get(key, "")) for key in ("maker", "serial")}
    setups, artefacts = _equipment(table.setups, document, "setups"), _equipment(table.artefacts, document, "artefacts")
    return Particulars(**said, setups=setups, artefacts=artefacts)


def _equipment(tables: Sequence[SetupTable | ArtefactTable], document: Document, where: str) -> Mapping[str, Equipment]:
    found = {}
    for number, each in enumerate(tables):
        for key in ("serial", "certificate"):
            _refuse_odd(getattr(each, key), document, where, number, key)
        found[each.name] = Equipment(each.serial, each.certificate)
    return found


def _refuse_odd(text: str, document: Document, *where: str | int) -> None:
    if len(text) > _LONGEST or not text.replace("\n", " ").isprintable():
        remedy = f"Write up to {_LONGEST} characters that can be printed"
        raise document.fault(DescriptionError(f"{shown(text)} cannot stand in a report", remedy), *where)
