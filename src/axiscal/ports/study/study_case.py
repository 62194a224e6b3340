"""A case of a study: one virtual machine, measured in one way. It carries all that it is a function of."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

Method = Literal["planned", "replanned", "even", "random"]
"""How places are chosen: as a plan asks for, planned anew while readings come, evenly along the axes, or anywhere."""


class Stop(NamedTuple):
    """When a case ends: after so many readings, or so much time, s; with neither, at the target of the campaign."""

    readings: int | None = None
    budget: float | None = None


@dataclass(frozen=True, slots=True)
class Variant:
    """One way of measuring, as texts, so that it can go to another computer.

    choices : JSON of the values of the grid, by key; draw : number of the draw of [random]
    campaign, machine, truth : texts; of `truth` the errors are drawn; names : what failures call campaign and machine
    prior : text of the campaign or type whose result is the prior, or ""
    setups : those that are used, None for all; times : of the stated std of the errors
    keep : the figures that are wanted
    """

    choices: str
    draw: int
    campaign: str
    machine: str
    truth: str
    names: tuple[str, str]
    prior: str
    setups: tuple[str, ...] | None
    times: float
    stop: Stop
    method: Method
    keep: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StudyCase:
    """One machine of one variant.  seed : of the study; machine : its number from 0"""

    variant: Variant
    seed: int
    machine: int

    @property
    def key(self) -> str:
        """Name of the case as canonical JSON; with the texts it determines the outcome."""
        return key_of(json.loads(self.variant.choices), self.variant.draw, self.machine)


def key_of(choices: dict[str, Any], draw: int, machine: int) -> str:
    """Return the key of a case: values of the grid, number of the draw, number of the machine."""
    return canonical({"draw": draw, "grid": choices, "machine": machine})


def canonical(value: Any) -> str:
    """Return the one JSON text of a value."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


class KeptFigure(NamedTuple):
    """column : of the table of results; words : what it is; unit : as printed"""

    column: str
    words: str
    unit: str = ""


FIGURES = {
    "readings": KeptFigure("readings", "readings"),
    "minutes": KeptFigure("minutes", "minutes of machine time", "min"),
    "rms": KeptFigure("rms_um", "RMS promised", "µm"),
    "worst": KeptFigure("worst_um", "worst place promised", "µm"),
    "U": KeptFigure("U_um", "U, expanded uncertainty in space", "µm"),
    "true_rms": KeptFigure("true_rms_um", "RMS that is true", "µm"),
    "true_worst": KeptFigure("true_worst_um", "worst place that is true", "µm"),
    "within_U": KeptFigure("within_U", "share of the volume within U"),
    "coverage_curves": KeptFigure("coverage_curves", "share of the curves in their bands"),
    "coverage_tcp": KeptFigure("coverage_tcp", "share of the tool point in its band"),
    "agreement": KeptFigure("agreement", "whether the readings agree"),
    "said": KeptFigure("said", "warnings"),
    "reached": KeptFigure("reached", "target reached"),
}
"""By the name that a study file has for it."""
