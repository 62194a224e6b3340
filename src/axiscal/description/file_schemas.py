"""machine.toml and campaign.toml as JSON schemas, by which editors complete and check while somebody writes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pydantic import BaseModel

from axiscal.description.campaign_schema import CampaignTable
from axiscal.machine.machine_schema import MachineFile
from axiscal.measurement.instrument import INSTRUMENTS

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def machine_schema() -> dict[str, Any]:
    """Return the schema of machine.toml."""
    return _schema(MachineFile, "machine.toml: the machine, stable over years")


def campaign_schema() -> dict[str, Any]:
    """Return the schema of campaign.toml; it knows the names of the instruments."""
    schema = _schema(CampaignTable, "campaign.toml: one calibration")
    schema["$defs"]["SetupTable"]["properties"]["instrument"]["enum"] = list(INSTRUMENTS)
    return schema


SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {"machine": machine_schema, "campaign": campaign_schema}
"""By the file that they describe."""


def _schema(model: type[BaseModel], title: str) -> dict[str, Any]:
    return {"$schema": _DIALECT, **_told(model.model_json_schema()), "title": title}


def _told(schema: dict[str, Any]) -> dict[str, Any]:
    """Return a schema for a person who writes the file: examples as it has them, no defaults in SI units."""
    told = {key: _below(key, value) for key, value in schema.items() if key not in ("default", "examples", "title")}
    if "examples" in schema:
        told["description"] = f"Such as {' or '.join(schema['examples'])}"
    return told


def _below(key: str, value: Any) -> Any:
    """Return what stands under a keyword: a schema, several of them by name or in a list, or anything else."""
    if key in ("properties", "$defs"):
        return {name: _told(each) for name, each in value.items()}
    if isinstance(value, list):
        return [_told(each) if isinstance(each, dict) else each for each in value]
    return _told(value) if isinstance(value, dict) else value
