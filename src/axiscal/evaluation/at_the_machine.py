"""As-found and as-left readings by a machine that runs: into two files, each reading on the disk before the next one.

The first command reads without the tables. Then somebody loads them, and the same command reads with them. What the
files hold already is not read again.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from axiscal.campaign.sources import Request, Skip, Source
from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import placed_readings
from axiscal.document.durable import write_whole
from axiscal.exceptions import InputError, ReadingError, SourceError
from axiscal.language.spoken import said
from axiscal.language.stages import staged
from axiscal.measurement.readers.csv_readings import filled_sheet, read_readings
from axiscal.measurement.reading import Reading

_SAME = 1e-7
"""m or rad: rounding of a place that was written down."""


@dataclass(frozen=True, slots=True)
class Taken:
    """By whom readings were taken, and with what in force.

    person : who gave the command, "" where nobody knows; source : what read
    files : SHA-256 of each file that the control itself said was in force, by its name
    """

    person: str = ""
    source: str = ""
    files: Mapping[str, str] = field(default_factory=dict)

    def write(self, file: Path) -> None:
        """Keep it beside a file of readings, with what that holds; raises OSError."""
        kept = asdict(self) | {"schema": "axiscal-taken/1", "readings": _digest(file)}
        write_whole(_beside(file), (json.dumps(kept, indent=1) + "\n").encode())

    @classmethod
    def of(cls, file: Path) -> Taken:
        """Return what is kept beside a file of readings, nothing where that was typed or has been changed since."""
        try:
            kept = json.loads(_beside(file).read_bytes())
            if kept.pop("schema") == "axiscal-taken/1" and kept.pop("readings") == _digest(file):
                return cls(str(kept["person"]), str(kept["source"]), dict(kept["files"]))
        except (OSError, ValueError, TypeError, KeyError, AttributeError):
            pass
        return cls()


def _beside(file: Path) -> Path:
    return file.with_name(f"{file.stem}.taken.json")


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


@dataclass(frozen=True, slots=True)
class Sheet:
    """A file of readings at places, one after another.

    wanted : a request for each place
    """

    file: Path
    description: CampaignDescription
    wanted: Sequence[Request]

    def held(self) -> tuple[Reading, ...]:
        """Return the readings that it holds; raises ReadingError where they are of other places."""
        if not self.file.exists():
            return ()
        held = placed_readings(read_readings(self.file), self.description, self.file)
        for reading, place in zip(held, self.wanted, strict=False):
            apart = np.max(np.abs(np.subtract(reading.pose, place.pose)))
            if reading.setup != place.setup.name or apart > _SAME or reading.approach != place.approach:
                what = "it holds readings of other places than this check"
                raise ReadingError(what, "Name another file, or give --points as then", self.file, reading.line)
        if len(held) > len(self.wanted):
            what = "it holds {count} readings, and this check has {wanted}"
            remedy = "Name another file, or give --points as then"
            raise ReadingError(what, remedy, self.file, count=len(held), wanted=len(self.wanted))
        return held

    def complete(self) -> bool:
        """Whether it holds all of its readings."""
        return len(self.held()) == len(self.wanted)

    def fill(self, opened: Callable[[], Source], taken: Taken) -> None:
        """Read what is missing; raises ReadingError before that, SourceError with how many readings are kept."""
        readings = list(self.held())
        if not os.access(self.file.absolute().parent, os.W_OK | os.X_OK):
            raise ReadingError("nothing can be written there", "Name a file in a folder of yours", self.file)
        source = opened()
        try:
            missing = self.wanted[len(readings) :]
            for request in staged("readings", missing, len(missing)):
                answer = source.read(request)
                if isinstance(answer, Skip):
                    raise SourceError(
                        "{reason}", "Name another number of --points, and other files", reason=answer.reason
                    )
                at = (request.setup.name, request.pose, request.approach)
                readings.append(Reading(*at, answer.value, answer.std, others=answer.others))
                write_whole(self.file, filled_sheet(self.description.machine.axes, readings).encode())
                taken.write(self.file)
        except InputError as failure:
            kept = "{remedy}. {count} of {wanted} readings are kept in {path}; go on with the same command"
            counts = {"count": len(readings), "wanted": len(self.wanted)}
            remedy = said(kept, remedy=failure.remedy, path=self.file, **counts)
            raise type(failure)(failure.what, remedy, failure.file) from failure
        finally:
            source.close()
