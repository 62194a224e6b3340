"""Twelve slips of a person at the page, each on drawn machines: how many the page names, and after how many readings.

    python benchmarks/bench_slips.py
    python benchmarks/bench_slips.py 8      # machines for each slip, 4 unless said

A slip begins at a mounting, or at the sixth reading. It is named where the page says its name, or offers it as a
button, before anything is kept or within three readings. It is noticed where the page asks to read again. Two jobs
take turns: two legs of a square on a router, and a laser on a lathe.

Each machine is then measured to the end by somebody who believes the page: a test that fails is put right, a button
says that the zero is new, and any other surprise is read again. What 95 % of the places of the row are then off by, of
its U, is the last column; a campaign is held where that is at most 1.
"""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from axiscal.campaign.beginning import begun_campaign
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources import virtual_machine
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.first_campaign import Purpose
from axiscal.description.first_files import first_files, of_builtin
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.known_rows import known_row
from axiscal.exceptions import ReadingError
from axiscal.machine.kinematics import frames
from axiscal.measurement.reading import Place
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.present.guide.progress import Answer
from axiscal.present.guide.slips import Cause, Meant, display_text
from axiscal.record.events import Asked
from axiscal.web.desk import Desk
from axiscal_core.threads import one_thread

READINGS = 16
BEGINS, WITHIN = 5, 3
"""Readings before a slip, and those in which it has to be named."""
JOBS = {"square": ("router", "square", "squareness XY"), "laser": ("lathe", "interferometer", "positioning Z")}
"""Machine, instrument, and what is wanted."""
BAD = "away from what is expected|no longer relied on|is not used"
"""What names a reading as bad; a reason the page cannot know."""


class Person:
    """Who measures a drawn machine, and knows what would be right."""

    def __init__(self, campaign: Campaign, seed: int) -> None:
        described = campaign.description
        self.campaign, self._rng = campaign, np.random.default_rng(seed)
        drawn = virtual_machine(f"sim:{seed}", Simulator(described.machine, described.setups))
        self.machine, _ = drawn
        self._source, self._shown = SimulatedSource(*drawn), list[Array]()

    def right(self, place: Place, asked: Place | None = None) -> Array:
        """Return what is read at a place, m, where another one is asked for: the way between them is seen as well."""
        answer = self._source.read(self.campaign.request(Asked(0, place)))
        values, setup = np.array([answer.value, *answer.others]), self.campaign.description.setup(place.setup)
        if asked is not None:
            there, here = frames(self.campaign.description.machine, np.array([place.pose, asked.pose])).tcp
            values[0] += np.array(setup.direction) @ (there - here)
        return values

    def reads(self, place: Place, slip: Slip, number: int) -> Array:
        """Return what the person types for a place, m.  number : of the reading, from 0"""
        slips = number >= BEGINS if slip.lasts else number == BEGINS
        self._shown.append(slip.typed(self, place) if slips else self.right(place))
        return self._shown[-1]

    def last(self, place: Place) -> Array:
        """Return what the display showed before."""
        return self._shown[-1]

    def other(self, place: Place) -> Array:
        """Return what is read at the place that comes next."""
        return self.right(self.campaign.state.coming[1], place)

    def elsewhere(self, place: Place) -> Array:
        """Return what is read half a travel away."""
        machine, setup = self.campaign.description.machine, self.campaign.description.setup(place.setup)
        pose = np.array(place.pose)
        low, high = machine.axes[setup.moves[0]].travel
        pose[setup.moves[0]] += 0.5 * (high - low) * (1 if pose[setup.moves[0]] < 0.5 * (low + high) else -1)
        return self.right(replace(place, pose=tuple(pose.tolist())), place)

    def along_another(self, place: Place) -> Array:
        """Return what is read where another axis, drawn, has been moved by the step."""
        machine, setup = self.campaign.description.machine, self.campaign.description.setup(place.setup)
        pose, before = np.array(place.pose), np.array(self.campaign.state.readings[-1].pose)
        others = [k for k, axis in enumerate(machine.axes) if k != setup.moves[0] and not axis.rotary]
        other = int(self._rng.choice(others))
        step = pose[setup.moves[0]] - before[setup.moves[0]]
        low, high = machine.axes[other].travel
        pose[setup.moves[0]] = before[setup.moves[0]]
        pose[other] = np.clip(pose[other] + step, low, high)
        return self.right(replace(place, pose=tuple(pose.tolist())), place)


