"""The records of a shop in one list: which machine, when, how well it was known, and what is wrong with a record.

A campaign that ends keeps what it came to in its record, so the list estimates nothing unless it is asked to.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from axiscal.campaign.ending import result_of
from axiscal.campaign.possible import described
from axiscal.estimation.estimate import concluded
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import AxiscalError, UnreachableError
from axiscal.language.stages import staged
from axiscal.ports.fleet.sister_records import Copy, beside_others, why_not
from axiscal.present.guide.progress import goals_text
from axiscal.record.copies import each_opened
from axiscal.record.events import Finished, Recorded
from axiscal.record.log import EventLog
from axiscal.record.result import NOT_SAID, Result


@dataclass(frozen=True, slots=True)
class ShopRecord:
    """A record of the shop, and what it comes to.

    machine, serial : of the machine; begun, last : the first event and the last reading, ISO 8601, UTC, "" for none
    readings : those that stand; target : in words; ended : why the campaign ended, "" while it goes on
    result : of a campaign that ended, or as estimated; remarks : what somebody has to mind
    """

    copy: Copy
    machine: str
    serial: str
    begun: str
    last: str
    readings: int
    target: str
    ended: str
    result: Result
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ShopList:
    """left_out : records that do not count, and why; kinds : how many events of each kind all records have"""

    listed: tuple[ShopRecord, ...]
    left_out: tuple[tuple[Path, str], ...]
    kinds: Mapping[str, int]

    @property
    def machines(self) -> int:
        """Number of their machines; without a serial number each campaign counts as another machine."""
        return len({(each.machine, each.serial, "" if each.serial else each.copy.campaign) for each in self.listed})


def shop_list(shop: Path, estimate: bool = False) -> ShopList:
    """Return the records of a folder, or of the store, the machine measured last first.

    estimate : also what campaigns come to that go on, or that an earlier version ended
    Raises RecordError for what is neither, and where the store does not answer.
    """
    found, left = _looked_at(shop, estimate)
    copies, listed = [each.copy for each in found], list[ShopRecord]()
    for each in found:
        why, remark = beside_others(each.copy, copies)
        if why:
            left.append((each.copy.file, why))
        else:
            listed.append(replace(each, remarks=(*each.remarks, remark) if remark else each.remarks))
    listed.sort(key=lambda each: (each.last or each.begun, each.copy.file.name), reverse=True)
    return ShopList(tuple(listed), tuple(left), Counter(sorted(kind for copy in copies for kind in copy.kinds)))


def _looked_at(shop: Path, estimate: bool) -> tuple[list[ShopRecord], list[tuple[Path, str]]]:
    """Return what each record of a folder or store comes to, and of those that cannot be read why."""
    found, left = list[ShopRecord](), list[tuple[Path, str]]()
    with each_opened(shop) as there:
        for file, opened in staged("records", there, len(there)):
            try:
                with opened() as record:
                    found.append(_listed(Copy.from_texts(file, record.texts()), record, estimate))
            except UnreachableError:
                raise
            except (AxiscalError, OSError) as fault:
                left.append((file, why_not(fault)))
    return found, left


def _listed(copy: Copy, record: EventLog, estimate: bool) -> ShopRecord:
    """Return what a record comes to: as it says itself, or else as it is estimated where that is asked for."""
    description, state, events = described(record), record.state(), record.events()
    last = next((each.at for each in reversed(events) if isinstance(each.event, Recorded)), "")
    remarks = () if state.readings else ("it has no readings",)
    result = next((each.event.result for each in state.undo[-1:] if isinstance(each.event, Finished)), NOT_SAID)
    if estimate and state.readings and result == NOT_SAID:
        try:
            result = result_of(concluded(case_of(description), state.readings))
        except AxiscalError as fault:
            remarks = (why_not(fault),)
    which = description.machine.name, description.particulars.serial, events[0].at, last, len(state.readings)
    return ShopRecord(copy, *which, goals_text(description.target), state.finished or "", result, remarks)
