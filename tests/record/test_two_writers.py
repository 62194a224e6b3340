"""A record against a list: writers, kills, copies, older heads, lines twice and branches, in any order."""

import shutil
import tempfile
from pathlib import Path
from unittest.mock import Mock

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from axiscal.campaign.repairing import repaired
from axiscal.exceptions import RecordError
from axiscal.record.events import Event
from axiscal.record.store import Record
from benchmarks.reliability.damages import first_record
from benchmarks.reliability.record_faults import recorded, values
from tests.generators.plain_records import HEAD

of_two = st.integers(0, 1)


class Written(RuleBasedStateMachine):
    """What was acknowledged stands, in its order, whatever happens to the file; what nobody wrote does not."""

    def __init__(self) -> None:
        super().__init__()
        self.folder = Path(tempfile.mkdtemp())
        self.path = self.folder / "mill.axiscal"
        self.path.write_bytes(first_record())
        self.heads, self.count, self.kept = [self.path.read_bytes()[:HEAD]], 0, list[float]()
        self.open_anew()

    def teardown(self) -> None:
        shutil.rmtree(self.folder)

    def drawn(self, count: int) -> list[Event]:
        """Return new readings."""
        self.count += count
        return [recorded(1e-9 * (self.count - n), "along x") for n in range(count)]

    def elsewhere(self, count: int) -> tuple[bytes, list[float]]:
        """Return the bytes that an entry would add, and its readings; the file stays as it is."""
        copy, before = self.folder / "copy.axiscal", self.path.read_bytes()
        copy.write_bytes(before)
        with Record.open(copy) as record:
            record.append(*self.drawn(count))
        return copy.read_bytes()[len(before) :], values(copy)[len(self.kept) :]

    @rule()
    def open_anew(self) -> None:
        """Two who have just come."""
        self.writers = [Record.open(self.path), Record.open(self.path)]

    @rule(writer=of_two, count=st.integers(1, 3))
    def append(self, writer: int, count: int) -> None:
        """One of them writes."""
        events = self.drawn(count)
        number = self.writers[writer].append(*events)
        self.kept += [1e-9 * (self.count - n) for n in range(count)]
        assert number == len(self.writers[writer].lines)
        self.heads.append(self.path.read_bytes()[:HEAD])

    @rule(count=st.integers(1, 3), part=st.floats(0, 1), behind=st.sampled_from((b"", b"\0" * 700, b"\xff {}")))
    def kill(self, count: int, part: float, behind: bytes) -> None:
        """A third one dies at any byte of an entry."""
        added, readings = self.elsewhere(count)
        with self.path.open("ab") as file:
            file.write(added[: int(part * len(added))] + behind)
        found = values(self.path)
        assert found in (self.kept, self.kept + readings)
        self.kept = found

    @rule(data=st.data())
    def set_the_head_back(self, data: st.DataObject) -> None:
        """The first page of an older copy comes over it."""
        with self.path.open("r+b") as file:
            file.write(data.draw(st.sampled_from(self.heads)))

    @rule(data=st.data())
    def write_lines_twice(self, data: st.DataObject) -> None:
        """A line is there once more."""
        line = data.draw(st.sampled_from(Record.open(self.path, write=False).lines))
        with self.path.open("ab") as file:
            file.write(b"\n" + line.written())

    @rule(size=st.integers(1, 400))
    def cut(self, size: int) -> None:
        """What is cut off behind the last acknowledged line is no loss; what is acknowledged is named."""
        whole = self.path.read_bytes()
        self.path.write_bytes(whole[:-size])
        with_all = False
        try:
            with_all = values(self.path) == self.kept
        except RecordError as damage:
            with_all = "damaged" in str(damage)
        lower = int(whole[30:42]), int(whole[542:554])
        assert with_all or max(lower) < len(self.kept) + 1
        self.path.write_bytes(whole)

    @rule(mine=st.integers(1, 3), theirs=st.integers(1, 3), merged=st.booleans())
    def branch(self, mine: int, theirs: int, merged: bool) -> None:
        """A computer that slept appends behind what it has seen; or two copies go on apart and are merged."""
        added, readings = self.elsewhere(theirs)
        copy = self.folder / "theirs.axiscal"
        copy.write_bytes(self.path.read_bytes() + added)
        self.open_anew()
        self.append(0, mine)
        paths = [self.path, copy]
        if not merged:
            with self.path.open("ab") as file:
                file.write(b"\n" + added)
            with pytest.raises(RecordError, match="Two went on from event"):
                self.writers[1].append(*self.drawn(1))
            with pytest.raises(RecordError, match="Two went on from event"):
                Record.open(self.path, write=False)
            paths = [self.path]
        asked = Mock(return_value=True)
        repaired(paths, self.folder / "both.axiscal", asked)
        asked.assert_called_once()
        (self.folder / "both.axiscal").replace(self.path)
        found = values(self.path)
        assert sorted(found) == sorted([*self.kept, *readings])
        self.kept = found
        self.heads = [self.path.read_bytes()[:HEAD]]
        self.open_anew()

    @invariant()
    def holds(self) -> None:
        """Everybody sees all that was acknowledged, and nothing else."""
        assert values(self.path) == self.kept
        for writer in self.writers:
            assert [reading.value for reading in writer.state().readings] == self.kept


TestWritten = Written.TestCase
TestWritten.settings = settings(stateful_step_count=20)
