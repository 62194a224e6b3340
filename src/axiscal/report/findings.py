"""What a person has to be told about an estimate: what could not be seen, and what does not fit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.error_model.iso230 import words
from axiscal.error_model.undescribed import undescribed
from axiscal.estimation.believed import trusted, with_sides
from axiscal.estimation.case import Case
from axiscal.estimation.changes import changes
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import ruling_of
from axiscal.estimation.zero_drift import paths
from axiscal.inference.aliasing import Alias, aliases
from axiscal.inference.misfit import Misfit, misfits
from axiscal.inference.repeats import Trend, trend
from axiscal.language.spoken import capital, listed, put, said
from axiscal.machine.description import Machine
from axiscal.machine.entry import SMOOTH
from axiscal.machine.names import COMPONENTS
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.place_texts import reading_unit, value_names
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics.from_scipy import chi_square_tail
from axiscal.report.coarse_display import coarse_displays
from axiscal.report.contradictions import contradictions
from axiscal.report.curves import value_unit
from axiscal.report.strangers import strangers
from axiscal.report.summary import Finding, ResidualCheck
from axiscal.report.wide_bands import wide_bands
from axiscal.units import said_quantity, to_unit

_OUTLIER, _MANY = 4.0, 0.1
_MISFIT = 1e-3
_TINY = 0.02
"""Readings that scatter by less than this share of what is stated are in another unit, or are no readings."""
_SHOWS, _AN_HOUR = 3.0, 3600.0
_SURE = 20.0
"""Odds below which nothing is said of kinks: as for what contradicts the model."""
_OTHER = 1.5
"""A noise that differs by this factor is not as stated."""
_MATTERS = 0.1


def observability(case: Case) -> list[str]:
    """Return what no allowed reading can see, in sentences, and what is not in the model at all."""
    absent = undescribed(case.description.machine)
    return [*(part.text for part in case.hidden), *([absent] if absent else [])]


def residual_check(estimation: Estimation) -> ResidualCheck | None:
    """Return the chi-square of the innovations of all readings that are believed; None before the first."""
    refused = {doubt.reading for doubt in estimation.outliers if doubt.rejected}
    believed = [each for i, each in enumerate(estimation.innovations) if i not in refused]
    if not believed:
        return None
    total = sum(each.chi_square for each in believed)
    count = sum(each.degrees for each in believed)
    return ResidualCheck(total, count, chi_square_tail(count, total))


def findings(estimation: Estimation) -> list[Finding]:
    """Return the warnings of an estimate: where something explains what does not fit, that, and not its symptoms."""
    compared = ruling_of(estimation).comparison
    symptoms = [] if compared.caused else [*_scales(estimation), *_misfit(estimation)]
    return [
        *coarse_displays(estimation.readings, estimation.stated.description.setups),
        *_unobservable(estimation),
        *_outliers(estimation),
        *contradictions(estimation, compared),
        *symptoms,
        *_missing_planes(estimation),
        *wide_bands(estimation),
        *_aliasing(estimation),
        *_drift(estimation),
        *_changes(estimation),
        *strangers(estimation),
    ]


def untimed(readings: Sequence[Reading], setups: Sequence[Setup]) -> list[Finding]:
    """Return warnings of set-ups whose zero may drift, where given readings do not tell when they were taken."""
    silent = {reading.setup for reading in readings if reading.time is None}
    text = (
        'The readings of "{setup}", whose zero may drift, do not tell when they were taken: they count as taken one '
        "after the other, as a plan would have it. If that took longer, the bands are too narrow: add a column time."
    )
    drifting = [setup.name for setup in setups if setup.drift_said == "stated" and setup.name in silent]
    return [Finding("drift", None, said(text, setup=name)) for name in drifting]


def _unobservable(estimation: Estimation) -> Iterator[Finding]:
    yardstick = estimation.case.yardstick
    if yardstick.unseen_rms > _MATTERS * estimation.accuracy.rms:
        text = "No allowed reading can bring the RMS below {size}: see what could not be seen."
        yield Finding("unobservable", None, said(text, size=said_quantity(yardstick.unseen_rms, "um")))


def _outliers(estimation: Estimation) -> Iterator[Finding]:
    doubted = {doubt.reading: doubt for doubt in estimation.outliers}
    surprises = [float(np.max(np.abs(each.value / each.std))) for each in estimation.innovations]
    misfit = sum(size > _OUTLIER for size in surprises) > max(
        2.0, _MANY * len(surprises)
    )  # then it is not the readings
    for index, (reading, surprise) in enumerate(zip(estimation.readings, surprises, strict=True)):
        doubt, name = doubted.get(index), estimation.name_of(index)
        if doubt is not None and doubt.implausible:
            text = "{objection}: it is not used; take it again, or record it with --accept."
            yield Finding("outlier", None, capital(said(text, objection=estimation.objection_to(doubt))))
        elif doubt is not None:
            fate = said("it is not used")
            if not doubt.rejected:
                fate = said("it counts with weight {weight:.2g}", weight=float(doubt.weight))
            text = (
                "{reading} is {away:.1f} standard deviations from what the other readings say: {fate}; take it again, "
                "or record it with --accept if it is right."
            )
            yield Finding("outlier", None, capital(said(text, reading=name, away=float(doubt.surprise), fate=fate)))
        elif surprise > _OUTLIER and not reading.accepted and not misfit:
            text = (
                "{reading} is {away:.1f} standard deviations from what the readings before it predict; take it again."
            )
            yield Finding("outlier", None, capital(said(text, reading=name, away=surprise)))


def _scales(estimation: Estimation) -> Iterator[Finding]:
    """Say which stated figures do not fit: those that were learnt, and those that should be."""
    if estimation.stated.inherited is not None:
        yield from _noises(estimation)
        return
    yield from _kinks(estimation)
    learnt = {(scale.kind, scale.owner) for scale in estimation.fit.scales.of} if estimation.fit else set()
    stated = estimation.stated.linear_as(estimation.case)
    for misfit in misfits(stated.observation, trusted(estimation)):
        if misfit.kind == "rough":
            yield _rough(misfit, estimation, ("rest", misfit.owner) in learnt)
        else:
            yield _off(misfit, estimation, ("noise" if misfit.kind == "noise" else "std", misfit.owner) in learnt)


def _noises(estimation: Estimation) -> Iterator[Finding]:
    """Say which of the noises learnt are not as stated."""
    found = estimation.fit
    for setup in estimation.stated.description.setups if found else ():
        noise = found.scales.value("noise", setup.name) if found else None
        if noise is not None and not 1 / _OTHER < noise / setup.noise < _OTHER:
            yield _off(Misfit(setup.name, "noise", setup.noise, noise), estimation, True)


def _kinks(estimation: Estimation) -> Iterator[Finding]:
    """Say where readings want curves that are not smooth, among those that are averaged over."""
    families = estimation.fit.families if estimation.fit else {}
    likeliest = max(families, key=lambda each: families[each], default=SMOOTH)
    odds = families.get(likeliest, 0.0) / max(1.0 - families.get(likeliest, 0.0), np.finfo(float).tiny)
    if likeliest == SMOOTH or odds < _SURE:
        return
    names = [entry.name for entry in estimation.case.description.machine.errors if entry.smoothness_averaged]
    several = f"The curves of {', '.join(names)} have" if len(names) > 1 else f"The curve {names[0]} has"
    times = f"{odds:.0f} to 1" if odds < 1000 else "more than 1000 to 1"
    text = f"{several} kinks: a smoothness of {likeliest} is {times} against the others that were averaged over."
    yield Finding("prior-misfit", names[0] if len(names) == 1 else None, text)


def _rough(misfit: Misfit, estimation: Estimation, learnt: bool) -> Finding:
    function = estimation.case.errors.names[misfit.owner]
    axis = estimation.case.errors.machine.axes[function.axis]
    text = said(
        "The {axis} curve {name} ({words}) has detail finer than {detail} that this model does not follow, about "
        "{size} of it.",
        axis=axis.name,
        name=misfit.owner,
        words=words(misfit.owner),
        detail=said_quantity(misfit.detail, axis.unit),
        size=said_quantity(misfit.rest, value_unit(function), 2),
    )
    counted_in = "Its band counts this as learnt from the readings; knots = {knots} would follow it."
    left_out = (
        'Its band does not count this: give it rest = "estimate", or learn all priors with scales = "estimate" in the '
        "campaign; knots = {knots} would follow it."
    )
    told = said(counted_in if learnt else left_out, knots=misfit.knots)
    return Finding("lack-of-fit", misfit.owner, listed(" ", [text, told]))


def _off(misfit: Misfit, estimation: Estimation, learnt: bool) -> Finding:
    unit, what = _named(misfit, estimation)
    stated, found = (said_quantity(value, unit, 2) for value in (misfit.stated, misfit.found))
    end = (
        said("the bands use what the readings say")
        if learnt
        else said('review it, or let scales = "estimate" learn it')
    )
    off = "The readings do not fit the prior: {what} is stated as {stated} and looks like {found}; {end}."
    text = said(off, what=what, stated=stated, found=found, end=end)
    if misfit.kind == "noise" and misfit.found > misfit.stated:
        together = _together(estimation.case.description.setup(misfit.owner), estimation.case.description.machine)
        text = listed(" ", [text, said("Or {together}", together=together)]) if together else text
    return Finding("prior-misfit", None if misfit.kind == "noise" else misfit.owner, text)


def _missing_planes(estimation: Estimation) -> Iterator[Finding]:
    """Say of readings that contradict the model which error of two axes it does not describe."""
    ruling, described = ruling_of(estimation), estimation.case.description
    if ruling.verdict != "contradicted" or not ruling.comparison.caused:
        return
    for setup in described.setups:
        if together := _together(setup, described.machine):
            yield Finding("lack-of-fit", None, said("Perhaps {together}", together=together))


def _together(setup: Setup, machine: Machine) -> str:
    """Return that two axes may do something together, where the machine does not say so; else nothing."""
    moving = [machine.axes[index].name for index in setup.moves]
    known = any(set(plane.axes) <= set(moving) for plane in machine.planes)
    if len(moving) != 2 or known:
        return ""
    along = int(np.argmax(np.abs(setup.direction))) + (3 if INSTRUMENTS[setup.instrument].reads == "angle" else 0)
    first, second = sorted(moving)
    name = f"E{COMPONENTS[along]}{first}{second}"
    text = "{first} and {second} do together what no sum of their curves follows: describe it as {name}."
    return said(text, first=first, second=second, name=name)


def _named(misfit: Misfit, estimation: Estimation) -> tuple[str, str]:
    if misfit.kind == "noise":
        setup = estimation.case.description.setup(misfit.owner)
        return reading_unit(setup), said('the noise of "{setup}"', setup=misfit.owner)
    function = estimation.case.errors.names[misfit.owner]
    return value_unit(function), said("the std of {name} ({words})", name=misfit.owner, words=words(misfit.owner))


def _aliasing(estimation: Estimation) -> Iterator[Finding]:
    for alias in aliases(estimation.case.description.machine, estimation.readings):
        yield Finding("aliasing", alias.error, _alias_text(alias))


def _alias_text(alias: Alias) -> str:
    unit, name = alias.axis.unit, alias.axis.name
    spacing = said("The positions read on {axis} all lie alike in the period", axis=name)
    if alias.spacing is not None:
        spaced = "The positions read on {axis} are equally spaced, {spacing} apart"
        spacing = said(spaced, axis=name, spacing=said_quantity(alias.spacing, unit, 4))
    slow = said("a constant")
    if not np.isinf(alias.seen_as):
        slow = said("one of {period}", period=said_quantity(alias.seen_as, unit, 4))
    return said(
        "{spacing}: what repeats every {period} in {error} looks like {slow}; vary the targets.",
        spacing=spacing,
        period=said_quantity(alias.period, unit, 4),
        error=alias.error,
        slow=slow,
    )


def _misfit(estimation: Estimation) -> Iterator[Finding]:
    check = residual_check(estimation)
    if check is None or min(check.probability, 1 - check.probability) > _MISFIT:
        return
    size = float(np.sqrt(check.chi_square / check.degrees))
    many = (
        "The readings scatter {size:.2g} times as much about their predictions as the priors and the noise say: bands "
        "that hold as stated would be too narrow by so much; review the std of the errors and the noise of the "
        'set-ups, or let scales = "estimate" in the campaign learn them.'
    )
    few = (
        "The readings scatter only {size:.2g} times as much about their predictions as the priors and the noise say: "
        "errors and noise are smaller than stated, and bands wider than they need be; or values are in another unit, "
        "or divided, and the machine is worse than these bands say. Check the unit, then review std and noise, or let "
        'scales = "estimate" in the campaign learn them.'
    )
    text = said(many if size > 1 else few, size=size)
    guess = said("Values about a thousand times too small (mm written as um?) look like that.")
    yield Finding("prior-misfit", None, listed(" ", [text, guess]) if size < _TINY else text)


def _drift(estimation: Estimation) -> Iterator[Finding]:
    """Say how far zeros have wandered: those that are stated to, and those that repeated readings show."""
    usable = with_sides(estimation)
    for setup in estimation.stated.description.setups:
        found = _stated_drift(estimation, setup) if setup.drift > 0 else _shown_drift(trend(usable, setup), setup)
        if found:
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
            found.append(
                said(
                    many if value_names(setup)[0] == "x" else one,
                    way=value_names(setup)[number],
                    setup=f"{setup.name} {number + 1}" if setup.stations else setup.name,
                    size=put("{moved:.2g} ± {spread:.2g} {unit}", moved=moved, spread=spread, unit=unit),
                    time=_lasting(float(path.times[worst] - path.times[0])),
                )
            )
            if abs(far) > _OUTLIER * path.prior[worst]:
                rate = abs(far) / max(float(path.times[worst] - path.times[0]), 60.0)
                usual = "That is more than is usual: state drift = {rate}."
                stated = "That is more than is stated: drift = {rate} would be."
                found.append(said(usual if setup.drift_said == "usual" else stated, rate=_rate_text(rate, unit)))
    return listed(" ", found)


def _shown_drift(found: Trend, setup: Setup) -> str:
    if found.std == 0 or abs(found.rate) <= _OUTLIER * found.std:
        return ""
    unit = reading_unit(setup)
    return said(
        'The zero of "{setup}" moved by {size} in {time}, as readings repeated in one place show ({away:.1f} standard '
        "deviations). The estimate takes it for noise: state drift = {rate} in the set-up.",
        setup=setup.name,
        size=said_quantity(found.rate * found.seconds, unit, 2),
        time=_lasting(found.seconds),
        away=float(abs(found.rate) / found.std),
        rate=_rate_text(abs(found.rate), unit),
    )


def _lasting(seconds: float) -> str:
    return said_quantity(seconds, "h" if seconds >= _AN_HOUR else "min", 2)


def _rate_text(rate: float, unit: str) -> str:
    return f'"{to_unit(rate * _AN_HOUR, unit):.2g} {unit}/h"'


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
