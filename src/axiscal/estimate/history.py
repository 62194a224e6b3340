"""How a campaign went, told when it is over: which readings are bad is known from the first one on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from axiscal.accuracy.yardstick import Accuracy
from axiscal.belief import Innovations
from axiscal.estimate.calibration import Calibration
from axiscal.measurement.reading import Reading


class Moment(NamedTuple):
    """What is known after a reading, what this surprised by (None before the first), and after how many seconds."""

    accuracy: Accuracy
    innovations: Innovations | None
    seconds: float


def path(calibration: Calibration) -> list[Moment]:
    """Return what was known before the first reading and after each.

    calibration : a concluded one
    As `Calibration.replay` tells it reading by reading; but between two counts from which scales are learnt anew they
    are taken together.
    """
    again, readings = calibration.replay(), calibration.readings
    moments = [Moment(again.accuracy(), None, 0.0)]
    while (count := len(again.readings)) < len(readings):
        undisturbed = again.undisturbed(len(readings) - count)
        if undisturbed:
            moments += _together(again, readings[count : count + undisturbed])
        elif count + 1 < len(readings):
            moments.append(_alone(again, readings[count]))
        else:  # what the last one taught is known
            return [*moments, Moment(calibration.accuracy(), calibration.innovations[-1], calibration.seconds)]
    return moments


def _alone(again: Calibration, reading: Reading) -> Moment:
    again.absorb(reading)
    return Moment(again.accuracy(), again.innovations[-1], again.seconds)


def _together(again: Calibration, readings: Sequence[Reading]) -> list[Moment]:
    seconds = []
    for reading in readings:
        again.absorb(reading)
        seconds.append(again.seconds)
    known = again.known_after_each()
    return [Moment(*each) for each in zip(known, again.innovations[-len(known) :], seconds, strict=True)]