@dataclass(frozen=True)
class Slip:
    """A slip, and what the page has to say.

    jog : times what the display shows at the test; typed : in the place of what is right, m
    lasts : also at the readings after the first; button : that tells the page of it, None where one reads again
    """

    name: str
    says: str
    typed: Callable[[Person, Place], Array] = Person.right
    jog: float = 1.0
    lasts: bool = False
    jobs: tuple[str, ...] = ("square", "laser")
    machines: int = 1
    button: Cause | None = None


SLIPS = (
    Slip("sign", "counts the other way", jog=-1.0),
    Slip("mm for um", "is in mm", jog=1e-3),
    Slip("unit", "thousandths of an inch", jog=1 / 25.4),
    Slip("scale", "shows 10 times", jog=10.0),
    Slip(
        "re-zeroed",
        "set anew|another zero",
        lambda person, place: person.right(place) + 140e-6,
        lasts=True,
        button="anew",
    ),
    Slip("bumped", "bumped|set anew", lambda person, place: person.right(place) - 300e-6, lasts=True, button="bumped"),
    Slip("legs swapped", "does not follow", jog=0.0, jobs=("square",)),  # on the other leg it looks along another axis
    Slip("wrong axis", BAD, Person.along_another, machines=2),
    Slip("missed reading", f"{BAD}|row", Person.other, lasts=True),
    Slip("repeated value", f"{BAD}|stuck|repeat", Person.last),
    Slip("stuck", f"{BAD}|stuck", Person.last, lasts=True),
    Slip("wrong place", BAD, Person.elsewhere),
)


def looked(desk: Desk, typed: str) -> Meant:
    """Return what the page makes of a reading as it is typed."""
    return Meant.of_text(desk.campaign, desk.state.question, typed)


def said(desk: Desk, typed: str) -> str:
    """Return what the page says before a reading is kept."""
    look = looked(desk, typed)
    return " ".join([look.sentence, *look.causes.values()])


def told(slip: Slip, desk: Desk, person: Person) -> Iterator[str]:
    """Yield what the page says at each of the steps in which a slip has to be named: a test, or a reading."""
    number = 0
    while (question := desk.state.question) is not None and number < READINGS:
        if desk.state.jog is not None:
            shown = f"{desk.state.jog.shows * slip.jog:.4g}"
            try:
                desk.jog(shown, anyway=False)
            except ReadingError as refused:
                yield str(refused)
                return
        asked = person.campaign.open_question().place
        setup = person.campaign.description.setup(asked.setup)
        typed = display_text(person.reads(asked, slip, number).tolist(), setup)
        before = said(desk, typed)
        desk.keep(typed, cause="keep")
        desk.think()
        number += 1
        if number > BEGINS:
            yield " ".join([before, desk.state.asks, *desk.state.minds])
    assert question is None or number == READINGS


@one_thread()
def met(slip: Slip, record: Path, seed: int) -> tuple[int, bool]:
    """Return after how many readings a slip is named, 0 for before any and -1 for never, and if it is noticed."""
    with Campaign.open(record) as campaign:
        person = Person(campaign, seed)
        desk, heard = Desk(campaign, lambda: None), ""
        for number, words in enumerate(told(slip, desk, person)):
            if number >= WITHIN:
                break
            heard += words
            if re.search(slip.says, words):
                return number + (slip.jog == 1.0), True
        return -1, heard.strip() != ""


