"""A case of a study: one virtual machine, measured in one way. It carries all that it is a function of.

As work it can go to another process: a question with its key, and what came of it.

What one case of a study comes to: a pure function of the case, that reads no file and no clock.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from axiscal.answers.answer import number
from axiscal.campaign.ending import reaches
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.errors.model import ErrorModel
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation, expanded_uncertainty
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.prediction import tcp_prediction
from axiscal.estimation.timed import ends_along
from axiscal.exceptions import AxiscalError
from axiscal.language.stages import listening
from axiscal.machine.description import Machine, machine_from_text
from axiscal.measurement.reading import Place
from axiscal.measurement.simulation import Curve, Simulator, VirtualMachine, by_number
from axiscal.numerics import Array
from axiscal.numerics.remembered import Memo
from axiscal.numerics.threads import one_thread
from axiscal.planning.other_readings import with_rooms
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.present.findings import findings
from axiscal.units import to_unit

_POSES = 80
"""Where the tool point is looked at in each machine; the error over many machines is that of their number."""
_PREPARED = Memo(4)
"""By variants: cases come one variant after the other."""


@dataclass(frozen=True, eq=False, slots=True)
class Prepared:
    """What all machines of a variant have in common.

    simulator : makes the machines, with every set-up of the campaign, so that what a set-up does not know of itself is
    the same whichever others are used; places : of the plan
    """

    case: Case
    simulator: Simulator
    places: tuple[Place, ...]


def prepared(variant: Variant) -> Prepared:
    """Return what all machines of a variant have in common; raises InputError where it cannot be measured."""
    return _PREPARED.answer(variant, lambda: _found(variant))


def _found(variant: Variant) -> Prepared:
    names = variant.names
    described = campaign_from_texts(variant.campaign, names[0], variant.machine, names[1], prior_text=variant.prior)
    simulator = Simulator(_true_machine(described.machine, variant), described.setups)
    case = case_of(_stated(described, variant))
    plan = proposed(case, limits_of(case, variant.stop)).plan
    return Prepared(case, simulator, with_rooms(case, plan.places))


def _true_machine(machine: Machine, variant: Variant) -> Machine:
    """Return the machine of a variant with the errors as the study's machine.toml has them."""
    truth = machine_from_text(variant.truth, variant.names[1])
    return replace(machine, errors=truth.errors, planes=truth.planes)


def _stated(described: CampaignDescription, variant: Variant) -> CampaignDescription:
    """Return the campaign with the set-ups of a variant."""
    if variant.setups is None:
        return described
    return replace(described, setups=tuple(each for each in described.setups if each.name in variant.setups))


@one_thread()
def outcome(question: StudyCase) -> dict[str, Any]:
    """Return the figures of a case, by their columns.  Raises InputError where it cannot be measured."""
    ready = prepared(question.variant)
    seed, setups = _number(question.seed, question.machine), ready.case.description.setups
    truth, ends = ready.simulator.drawn(seed), ends_along(ready.case, ready.places)
    known = concluded(ready.case, truth.measured(setups, ready.places, ends, by_number(seed)))
    found = _figures(known, truth, question)
    return {figure.column: _rounded(found[name], name) for name, figure in FIGURES.items()}


def _rounded(value: Any, name: str) -> Any:
    """Return a figure as any processor gives it; whatever is no number as it is."""
    return number(value, name) if isinstance(value, float) else value


def _number(seed: int, machine: int) -> int:
    """Return what everything by chance in one machine begins with: the same in every variant."""
    digest = hashlib.sha256(f"{seed} {machine}".encode()).digest()
    return int.from_bytes(digest[:7], "big")


def _figures(known: Estimation, truth: VirtualMachine, question: StudyCase) -> dict[str, Any]:
    expanded, accuracy = expanded_uncertainty(known), known.accuracy
    size = np.linalg.norm(left_over(known, truth), axis=1)
    low, high = np.array(known.case.description.target.volume).T
    rng = np.random.default_rng((_number(question.seed, question.machine), 8))
    poses = rng.uniform(low, high, (_POSES, len(low)))
    ways = rng.choice([-1.0, 1.0], poses.shape)
    said = sorted({finding.code for finding in findings(known)} - {"unobservable"})
    return {
        "readings": len(known.readings),
        "minutes": to_unit(known.timed.seconds, "min"),
        "rms": to_unit(accuracy.rms, "um"),
        "worst": to_unit(accuracy.worst, "um"),
        "U": to_unit(expanded.space, "um"),
        "true_rms": to_unit(float(np.sqrt(np.mean(size**2))), "um"),
        "true_worst": to_unit(float(size.max()), "um"),
        "within_U": float(np.mean(size <= expanded.space)),
        "coverage_curves": curves_held(known, truth),
        "coverage_tcp": tcp_held(known, truth, poses, ways),
        "agreement": "contradict" if known.agreement.contradicts else "agree",
        "said": " ".join(said),
        "reached": reaches(known.case.description.target, known),
    }


