"""Stacked axes.

The paper's sample machine: three axes on top of each other, one dial that reads the sum of their height errors. Only
the sum of the three constants can ever be seen. The paper's measure J counts the other two combinations for ever; the
height itself is known well.
"""

import numpy as np

import axiscal as ac
from axiscal.errors.gauge import unseen_factor
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root, joint_root
from axiscal.measurement.candidates import spread
from axiscal.planning.step.best_step import Step

MACHINE, MM = ac.load_machine("paper-three-stacked"), 1e-3  # what the paper calls 1
MODEL = ac.ErrorModel(MACHINE)
DIAL = ac.Setup("dial", "indicator", (0, 0, 1), (0, 1, 2), (5 * MM,) * 3, 0.01 * MM, (), 0, 0, 0, (0.0,) * 3, "+")
OBSERVATION, PLACES = ac.Observation(MODEL, (DIAL,)), spread(MACHINE, (DIAL,), 2000)
JOINT, HEIGHT = joint_root(MODEL), Root.of_gram(volume_moments(MODEL, whole_travel(MODEL)).gram)


def chosen(count: int) -> tuple[list[Step], list[ac.Knowledge]]:
    """Return so many readings, each the best there is (B&H eq. 27, 37), and what is known before and after each."""
    steps, known = list[Step](), [ac.Knowledge.before(OBSERVATION)]
    for _ in range(count):
        steps.append(ac.best_step(known[-1], JOINT, PLACES))
        known.append(known[-1].read([steps[-1].reading(OBSERVATION)]))
    return steps, known


def main() -> dict[str, object]:
    """Return what 22 readings do to J (B&H eq. 36) and to the height."""
    readings, factors = np.arange(23.0), [each.belief.factor for each in chosen(22)[1]]
    J, height = ([root.criterion(factor) for factor in factors] for root in (JOINT, HEIGHT))
    seen = OBSERVATION.rows(0, *PLACES.in_setup(0))
    left = unseen_factor(factors[0], seen.rows / np.sqrt(seen.variances)[:, None])
    lines = {"one joint": (readings, np.sqrt(J) / (30 * MM**3) ** 0.5), "the height": (readings, np.sqrt(height) / MM)}
    return {
        "J before": J[0] / MM**3,
        "J after the first reading": J[1] / MM**3,
        "J that no reading takes away": JOINT.criterion(left) / MM**3,
        "height known to, before": float(height[0] ** 0.5) / MM,
        "picture": {"x": "readings", "y": "standard deviation, RMS", "log": True, "lines": lines},
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
