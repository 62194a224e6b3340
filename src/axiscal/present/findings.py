"""What a person has to be told about an estimate: what could not be seen, and what does not fit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.description.usual import Kind
from axiscal.errors.gauge import undescribed
from axiscal.errors.iso230 import words
from axiscal.estimation.agreement_words import STRANGE, farthest, membership_words
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation, paths
from axiscal.estimation.inheritance import changes
from axiscal.estimation.promise.agreement import AGREES
from axiscal.language.spoken import capital, later, listed, put, said
from axiscal.measurement.reading import Reading, reading_unit, value_names
from axiscal.measurement.setup import Setup
from axiscal.present.doubled import coarse_displays
from axiscal.present.summary import Finding
from axiscal.units import said_quantity, to_unit

_FAR_FROM_STATED = 3.0
"""Factor from which on a size is not as stated."""
_WORDS: dict[Kind, str] = {
    "std": later("size"),
    "length": later("length over which it varies"),
    "rest": later("detail"),
    "reversal": later("reversal"),
    "together": later("what two axes do together"),
    "drift": later("drift of the zero"),
    "cycle": later("coming and going of the zero"),
    "growth": later("growth while it was read"),
    "way": later("what a reversal needs a way for"),
    "noise": later("noise"),
}

_FAR, _MANY = 4.0, 0.1
_SHOWS, _AN_HOUR = 3.0, 3600.0
_MATTERS = 0.1


def observability(case: Case) -> list[str]:
    """Return what no allowed reading can see, in sentences, and what is not in the model at all."""
    absent = undescribed(case.description.machine)
    return [*(part.text for part in case.hidden), *([absent] if absent else [])]


def findings(estimation: Estimation) -> list[Finding]:
    """Return the warnings of an estimate."""
    return [
        *coarse_displays(estimation.readings, estimation.stated.description.setups),
        *_unobservable(estimation),
        *_outliers(estimation),
        *learnt_sizes(estimation),
        *_drift(estimation),
        *_changes(estimation),
        *strangers(estimation),
    ]


def untimed(readings: Sequence[Reading], setups: Sequence[Setup]) -> list[Finding]:
    """Return warnings of set-ups whose zero may drift, where given readings do not tell when they were taken."""
    silent = {reading.setup for reading in readings if reading.time is None}
    text = (
        'The zero of "{setup}" may drift, and its readings have no time. They count as taken one after the other, '
        "as in a plan. If that took longer, the bands are too narrow: add a column time."
    )
    drifting = [setup.name for setup in setups if setup.drift_said == "stated" and setup.name in silent]
    return [Finding("drift", None, said(text, setup=name)) for name in drifting]


def _unobservable(estimation: Estimation) -> Iterator[Finding]:
    yardstick = estimation.case.yardstick
    if yardstick.unseen_rms > _MATTERS * estimation.accuracy.rms:
        text = "No allowed reading can bring the RMS below {size}: see what could not be seen."
        yield Finding("unobservable", None, said(text, size=said_quantity(yardstick.unseen_rms, "um")))


def _outliers(estimation: Estimation) -> Iterator[Finding]:
    """Say which readings do not count, and which do although they do not agree with the others."""
    for doubt in estimation.outliers:
        if doubt.implausible:
            text = "{objection}: it is not used; take it again, or record it with --accept."
            yield Finding("outlier", None, capital(said(text, objection=estimation.objection_to(doubt))))
        else:
            text = (
                "{reading} is {away:.1f} standard deviations from what the other readings say, and is not used. "
                "Take it again, or record it with --accept if it is right."
            )
            name = estimation.name_of(doubt.reading)
            yield Finding("outlier", None, capital(said(text, reading=name, away=float(doubt.surprise))))
    yield from _disagreeing(estimation)


def _disagreeing(estimation: Estimation) -> Iterator[Finding]:
    """Say which used readings do not agree with the others; of very many it is not the readings."""
    left = {} if estimation.posterior is None else estimation.posterior.left_out
    far = [index for index, each in left.items() if each.z > AGREES and index not in estimation.left_out]
    if len(far) > max(2.0, _MANY * len(left)):
        return
    for index in far:
        if not estimation.readings[index].accepted:
            text = "{reading} is {away:.1f} standard deviations from what the other readings say; take it again."
            name = estimation.name_of(index)
            yield Finding("outlier", None, capital(said(text, reading=name, away=float(left[index].z))))


def _drift(estimation: Estimation) -> Iterator[Finding]:
    """Say how far zeros have wandered that may."""
    for setup in estimation.stated.description.setups:
        if found := _stated_drift(estimation, setup):
            yield Finding("drift", None, found)


def _stated_drift(estimation: Estimation, setup: Setup) -> str:
    """Return by how much a zero has drifted that may, and whether that is more than stated; empty if it hardly has."""
    unit, found = reading_unit(setup), list[str]()
    for number, path in enumerate(paths(estimation, setup)):
        worst = int(np.argmax(np.abs(path.mean)))
        far, std = float(path.mean[worst]), float(path.std[worst])
        if abs(far) > _SHOWS * std:
            one = 'The zero of "{setup}" had moved by {size} after {time}; the estimate takes that off.'
            many = 'The zero along {way} of "{setup}" had moved by {size} after {time}; the estimate takes that off.'
            moved, spread = float(to_unit(far, unit)), float(to_unit(std, unit))
            seconds = float(path.times[worst] - path.times[0])
            found.append(
                said(
                    many if value_names(setup)[0] == "x" else one,
                    way=value_names(setup)[number],
                    setup=f"{setup.name} {number + 1}" if setup.stations else setup.name,
                    size=put("{moved:.2g} ± {spread:.2g} {unit}", moved=moved, spread=spread, unit=unit),
                    time=said_quantity(seconds, "h" if seconds >= _AN_HOUR else "min", 2),
                )
            )
            if abs(far) > _FAR * path.prior[worst]:
                rate = abs(far) / max(float(path.times[worst] - path.times[0]), 60.0)
                usual = "That is more than is usual: state drift = {rate}."
                stated = "That is more than is stated: drift = {rate} would be."
                written = f'"{to_unit(rate * _AN_HOUR, unit):.2g} {unit}/h"'
                found.append(said(usual if setup.drift_said == "usual" else stated, rate=written))
    return listed(" ", found)


def _changes(estimation: Estimation) -> Iterator[Finding]:
    """Say which curves have changed since the campaign whose result is the prior."""
    for change in changes(estimation):
        unit, place = ("urad" if change.angular else "um"), "deg" if change.rotary else "mm"
        text = said(
            "{name} ({words}) has changed since the last campaign: by up to {size} at {place} (by chance once in "
            "{times:.0e}).",
            name=change.name,
            words=words(change.name),
            size=said_quantity(abs(change.size), unit, 2),
            place=said_quantity(change.position, place, 4),
            times=float(1 / max(change.chance, 1e-12)),
        )
        yield Finding("drift", change.name, text)


def strangers(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning where the readings say that the machine is none of its type."""
    member = estimation.membership
    if member is None or member.sister >= STRANGE:
        return
    found, unlike = farthest(estimation), membership_words(estimation)
    text = "{unlike}. What its type has taught hardly counts; its bands are those of any machine."
    yield Finding("not-a-sister", None if found is None else found.name, capital(said(text, unlike=unlike)))


def learnt_sizes(estimation: Estimation) -> Iterator[Finding]:
    """Yield a sentence for each group of alike sizes that readings find far from what was stated."""
    found = estimation.posterior
    if found is None:
        return
    for size in estimation.stated.sizes.of:
        times = found.sizes[size.kind, size.owners[0]]
        if not 1 / _FAR_FROM_STATED < times < _FAR_FROM_STATED:
            text = "{names}, {what}: {times:.2g} times as large as stated or usual."
            names = ", ".join(size.owners)
            owner = size.owners[0] if size.owners[0] in estimation.case.errors.names and len(size.owners) == 1 else None
            yield Finding("prior-misfit", owner, said(text, names=names, what=said(_WORDS[size.kind]), times=times))
