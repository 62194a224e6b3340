"""Faults while a record is begun, written to, copied: what was acknowledged is there, and nothing blocks the next."""

from __future__ import annotations

from pathlib import Path

from axiscal.measurement.reading import Reading
from axiscal.record.events import Created, Recorded, Stored
from axiscal.record.store import Record
from benchmarks.reliability.faults import faults
from benchmarks.reliability.trial import Say, Trial, scratch

CREATED = Created("name = 'm'", "machine = 'm'", "machine.toml", "campaign.toml", {"axiscal": "0.1.0"})
NAME = "mill.axiscal"


def recorded(value: float, setup: str = "laser") -> Recorded:
    """Return a reading of a machine with two axes; with one where the set-up is that of `plain_records`."""
    place, approach = ((0.1, 0.2), (1, 0)) if setup == "laser" else ((0.1,), (1,))
    return Recorded(Reading(setup, place, approach, value))


def values(path: Path) -> list[float]:
    """Return the readings that a record holds."""
    with Record.open(path, write=False) as record:
        return [reading.value for reading in record.state().readings]


def events(path: Path) -> tuple[Stored, ...]:
    """Return what a record holds."""
    with Record.open(path, write=False) as record:
        return record.events()


def begun() -> Trial:
    """Begin a record."""

    def work(folder: Path, say: Say) -> None:
        Record.create(folder / NAME, CREATED).close()
        say("begun")

    def lost(folder: Path, said: tuple[str, ...]) -> bool:
        path = folder / NAME
        if path.exists():
            Record.open(path).close()
        elif "begun" in said:
            return True
        else:
            Record.create(path, CREATED).close()
        return [file.name for file in folder.iterdir()] != [NAME]

    with scratch() as top:
        before = top / "before"
        before.mkdir()
        outcomes = [lost(top / "now", outcome.said) for _, outcome in faults(before, top / "now", work)]
    return Trial("faults while a record is begun", len(outcomes), sum(outcomes))


def read() -> Trial:
    """Look at a record: the first call that would change the disk would end it, and none is made."""

    def work(folder: Path, say: Say) -> None:
        say(str(values(folder / NAME)))

    with scratch() as top:
        before = top / "before"
        before.mkdir()
        with Record.create(before / NAME, CREATED) as record:
            record.append(recorded(1.0))
        outcomes = [outcome for _, outcome in faults(before, top / "now", work)]
    return Trial("calls that change the disk while a record is read", 1, len(outcomes))


def written() -> Trial:
    """Add to a record, one reading, three at once, another, and copy it."""

    def work(folder: Path, say: Say) -> None:
        with Record.open(folder / NAME) as record:
            for batch in ((1.0,), (2.0, 3.0, 4.0), (5.0,)):
                record.append(*map(recorded, batch))
                say(" ".join(map(str, batch)))
            record.copy_to(folder / "copy.axiscal")
            say("copied")

    def lost(folder: Path, said: tuple[str, ...]) -> bool:
        heard = [0.0, *(float(word) for line in said if line[0].isdigit() for word in line.split())]
        kept, copy = values(folder / NAME), folder / "copy.axiscal"
        with Record.open(folder / NAME) as record:
            record.append(recorded(9.0))
            record.copy_to(copy)
        whole = kept in ([0.0], [0.0, 1.0], [0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
        left = sorted(file.name for file in folder.iterdir()) != ["copy.axiscal", NAME]
        return kept[: len(heard)] != heard or not whole or left or values(copy) != [*kept, 9.0]

    with scratch() as top:
        before = top / "before"
        before.mkdir()
        with Record.create(before / NAME, CREATED) as record:
            record.append(recorded(0.0))
            record.copy_to(before / "copy.axiscal")
        outcomes = [lost(top / "now", outcome.said) for _, outcome in faults(before, top / "now", work)]
    return Trial("faults while a record is written to and copied", len(outcomes), sum(outcomes))
