"""[[setups]] of campaign.toml read into `Setup`, with the instrument's usual figures where the file is silent."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.fields import WAYS, refuse_same_name
from axiscal.description.sights import (
    lack_of,
    refuse_short_stroke,
    refuse_stray_keys,
    refuse_unreachable,
    seen,
)
from axiscal.description.sites import STROKE, SiteReader, Surroundings
from axiscal.description.stated_type_b import with_drift, with_material
from axiscal.document import meant, shown
from axiscal.document.validation import Stated
from axiscal.exceptions import DescriptionError, Faults
from axiscal.language.spoken import joined, said
from axiscal.machine.axis import travel_text
from axiscal.measurement.charts.kinds import Line
from axiscal.measurement.instruments.displacement import (
    HalvedLength,
    Interferometer,
    PrinterProbe,
    Probe,
    Straightedge,
)
from axiscal.measurement.instruments.distance import of_each
from axiscal.measurement.instruments.written import Foreign
from axiscal.measurement.setup import SQUARE, Nodes, Setup, Unknown, Vector
from axiscal.units import format_quantity, to_unit
from axiscal_core.axes import Axis
from axiscal_core.instrument import TOOL

_SHORTEST_REACH = 4.0
"""A reach is longer than so many overruns."""


def read_setups(tables: list[SetupTable], around: Surroundings) -> tuple[Setup, ...]:
    """Return the set-ups; raises DescriptionError or UnitError at the line that is wrong."""
    document = around.document
    if not tables:
        raise document.fault(DescriptionError("there is no set-up", "Add a table [[setups]]"), "setups")
    faults, setups = Faults(), list[Setup]()
    for number, table in enumerate(tables):
        with faults.noted():
            stated = Stated(document, table, ("setups", number))
            if table.choose_from is not None:
                _refuse_choice(stated, table.choose_from)
            if around.anew:
                refuse_stray_keys(stated)
            halved = bool(table.lengths) and not around.whole_lengths
            kind = PrinterProbe if around.printer and table.instrument is Probe else table.instrument
            kind = HalvedLength if halved else kind
            for each in each_alone(table, halved):
                setups.append(_Reader(document, each, stated.keys, around, kind).setup())
    with faults.noted():
        refuse_same_name([setup.name for setup in setups], document, "setups", 'two set-ups are called "{name}"')
    faults.refuse()
    return tuple(setups)


def each_alone(table: SetupTable, halved: bool = False) -> list[SetupTable]:
    """Return a set-up at each place from which a plan may choose, called by it, in mm, or for each length; else itself.

    A length is one reading, at its second end; halved, as records of before have it, one at each end, with its part of
    the noise.
    """
    key, noise = "station" if table.artefact is None else "at", table.noise or table.instrument.usual.noise
    each = list[dict[str, Any]]()
    for name, ends in table.lengths.items():
        part = {"noise": noise / math.sqrt(2.0), "raster": {"along": math.dist(*ends)}} if halved else {}
        each.append({"name": f"{table.name} {name}", "lengths": {}, "along": ends, **part})
    for number, place in enumerate(table.choose_from or ()):
        where = ", ".join(f"{to_unit(value, 'mm'):g}" for value in place)
        each.append({"name": f"{table.name} at {where}", key: place, "mounted": table.mounted + number})
    return [table.model_copy(update=update) for update in each] or [table]


def _refuse_choice(stated: Stated[SetupTable], places: Sequence[Vector]) -> None:
    """Raise DescriptionError where a plan may choose from places that are none."""
    table, kind = stated.table, stated.table.instrument
    stands = kind.site == "bar" or (kind.site == "sight" if table.artefact is None else kind.usual.contact != "free")
    with stated.at_key("choose_from"):
        if not stands:
            what = "a {instrument} stands at no place that could be chosen"
            raise DescriptionError(what, "Write a set-up for each way to mount it", instrument=kind.instrument)
        if table.stations or any(each is not None for each in (table.station, table.at)):
            what = "it is said twice where it stands"
            raise DescriptionError(what, "Keep choose_from, or station, stations or at")
        if len(set(places)) < max(len(places), 2):
            raise DescriptionError("these are not two or more different places", "Name each place once")


class _Reader(SiteReader):
    """Reads one table."""

    def setup(self) -> Setup:
        table, kind = self.table, self.kind
        setup = self.sited()
        with self.at_key("direction"):
            self._refuse_direction(setup)
        unknowns = self._unknowns(setup)
        # spheres are put up one by one, or on a board
        apart = setup.contact == "retracted" and setup.artefact is not None and setup.artefact.calibrated is None
        mountings = len(setup.balls) if apart and table.setup_time is None else 1
        setup = replace(
            setup,
            unknowns=of_each(unknowns, len(table.stations)) if table.stations else unknowns,
            setup_time=setup.setup_time * mountings,
            raster=self._raster(setup),
            reach=self._reach(setup.moves) if table.reach else None,
            nodes=self._nodes(setup.moves) if table.map else None,
        )
        setup = with_drift(table, setup, self.around.usual_doubts)
        setup = with_material(self, setup)
        if kind is Straightedge and table.artefact is not None:
            setup = self._on_square(setup)
        setup = seen(self, setup) if setup.chart is None else self._charted(setup)
        if kind.site in ("sight", "bar") and not setup.standing:
            what = 'it is not said where the station of "{setup}" is'
            remedy = 'Write station = ["0 mm", "0 mm", "-300 mm"], in the workpiece frame'
            raise self.misstated("instrument", what, remedy, setup=setup.name)
        with self.at_key("instrument" if setup.base is None else "base"):
            setup.check()
            if isinstance(setup, Foreign):
                setup = replace(setup, curved=setup.curved_by())
        lack = lack_of(setup, table)
        if lack is not None and (self.around.asking or kind.site == "length"):
            raise self.misstated("instrument", *lack)
        return replace(setup, lacks=lack)

    def _charted(self, setup: Setup) -> Setup:
        """Return a set-up that has a chart, with the stroke of what is held in touch."""
        stroke = STROKE if self.table.stroke is None else self.table.stroke
        with self.at_key("artefact" if setup.artefact else "length" if setup.length else "along"):
            refuse_unreachable(setup)
        if setup.contact != "held":
            return setup
        with self.at_key("length" if setup.length else "instrument"):
            refuse_short_stroke(setup, stroke)
        return replace(setup, stroke=stroke)

    def _refuse_direction(self, setup: Setup) -> None:
        """Raise DescriptionError where a direction is lacking, or given beside that of a line."""
        given, lined = self.table.direction, isinstance(setup.chart, Line)
        if lined and given is not None and self.kind is Interferometer:
            raise DescriptionError("the direction of a laser along a line is that of the line", "Take direction out")
        if self.kind.directed and given is None and not lined and self.kind.site != "length":
            what = '"direction" is missing: the {instrument} reads in one direction'
            raise DescriptionError(what, WAYS, instrument=self.kind.instrument)

    def _reach(self, moves: tuple[int, ...]) -> tuple[tuple[float, float], ...]:
        spans = [axis.travel for axis in self.machine.axes]
        for name, (low, high) in self.table.reach.items():
            with self.at_key("reach", name):
                index = self._moving(name, moves, "{axis} has a reach, but does not move in this set-up")
                if high - low < _SHORTEST_REACH * self.machine.axes[index].overrun:
                    raise DescriptionError("{text} is too short", "Give ends farther apart", text=name)
                spans[index] = low, high
        return tuple(spans)

    def _nodes(self, moves: tuple[int, ...]) -> tuple[Nodes, Nodes]:
        """Return where the nodes lie of maps whose files carry no coordinates."""
        stated = self.table.map
        with self.at_key("map"):
            if stated.keys() != {"X", "Y"}:
                raise DescriptionError("a map has two sides, X and Y", "State both of them, and no other")
            for name in stated:
                self._moving(name, moves, "{axis} has nodes of a map, but does not move in this set-up")
        return stated["X"], stated["Y"]

    def _moving(self, name: str, moves: tuple[int, ...], what: str) -> int:
        """Return the index of an axis that moves; raises DescriptionError for another.  what : is wrong then"""
        index = self.machine.index(name)
        if index not in moves:
            raise DescriptionError(what, "Take it out here, or add {axis} to moves", axis=name)
        return index

    def _raster(self, setup: Setup) -> tuple[float, ...]:
        """Return the steps of the axes; those of a chart are its own."""
        steps, margin, table = [0.0] * len(self.machine.axes), (setup.base or 0.0) / 2, self.table
        along = ["along"] if table.along else ["azimuth", "elevation"] if table.length else []
        turning = [self.machine.axes[k].name for k in setup.moves if self.machine.axes[k].rotary]
        known = ["arc"] if table.plane else along + turning
        for name, step in table.raster.items():
            with self.at_key("raster", name):
                if setup.chart is None:
                    index = self._moving(name, setup.moves, "{axis} has a raster, but does not move in this set-up")
                    _refuse_no_multiple(step, self.machine.axes[index], table.reach.get(name), margin)
                    steps[index] = step
                elif self.around.anew and name not in known:
                    what, remedy = "{axis} has a raster, and readings of this set-up go along {known}", "Take it out"
                    raise DescriptionError(what, remedy, axis=name, known=joined(known) or said("no axis"))
        return tuple(steps)

    def _unknowns(self, setup: Setup) -> tuple[Unknown, ...]:
        """Return what it leaves open: its own, or what its place does; of these whose they are stays."""
        given, kind = self.table.unknowns, self.kind
        turns = any(self.machine.axes[index].rotary for index in setup.moves)
        own = setup.unknowns or tuple(each for each in kind.usual.unknowns if turns or each.name not in TOOL)
        if given is not None:
            placed = {unknown.name: unknown for unknown in setup.unknowns}
            known = placed or kind.unknown_reads
            for name in (each for each in given if each not in known):
                what = "{name} is not an unknown of a set-up with a {instrument}"
                told = {"name": shown(name), "instrument": kind.instrument}
                raise self.misstated(("unknowns", name), what, meant(name, known), **told)
            own = tuple(replace(placed.get(name, Unknown(name, std)), std=std) for name, std in given.items())
        moving = [self.machine.axes[k].name for k in setup.moves if not self.machine.axes[k].rotary]
        if any(unknown.name == "slope" for unknown in own) and kind.directed and len(moving) != 1:
            what = "an unknown slope needs exactly one linear axis that moves; here {axes} move"
            remedy = 'Name one in moves, such as moves = ["X"], or give unknowns without slope'
            axes, where = joined(moving) or said("none"), "moves" if given is None else ("unknowns", "slope")
            raise self.misstated(where, what, remedy, axes=axes)
        return own

    def _on_square(self, setup: Setup) -> Setup:
        """Return a set-up whose straightedge is a leg of a square: the turn of the square replaces the slope."""
        square = replace(self._named(), mounted=self.table.mounted)
        if square.balls:
            remedy = 'Let the square be an artefact without balls: [[artefacts]] name = "square", turned = "1 mrad"'
            raise self.misstated(
                "artefact", "{square} has balls: a straightedge lies at none", remedy, square=square.name
            )
        if square.keep_out and self.around.asking:
            what = "an indicator goes along {square}, and keeps clear of no keep_out"
            raise self.misstated("artefact", what, "Take it out, and see to the ways yourself", square=square.name)
        own = tuple(unknown for unknown in setup.unknowns if unknown.name != "slope")
        turns = tuple(Unknown(name, square.turned, square.standing) for name in SQUARE)
        return replace(setup, unknowns=(*own, *turns))


def _refuse_no_multiple(step: float, axis: Axis, reach: tuple[float, float] | None, margin: float) -> None:
    """Raise DescriptionError for a raster without a place where an axis is read.

    reach : from where to where; None for the whole travel; margin : m or rad, that its ends are kept off
    """
    ends = axis.travel if reach is None else reach
    low, high = ends[0] + margin, ends[1] - margin
    if math.ceil(low / step - 1e-9) * step > high + 1e-9 * axis.length:
        what = "no multiple of {text} lies in the travel of {axis}"
        what = what if reach is None else "no multiple of {text} lies in the reach of {axis}"
        remedy, travel = "Give a smaller step; the axis goes from {travel}", travel_text(axis)
        raise DescriptionError(what, remedy, text=format_quantity(step, axis.unit), axis=axis.name, travel=travel)
