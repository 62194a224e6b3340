"""Problems of the posterior: an axis with a reversal, five axes, a plate with a plane, two set-ups, stated noises."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.usual import usual_machine
from axiscal.estimation.case import Case
from axiscal.estimation.promise.problem import problem
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal_core.normal import Normal
from axiscal_core.problem import Problem
from axiscal_core.theta import Sizes
from axiscal_core.usual import sizes_of
from tests.generators.campaigns import CAMPAIGN as TWO_SETUPS
from tests.generators.planes import warped
from tests.generators.texts import machine_text

AXIS = machine_text(
    "w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "10 um", length = "200 mm", knots = 11', "EXX_reversal": "3 um"}
)
_HEAD = 'machine = "m"\nusual = "off"\n[target]\nreadings = 1\n'
_SETUP = '[[setups]]\nname = "it"\napproach = "both"\nnoise = "0.5 um"\n'
_LASER = 'instrument = "interferometer"\ndirection = "x"\nunknowns = { zero = "1 mm" }\n'
_PROBE = 'instrument = "probe"\ndirection = "z"\nunknowns = { zero = "1 mm" }\n'
_NEST = 'instrument = "rtest"\nstation = ["150 mm", "0 mm", "100 mm"]\n'


def _case(machine: str, setup: str) -> Case:
    return Case(campaign_from_texts(_HEAD + _SETUP + setup, "campaign.toml", machine, "m"))


def case_of(kind: str) -> Case:
    """Return a case by its name, with the rough part of each curve."""
    plain = plain_case(kind)
    described = plain.description
    return replace(plain, description=replace(described, machine=usual_machine(described.machine, described.setups)))


def plain_case(kind: str) -> Case:
    """Return a case by its name, without any rough part that its machine does not state."""
    if kind == "axis":
        return _case(AXIS, _LASER)
    if kind == "plate":
        return _case(warped((5, 4)).replace('rest = "2 um"', 'rest = "2 um", smoothness = 1.5'), _PROBE)
    if kind == "five axes":
        return _case(load_machine("dmu60").text, _NEST)
    text = load_machine("three-axis-mill").text
    return Case(campaign_from_texts(f'usual = "off"\n{TWO_SETUPS}', "campaign.toml", text, "mill"))


KINDS = ("axis", "plate", "five axes", "two set-ups")


def readings_of(case: Case, count: int, seed: int, stds: bool = False) -> list[Reading]:
    """Return readings of a virtual machine at places and sides anywhere, a minute apart.

    stds : every fourth states its own noise
    """
    rng, described = np.random.default_rng((seed, 1)), case.description
    machine = Simulator(described.machine, described.setups).drawn(seed)
    low, high = np.array([axis.travel for axis in described.machine.axes]).T

    def taken(i: int) -> Reading:
        setup = described.setups[i % len(described.setups)]
        pose = np.where(np.isin(np.arange(len(low)), setup.moves), rng.uniform(low, high), setup.park)
        sides = tuple(int(side) for side in rng.choice([-1, 1], len(low)))
        value, *others = machine.read_all(setup, tuple(pose.tolist()), sides, rng, 60.0 * i)
        std = 2e-6 if stds and i % 4 == 0 else None
        return Reading(setup.name, tuple(pose.tolist()), sides, value, std, others=tuple(others), time=60.0 * i)

    return [taken(i) for i in range(count)]


def asked(kind: str, count: int, seed: int = 0, stds: bool = False, inherits: bool = False) -> Problem:
    """Return a problem.  inherits : whether an earlier campaign left a prior"""
    case = case_of(kind)
    return stated(case, readings_of(case, count, seed, stds), inherited(case, seed) if inherits else None)


def stated(case: Case, readings: Sequence[Reading], left: Normal | None = None) -> Problem:
    """Return the problem of readings with what usually goes wrong."""
    described = case.description
    sizes = sizes_of(
        described.machine, [setup.name for setup in described.setups], "roughly", usual=True, inherited=left is not None
    )
    return problem(case.observation, readings, sizes, left)


def inherited(case: Case, seed: int) -> Normal:
    """Return a prior as an earlier campaign might leave it: correlated, and not about nought."""
    rng, prior = np.random.default_rng((seed, 2)), case.observation.prior_covariance()
    size = case.errors.size
    stds = np.sqrt(np.diagonal(prior)[:size])
    mixed = np.eye(size) + 0.3 * rng.standard_normal((size, size)) / np.sqrt(size)
    root = 0.3 * stds[:, None] * mixed
    return Normal.of_factor(0.5 * stds * rng.standard_normal(size), root)


def plain(case: Case, readings: Sequence[Reading], sizes: Sizes) -> Problem:
    """Return the problem without what readings alone suffer."""
    return problem(case.observation, readings, sizes, None, usual=False)


def sized(given: Problem, kinds: Sequence[str]) -> Problem:
    """Return a problem with the sizes of some kinds only; the others are as stated."""
    kept = [i for i, size in enumerate(given.sizes.of) if size.kind in kinds]
    number = np.full(len(given.sizes) + 1, -1, dtype=np.intp)
    number[kept] = np.arange(len(kept))

    def of(at: NDArray[np.intp]) -> NDArray[np.intp]:
        return np.where(at < 0, -1, number[at])

    curves = tuple(replace(each, length_at=of(each.length_at)) for each in given.curves)
    sizes = Sizes(tuple(given.sizes.of[i] for i in kept))
    return replace(given, sizes=sizes, size_at=of(given.size_at), groups=of(given.groups), curves=curves)
