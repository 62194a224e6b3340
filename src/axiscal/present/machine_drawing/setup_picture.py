"""The picture of a set-up: the machine, the instrument on it, and where readings are taken."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.language.spoken import counted, said
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.present.drawing.scene import RIGHT, Arrow, Part, Stroke, Viewport, drawn, flat
from axiscal.present.drawing.strokes import text, wrapped
from axiscal.present.drawing.svg_picture import SCREENS, Drawing, picture_file
from axiscal.present.machine_drawing.instruments import MountedSetup, instrument_parts, reading_parts
from axiscal.present.machine_drawing.machine_scene import box_corners, edges, machine_parts, reach_edges
from axiscal.present.machine_drawing.standing_machine import Measures, StandingMachine, name_of, up
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

_LINE = 20.0
"""Pixels from one line of text to the next."""
_SIDE = 10.0
"""Pixels between the picture and its edge."""


@dataclass(frozen=True, eq=False, slots=True)
class SetupScene:
    """A set-up on its machine, ready to be drawn at any width.

    parts : of the scene; title, legend : in words; note : what lines mean that all set-ups of a machine show
    """

    parts: Sequence[Part]
    title: str
    legend: str
    note: str

    def svg(self, width: float, height: float, left: float = 0.0, top: float = 0.0, titled: bool = True) -> str:
        """Return the picture as SVG elements within a frame, pixels."""
        heads = wrapped(self.title, width - 2 * _SIDE, "title") if titled else []
        lines = wrapped(self.legend, width - 2 * _SIDE) if self.legend else []
        over, beneath = _LINE * len(heads) + 4, _LINE * len(lines) + 6
        frame = Viewport(left + _SIDE, top + over, width - 2 * _SIDE, height - over - beneath)
        words = _lines(heads, left + _SIDE, top + 16, "title")
        return drawn(self.parts, frame) + words + _lines(lines, left + _SIDE, top + height - beneath + 18, "soft")


def _lines(lines: Sequence[str], left: float, top: float, kind: str) -> str:
    return "".join(text(left, top + _LINE * n, line, kind) for n, line in enumerate(lines))


def setup_scene(
    campaign: CampaignDescription,
    setup: Setup,
    places: Sequence[Place],
    at: Place | None = None,
    coming: Sequence[Place] = (),
) -> SetupScene:
    """Return a set-up with the places where it is read.

    places : of any set-up; coming : where readings are still to be taken
    at : where the machine stands, None for one of the places
    """
    own, later = ([place for place in some if place.setup == setup.name] for some in (places, coming))
    shown = at or _best_seen(campaign, setup, own)
    room = StandingMachine(campaign.machine, np.array(shown.pose if shown else setup.park, dtype=float))
    stand = MountedSetup(Measures(room), setup)
    parts = [
        *machine_parts(room),
        *reach_edges(room),
        *_outlines(campaign, room),
        *instrument_parts(stand),
    ]
    size = 3.0 if len(own) + len(later) < 10 else 2.2
    parts += reading_parts(stand, _tips(room, later), _sides(room, later), "soft", size)
    parts += reading_parts(stand, _tips(room, own), _sides(room, own), "read", size)
    one_line = len(setup.moves) == 1 and not campaign.machine.axes[setup.moves[0]].rotary
    tails = one_line and any(any(place.approach) for place in own)
    read = "● " + counted("{count} reading", "{count} readings", len(own)) if own else ""
    coming_words = said("grey: {count} to come", count=len(later)) if later else ""
    legend = " · ".join(part for part in (read, coming_words) if part)
    notes = _reach_note(room), said("tail: the side it comes from") if tails else ""
    return SetupScene(parts, setup.name, legend, " · ".join(note for note in notes if note))


def frame_seen(machine: Machine, place: Place) -> list[tuple[float, float]]:
    """Return unit vectors along x, y, z of the workpiece as a picture of the machine has them, right and down."""
    room = StandingMachine(machine, np.array(place.pose))
    return [(right, down) for right, down in flat(np.array([*map(room.direction_on_table, np.eye(3))])).tolist()]


def machine_scene(machine: Machine, *, lengths: bool = True) -> SetupScene:
    """Return a machine that stands amid its travels.  lengths : whether its axes say how far they travel, in mm"""
    room = StandingMachine(machine, np.array([sum(axis.travel) / 2 for axis in machine.axes]))
    named = {
        name_of(room, k): _travel(name_of(room, k), axis) for k, axis in enumerate(machine.axes) if not axis.rotary
    }
    parts = [
        replace(part, name=named.get(part.name, part.name)) if lengths and isinstance(part, Arrow) else part
        for part in machine_parts(room)
    ]
    return SetupScene([*parts, *reach_edges(room)], machine.name, "", _reach_note(room) if lengths else "")


def _travel(name: str, axis: Axis) -> str:
    """Return an axis with how far it travels, mm; where its display shows diameters, that too."""
    text = f"{name} {1e3 * axis.length:.0f}"
    return f"{text} (⌀ {2e3 * axis.length:.0f})" if axis.diameters else text


def _reach_note(room: StandingMachine) -> str:
    spans = " × ".join(f"{1e3 * span:.0f}" for span in room.reach[1] - room.reach[0] if span > 1e-9)
    return said("dashed: where the tool reaches, {size} mm", size=spans) if spans else ""


def _tips(room: StandingMachine, places: Sequence[Place]) -> Array:
    """Return where the tool point is at places, (n, 3) m, in the room as the table stands."""
    if not places:
        return np.zeros((0, 3))
    return room.on_table(room.machine.frames(np.array([place.pose for place in places])).tcp)


def _sides(room: StandingMachine, places: Sequence[Place]) -> Array:
    axes = len(room.machine.axes)
    return np.array([place.approach or (0,) * axes for place in places], dtype=float).reshape(-1, axes)


def _best_seen(campaign: CampaignDescription, setup: Setup, places: Sequence[Place]) -> Place | None:
    """Return the place that shows all best: rotary axes near 0, the tool to the right or high up."""
    if not places:
        return None
    upright = StandingMachine(campaign.machine, np.array(setup.park)).upright
    turned = [k for k, axis in enumerate(campaign.machine.axes) if axis.rotary]
    tips = campaign.machine.frames(np.array([place.pose for place in places])).tcp @ upright.T
    high = abs(setup.direction[2]) > 0.7 and setup.instrument == "interferometer"

    def merit(n: int) -> tuple[float, float]:
        off = sum(abs(float(np.sin(places[n].pose[k] / 2))) for k in turned)
        return round(-off, 3), float(tips[n][2] if high else tips[n] @ RIGHT)

    return places[max(range(len(places)), key=merit)]


def _outlines(campaign: CampaignDescription, room: StandingMachine) -> Iterator[Part]:
    """Yield the part that is to be machined, and what the tool has to keep out of."""
    part = campaign.target.part
    if part is not None and part.radius is not None:
        turn = np.linspace(0, 2 * np.pi, 73)
        low, high = part.spans[2]
        ring = part.radius * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
        for level in (low, high):
            yield Stroke(room.on_table(ring + up(level)), "part", 1.6)
    elif part is not None:
        low_corner, high_corner = np.array(part.spans).T
        yield from edges(room.on_table(box_corners(low_corner, high_corner)), "part", "")
    for artefact in {setup.artefact.name: setup.artefact for setup in campaign.setups if setup.artefact}.values():
        for kept_out in artefact.keep_out:
            low_corner, high_corner = np.clip(np.array(kept_out), -1.0, 1.0).T
            yield from edges(room.on_table(box_corners(low_corner, high_corner)), "beam", "2 4")


def setup_picture(scene: SetupScene, width: float) -> str:
    """Return the text of an SVG file with one set-up, without its title, for a width in pixels."""
    ratio = 0.66 if width > 500 else 0.95
    whole = replace(scene, legend=" · ".join(part for part in (scene.legend, scene.note) if part))
    drawing = Drawing(width, round(ratio * width), whole.svg(width, round(ratio * width), titled=False))
    return picture_file([drawing], scene.title)


def plan_picture(
    title: str, campaign: CampaignDescription, places: Sequence[Place], widths: Sequence[float] = SCREENS
) -> str:
    """Return the text of an SVG file: each set-up that is read, on the machine.

    places : in any order; widths : of screens, pixels, the widest first
    """
    used = dict.fromkeys(place.setup for place in places)
    scenes = [setup_scene(campaign, campaign.setup(name), places) for name in used]
    return picture_file([_beside_each_other(scenes, title, width) for width in widths], title)


def _beside_each_other(scenes: Sequence[SetupScene], title: str, width: float) -> Drawing:
    """Return the pictures of set-ups beside and below each other, and once what the dashed lines are."""
    columns = max(1, min(len(scenes), 1 if width < 700 else 2 if width < 1100 else 3))
    across = width / columns
    alone = len(scenes) == 1
    high = round(across * (0.6 if across > 600 else 0.9))
    note = scenes[0].note if scenes else ""
    heads = wrapped(f"{title}: {scenes[0].title}" if alone else title, width - 2 * _SIDE, "title")
    feet = wrapped(" · ".join(part for part in (scenes[0].legend, note) if part) if alone else note, width - 2 * _SIDE)
    top = _LINE * len(heads) + 12
    foot = top + high * -(-len(scenes) // columns)
    body = _lines(heads, _SIDE, 20, "title")
    for n, scene in enumerate(scenes):
        shown = replace(scene, legend="") if alone else scene
        body += shown.svg(across, high, across * (n % columns), top + high * (n // columns), titled=not alone)
    return Drawing(width, foot + 10 + _LINE * len(feet), body + _lines(feet, _SIDE, foot + 18, "soft"))
