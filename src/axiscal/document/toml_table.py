"""What tables of a document are: pydantic models in which every key is known and no value is bent to fit."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from axiscal.document.validation import NAME


class Table(BaseModel):
    """A table in which every key is known; it is read by the context of `read_model`."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)


class NamedTable(Table):
    """A table whose keys are read by the name that it stands under, such as that of an axis."""

    name: str = Field(alias=NAME)


def _named(tables: Any) -> Any:
    if not isinstance(tables, dict):
        return tables
    return {key: {NAME: key, **each} if isinstance(each, dict) else each for key, each in tables.items()}


WITH_NAMES = BeforeValidator(_named)
"""Marks a table of `NamedTable`s: each is given its name."""
