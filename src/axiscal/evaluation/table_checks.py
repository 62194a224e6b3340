"""Each table of an export by itself: where its correction shows most, and how much of it the readings show.

The change of the readings from as found to as left is a sum over the tables, C = Σ s_k T_k + noise. Table k should take
T_k away. Generalised least squares give s_k: 1 where the table works as exported, 0 where it is missing, −1 where its
sign is wrong. A table counts as checked where s_k is known well enough to tell these apart.

`Judgement` is what the readings of a check say of a compensated machine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.volume import Box
from axiscal.estimation.machine_estimate import Estimate
from axiscal.evaluation.datums import Datum, Readout, taken_away
from axiscal.language.spoken import said
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.tables.loaded import Loaded
from axiscal.tables.offer import Export, title
from axiscal.tables.surface import Control, remainder, tour
from axiscal.units import format_quantity
from axiscal_core.machine import Machine
from axiscal_core.ties import ALIKE, first_best

KNOWN = 0.15
"""A share known to this standard deviation is checked: 0 and 1 are more than six of them apart."""
WORKS = 0.5
"""A share below this is nearer to a missing table, or one with the wrong sign, than to the one exported."""
_FEW = 5
"""Places at which files are looked at as a whole; three or eight tell as well whether they work."""
_NOTHING = 1e-9
"""m or rad: a correction below a nanometre is none."""
_TAKEN_OFF = 1e-9
"""Of a variance: what is left of a value by rounding alone."""
_FRESH = 0.05
"""Share of the travel: nearer to a reading is no new place."""
_ALONG, _THROUGH = 0.5, 0.5
"""Cosine, and share of a travel: a reading bears on an axis by half its direction, a range by half its length."""


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """One effect of one table: the mean of its directions, or their difference.

    name : "X", "Y over X", "reversal of X"; over : index of the axis whose position counts, None for files without one
    largest : what it moves at most, m or rad; rotary : whether that is an angle
    targets : positions of that axis where the correction is largest, and the ends; both : from both sides
    """

    name: str
    control: Control
    over: int | None
    targets: tuple[float, ...]
    both: bool
    largest: float = 0.0
    rotary: bool = False

    @property
    def motion(self) -> str:
        """Its largest motion, as text."""
        return format_quantity(self.largest, "arcsec" if self.rotary else "um", 2)


@dataclass(frozen=True, slots=True)
class Share:
    """How much of a table the readings show: its share and the standard deviation of that.

    size : what the table moves at most, as text
    """

    name: str
    value: float
    std: float
    size: str

    @property
    def checked(self) -> bool:
        """Whether the readings can tell a table that works from one that is missing."""
        return self.std <= KNOWN

    @property
    def works(self) -> bool:
        """Whether it is nearer to the table that was exported than to none."""
        return self.value >= WORKS


def parts_of(estimate: Estimate, offered: Export) -> tuple[Part, ...]:
    """Return the parts of an export that move anything: its tables, and what else its files hold as one."""
    parts = list[Part]()
    for table in offered.tables:
        over, half = estimate.machine.index(table.over), (table.forward - table.reverse) / 2
        reversal = replace(table, forward=half, reverse=-half), said("reversal of {table}", table=title(table))
        ends = estimate.box[over]
        at = np.linspace(*ends, 201)
        for one, name in ((table.averaged(), title(table)), reversal):
            if (most := float(np.max(np.abs(one.forward)))) > _NOTHING:
                values = one.deviation(at, 1)
                apart = np.round(np.abs(values - (values[0] + values[-1]) / 2), 12)  # of what is even all along
                places = (float(at[first_best(sizes, ALIKE)]) for sizes in (apart, np.abs(values)))
                control, both = Loaded((one,)).control(estimate.machine), name != title(table)
                parts.append(Part(name, control, over, (*ends, *places), both, most, one.rotary))
    rest = remainder(offered.control, Loaded(offered.tables).control(estimate.machine))
    low, high = np.array(estimate.box).T
    poses, ways = tour(low + (high - low) * np.random.default_rng(0).uniform(size=(64, len(low))), estimate.box)
    most = float(np.max(np.abs(rest(poses, ways))))
    whole = Part("the files as a whole" if not parts else "the other files", rest, None, (), False, most)
    return (*parts, *([whole] if most > _NOTHING else []))


def needed(estimate: Estimate, setups: Sequence[Setup], new: Places, parts: Sequence[Part]) -> Places:
    """Return the places that show each part: at both ends, and where it corrects most, from both sides if it is apart.

    new : places that may be read
    """
    found = Places.none(len(estimate.machine.axes))
    for part in sorted(parts, key=lambda p: not p.both):
        options = [_showing(estimate.machine, setups, part, new.within(mine)) for _, mine in new.by_setup()]
        scores = np.array([score for score, _ in options])
        if np.any(scores > 0):
            found = Places.joined([found, without(options[first_best(scores, ALIKE)][1], found)])
    return found


def without(candidates: Places, known: Places) -> Places:
    """Return candidates that are not known ones, from whichever side."""
    seen = {*_keys(known)}
    return candidates.within(np.array([key not in seen for key in _keys(candidates)], dtype=bool))


def whitening(covariance: Array) -> Array:
    """Return W (r, m) with W C Wᵀ = 1 on what a covariance (m, m) of rank r reaches, but for rounding."""
    scale, vectors = np.linalg.eigh(covariance)
    kept = scale > _TAKEN_OFF * scale[-1]
    whiten: Array = vectors[:, kept].T / np.sqrt(scale[kept])[:, None]
    return whiten


def shares(parts: Sequence[Part], columns: Array, change: Array, covariance: Array) -> tuple[Share, ...]:
    """Return the share of each part.

    columns : (m, parts) what each takes away; change : (m,) as found less as left; covariance : (m, m), may be singular
    """
    whiten = whitening(covariance)
    rows, seen = whiten @ columns, whiten @ change
    left, sizes, right = np.linalg.svd(rows, full_matrices=False)
    shown = sizes > 1e-9 * max(float(sizes[:1].sum()), _NOTHING)
    values = right[shown].T @ ((left[:, shown].T @ seen) / sizes[shown])
    spread = np.sqrt(np.sum((right[shown].T / sizes[shown]) ** 2, axis=1))
    open_ones = np.sum(right[shown] ** 2, axis=0) < 1 - 1e-6
    stds = np.where(open_ones, np.inf, spread)
    return tuple(Share(p.name, float(v), float(s), p.motion) for p, v, s in zip(parts, values, stds, strict=True))


def idle_axes(readout: Readout, box: Box) -> tuple[str, ...]:
    """Return the axes of which values say nothing: moved over less than half of the volume while read along.

    A rotary axis is read by any direction.  box : the volume
    """
    machine, poses, ways = readout.machine, readout.places.poses, np.zeros((len(readout.of), 3))
    turned, idle = machine.frames(poses).rotations, list[str]()
    for setup, _, of, at in readout.each():
        ways[of] = setup.slopes(at).moved.reshape(-1, 3)
    for k, (axis, (low, high)) in enumerate(zip(machine.axes, box, strict=True)):
        along = np.abs(np.sum(ways * (turned[k] @ np.array(axis.direction))[readout.of], axis=1)) > _ALONG
        mine = poses[readout.of[along | axis.rotary], k]
        if high > low and (not len(mine) or np.ptp(mine) < _THROUGH * (high - low)):
            idle.append(axis.name)
    return tuple(idle)


def _showing(machine: Machine, setups: Sequence[Setup], part: Part, at: Places) -> tuple[float, Places]:
    """Return those places of one set-up that show a part: nearest to its targets, or what it moves farthest.

    And by how much it makes their values differ, in standard deviations of one.
    """
    setup, picked = setups[int(at.setups[0])], dict[int, None]()
    if part.over is None:  # the farthest from the mean, then from each other
        effects = taken_away(Readout(machine, setups, at), part.control).reshape(len(at), -1)
        apart = np.linalg.norm(effects - effects.mean(axis=0), axis=1)
        for _ in range(min(_FEW, len(effects))):
            away = np.linalg.norm(effects - effects[np.argmax(apart)], axis=1)
            picked[int(np.argmax(apart))] = None
            apart = away if len(picked) == 1 else np.minimum(apart, away)
    elif part.over in setup.moves:
        for way in setup.sides if part.both else (0,):
            from_there = np.flatnonzero((at.approaches[:, part.over] == way) | (way == 0))
            for target in part.targets if len(from_there) else ():
                picked[int(from_there[np.argmin(np.abs(at.poses[from_there, part.over] - target))])] = None
    chosen = at.within(np.array(sorted(picked) if part.over is None else [*picked], dtype=np.intp))
    if len(chosen) < 2:
        return 0.0, chosen
    return float(np.ptp(taken_away(Readout(machine, setups, chosen), part.control))) / setup.noise, chosen


def far_from(machine: Machine, places: Places, used: Places) -> NDArray[np.bool_]:
    """Return which places are far from every one that their set-up was read at, (m,)."""
    lengths, far = np.array([axis.length for axis in machine.axes]), np.ones(len(places), dtype=bool)
    for setup, pose in zip(used.setups, used.poses, strict=True):
        far &= (places.setups != setup) | (np.max(np.abs(places.poses - pose) / lengths, axis=1) >= _FRESH)
    return far


def _keys(places: Places) -> list[tuple[object, ...]]:
    return list(zip(places.setups.tolist(), map(tuple, np.round(places.poses, 9).tolist()), strict=True))


OF_TWENTY = 0.05
"""Share of the machines exactly as promised that are called worse."""
HARDLY = 1e-4
"""A change of the readings that is less likely than this is not the one that the tables make."""

Verdict = Literal["promised", "worse", "faulty", "undecided"]
Decision = Literal["conform", "not conform", "neither"]


@dataclass(frozen=True, eq=False, slots=True)
class Judgement:
    """What as-found and as-left readings say; m.

    found, left : (m,) deviations, one for each value of a reading, the datums of the set-ups taken off
    std : (m,) of each, from the instrument and from what else is not known of its set-up
    of : (m,) index of the place of each; coming : sum of the squares of `left` that the estimate promises, m²
    agrees : probability that all of them together are as far off as these, or farther, if the estimate is right
    changed : probability that the tables change readings as little like they should as these, if they are loaded
    share : by which multiple of what the tables take away the readings changed; None when that is nothing
    lines : set-ups that are judged against their own line; strained : datums further off than stated
    still : set-ups all of whose as-left readings show one and the same number
    shares : how much of each table the readings show; idle : axes that were not moved through their volume, or along
        which nothing was read
    tools : set-ups that are judged with the tool where the readings put it
    tolerance : the largest deviation that somebody allowed, None where nobody did
    decision : what as-left deviations prove of it (ISO 14253-1), whatever the tables do
    places : where they were taken each way, mm and deg by axis; promised : U over the volume with the tables
    """

    found: Array
    left: Array
    std: Array
    of: NDArray[np.intp]
    coming: float
    agrees: float
    changed: float
    share: float | None
    lines: tuple[str, ...]
    strained: tuple[Datum, ...]
    still: tuple[str, ...] = ()
    shares: tuple[Share, ...] = ()
    idle: tuple[str, ...] = ()
    tools: tuple[str, ...] = ()
    tolerance: float | None = None
    decision: Decision | None = None
    places: Sequence[Mapping[str, float]] = ()
    promised: float = 0.0

    @property
    def verdict(self) -> Verdict:
        """Whether tables fail, else whether the machine is as promised; undecided where something contradicts that."""
        if self.faulty:
            return "faulty"
        if self.agrees < OF_TWENTY:
            return "worse"
        return "undecided" if self.strained or self.still or not self.loaded else "promised"

    @property
    def faulty(self) -> list[Share]:
        """The tables that are missing, or loaded with the wrong sign."""
        return [share for share in self.shares if share.checked and not share.works]

    @property
    def loaded(self) -> bool:
        """Whether the readings changed as the tables make them."""
        return self.changed >= HARDLY