def left_over(known: Estimation, truth: VirtualMachine) -> Array:
    """Return what the estimate misses of the TCP deviation over the volume, (m, 3) m.

    As in the promised figures, it leaves out a shift that no set-up sees, the rigid motion of a probed part, or
    directions that do not count.
    """
    yardstick, errors = known.case.yardstick, ErrorModel(truth.model.machine)
    poses = yardstick.inside
    sides = (1.0, -1.0) if errors.reversing else (1.0,)
    parts = list[Array]()
    for side in sides:
        ways = np.full_like(poses, side)
        left = truth.deviation(poses, ways) - known.estimate().deviation(poses, ways)
        parts.append(left if yardstick.alignment is None else yardstick.alignment.left(poses, left))
    whole: Array = np.concatenate(parts)
    shift: Array = whole.mean(axis=0) * np.array(yardstick.zeroed, dtype=float)
    counted: Array = (whole - shift) * np.array(yardstick.counted, dtype=float)
    return counted


_POSITIONS = 101
"""Of each curve; any number that is finer than its knots would do."""


def curves_held(estimation: Estimation, machine: VirtualMachine) -> float:
    """Return the share of all error curves, at 101 positions each, that lies in their 95 % bands."""
    names = [term.name for term in machine.model.terms]
    inside = [
        _curve(estimation, name, machine.curves[names.index(name)])
        for name in estimation.case.errors.names
        if name in names
    ]
    return float(np.mean(np.concatenate(inside)))


def _curve(estimation: Estimation, name: str, truth: Curve) -> Array:
    function = estimation.case.errors.names[name]
    positions = np.linspace(function.basis.knots[0], function.basis.knots[-1], _POSITIONS)
    mean, std = estimation.estimate().curve(name, positions)
    return (np.abs(truth(positions) - mean) <= BAND * std).astype(float)


def tcp_held(estimation: Estimation, machine: VirtualMachine, poses: Array, approaches: Array) -> float:
    """Return the share of the TCP deviations along x, y, z at poses (m, q) that lies in their 95 % bands."""
    mean, std = tcp_prediction(estimation, poses, approaches)
    moves = std > 0
    inside = np.abs(machine.deviation(poses, approaches) - mean)[moves] <= BAND * std[moves]
    return float(inside.mean())


def limits_of(case: Case, stop: Stop) -> Limits:
    """Return when a case ends: what the study says, else the target of the campaign."""
    if stop.readings is not None or stop.budget is not None:
        return Limits(stop.readings, budget=stop.budget)
    return Limits.of(case.description.target)


class Stop(NamedTuple):
    """When a case ends: after so many readings, or so much time, s; with neither, at the target of the campaign."""

    readings: int | None = None
    budget: float | None = None


@dataclass(frozen=True, slots=True)
class Variant:
    """One way of measuring, as texts, so that it can go to another process.

    choices : JSON of the values of the grid, by key
    campaign, machine, truth : texts; of `truth` the errors are drawn; names : what failures call campaign and machine
    prior : text of the campaign or type whose result is the prior, or ""
    setups : those that are used, None for all
    """

    choices: str
    campaign: str
    machine: str
    truth: str
    names: tuple[str, str]
    prior: str
    setups: tuple[str, ...] | None
    stop: Stop


@dataclass(frozen=True, slots=True)
class StudyCase:
    """One machine of one variant.  seed : of the study; machine : its number from 0"""

    variant: Variant
    seed: int
    machine: int

    @property
    def key(self) -> str:
        """Name of the case as canonical JSON; with the texts it determines the outcome."""
        return key_of(json.loads(self.variant.choices), self.machine)


def key_of(choices: dict[str, Any], machine: int) -> str:
    """Return the key of a case: values of the grid, number of the machine."""
    return canonical({"grid": choices, "machine": machine})


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


Solve = Callable[[Any], dict[str, Any]]
"""A pure function of a question that can be pickled; its result can be written as JSON."""


class WorkItem(NamedTuple):
    """asked : what `Solve` is given"""

    key: str
    asked: Any


class Done(NamedTuple):
    """result : None where there is an error instead, in words"""

    key: str
    result: dict[str, Any] | None
    error: str = ""


Engine = Callable[[Solve, Iterable[WorkItem]], Generator[Done]]
"""Yields what comes of questions, in any order: worked on in this process, or in some of this computer."""


def answered(solve: Solve, question: WorkItem) -> Done:
    """Return what comes of a question; whatever is wrong with it is kept, and others go on."""
    try:
        return Done(question.key, solve(question.asked))
    except AxiscalError as fault:
        return Done(question.key, None, str(fault))
    except Exception as fault:  # noqa: BLE001 - a defect in one case of thousands is a row of the table
        return Done(question.key, None, f"a defect in axiscal: {type(fault).__name__}: {fault}")


def here(solve: Solve, questions: Iterable[WorkItem]) -> Generator[Done]:
    """Yield what comes of questions, worked on in this process."""
    for question in questions:
        with listening(None):  # which case it is counts, not what is done in it
            found = answered(solve, question)
        yield found


def processors_here() -> int:
    """Return how many processors this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