def measured(slip: Slip, desk: Desk, person: Person) -> None:
    """Measure to the end of the plan as somebody does who believes the page."""
    right, number = False, 0
    while desk.state.question is not None and number < READINGS:
        if (test := desk.state.jog) is not None:
            try:
                desk.jog(f"{test.shows * (1.0 if right else slip.jog):.4g}", anyway=False)
            except ReadingError:
                right = True
                desk.jog(f"{test.shows:.4g}", anyway=False)
        asked = person.campaign.open_question().place
        setup = person.campaign.description.setup(asked.setup)
        slips = slip.button is not None or not right  # a zero stays where it is
        typed = display_text((person.reads(asked, slip, number) if slips else person.right(asked)).tolist(), setup)
        cause: Cause | None = None
        if looked(desk, typed).surprising and slip.button is not None:
            cause, right = ("keep" if right else slip.button), True
        elif looked(desk, typed).surprising:
            typed, right = display_text(person.right(asked).tolist(), setup), True
            cause = "really" if looked(desk, typed).surprising else None
        desk.keep(typed, cause=cause)
        desk.think()
        number += 1
        answers: tuple[Answer, ...] = ("jump", "stuck")
        for answer in (each for each in answers if desk.state.asks and each in desk.state.choices):
            desk.set_anew(answer)
            right = True


@one_thread()
def off(slip: Slip, record: Path, seed: int) -> float:
    """Return what 95 % of the places of the row are off by at the end, of its U: the largest over the rows."""
    with Campaign.open(record) as campaign:
        person = Person(campaign, seed)
        measured(slip, Desk(campaign, lambda: None), person)
        known, found = campaign.so_far(), list[float]()
        estimate, errors = known.estimate(), known.printed.belief
        for asked in asked_rows(campaign.description, known.readings, whole=True):
            if (row := asked.own) is None:
                continue
            true = person.machine.does(row.poses, row.sides)
            said = (estimate.rotation if row.angular else estimate.deviation)(row.poses, row.sides)
            away = row.row(true.rotation if row.angular else true.displacement) - row.row(said)
            sizes = np.linalg.norm(away.reshape(-1, 1 if row.angular else row.dimensions), axis=1)
            allowed = known_row(asked, known.case, errors, True, known.without_readings).known
            found.append(float(np.quantile(sizes, 0.95) / allowed))
        return max(found)


def begun(folder: Path) -> dict[str, Path]:
    """Return a record of each job, planned."""
    records = {}
    for job, (machine, instrument, wanted) in JOBS.items():
        texts = first_files(of_builtin(machine), [instrument], Purpose("", [wanted])).texts
        target = re.sub(r"(?m)^readings = .*$", f"readings = {READINGS}", texts["campaign.toml"])
        described = campaign_from_texts(target, "campaign.toml", texts["machine.toml"], "machine.toml")
        records[job] = folder / f"{job}.axiscal"
        begun_campaign(records[job], described).close()
    return records


def main() -> None:
    """Print the table."""
    machines = int(sys.argv[1]) if len(sys.argv) > 1 else 4
    heads = f"{'slip':16} {'named':>7} {'noticed':>8} {'held':>7}"
    print(f"{heads}  readings until it is named (0: before any; –: never); off/U")
    with tempfile.TemporaryDirectory() as name:
        records = begun(Path(name))
        for slip in SLIPS:
            found, away = [], []
            for seed in range(machines * slip.machines):
                one = Path(name) / "one.axiscal"
                shutil.copy(records[slip.jobs[seed % len(slip.jobs)]], one)
                found.append(met(slip, one, 100 + seed))
                shutil.copy(records[slip.jobs[seed % len(slip.jobs)]], one)
                away.append(off(slip, one, 100 + seed))
            after = " ".join("–" if number < 0 else str(number) for number, _ in found)
            named, noticed = sum(number >= 0 for number, _ in found), sum(heard for _, heard in found)
            held = sum(each <= 1 for each in away)
            counts = f"{named:>3}/{len(found):<3} {noticed:>4}/{len(found):<3} {held:>3}/{len(away):<3}"
            print(f"{slip.name:16} {counts}  {after}; {max(away):.2f} at most", flush=True)


if __name__ == "__main__":
    main()
