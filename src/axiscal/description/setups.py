"""[[setups]] of campaign.toml read into `Setup`, with the instrument's usual figures where the file is silent."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.fields import WAYS
from axiscal.description.sights import (
    lack_of,
    refuse_both,
    refuse_of_length,
    refuse_short_stroke,
    refuse_stray_keys,
    refuse_unreachable,
    seen,
)
from axiscal.description.sites import STROKE, SiteReader, Surroundings
from axiscal.description.stated_type_b import with_drift, with_material
from axiscal.document import Document, meant, shown
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
from axiscal.measurement.instruments.distance import Tracker, of_each
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
            refuse_both(stated)
            refuse_of_length(stated)
            if around.anew:
                refuse_stray_keys(stated)
            printed = around.printer and table.instrument is Probe
            kind = PrinterProbe if printed else table.instrument
            halved = table.lengths and not around.whole_lengths
            kind, each_one = (HalvedLength, _halved(table)) if halved else (kind, each_alone(table))
            setups += [_Reader(document, each, stated.keys, around, kind).setup() for each in each_one]
    with faults.noted():
        _refuse_same_name(setups, document)
    faults.refuse()
    return tuple(setups)


def each_alone(table: SetupTable) -> list[SetupTable]:
    """Return a set-up at each place from which a plan may choose, called by it, in mm, or for each length; else itself.

    A length is one reading, at its second end.
    """
    if table.lengths:
        named = ((f"{table.name} {name}", ends) for name, ends in table.lengths.items())
        return [table.model_copy(update={"lengths": {}, "name": name, "along": ends}) for name, ends in named]
    if table.choose_from is None:
        return [table]
    key, tables = "station" if table.artefact is None else "at", list[SetupTable]()
    for number, place in enumerate(table.choose_from):
        where = ", ".join(f"{to_unit(value, 'mm'):g}" for value in place)
        name = f"{table.name} at {where}"
        tables.append(table.model_copy(update={"name": name, key: place, "mounted": table.mounted + number}))
    return tables


def _halved(table: SetupTable) -> list[SetupTable]:
    """Return a set-up for each length as records of before read it: at both ends, each with its part of the noise."""
    noise = (table.instrument.usual.noise if table.noise is None else table.noise) / math.sqrt(2.0)
    steps = ((each, {"along": math.dist(*each.along)}) for each in each_alone(table) if each.along)
    return [each.model_copy(update={"noise": noise, "raster": raster}) for each, raster in steps]


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


def _refuse_same_name(setups: Sequence[Setup], document: Document) -> None:
    seen: set[str] = set()
    for number, setup in enumerate(setups):
        if setup.name in seen:
            what, remedy = 'two set-ups are called "{setup}"', "Give each a name of its own"
            raise document.fault(DescriptionError(what, remedy, setup=setup.name), "setups", number, "name")
        seen.add(setup.name)


class _Reader(SiteReader):
    """Reads one table."""

    def setup(self) -> Setup:
        table, machine, kind = self.table, self.around.machine, self.kind
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
        setup = seen(self, machine, setup) if setup.chart is None else self._charted(setup)
        if kind.site in ("sight", "bar") and not setup.standing:
            what = "it is not said where {thing} is"
            remedy = 'Write station = ["0 mm", "0 mm", "-300 mm"], in the workpiece frame'
            thing = "the tracker" if kind is Tracker else "the {instrument}'s other end"
            raise self.misstated("instrument", what, remedy, thing=said(thing, instrument=kind.instrument))
        with self.at_key("instrument" if setup.base is None else "base"):
            setup.check()
            if isinstance(setup, Foreign):
                setup = replace(setup, curved=setup.curved_by())
        lack = lack_of(setup, machine, table.reach, table.moves is not None)
        if lack is not None and self.around.asking:
            raise self.misstated("instrument", *lack)
        return replace(setup, lacks=lack)

    def _charted(self, setup: Setup) -> Setup:
        """Return a set-up that has a chart, with the stroke of what is held in touch."""
        stroke = STROKE if self.table.stroke is None else self.table.stroke
        with self.at_key("artefact" if setup.artefact else "length" if setup.length else "along"):
            refuse_unreachable(self.around.machine, setup)
        if setup.contact != "held":
            return setup
        with self.at_key("length" if setup.length else "instrument"):
            refuse_short_stroke(self.around.machine, setup, stroke)
        return replace(setup, stroke=stroke)

    def _refuse_direction(self, setup: Setup) -> None:
        """Raise DescriptionError where a direction is lacking, or given beside that of a line."""
        given, lined = self.table.direction, isinstance(setup.chart, Line)
        if lined and given is not None and self.kind is Interferometer:
            raise DescriptionError("the direction of a laser along a line is that of the line", "Take direction out")
        if self.kind.directed and given is None and not lined:
            what = '"direction" is missing: the {instrument} reads in one direction'
            raise DescriptionError(what, WAYS, instrument=self.kind.instrument)

    def _reach(self, moves: tuple[int, ...]) -> tuple[tuple[float, float], ...]:
        spans = [axis.travel for axis in self.around.machine.axes]
        for name, (low, high) in self.table.reach.items():
            with self.at_key("reach", name):
                index = self._moving(name, moves, "{axis} has a reach, but does not move in this set-up")
                if high - low < _SHORTEST_REACH * self.around.machine.axes[index].overrun:
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
        index = self.around.machine.index(name)
        if index not in moves:
            raise DescriptionError(what, "Take it out here, or add {axis} to moves", axis=name)
        return index

    def _raster(self, setup: Setup) -> tuple[float, ...]:
        """Return the steps of the axes; those of a chart are its own."""
        steps, margin = [0.0] * len(self.around.machine.axes), (setup.base or 0.0) / 2
        for name, step in self.table.raster.items():
            with self.at_key("raster", name):
                if setup.chart is not None:
                    self._refuse_no_coordinate(name, setup)
                    continue
                index = self._moving(name, setup.moves, "{axis} has a raster, but does not move in this set-up")
                _refuse_no_multiple(step, self.around.machine.axes[index], self.table.reach.get(name), margin)
                steps[index] = step
        return tuple(steps)

    def _refuse_no_coordinate(self, name: str, setup: Setup) -> None:
        """Raise DescriptionError for a step along what is no coordinate of a chart."""
        table, axes = self.table, [self.around.machine.axes[k] for k in setup.moves]
        known = ["along"] if table.along else ["azimuth", "elevation"] if table.length else []
        known = ["arc"] if table.plane else known + [axis.name for axis in axes if axis.rotary]
        if self.around.anew and name not in known:
            what, remedy = "{axis} has a raster, and readings of this set-up go along {known}", "Take it out here"
            raise DescriptionError(what, remedy, axis=name, known=joined(known) or said("no axis"))

    def _unknowns(self, setup: Setup) -> tuple[Unknown, ...]:
        given, moves, kind = self.table.unknowns, setup.moves, self.kind
        if setup.unknowns:
            return setup.unknowns if given is None else self._chosen(given, setup.unknowns)
        if given is None:
            turns = any(self.around.machine.axes[index].rotary for index in moves)
            unknowns = tuple(unknown for unknown in kind.usual.unknowns if turns or unknown.name not in TOOL)
        else:
            unknowns = tuple(self._unknown(name, std) for name, std in given.items())
        if kind.directed and "slope" in (unknown.name for unknown in unknowns):
            with self.at_key(*(["moves"] if given is None else ["unknowns", "slope"])):
                self._refuse_slope(moves, given is None)
        return unknowns

    def _chosen(self, given: Mapping[str, float], placed: Sequence[Unknown]) -> tuple[Unknown, ...]:
        """Return those of the unknowns of its place that are named, with their std as given; whose they are stays."""
        known = {unknown.name: unknown for unknown in placed}
        for name in given:
            if name not in known:
                what, remedy = "{name} is not an unknown of this {instrument}", "Known are {known}"
                told = {"name": shown(name), "instrument": self.kind.instrument, "known": ", ".join(known)}
                raise self.misstated(("unknowns", name), what, remedy, **told)
        return tuple(replace(known[name], std=std) for name, std in given.items())

    def _unknown(self, name: str, std: float) -> Unknown:
        kind, kinds = self.kind, self.kind.unknown_reads
        if name not in kinds and not (name == "slope" and kind.reads == "angle"):  # refused for its own reason
            what = "{name} is not an unknown of a set-up with a {instrument}"
            length = kind.site == "length" and name == "zero"
            remedy = "Take it out: a length is the difference of two places" if length else meant(name, kinds)
            raise self.misstated(("unknowns", name), what, remedy, name=shown(name), instrument=kind.instrument)
        return Unknown(name, std)

    def _refuse_slope(self, moves: tuple[int, ...], by_default: bool) -> None:
        kind = self.kind
        if kind.reads == "angle":
            what = "an unknown slope turns the line of a displacement, and the {instrument} reads an angle"
            raise DescriptionError(what, "Take slope out", instrument=kind.instrument)
        moving = [self.around.machine.axes[index].name for index in moves if not self.around.machine.axes[index].rotary]
        if len(moving) != 1:
            what = "an unknown slope needs exactly one linear axis that moves; here {axes} move"
            if by_default:
                what = (
                    "the {instrument}'s usual unknown slope needs exactly one linear axis that moves; here {axes} move"
                )
            remedy = 'Name one in moves, such as moves = ["X"], or give unknowns without slope'
            axes = ", ".join(moving) or said("none")
            raise DescriptionError(what, remedy, instrument=kind.instrument, axes=axes)

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
    if math.ceil(low / step - 1e-9) * step <= high + 1e-9 * axis.length:
        return
    size = format_quantity(step, axis.unit)
    if reach is not None:
        what, remedy = "no multiple of {text} lies in the reach of {axis}", "Give a smaller step, or a longer reach"
        raise DescriptionError(what, remedy, text=size, axis=axis.name)
    what = "no multiple of {text} lies in the travel of {axis}"
    remedy = "Give a smaller step; the axis goes from {travel}"
    raise DescriptionError(what, remedy, text=size, axis=axis.name, travel=travel_text(axis))
