"""A short independent check of a machine after its tables were loaded: where to look, and what the readings decide.

Points are new ones, drawn at random as the checks of a plan are, and held to the estimate as these are to others.
They answer three questions. Do the tables work: did the readings change by their correction? Is the machine as
promised: are the readings as left no farther from the estimate than its uncertainty and their noise explain? One of
twenty machines exactly as promised is called worse. Is a tolerance kept, where somebody states one (ISO 14253-1): every
deviation with its expanded uncertainty lies inside, one lies outside with all of it, or neither.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.estimation.promise.posterior import Posterior
from axiscal.evaluation.datums import GUARD, Datums, Readout, datums_of, fewest, lines_shared, taken_away, upright
from axiscal.evaluation.table_checks import (
    Decision,
    Judgement,
    Part,
    idle_axes,
    needed,
    shares,
    whitening,
    without,
)
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import said
from axiscal.measurement.candidates import distinct, drawn_places
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.instruments.displacement import Displacement
from axiscal.measurement.instruments.distance import Nest, Tracker
from axiscal.measurement.observation import levers_of
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.reading_rows import places_of
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.tables.surface import Control, left_by
from axiscal_core.from_scipy import chi_square_quantile, chi_square_share
from axiscal_core.threads import one_thread

_DISPLACEMENTS = (Displacement, Nest, Tracker)
_CHECKING = tuple(sorted(name for name, kind in INSTRUMENTS.items() if issubclass(kind, _DISPLACEMENTS)))
"""Instruments that read displacements along fixed directions: the ones a check is made with."""
_REMEDY = "A check is made with {known}: give the campaign a set-up of that kind"
USUAL, _FEW = 12, 4
"""Places of a check that nobody gave a number for, and how many of them lie elsewhere than where the tables ask."""
_FEWEST = 2
"""Fewer new places of a set-up are not worth mounting it."""
_SAME = 1e-7
"""Rounding of a place that was written down, m or rad: far below what an instrument resolves, far above float64."""
_STILL = 4
"""So many readings of a set-up that show one and the same number are an instrument that does not move."""
_NOTHING = 1e-9
"""A change of a nanometre is none: far below any reading's noise."""
_FACTORS = 64
"""Factors at which a t is looked at, of equal probability; 30 tell p = 0.05 as well."""


@one_thread()
def expected(estimate: Estimate, readout: Readout, control: Control | None) -> tuple[Array, Array]:
    """Return the deviation that is expected under a control for each value, (m,), and its factor (m, n), m."""
    model, places, count = estimate.model, readout.places, len(readout.of)
    if control is None:
        tips = estimate.deviation(places.poses, places.approaches)
    else:
        tips = left_by(estimate.machine, estimate.deviation, control, places.poses, places.approaches)
    shown, rows, rests = np.zeros(count), np.zeros((count, model.size)), np.zeros((count, len(model.terms)))
    for setup, mine, of, at in readout.each():
        poses, approaches, seen = places.poses[mine], places.approaches[mine], setup.slopes(at)
        levers = levers_of(model, seen, poses)
        turned = model.along(levers_of(model, seen._replace(moved=np.zeros_like(seen.moved)), poses), poses, approaches)
        shown[of] = (np.einsum("mkc,mc->mk", seen.moved, tips[mine]) + (turned @ estimate.mean).T).ravel()
        rows[of] = model.along(levers, poses, approaches).swapaxes(0, 1).reshape(-1, model.size)
        rests[of] = levers.transpose(2, 0, 1).reshape(-1, len(model.terms))
    rests *= np.array([function.rest for function in model.terms])
    return shown, np.hstack([rows @ estimate.factor, np.diag(np.linalg.norm(rests, axis=1))])


