"""The paper's figures on one page that carries everything."""

from __future__ import annotations

from axiscal.ports.paper import drawings as figures
from axiscal.ports.paper.experiment import SHOWN_SINGLE, SHOWN_STACKED, SIMULATED, Experiment
from axiscal.present.drawing.shown import shown
from axiscal.present.standalone import page_of


def render(experiment: Experiment) -> str:
    """Return the page as self-contained HTML."""
    values = {
        "draw": shown,
        "single": list(zip(SHOWN_SINGLE, figures.single_spline(experiment), strict=True)),
        "decrease": [figures.decrease(experiment, logarithmic=logarithmic) for logarithmic in (False, True)],
        "stacked": list(zip(SHOWN_STACKED, figures.stacked(experiment), strict=True)),
        "both": figures.both_criteria(experiment),
        "confounded": figures.confounded(experiment, SHOWN_STACKED[-1]),
        "simulated": SIMULATED,
        "variances": experiment.single.overall_variances,
        "stacked_variances": experiment.stacked.overall_variances,
        "heights": [value**0.5 for value in experiment.stacked.height_variances],
        "left": experiment.stacked.stack.variance_left,
        "joint_left": (experiment.stacked.stack.variance_left / experiment.stacked.stack.length) ** 0.5,
        "excess": experiment.lattice_excess,
        "lattices": experiment.lattice_sizes,
        "last": SHOWN_STACKED[-1],
        "rows": list(enumerate(experiment.single.overall_variances)),
        "positions": experiment.single.positions[:, 0].tolist(),
        "errors": experiment.squared_errors.mean(axis=0).tolist(),
    }
    return page_of("axiscal.ports.paper", "reproduce.html", **values)
