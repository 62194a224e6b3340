"""What tables of a document are: pydantic models in which every key is known and no value is bent to fit."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Strict

AS_TUPLE = Strict(False)
"""Marks a tuple: files have lists."""


class Table(BaseModel):
    """A table in which every key is known; it is read by the context of `read_model`."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)
