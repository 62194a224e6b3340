"""The desk: one open campaign, the steps that a page may ask of it, and the state that all pages are shown.

Everything here runs on one thread. A step says which state it answers. `once` refuses it if the record has moved on
since, so that no reading answers another question.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

from axiscal.campaign.agreement_words import agreement_words, change_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended, because_text
from axiscal.campaign.sources import virtual_in
from axiscal.estimation.promise.agreement import Explained
from axiscal.evaluation.check import Check
from axiscal.exceptions import AxiscalError, OvertakenError, RecordError, TableError
from axiscal.language.spoken import said
from axiscal.present.answer import Outcome, PlannedAnswer
from axiscal.present.answer_of_campaign import results_beside, standing_answer
from axiscal.present.guide import progress, slips
from axiscal.present.guide.checking import CheckJudged
from axiscal.present.guide.question import Question, asked_text, typed
from axiscal.present.plan_answer import coming_answer
from axiscal.present.schematic import setup_picture, setup_schematic
from axiscal.present.sentences import spelt
from axiscal.record.events import Asked, Warmed
from axiscal.tables import registry
from axiscal.web.shapes import AnswerShape, Short, StateShape


class Desk:
    """One campaign and what is shown of it.

    state : the newest, all that a page shows
    """

    def __init__(self, campaign: Campaign) -> None:
        self.campaign, self.virtual = campaign, virtual_in(campaign.state.notes)
        self._minds = list[str]()
        self._answer: Outcome | PlannedAnswer | None = None
        self._answers: object = None  # the readings and the end that it is about
        self._before: frozenset[int] | None = None
        self._version = 0
        self._alike: set[int] = set()
        self.state = self._renewed()

    @property
    def results(self) -> Path:
        """The folder for the results, beside the record."""
        return results_beside(self.campaign.path)

    def look(self) -> None:
        """Show what others have written to the record since, and do what the next question need not wait for."""
        try:
            moved = self._moved_on()
        except AxiscalError as failure:  # such as a record that has been moved away
            if self.state.trouble != str(failure):
                self._version += 1
                self.state = self.state.model_copy(update={"trouble": str(failure), "version": self._version})
            return
        if moved:
            self._show()
        if self._before is not None or self._answers != self._stands:
            self.think()

    def think(self) -> None:
        """Have second thoughts on the last reading, and find the answer."""
        minds, before, self._before = list(self._minds), self._before, None
        if before is not None:
            minds += progress.others_doubted(self.campaign, before, command=False)
        if self._answers != self._stands:  # what a report says stands
            self._answer, self._answers = None, self._stands  # tried once
            self._answer = coming_answer(self.campaign) or standing_answer(self.campaign)
        self._show(minds, noted=True)

    @property
    def _stands(self) -> object:
        """What an answer is about."""
        state = self.campaign.state
        return state.readings, state.plan, state.finished, state.told(Warmed)

    def once(self, step: Callable[[Desk], str], after: int | None = None) -> str:
        """Do a step.

        after : `last` of the state that it answers, None for what answers none; OvertakenError if that has changed
        """
        if self._moved_on():
            self._show()
        if after is not None and self.campaign.state.last != after and after not in self._alike:
            what = said("The record has moved on in the meantime, in another window or program: nothing was done")
            raise OvertakenError(what, said("Look at what is asked now, then do it again if it is still right"))
        return step(self)

    def keep(self, text: Short, cause: slips.Cause | None = None) -> str:
        """Keep a reading of what is asked; raises SurprisingError where nobody has said the cause of a strange one.

        text : as it is typed, "-1,7", "0.0021 mm", three numbers in one line; by default in the unit of the question
        """
        asked = self.campaign.open_question()
        question = self.state.question or Question.from_campaign(self.campaign, asked)
        values = typed(self.campaign, text)
        if cause is None:
            slips.refuse_surprising(self.campaign, question, values)
        before = progress.doubted(self.campaign) if self._before is None else self._before
        kept, told = slips.keep_as(self.campaign, question, values, cause)
        self._before = before
        self._show()
        return f"{said('Kept reading {number}; it is on the disk.', number=kept.number)} {told}".rstrip()

    def jog(self, text: Short, *, anyway: bool = False) -> str:
        """Keep what the display shows at the test of its sign; raises ReadingError where that is wrong.

        anyway : go on although it is
        """
        return self._noted(lambda: slips.try_jog(self.campaign, text, anyway=anyway))

    def accept(self) -> str:
        """Put right the mistake that readings name; raises RecordError where they name none."""
        named = self._explained()
        if named is None:
            raise RecordError(said("The readings name no mistake"), said("Go on with the readings"))
        told = self.campaign.accept(named.mistake, self.campaign.description.setups[named.setups[0]].name)
        self._show()
        return said("Put right: {change}; undo takes it back.", change=change_words(told))

    def skip(self, reason: Short, *, rest: bool = False) -> str:
        """Keep in mind that the reading asked for cannot be taken; rest : nor any other of its set-up."""
        skipped = self.campaign.skip(reason, rest=rest)
        self._show()
        if rest:
            left = 'Left "{setup}": the plan is made anew without it; undo goes back to it.'
            return said(left, setup=skipped.place.setup)
        return said("Skipped {reading}; the plan is made anew around it.", reading=asked_text(self.campaign, skipped))

    def note(self, text: Short) -> str:
        """Keep a sentence in the record; who has seen the state before may still answer what is asked."""
        return self._noted(lambda: progress.take_note(self.campaign, text))

    def _noted(self, told: Callable[[], str]) -> str:
        """Keep a note, and return a sentence of it; who has seen the state before may still answer what is asked."""
        seen = self.campaign.state.last
        try:
            return told()
        finally:
            self._alike.add(seen)
            self._show(self._minds, noted=True)

    def setup_picture(self, width: float) -> str:
        """Return the set-up of the next reading, on the machine, as SVG; "" if there is none.  width : pixels"""
        asked = self.campaign.state.pending
        if asked is None:
            return ""
        description, state = self.campaign.description, self.campaign.state
        taken = [reading.place for reading in state.readings]
        setup = description.setup(asked.place.setup)
        return setup_picture(setup_schematic(description, setup, taken, asked.place, state.coming), width)

    def set_anew(self) -> str:
        """Keep that a zero was set anew before the next reading."""
        told = progress.set_anew(self.campaign)
        self._show()
        return told

    def undo(self) -> str:
        """Take back the last reading, skip or end."""
        _, sentence = progress.take_back(self.campaign)
        self._show()
        return sentence

    def go_on(self) -> str:
        """Ask for one more reading although a target is reached."""
        asked = self.campaign.next(beyond=True)
        self._show()
        if isinstance(asked, Ended):
            return said("Nothing more to ask: {because}.", because=because_text(asked.because))
        return said("One more.")

    def finish(self) -> str:
        """End the campaign and write its results into the folder beside the record."""
        from axiscal.present.delivery import deliver  # pictures and tables, which no question waits for
        from axiscal.present.result_set import RECORD

        self.campaign.log.refuse_other(self.results / RECORD)
        known = self.campaign.estimate(ended=True)
        self.campaign.finish()
        try:
            result = deliver(self.campaign, known, self.results)
            self._answer, self._answers = result.answer, self._stands
        finally:
            self._show()
        return said("Ended. Report, figures and tables are in {folder}.", folder=self.results.name)

    def tables_packed(self, control: str) -> bytes:
        """Return the files for a control as one, as they were written, or made now with its sign.

        Raises InputError, TableError.
        """
        self.look()
        if control in self.state.tables and self.campaign.description.bump_of(control) is None:
            files = {file.name: file.read_text() for file in sorted((self.results / "tables" / control).iterdir())}
        else:
            known = self.campaign.estimate(ended=True)
            if known.agreement.withheld:
                raise TableError(agreement_words(known), said("Take readings again"))
            offered = registry.offered(known, control)
            files = {**offered.files, "README.txt": offered.readme}
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, text in files.items():
                archive.writestr(f"{control}/{name}", text)
        return packed.getvalue()

    def volume_picture(self, width: float) -> str:
        """Return the error of the volume, found, and left with the tables, as SVG.  width : pixels"""
        from axiscal.present.found_and_left import found_and_left_drawing  # no question waits for them
        from axiscal.present.volume_error import volume_error

        known, tables = self.campaign.estimate(ended=True), self.state.tables
        control = next((each for each in tables if each != "csv"), "csv")
        volume = volume_error(known, control, registry.offered_control(known, control) if tables else None)
        drawing = found_and_left_drawing(volume, self.campaign.description.machine, width)
        return drawing.on_screen(said("The error of the volume"))

    def judge(self, control: str, tolerance: str, found: Sequence[str], left: Sequence[str]) -> CheckJudged:
        """Return what readings without the tables and with them say, or what is wrong with each by its field."""
        check = Check.from_campaign(self.campaign, control)
        return CheckJudged.of(check, found, left, tolerance, self.campaign.path.parent)

    def _explained(self) -> Explained | None:
        """Return the mistake that readings name which contradict each other, None for none."""
        found = self.campaign.estimate().agreement
        return found.explained[0] if found.contradicts and found.explained else None

    def _moved_on(self) -> bool:
        """Take in what others have written since, and return whether that was anything."""
        before = self.campaign.state.last
        return self.campaign.looked_at_again().last != before

    def _show(self, minds: Sequence[str] = (), *, noted: bool = False) -> None:
        """Show the state anew; noted : nothing has happened to what is asked."""
        self._minds = list(minds)
        if not noted:
            self._alike.clear()
        self.state = self._renewed()

    def _renewed(self) -> StateShape:
        self._version += 1
        question, ended, trouble = self._asked()
        campaign, state, results, answer = self.campaign, self.campaign.state, self.results, self._answer
        written = state.finished is not None and (results / "report.pdf").is_file()
        overtaken = ended is not None and self._answers != self._stands  # it would contradict what ended it
        return StateShape(
            version=self._version,
            last=state.last,
            machine=campaign.description.machine.name,
            record=campaign.path.name,
            progress=progress.Progress.of(campaign),
            question=question,
            ended=None if ended is None else spelt(because_text(ended)),
            finished=None if state.finished is None else spelt(because_text(state.finished)),
            jog=slips.jog(campaign),
            shows="" if question is None else slips.shown_on(campaign, self.virtual),
            trouble=trouble,
            readings=list(progress.latest(campaign)),
            notes=state.notes,
            due=progress.due(campaign),
            undo=progress.last_step(campaign)[0],
            minds=[spelt(each) for each in [*self._minds, *progress.contradictions(campaign, command=False)]],
            named=state.finished is None and self._explained() is not None,
            answer=None if answer is None or overtaken else AnswerShape.of_campaign(campaign, answer),
            results=results.name if written else "",
            tables=sorted(each.name for each in (results / "tables").glob("*/")) if written else (),
            controls=registry.controllers(),
        )

    def _asked(self) -> tuple[Question | None, str | None, str]:
        """Return what is asked now, why nothing is, and what is in the way."""
        if self.campaign.state.finished is not None:
            return None, None, ""
        try:
            asked = self._next()
        except AxiscalError as failure:
            return None, None, str(failure)
        if isinstance(asked, Ended):
            return None, asked.because, ""
        return Question.from_campaign(self.campaign, asked), None, ""

    def _next(self) -> Asked | Ended:
        """Return what is asked; another program may be asking at the same moment."""
        try:
            return self.campaign.next()
        except OvertakenError:
            self.campaign.looked_at_again()
            self._alike.clear()
            return self.campaign.next()