@one_thread()
def plan_check(
    estimate: Estimate,
    setups: Sequence[Setup],
    new: Places,
    parts: Sequence[Part],
    count: int | None = None,
    tolerance: float = 0.0,
) -> Places:
    """Return places that show the parts, those that tell the machine from each set-up that is read, and random ones.

    new : that may be read; parts : those first that correct most; tolerance : it is judged by, m, 0 if nobody knows yet
    count : how many; None for what parts need, and `USUAL` at least where there are so many
    Raises ReadingError where there are not as many, or too few to tell the machine from any set-up.
    """
    once = distinct(new)
    least = {s: fewest(setups[s], once.poses[mine], tolerance) for s, mine in once.by_setup()}
    least = {s: own for s, own in least.items() if own <= once.setups.tolist().count(s)}
    if len(once) and not least:
        raise ReadingError("too few places are new to tell the machine from a set-up", _fewer(0))
    able = np.isin(new.setups, [*least])
    room = int(able.sum()) if count is None else count
    first = needed(estimate, setups, new.within(able), parts)
    mounted = _mounted(setups, [*dict.fromkeys(first.setups.tolist())] or [*least], least, room)
    if least and not mounted:
        what = "{count} places cannot tell the machine from a set-up"
        raise ReadingError(what, "Ask for {least} or more", count=room, least=min(least.values()))
    first = first.within(np.isin(first.setups, mounted))

    def lacking(setup: int) -> int:
        had: int = first.setups.tolist().count(setup)
        return max(least[setup] - had, 0)

    while len(first) + sum(map(lacking, mounted)) > room:
        first = first.without(len(first) - 1)
    others = without(once.within(np.isin(once.setups, mounted)), first)
    among = np.array([setup for setup in mounted for _ in range(lacking(setup))], dtype=np.intp)
    first = Places.joined([first, drawn_places(others, among, len(among))])
    others = without(others, first)
    left = max(USUAL - len(first), _FEW) if count is None else count - len(first)
    if count is not None and left > len(others):
        found = len(first) + len(others)
        raise ReadingError("only {new} places of {count} are new", _fewer(found), new=found, count=count)
    return Places.joined([first, drawn_places(others, others.setups, min(left, len(others)))])


def _mounted(setups: Sequence[Setup], asked: Sequence[int], least: Mapping[int, int], room: int) -> list[int]:
    """Return those of the set-ups asked for that have room: the legs of a square, which share its turn, together.

    least : places that each needs, of those that can have them; room : places of all
    """
    found = list[int]()
    for setup in asked:
        shared = lines_shared(setups[setup])
        fresh = {setup, *(other for other in least if lines_shared(setups[other]) & shared)}.difference(found)
        if sum(least[each] for each in fresh) <= room:
            found += sorted(fresh)
            room -= sum(least[each] for each in fresh)
    return found


def _fewer(new: int) -> str:
    if new >= _FEWEST:
        return said("Ask for --points {new} or fewer", new=new)
    return said("Take the check at places of your own, and give them with --found and --left")


def with_displacements(setups: Sequence[Setup], candidates: Places, by: str = "") -> Places:
    """Return the candidates of set-ups that read displacements; raises ReadingError when there are none.

    by : their instrument; empty for any
    """
    checking = (by,) if by else _CHECKING
    kept = [i for i, s in enumerate(candidates.setups) if setups[s].instrument in checking]
    if not kept:
        what = "no set-up of this campaign reads a length along a direction"
        raise ReadingError(what, _REMEDY, known=", ".join(checking))
    return candidates.within(np.array(kept, dtype=np.intp))


@one_thread()
def judge(
    estimate: Estimate,
    setups: Sequence[Setup],
    found: Sequence[Reading],
    left: Sequence[Reading],
    control: Control,
    known: float,
    parts: Sequence[Part] = (),
    tolerance: float | None = None,
    posterior: Posterior | None = None,
) -> Judgement:
    """Return what readings without and with the tables say; raises ReadingError when they are not of the same places.

    The zero of a set-up and an unknown slope are taken off each set of readings.
    known : m, to which a set-up has to be known, or it is judged against itself
    parts : the tables, each of which must work, however small the deviations are
    tolerance : the largest deviation that somebody allows, m
    posterior : says how far the sizes of errors vary that these readings show; None for as far as all over the volume
    """
    _refuse_different(found, left)
    places = places_of(setups, left)
    for other in (setups[index] for index in places.setups):
        if other.instrument not in _CHECKING:
            what = '"{setup}" reads no displacement along a direction ({instrument})'
            raise ReadingError(what, _REMEDY, setup=other.name, instrument=other.instrument, known=", ".join(_CHECKING))
    readout = Readout(estimate.machine, setups, places)
    datums = datums_of(readout, known)
    each_read = (_seen(readout, datums, readings) for readings in (found, left))
    (before, noise_before), (after, noise) = each_read
    mean, factor = expected(estimate, readout, control)
    free, spread = datums.free, datums.spread + np.diag(noise**2)
    # a set-up may have been mounted anew between the two
    apart = free @ (2 * datums.spread + np.diag(noise_before**2 + noise**2)) @ free.T
    # one place of a ball, or one error of the machine, is in many values: these are not independent
    beyond, unknown, noisy = free @ (after - mean), free @ factor, free @ spread @ free.T
    rows = unknown[:, : estimate.factor.shape[1]] @ np.linalg.pinv(estimate.factor)
    coming = float(np.sum((free @ mean) ** 2) + np.sum(unknown**2) + np.trace(noisy))
    change, should = free @ (before - after), free @ (expected(estimate, readout, None)[0] - mean)
    weight = float(should @ should)
    taken = [free @ taken_away(readout, part.control) for part in parts]
    each = shares(parts, np.stack(taken, axis=1), change, apart) if parts else ()
    std = np.sqrt(np.diag(noisy))
    lying = {unknown.owner for setup in setups if setup.balls for unknown in setup.unknowns}
    return Judgement(
        free @ before,
        free @ after,
        std,
        readout.of,
        coming,
        _likelihood(
            beyond, noisy, unknown, lambda w: posterior.degrees_over(w @ rows) if posterior else estimate.belief.degrees
        ),
        _likelihood(change - should, apart),
        float(change @ should) / weight if weight > _NOTHING**2 else None,
        tuple(name for name in datums.lines if name not in lying),
        datums.strained(after, noise, known),
        _still(left),
        each,
        idle_axes(readout, estimate.box),
        datums.tools,
        tolerance,
        None if tolerance is None else decision(free @ after, std, tolerance),
    )


