"""Priors of many errors in one go are those of one error after the other, to rounding."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from axiscal.inference.error_priors import by_length, prior_of
from axiscal.inference.priors_at_once import PriorsAtOnce
from axiscal.inference.scales import Scale, all_scales, length_owners

from axiscal.error_model.model import ErrorModel
from axiscal.machine import Machine, load_machine, machine_from_text
from axiscal.machine.entry import ROUGH, ErrorEntry
from axiscal.machine.plane_entry import PlaneEntry
from axiscal.numerics import Array
from tests.inference.test_evidence import MILL

REPEATED = MILL.replace("[errors]", '[errors]\nEXX_pitch = { std = "5 um", harmonics = 2, period = "50 mm" }')


def _rough(machine: Machine) -> Machine:
    """Return the machine with one of its curves rough, so that two kinds of curves have as many knots."""
    return replace(
        machine, errors=tuple(replace(e, smoothness=ROUGH) if e.name == "EBX" else e for e in machine.errors)
    )


def _factor(scales: tuple[Scale, ...], kind: str, owner: str, logs: Array) -> float:
    found = [float(np.exp(log)) for scale, log in zip(scales, logs, strict=True) if scale[:2] == (kind, owner)]
    return found[0] if found else 1.0


@pytest.mark.parametrize("text", [MILL, REPEATED, "three-axis-mill", "dmu60"])
@pytest.mark.parametrize("some", [1, 2, 3])
def test_they_are_those_of_each_error_alone(text: str, some: int) -> None:
    machine = _rough(machine_from_text(text)) if "\n" in text else load_machine(text)
    scales = all_scales(machine, ())[::some]
    index = {(scale.kind, scale.owner): i for i, scale in enumerate(scales)}
    entries: list[ErrorEntry | PlaneEntry] = [*machine.errors, *machine.planes]
    terms, by_name = ErrorModel(machine).terms, {entry.name: entry for entry in entries}
    once = PriorsAtOnce(terms, by_name, index)
    for logs in np.random.default_rng(some).normal(0, 0.5, (3, len(scales))):
        priors, slopes = once.at(logs), once.by_length(logs)
        assert set(priors) == set(slopes) == {term.name for term in terms}
        for term in terms:
            entry = by_name[term.name]
            owners = length_owners(entry)
            first, second = (_factor(scales, "length", owner, logs) for owner in owners)
            asked = term, entry, entry.std * _factor(scales, "std", term.name, logs), (first, second)
            np.testing.assert_allclose(priors[term.name], prior_of(*asked), rtol=1e-13)
            wanted = [
                (index[("length", owner)], by_length(*asked, number))
                for number, owner in enumerate(dict.fromkeys(owners))
                if ("length", owner) in index
            ]
            assert [at for at, _ in slopes[term.name]] == [at for at, _ in wanted]
            for (_, found), (_, expected) in zip(slopes[term.name], wanted, strict=True):
                np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-30)
