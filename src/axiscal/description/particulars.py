"""Who measured what with which instruments: what a report is signed for, and no figure depends on."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import Field

from axiscal.description.campaign_schema import ArtefactTable, CampaignTable, ReportTable, SetupTable
from axiscal.machine import Machine


@dataclass(frozen=True, slots=True)
class Equipment:
    """The instrument or artefact of readings: serial number and calibration certificate, "" where nobody said."""

    serial: str = ""
    certificate: str = ""


class Particulars(ReportTable, frozen=True):
    """[report] of campaign.toml, with its machine, instruments and artefacts; "" where nothing is said.

    maker, serial : of the machine; setups, artefacts : by name
    """

    maker: str = ""
    serial: str = ""
    setups: dict[str, Equipment] = Field(default={})
    artefacts: dict[str, Equipment] = Field(default={})


NOTHING_SAID = Particulars()


def read_particulars(table: CampaignTable, machine: Machine) -> Particulars:
    """Return who measured with what."""
    built = tomllib.loads(machine.text)
    of_machine = {key: str(built.get(key, "")) for key in ("maker", "serial")}
    setups, artefacts = _equipment(table.setups), _equipment(table.artefacts)
    return Particulars(**table.report.model_dump(), **of_machine, setups=setups, artefacts=artefacts)


def _equipment(tables: Sequence[SetupTable | ArtefactTable]) -> dict[str, Equipment]:
    return {each.name: Equipment(each.serial, each.certificate) for each in tables}
