"""Every failure raised on purpose: one class each, the message built in one place.

The command line turns any `AxiscalError` into a paragraph on stderr, faults beside it listed, and exit status 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from axiscal.language.spoken import Said, again, said

_MOST = 5
"""So many faults of a file are said beside the first."""


class AxiscalError(Exception):
    """Base of every failure that axiscal raises on purpose."""


class InputError(AxiscalError):
    """Something a person wrote cannot be used: where it stands, what is wrong, what would be right.

    Its text is in the language that is spoken when it is printed.

    what : the fault, with the offending value quoted; remedy : what would be right: messages with {names} of values, or
    texts that were said
    file, line : where it stands, as far as known
    beside : further faults of the same file, those that are alike together, the first of them like this one
    """

    beside: Sequence[Sequence[InputError]] = ()

    def __init__(
        self, what: str, remedy: str, file: str | Path | None = None, line: int | None = None, **values: object
    ) -> None:
        self.what, self.remedy = (text if isinstance(text, Said) else said(text, **values) for text in (what, remedy))
        self.file, self.line = file, line
        super().__init__(what, remedy)

    def placed(self, file: str | Path | None, line: int | None = None) -> InputError:
        """Return the same failure of the same class, placed in a file and line."""
        placed = type(self).__new__(type(self))
        InputError.__init__(placed, self.what, self.remedy, file, line)
        return placed

    def __str__(self) -> str:
        if not self.beside:
            return self._told(self.file)
        alike, *others = self.beside
        lines = [f"{self._told(self.file)}{_how_often(alike[1:])}"]
        lines += [f"- {one._told(self.file, short=True)}{_how_often(more)}" for one, *more in others[:_MOST]]
        left = sum(map(len, others[_MOST:]))
        return "\n".join([*lines, said("And {left} more.", left=left)] if left else lines)

    def _told(self, first: str | Path | None, *, short: bool = False) -> str:
        """Return place, fault and remedy.  short : behind a fault of the first file, which is not named again"""
        line = "" if self.line is None else said("line {line}", line=self.line)
        file = "" if self.file is None or (short and line and str(self.file) == str(first)) else str(self.file)
        place = ", ".join(part for part in (file, line) if part)
        told = f"{again(self.what).rstrip('.')}. {_sentence(again(self.remedy)).rstrip('.')}."
        return f"{place}: {told}" if file or (short and place) else told


class Faults:
    """All that is wrong in one file, so that nobody has to run again for each.

    with faults.noted():
        ...                    # what raises InputError here is kept, and the rest goes on
    faults.refuse()            # raises the first with the others behind it, if there were any
    """

    def __init__(self) -> None:
        self.found: list[InputError] = []

    @contextmanager
    def noted(self) -> Iterator[None]:
        """Keep an InputError that the block raises."""
        try:
            yield
        except InputError as fault:
            self.found.append(fault)

    def refuse(self) -> None:
        """Raise all faults as one, of the class of the first; nothing if there are none."""
        if not self.found:
            return
        alike: dict[tuple[str, str, str], list[InputError]] = {}
        for fault in self.found:
            alike.setdefault((fault.what, fault.remedy, str(fault.file)), []).append(fault)
        self.found[0].beside = list(alike.values())
        raise self.found[0]


def _how_often(more: Sequence[InputError]) -> str:
    """Return that a fault comes again, in how many lines and up to which one, where it does."""
    if not more:
        return ""
    if more[-1].line is None:
        return " " + said("({count} times.)", count=len(more) + 1)
    return " " + said("({count} times, up to line {line}.)", count=len(more) + 1, line=more[-1].line)


def _sentence(text: str) -> str:
    """Return a text that begins with a capital, unless it begins with a name such as axiscal or X_mm."""
    first, _, rest = text.partition(" ")
    is_word = first.rstrip(",:").isalpha() and first.islower() and first != "axiscal" and not rest.startswith("=")
    return text[:1].upper() + text[1:] if is_word else text


class UnitError(InputError):
    """A quantity without a unit, with an unknown unit, or of the wrong dimension."""


class DescriptionError(InputError):
    """A machine or campaign description that cannot be used."""


class CodeError(AxiscalError):
    """Code that came with a campaign, which nobody on this computer has said yes to."""


class ReadingError(InputError):
    """A reading that cannot be used: not a number, outside the travel, of an unknown set-up, or too few of a test."""


class RecordError(InputError):
    """A campaign record that cannot be opened, or a step that does not fit its state."""


class NewerError(RecordError):
    """A record that a newer version of axiscal has written to, where this one cannot do without what it wrote."""


class OvertakenError(RecordError):
    """A step that was meant for a state of the record in which it is no longer."""


class AmbiguityError(InputError):
    """Two different machines or stations fit the readings as well as each other."""


class SourceError(InputError):
    """A source of readings that died, stalled or answered nonsense."""


class TableError(InputError):
    """A compensation table that the controller cannot hold or would read differently."""


class TargetError(InputError):
    """A target that cannot be reached, or targets that contradict each other."""


class SummaryError(AxiscalError):
    """A figure for the report that is not finite."""


class PlanError(InputError):
    """A plan that cannot be made: nothing ends it, nothing may be read, or the time is too short for one reading."""


class ProgramError(InputError):
    """A measuring program that cannot be written: it would leave the travel, or the control has no words for it."""


class TravelError(ProgramError):
    """A reading that the axes cannot be brought to, or cannot touch, within their travels."""


class PortError(InputError):
    """What an installed package brings cannot be used."""
