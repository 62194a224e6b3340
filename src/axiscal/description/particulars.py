"""Who measured what with which instruments: what a report is signed for, and no figure depends on."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from axiscal.machine import Machine

if TYPE_CHECKING:
    from axiscal.description.campaign_schema import ArtefactTable, CampaignTable, SetupTable


@dataclass(frozen=True, slots=True)
class Equipment:
    """The instrument or artefact of readings: serial number and calibration certificate, "" where nobody said."""

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


def read_particulars(table: CampaignTable, machine: Machine) -> Particulars:
    """Return who measured with what."""
    built = tomllib.loads(machine.text)
    of_machine = {key: str(built.get(key, "")) for key in ("maker", "serial")}
    setups, artefacts = _equipment(table.setups), _equipment(table.artefacts)
    return Particulars(**table.report.model_dump(), **of_machine, setups=setups, artefacts=artefacts)


def _equipment(tables: Sequence[SetupTable | ArtefactTable]) -> Mapping[str, Equipment]:
    return {each.name: Equipment(each.serial, each.certificate) for each in tables}
