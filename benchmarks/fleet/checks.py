"""How often a check of few readings finds a crash, and calls a machine in order out of order: on a three-axis mill.

`python -m benchmarks.fleet.checks`; figures for docs/evidence/fleet.md. A machine is drawn as a campaign of sixty
readings left it and as it drifts since; then its squareness A0Z is off, or the scale of Z, or both.
"""

from __future__ import annotations

from itertools import repeat

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case, ends_along
from axiscal.estimation.promise.problem import Inherited
from axiscal.machine import load_machine
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.ports.fleet.quick_check import QuickCheck
from axiscal_core.eigen import unique_root
from axiscal_core.threads import one_thread

NAME = "three-axis-mill"
_LASER = """[[setups]]
name = "laser {0}"
instrument = "interferometer"
direction = "{0}"
moves = ["{1}"]
noise = "0.5 um"
approach = "both"
"""
_PROBE = """[[setups]]
name = "probe {0}"
instrument = "probe"
direction = "{0}"
moves = ["X", "Y", "Z"]
reach = {{ X = ["0 mm", "600 mm"], Y = ["0 mm", "400 mm"], Z = ["0 mm", "400 mm"] }}
approach = "both"
"""
KEPT, TRIALS, COUNTS, EACH = 0.95, 200, (12, 8, 6), 10
"""Share that is kept; machines; readings of a check; readings of each set-up in the campaign before."""


@one_thread()
def main() -> None:
    """Print what each number of readings finds."""
    setups = "".join(each.format(axis, axis.upper()) for each in (_LASER, _PROBE) for axis in "xyz")
    text = f'machine = "{NAME}"\n[target]\nrms = "4 um"\n{setups}'
    described = campaign_from_texts(text, "campaign.toml", load_machine(NAME).text, NAME)
    case, rng = Case(described), np.random.default_rng(30)
    stated, size = case.errors.prior_covariance(), case.errors.size
    left = _after(case, rng)[:size, :size]
    mean = _drawn(stated - left, rng)
    check, crashes = QuickCheck(described, Inherited(mean, left), KEPT), _crashes(case.errors)
    for count in COUNTS:
        places, called = check.planned(count), dict.fromkeys(crashes, 0)
        for trial in range(TRIALS):
            now = KEPT * (mean + _drawn(left, rng)) + np.sqrt(1 - KEPT**2) * _drawn(stated, rng)
            for name, crash in crashes.items():
                virtual = Simulator(described.machine, described.setups).with_coefficients(now + crash, trial)
                chance = repeat(np.random.default_rng((trial, 6)))
                readings = virtual.measured(described.setups, places, ends_along(case, places), chance)
                called[name] += not check.judged(readings).in_order
        said = ", ".join(f"{name} {100 * times / TRIALS:.1f} %" for name, times in called.items())
        used = len({place.setup for place in places})
        print(f"{count} readings in {used} set-ups, called out of order: {said}", flush=True)


def _after(case: Case, rng: np.random.Generator) -> Array:
    """Return the covariance of all unknowns after a campaign, (n, n)."""
    covariance = case.prior.covariance
    for index in range(len(case.description.setups)):
        poses, approaches = case.lattice.in_setup(index)
        some = rng.choice(len(poses), EACH, replace=False)
        seen = case.observation.rows(index, poses[some], approaches[some])
        shown = covariance @ seen.rows.T
        covariance = covariance - shown @ np.linalg.solve(seen.rows @ shown + np.diag(seen.variances), shown.T)
    return covariance


def _crashes(errors: ErrorModel) -> dict[str, Array]:
    columns = {term.name: term.columns for term in errors.terms}
    square, scale = np.zeros(errors.size), np.zeros(errors.size)
    square[columns["A0Z"]] = 90e-6
    scale[columns["EZZ"]] = np.linspace(-20e-6, 20e-6, columns["EZZ"].stop - columns["EZZ"].start)
    alone = {"squareness of Z to Y by 90 urad": square, "scale of Z by 40 um": scale, "both": square + scale}
    return {"nothing": np.zeros(errors.size), **alone}


def _drawn(covariance: Array, rng: np.random.Generator) -> Array:
    drawn: Array = unique_root((covariance + covariance.T) / 2) @ rng.standard_normal(len(covariance))
    return drawn


if __name__ == "__main__":
    main()