def decision(deviations: Array, std: Array, tolerance: float) -> Decision:
    """Return what deviations with their standard deviations prove of a tolerance (ISO 14253-1)."""
    sizes = np.abs(deviations)
    if np.all(sizes + GUARD * std <= tolerance):
        return "conform"
    return "not conform" if np.any(sizes - GUARD * std > tolerance) else "neither"


def _still(readings: Sequence[Reading]) -> tuple[str, ...]:
    """Return the set-ups with one value at several places, which noise and machine make impossible."""
    shown: dict[str, list[tuple[float, ...]]] = {}
    for reading in readings:
        shown.setdefault(reading.setup, []).append(reading.values)
    return tuple(name for name, values in shown.items() if len(values) >= _STILL and len(set(values)) == 1)


def _seen(readout: Readout, datums: Datums, readings: Sequence[Reading]) -> tuple[Array, Array]:
    """Return what was read, less what is known of the instruments and not linear in their datums, and its std, m."""
    shown = np.array([value for reading in readings for value in reading.values])
    noise = np.array([r.std or readout.setups[s].noise for r, s in zip(readings, readout.places.setups, strict=True)])
    return upright(readout, datums, shown), noise[readout.of]


def _likelihood(
    values: Array, noisy: Array, unknown: Array | None = None, degrees_of: Callable[[Array], float] = lambda _: np.inf
) -> float:
    """Return the probability of values at least this large, in the mean square over their standard deviations.

    noisy : (m, m) N, their covariance by readings, singular; unknown : (m, n) F, what is not known of the machine
    degrees_of : returns f of what is whitened by a matrix (k, m), whose squares have one factor w = (f − 2)/χ²_f
    With P = F Fᵀ + N, z = P^−½ y and κ the eigenvalues of P^−½ F Fᵀ P^−½, zᵀz is Σ (1 + (w − 1) κ) χ²_1, which is about
    a χ² (Satterthwaite 1946); the result is its mean over w.
    """
    machine = np.zeros_like(noisy) if unknown is None else unknown @ unknown.T
    whiten = whitening(machine + noisy)
    shares = np.linalg.eigvalsh(whiten @ machine @ whiten.T)
    chances, factors = (np.arange(_FACTORS) + 0.5) / _FACTORS, np.ones(1)
    if np.isfinite(degrees := degrees_of(whiten)):
        factors = (degrees - 2) / np.array([chi_square_quantile(np.array([degrees]), p)[0] for p in chances])
    parts = 1 + np.outer(factors - 1, shares)
    sums, squares = parts.sum(axis=1), np.sum(parts**2, axis=1)
    size = float(np.sum((whiten @ values) ** 2))
    return float(np.mean(1 - chi_square_share(sums**2 / squares, size * sums / squares)))


def same_place(reading: Reading, setup: str, pose: Sequence[float], approach: Sequence[int]) -> bool:
    """Return whether a reading was taken at a place, from the same side."""
    near = np.max(np.abs(np.subtract(reading.pose, pose))) <= _SAME
    return bool(near) and reading.setup == setup and reading.approach == approach


def _refuse_different(found: Sequence[Reading], left: Sequence[Reading]) -> None:
    if len(found) != len(left) or not left:
        what = "there are {found} as-found and {left} as-left readings"
        raise ReadingError(what, "Take both at the same places, in the same order", found=len(found), left=len(left))
    for before, after in zip(found, left, strict=True):
        if not same_place(before, after.setup, after.pose, after.approach):
            what = "as found and as left were not read at the same place from the same side"
            raise ReadingError(what, "Take both at the same places, in the same order", line=after.line)
