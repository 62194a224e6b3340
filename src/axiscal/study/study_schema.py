"""The keys of a study file, as pydantic models; only `study_file` uses them."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from axiscal.study.figures_kept import FIGURES

MOST_MACHINES = 1_000_000
"""More is a slip of the finger."""


class _KnownKeys(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class StudyTable(_KnownKeys):
    """[study]: what every case begins with."""

    campaign: str = Field(examples=['"campaign.toml"'])
    seed: int = Field(1, ge=0, le=2**63, examples=["1"])
    machines: int = Field(100, ge=1, le=MOST_MACHINES, examples=["200"])
    stop: str | dict[str, Any] = Field("target", examples=['"target"', "{ readings = 30 }"])
    method: Literal["planned", "replanned", "even", "random"] = Field("planned", examples=['"planned"'])


class ResultsTable(_KnownKeys):
    """[results]: what is kept of every case."""

    keep: list[str] = Field(default=list(FIGURES), min_length=1, examples=['["minutes", "U"]'])


class StudyFile(_KnownKeys):
    """The whole file."""

    study: StudyTable = Field(examples=['{ campaign = "campaign.toml" }'])
    grid: dict[str, list[Any]] = Field(default={}, examples=['{ "target.rms" = ["4 um", "8 um"] }'])
    random: dict[str, Any] = Field(default={}, examples=["{ draws = 100 }"])
    results: ResultsTable = Field(default_factory=ResultsTable)
