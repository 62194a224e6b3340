"""The desk: one open campaign, the steps that a page may ask of it, and the state that all pages are shown.

Everything here runs on one thread. A step says which state it answers. `once` refuses it if the record has moved on
since, so that no reading answers another question.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended, because_text
from axiscal.campaign.sources import virtual_in
from axiscal.evaluation.check import Check
from axiscal.exceptions import AxiscalError, OvertakenError, TableError
from axiscal.language.spoken import said
from axiscal.present.answer import Outcome, PlannedAnswer
from axiscal.present.answer_of_campaign import results_beside, standing_answer
from axiscal.present.guide import actions, progress, slips
from axiscal.present.guide.checking import CheckJudged
from axiscal.present.guide.question import Question
from axiscal.present.plan_answer import coming_answer
from axiscal.present.schematic import setup_picture, setup_schematic
from axiscal.present.sentences import spelt
from axiscal.record.events import Asked, Warmed
from axiscal.tables import registry
from axiscal.web.shapes import AnswerShape, StateShape


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
            minds += actions.others_doubted(self.campaign, before, command=False)
        if self._answers != self._stands:  # what a report says stands
            self._answer, self._answers = None, self._stands  # tried once
            self._answer = coming_answer(self.campaign) or standing_answer(self.campaign)
        self._show(minds, noted=True)

    @property
    def _stands(self) -> object:
        """What an answer is about."""
        state = self.campaign.state
        return state.readings, state.plan, state.finished, state.told(Warmed)

    def once(self, step: Step, after: int | None = None, **given: Any) -> str:
        """Do a step of `STEPS`, and return a sentence of it.  given : what it takes

        after : `last` of the state that it answers, None for what answers none; OvertakenError if that has changed
        A note answers nothing: who has seen the state before may still answer what is asked.
        """
        if self._moved_on():
            self._show()
        campaign, noted = self.campaign, step in (actions.note, slips.try_jog)
        seen, count = campaign.state.last, len(campaign.state.readings)
        if after is not None and seen != after and after not in self._alike:
            what = said("The record has moved on in the meantime, in another window or program: nothing was done")
            raise OvertakenError(what, said("Look at what is asked now, then do it again if it is still right"))
        before = actions.doubted(campaign) if step is slips.keep and self._before is None else self._before
        told = ""
        try:
            told = step(self if step is Desk.finish else campaign, **given)
            return told
        finally:
            if len(campaign.state.readings) > count:
                self._before = before
            if told or campaign.state.last != seen:
                self._alike |= {seen} if noted else set()
                self._show(self._minds if noted else (), noted=noted)

    def setup_picture(self, width: float) -> str:
        """Return the set-up of the next reading, on the machine, as SVG; "" if there is none.  width : pixels"""
        asked = self.campaign.state.pending
        if asked is None:
            return ""
        description, state = self.campaign.description, self.campaign.state
        places = [*(reading.place for reading in state.readings), *state.coming]
        setup = description.setup(asked.place.setup)
        return setup_picture(setup_schematic(description, setup, places, asked.place), width)

    def finish(self) -> str:
        """End the campaign and write its results into the folder beside the record."""
        from axiscal.present.delivery import deliver  # pictures and tables, which no question waits for
        from axiscal.present.result_set import RECORD

        self.campaign.log.refuse_other(self.results / RECORD)
        known = self.campaign.estimate(ended=True)
        self.campaign.finish()
        result = deliver(self.campaign, known, self.results)
        self._answer, self._answers = result.answer, self._stands
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
        volume = volume_error(known, control, registry.offered(known, control).control if tables else None)
        drawing = found_and_left_drawing(volume, self.campaign.description.machine, width)
        return drawing.on_screen(said("The error of the volume"))

    def judge(self, control: str, tolerance: str, found: Sequence[str], left: Sequence[str]) -> CheckJudged:
        """Return what readings without the tables and with them say, or what is wrong with each by its field."""
        check = Check.from_campaign(self.campaign, control)
        return CheckJudged.of(check, found, left, tolerance, self.campaign.path.parent)

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
            undo=actions.last_step(campaign)[0],
            minds=[spelt(each) for each in [*self._minds, *actions.contradictions(campaign, command=False)]],
            named=state.finished is None and actions.explained(campaign) is not None,
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


Step = Callable[..., str]
"""What a page may ask for: it takes the campaign and what is given, and returns a sentence."""
STEPS: dict[str, Step] = {
    "readings": slips.keep,
    "jogs": slips.try_jog,
    "accepts": actions.accept,
    "skips": actions.skip,
    "notes": actions.note,
    "zeros": actions.set_anew,
    "undo": actions.undo,
    "next": actions.go_on,
    "finish": Desk.finish,
}
"""By the names of their paths."""
