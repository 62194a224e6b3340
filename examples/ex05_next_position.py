"""Where to measure next.

Each place of a reading lets the mean variance of the machine fall by a certain amount, and which value the reading will
have does not matter. The fall is a ratio of two polynomials between knots; `best_step` finds its largest value exactly.
`Knowledge` keeps what no spline follows apart: reading one place again and again leaves that.
"""

import numpy as np

import axiscal as ac
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root
from axiscal.measurement.candidates import spread


def main() -> dict[str, object]:
    """Return the first six places on one axis, and the accuracy after each."""
    machine = ac.load_machine("one-axis")
    model = ac.ErrorModel(machine)
    setup = ac.Setup(
        "laser", "interferometer", (1.0, 0.0, 0.0), (0,), (0.5,), 0.3e-6, (), 600.0, 1.0, 3.0, (0.0,), "both"
    )
    observation = ac.Observation(model, (setup,))
    knowledge = ac.Knowledge.before(observation)
    root = Root.of_gram(volume_moments(model, whole_travel(model)).gram)
    places, rms = [], [np.sqrt(root.criterion(knowledge.belief.factor)) * 1e6]
    for _ in range(6):
        step = ac.best_step(knowledge, root, spread(machine, (setup,), 200))
        knowledge = knowledge.read([step.reading(observation)])
        places.append(float(step.pose[0]) * 1e3)
        rms.append(np.sqrt(root.criterion(knowledge.belief.factor)) * 1e6)
    return {
        "first place, mm": places[0],
        "RMS before, um": float(rms[0]),
        "RMS after one reading, um": float(rms[1]),
        "RMS after six readings, um": float(rms[6]),
        "picture": {"x": "readings", "y": "RMS, µm", "lines": {"known to": (np.arange(7.0), np.array(rms))}},
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
