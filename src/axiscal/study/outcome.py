"""What one case of a study comes to: a pure function of the case, that reads no file and no clock."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from axiscal.campaign.ending import reaches
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.design.plan.task import Limits
from axiscal.error_model.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.uncertain import expanded_uncertainty
from axiscal.machine.description import Machine, machine_from_text
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.report.digits import number
from axiscal.report.findings import findings
from axiscal.simulation import Simulator, VirtualMachine
from axiscal.study.closed_loop import Reader, replanned
from axiscal.study.coverage import curves_held, tcp_held
from axiscal.study.figures_kept import FIGURES
from axiscal.study.places_read import limits_of, places_read
from axiscal.study.study_case import StudyCase, Variant
from axiscal.units import to_unit

_POSES = 80
"""Where the tool point is looked at in each machine; the error over many machines is that of their number."""
_VARIANTS = 4
"""Prepared at a time: cases come one variant after the other."""


@dataclass(frozen=True, eq=False, slots=True)
class Prepared:
    """What all machines of a variant have in common.

    simulator : makes the machines, with every set-up of the campaign, so that what a set-up does not know of itself is
    the same whichever others are used; places : None where each machine has its own
    """

    case: Case
    limits: Limits
    simulator: Simulator
    places: tuple[Place, ...] | None


def prepared(variant: Variant) -> Prepared:
    """Return what all machines of a variant have in common; raises InputError where it cannot be measured."""
    return prepared_from(variant.text)


@lru_cache(maxsize=_VARIANTS)
def prepared_from(text: str) -> Prepared:
    """Return what all machines of a variant have in common, from its text."""
    variant = Variant.from_text(text)
    names = variant.names
    described = campaign_from_texts(variant.campaign, names[0], variant.machine, names[1], prior_text=variant.prior)
    simulator = Simulator(_true_machine(described.machine, variant), described.setups)
    case = case_of(_stated(described, variant))
    limits = limits_of(case, variant.stop)
    own = variant.method in ("random", "replanned")
    places = None if own else places_read(case, variant.method, limits, np.random.default_rng(0))
    return Prepared(case, limits, simulator, places)


def _true_machine(machine: Machine, variant: Variant) -> Machine:
    """Return the machine of a variant with the errors as the study's machine.toml has them."""
    truth = machine_from_text(variant.truth, variant.names[1])
    return replace(machine, errors=truth.errors, planes=truth.planes)


def _stated(described: CampaignDescription, variant: Variant) -> CampaignDescription:
    """Return the campaign with the set-ups that are used and errors of so many times the true std."""
    if variant.setups is not None:
        chosen = tuple(setup for setup in described.setups if setup.name in variant.setups)
        described = replace(described, setups=chosen)
    if variant.times == 1:
        return described
    machine, times = described.machine, variant.times
    errors = tuple(
        replace(entry, std=times * entry.std, rest=None if entry.rest is None else times * entry.rest)
        for entry in machine.errors
    )
    planes = tuple(
        replace(plane, std=times * plane.std, rest=None if plane.rest is None else times * plane.rest)
        for plane in machine.planes
    )
    return replace(described, machine=replace(machine, errors=errors, planes=planes))


@one_thread()
def outcome(question: StudyCase) -> dict[str, Any]:
    """Return the figures of a case, by their columns.  Raises InputError where it cannot be measured."""
    ready = prepared(question.variant)
    truth = ready.simulator.drawn(_number(question.seed, question.machine))
    readings = _read(ready, truth, question)
    known = concluded(ready.case, readings)
    found = _figures(known, truth, question)
    return {FIGURES[name].column: _rounded(found[name], name) for name in question.variant.keep}


def _read(ready: Prepared, truth: VirtualMachine, question: StudyCase) -> tuple[Reading, ...]:
    """Return what is read of one machine."""
    variant, number = question.variant, _number(question.seed, question.machine)
    if variant.method == "replanned":
        return replanned(ready.case, variant.stop, truth, number)
    places = ready.places
    if places is None:
        rng = np.random.default_rng((number, 7))
        places = places_read(ready.case, variant.method, ready.limits, rng)
    return taken(ready.case, truth, places, number)


def _rounded(value: Any, name: str) -> Any:
    """Return a figure as any processor gives it; whatever is no number as it is."""
    return number(value, name) if isinstance(value, float) else value


def _number(seed: int, machine: int) -> int:
    """Return what everything by chance in one machine begins with: the same in every variant."""
    digest = hashlib.sha256(f"{seed} {machine}".encode()).digest()
    return int.from_bytes(digest[:7], "big")


def taken(case: Case, truth: VirtualMachine, places: tuple[Place, ...], number: int) -> tuple[Reading, ...]:
    """Return what a virtual machine shows at places, one after the other; zeros drift with the time of the plan."""
    reader = Reader(case, truth, number)
    for place in places:
        reader.take(place)
    return reader.readings


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
        "minutes": to_unit(known.seconds, "min"),
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

    What is not counted is taken off as in the figures that are promised: a shift that no set-up sees, the rigid
    motion of a part that is probed, or directions that do not count.
    """
    yardstick, errors = known.case.yardstick, ErrorModel(truth.model.machine)
    poses = yardstick.places[yardstick.evenly[: len(yardstick.places)]]
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
