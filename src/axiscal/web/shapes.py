"""What goes over the wire: the JSON documents of the API, version 1. Lengths in µm, angles in µrad, minutes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, Self

from pydantic import Field

from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.evidence import evidence_words
from axiscal.present.answer import AnswerDocument, AnswerWords, BoughtAccuracy, Outcome, PlannedAnswer
from axiscal.present.answer_words import answer_text
from axiscal.present.guide.actions import Short
from axiscal.present.guide.progress import Due, KeptReading, Progress, RecordStanding
from axiscal.present.guide.question import Question
from axiscal.present.guide.slips import Jog
from axiscal.present.plan_words import plan_text
from axiscal.present.sentences import spelt
from axiscal.record.events import Note

LONGEST = 25.0
"""s that a request may wait for news: less than what programs between us and a browser would take for a fault."""
Seen = Annotated[int, Field(ge=0, description="Wait until the state has another version")]
Wait = Annotated[float, Field(ge=0, le=LONGEST, allow_inf_nan=False, description="s, at most")]
After = Annotated[int, Field(ge=0, description="`last` of the state that is answered; 409 if it has changed")]
Width = Annotated[float, Field(ge=120, le=2000, allow_inf_nan=False, description="Pixels")]
LETTERS = 48_000
"""Of a dropped file at most: the page sends no more of it."""


class AnswerShape(AnswerWords):
    """The result, or the plan, in words and as their document."""

    document: Outcome | PlannedAnswer

    @classmethod
    def of_campaign(cls, campaign: Campaign, answer: Outcome | PlannedAnswer) -> Self:
        """Return the answer of a campaign with its words."""
        if isinstance(answer, PlannedAnswer):
            text = plan_text(answer)
        else:
            agreement = agreement_words(campaign.so_far()) if answer.readings else ""
            text = answer_text(answer, agreement, evidence_words(campaign.log))
        first, sentences = ([spelt(each) for each in some] for some in (text.first, text.sentences))
        rows = [[spelt(cell) for cell in row] for row in text.rows]
        return cls(first=first, rows=rows, sentences=sentences, document=answer)


class StateShape(AnswerDocument):
    """All that the page shows. `last` names the state of the record, `version` this document.

    minds : what to mind about the last reading; named : whether it names a mistake that can be put right
    jog : the test with which the mounting begins, null where it is done
    shows : what the instrument on a virtual machine shows at the question, "" on a real one
    answer : null until it is known for the first time; tables : the controls that there are tables for, once it ended
    controls : all that tables can be made for
    """

    document: Literal["axiscal-page/1"] = "axiscal-page/1"
    version: int
    last: int
    machine: str
    record: str
    progress: Progress
    question: Question | None
    ended: str | None
    finished: str | None
    jog: Jog | None
    shows: str
    trouble: str
    readings: list[KeptReading]
    notes: Sequence[Note]
    due: Due
    undo: str
    minds: list[str]
    named: bool
    answer: AnswerShape | None
    results: str
    tables: Sequence[str]
    controls: Sequence[str]


class CheckedRequest(AnswerDocument):
    """Readings of a check of the tables of a control as they are typed, in the order of its places."""

    control: Short
    tolerance: Short
    found: Annotated[Sequence[Short], Field(max_length=500)]
    left: Annotated[Sequence[Short], Field(max_length=500)]


class DraftShape(AnswerDocument):
    """What was chosen of a campaign that has not begun, as a person typed it; kept on the disk at every touch.

    screen : which is open; machine : built-in, or file : a file of a control with its text
    file of a built-in machine : readings of it; along : the axis that was read, where they name none
    travels : of linear axes, such as "600 mm"; switched : axes on the other side than usual, table instead of head
    size : of its errors, as `first_files.SIZES` has them; without : rows that instruments could show and nobody wants
    budget : of machine time, such as "90 min"; compensated : whether a compensation is active, "" where nobody knows
    virtual : whether a virtual machine is to give the readings
    """

    screen: Literal["start", "machine", "with", "plan"] = "start"
    machine: Short = ""
    file: Annotated[str, Field(max_length=60, pattern=r"^([^./\\\x00-\x1f\x7f][^/\\\x00-\x1f\x7f]*)?$")] = ""
    text: Annotated[str, Field(max_length=LETTERS)] = ""
    along: Short = ""
    travels: Mapping[str, Short] = {}
    switched: Sequence[Short] = ()
    size: Literal["new", "used", "home-made"] = "used"
    instruments: Sequence[Short] = ()
    without: Sequence[Short] = ()
    target: Short = ""
    budget: Short = ""
    compensated: Literal["", "no", "yes"] = ""
    virtual: bool = False


class MachineShape(AnswerDocument):
    """What a draft makes of a machine.

    faults : what is wrong, by its field ("file", "travels.X", "target", "instruments")
    readings : what the dropped file holds, in words, "" where it is one of a control
    lengths : how far each linear axis travels, mm; carried : those whose table moves, not the head
    radii : those whose display shows diameters; look : what the file could not say
    offered : the instruments that it can be read with; asks : whether it is open if a compensation is active
    """

    title: str = ""
    faults: Mapping[str, str]
    readings: str = ""
    lengths: Mapping[str, float] = {}
    carried: Sequence[str] = ()
    radii: Sequence[str] = ()
    look: Sequence[str] = ()
    offered: Sequence[str] = ()
    asks: bool = False


class StartShape(AnswerDocument):
    """All that the start shows.

    left_out : records that cannot be read, and why
    machines, instruments : names and words of those there are
    """

    document: Literal["axiscal-start/1"] = "axiscal-start/1"
    folder: str
    begun: Sequence[RecordStanding]
    left_out: Sequence[str]
    machines: Mapping[str, str]
    instruments: Mapping[str, str]
    draft: DraftShape
    machine: MachineShape


class RowsShape(AnswerDocument):
    """The rows that an instrument can show on the machine of the draft, in words by their names.

    fault : why it cannot be set up there
    """

    rows: Mapping[str, str] = {}
    fault: str = ""


class CurveShape(AnswerDocument):
    """What minutes buy: U of the volume after each."""

    marks: Sequence[BoughtAccuracy]


class PlanShape(AnswerDocument):
    """The plan of a draft; rows : U before and after it, by their names; minds : what nobody has said yet."""

    answer: AnswerShape
    rows: Mapping[str, Sequence[str]]
    minds: Sequence[str]


class SentenceShape(AnswerDocument):
    """An answer in words, "" for nothing that is worth a word."""

    sentence: str


class DoneShape(AnswerDocument):
    """A step that was done, in words, and the state after it."""

    sentence: str
    state: StateShape


class ProblemShape(AnswerDocument):
    """A step that was not done: a code for programs, a sentence for people.

    problem : "overtaken", "surprising", "refused", "malformed", "forbidden", "host", "missing", "method", "large",
        "defect"
    """

    problem: str
    sentence: str
