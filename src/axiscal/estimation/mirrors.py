"""Whether another place of a station fits as well: then nothing is promised until a reading has decided."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.case import Case
from axiscal.estimation.stations import BentReadings, Optimum, mirrored, polished
from axiscal.exceptions import AmbiguityError
from axiscal.language.spoken import said
from axiscal.measurement.place_texts import place_text
from axiscal.measurement.reading import Reading, drawn
from axiscal.numerics import Array
from axiscal.units import to_unit

_MOST = 200
"""Readings by which places are compared: of time."""
_NEAR, _APART = 6.0, 5.0
"""Optima within so much of the best one's log posterior, and so many standard deviations apart, are two."""


def refuse_mirrors(known: Absorbed, readings: Sequence[Reading], implausible: Sequence[int]) -> None:
    """Raise AmbiguityError where a station's mirror image fits as well, with the reading that decides."""
    case = known.case
    kept = [reading for index, reading in enumerate(readings) if index not in implausible]
    size = case.errors.size + len(case.observation.unknowns)
    for index in range(len(case.description.setups)):
        images = mirrored(case, kept, known.knowledge.belief.mean[:size], index)
        for number, (columns, image) in enumerate(zip(case.station_columns(index), images, strict=False)):
            here = known.knowledge.belief.mean[list(columns)]
            spread = np.sqrt(np.diagonal(known.knowledge.belief.covariance)[list(columns)])
            if np.all(np.abs(image[list(columns)] - here) < _APART * spread):
                continue
            problem = BentReadings(case, drawn(kept, _MOST))
            best, other = (polished(problem, start) for start in (known.knowledge.belief.mean[:size], image))
            apart = np.abs(best.point - other.point)[list(columns)] > _APART * spread
            if other.cost - best.cost < _NEAR and np.any(apart):
                raise _ambiguity(case, index, number, best, other)


def _ambiguity(case: Case, index: int, number: int, best: Optimum, other: Optimum) -> AmbiguityError:
    setup = case.description.setups[index]
    stated, columns = np.array(setup.standing[number]), list(case.station_columns(index)[number])
    first, second = (_text(stated + each.point[columns]) for each in (best, other))
    pose, differ = _decisive(case, index, number, best.point, other.point)
    axes, name = case.description.machine.axes, setup.name
    whose = said("station {number}", number=number + 1) if setup.stations else said("the station")
    what = '{whose} of "{name}" fits its readings as well at {first} as at {second} (x, y, z in the workpiece frame)'
    remedy = (
        'Read "{name}" at {place} as well: there the two differ by {apart:.3g} mm. '
        "Points in one plane cannot tell a station from its mirror image; or state the station nearer"
    )
    place, apart = place_text(axes, pose), to_unit(differ, "mm")
    return AmbiguityError(what, remedy, whose=whose, name=name, first=first, second=second, place=place, apart=apart)


def _decisive(case: Case, index: int, number: int, first: Array, second: Array) -> tuple[list[float], float]:
    """Return the place where the predictions of two optima differ the most, and by how much, m."""
    poses, sides = case.lattice.of(index)
    one, two = (case.observation.shown(index, poses, sides, point)[:, number] for point in (first, second))
    best = int(np.argmax(np.abs(one - two)))
    return poses[best].tolist(), float(abs(one - two)[best])


def _text(place: Array) -> str:
    return "(" + ", ".join(f"{to_unit(float(each), 'mm'):.1f}" for each in place) + ") mm"
