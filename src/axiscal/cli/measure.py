"""The dialogue at the prompt, one question after the other.

The prompt shows the line on top, the set-up to mount, the reading to take, and what can be typed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended, because_text
from axiscal.cli.outputs import standing_screen, write_outputs
from axiscal.cli.printing import ask, mind_lines, say
from axiscal.cli.texts import opened_to_write, tell_out_of_reach
from axiscal.exceptions import AxiscalError, OvertakenError
from axiscal.language.spoken import WORDS, decimals, listed, put, said, speaking
from axiscal.present.answer_of_campaign import cost_sentence, cost_words, results_beside
from axiscal.present.answer_words import minutes_text
from axiscal.present.guide import actions, progress, slips
from axiscal.present.guide.question import Question, action, degrees, question_text, typed
from axiscal.present.result_set import RECORD
from axiscal.present.whose_language import chosen
from axiscal.record.events import Asked
from axiscal.units import um_text

_LETTERS = dict(zip(slips.CAUSES, "smiabvk", strict=True))
"""What is typed for a cause of a surprise."""
_STEPS = {"undo": actions.undo, "anew": actions.set_anew, "more": actions.go_on}
_Then = Literal["same", "anew", "stands", "finish", "pause"]
"""What comes after something was typed: the same prompt, the question anew, a reading, the end, or a pause."""


@dataclass(eq=False, slots=True)
class Prompt:
    """The dialogue about one campaign.  out : folder for the results; mounted : the set-up that stands"""

    campaign: Campaign
    out: Path
    mounted: str = ""

    def held(self) -> bool:
        """Hold the dialogue; return False where the person pauses, True where the campaign is to be finished."""
        tell_out_of_reach(self.campaign)
        self.mounted, then = next((each.setup for each in self.campaign.state.readings[-1:]), ""), "anew"
        while then == "anew":
            asked = self.campaign.next()
            then = self._ended(asked) if isinstance(asked, Ended) else self._asked(asked)
        return then == "finish"

    def _asked(self, asked: Asked) -> _Then:
        question = Question.from_campaign(self.campaign, asked)
        if question.setup != self.mounted:
            named = said('Set-up "{setup}"', setup=question.setup)
            to_do = [f"  {name:<9} {what}" for name, what in question.mounting]
            say("\n".join([f"\n{named}: {question.mount_sentence}.", *to_do]))
            then = self._until_done(said("Enter when it stands, or ? > "), question, self._too_early)
            if then == "stands" and progress.open_temperature(self.campaign):
                prompt = said("Temperature of the machine's scale [degC], Enter: not measured > ")
                then = self._until_done(prompt, question, self._take_temperature)
            if then != "stands":
                return then
            self.mounted = question.setup
        say(headline(self.campaign, question))
        say(question_lines(question))
        prompt = said("reading [{unit}] > ", unit=question.asks)
        return self._until_done(prompt, question, self._keep, enter="same")

    def _until_done(
        self, prompt: str, question: Question | None, take: Callable[[str], _Then], enter: _Then = "stands"
    ) -> _Then:
        """Ask until something has been done; a refusal is said, and the same is asked again.

        question : what is asked, None at the end; take : what is done with a value; enter : what comes of Enter alone
        """
        then: _Then = "same"
        while then == "same":
            word, _, text = (line := ask(prompt).strip()).partition(" ")
            try:
                wanted = action(word)
                then = take(line) if wanted is None else self._done(wanted, text, question) if wanted else enter
            except OvertakenError:
                self.campaign.looked_at_again()
                say("  " + said("Nothing was done: the record has moved on, on a page or by another command."))
                then = "anew"
            except AxiscalError as failure:
                say(f"  {failure}")
            if then == "same" and question is not None and wanted in ("", "more"):
                say(question_lines(question))
        return then

    def _too_early(self, text: str) -> _Then:
        typed(self.campaign, text)
        say("  " + said("This is a reading: press Enter when the set-up stands, then type it."))
        return "same"

    def _take_temperature(self, text: str) -> _Then:
        say(f"  {actions.note(self.campaign, degrees(text))}")
        return "stands"

    def _done(self, wanted: str, text: str, question: Question | None) -> _Then:
        """Do what a word asks for.  text : what followed it"""
        match wanted:
            case "skip" | "leave" if question is not None:
                return self._skip(text, rest=wanted == "leave")
            case "stop":
                return self._stop()
            case "help":
                say("\n".join(f"  {said(word):<18} {said(does)}" for word, does in WORDS["prompt"]["rows"]))
            case "pause":
                return "pause"
            case "note":
                sentence = text or ask("  " + said("what is to be kept in the record?") + " ")
                say(f"  {actions.note(self.campaign, sentence)}")
            case "undo" | "anew" | "more" if wanted != "more" or question is None:
                say(f"  {_STEPS[wanted](self.campaign)}")
                return "anew"
        return "same"

    def _keep(self, text: str) -> _Then:
        before, asked = actions.doubted(self.campaign), actions.named_now(self.campaign)
        try:
            told = slips.keep(self.campaign, text)
        except slips.SurprisingError as strange:
            say(f"  {strange.what}.")
            named_by = {_LETTERS[each]: each for each in strange.causes}
            known = listed(
                ", ", [put("{letter} {cause}", letter=k, cause=said(slips.CAUSES[v])) for k, v in named_by.items()]
            )
            word = ask("  " + said("Type {causes}; Enter to read again:", causes=known) + " ").strip().lower()
            if (cause := named_by.get(word)) is None:
                return "same"
            told = slips.keep(self.campaign, text, cause)
        say(f"  {told}")
        minds, named = actions.others_doubted(self.campaign, before), actions.named_now(self.campaign)
        if named is not None and named != asked:
            say(f"  {named.question}")
            if (chosen := _chosen(named)) is not None:
                say(f"  {actions.confirmed(self.campaign, named, chosen)}")
                minds = []
        for line in mind_lines(*actions.contradictions(self.campaign), *minds):
            say(f"  {line}")
        return "anew"

    def _skip(self, reason: str, *, rest: bool) -> _Then:
        costs = cost_words(self.campaign, rest=rest)
        say(f"  {cost_sentence(costs)}")
        if rest and costs and not _is_yes(said("Type yes to leave it, Enter to go on:")):
            return "same"
        why = said("the set-up was left") if rest else ""
        reason = reason or why or ask("  " + said("why can it not be taken?") + " ")
        say(f"  {actions.skip(self.campaign, reason, rest=rest)}")
        return "anew"

    def _stop(self) -> _Then:
        """Say what there would be if the campaign ended here, and end it where the person wants that."""
        say(standing_screen(self.campaign))
        choice = said("Type yes to end it here and write the results, Enter to go on:")
        return "finish" if _is_yes(choice) else "same"

    def _ended(self, ended: Ended) -> _Then:
        """Say that nothing more is to be measured, and ask whether to write the results, go on or back."""
        say("\n" + said("Done: {because}.", because=because_text(ended.because)))
        say(standing_screen(self.campaign))
        prompt = said("Enter writes the results into {folder}; undo, more, note or pause > ", folder=self.out)
        return self._until_done(prompt, None, self._too_early, enter="finish")


def _chosen(named: actions.Named) -> str | None:
    """Ask what is named, and return the answer; None where the person does not know, or says no."""
    if len(named.answers) == 1:
        return named.answers[0] if _is_yes(said("Type yes if so, Enter if not:")) else None
    typed_for = {said(answer).lower(): answer for answer in named.answers}
    choice = said("Type {answers}; Enter if you do not know:", answers=listed(said(" or "), [*typed_for]))
    return typed_for.get(ask(f"  {choice} ").strip().lower())


def _is_yes(choice: str) -> bool:
    return ask(f"  {choice} ").strip().lower() in ("yes", "y", said("yes"))


def headline(campaign: Campaign, question: Question) -> str:
    """Return two lines: machine, readings and minutes; how well the machine was, is and will be known."""
    now = progress.Progress.of(campaign)
    done = (
        campaign.description.machine.name,
        said("reading {number} of {last}", number=question.number, last=question.number + now.coming - 1),
        said("{done} min done, about {left} left", done=minutes_text(now.minutes), left=minutes_text(now.left_minutes)),
    )
    sizes = {"figure": said(now.figure), "before": um_text(now.before_um), "now": um_text(now.now_um)}
    known = (
        said("{figure} {before} → {now}, {promised} expected", promised=um_text(now.promised_um), **sizes),
        said("target {goals}", goals=now.goals) if now.goals else "",
        said("at best {floor}", floor=um_text(now.floor_um)),
    )
    return "\n" + "\n".join(" · ".join(part for part in parts if part) for parts in (done, known))


def question_lines(question: Question) -> str:
    """Return where to go, from which side, the sign in words, and what to expect."""
    beside = (said("again"), question.again), (said("check"), question.check)
    others = *beside, (said("expect"), expected_text(question))
    return question_text(question.places, question.touch, question.sign, *others)


def expected_text(question: Question) -> str:
    """Return what each number of the reading is expected to be, with two standard deviations."""
    shown = [f"{decimals(f'{each.mean:.1f}')} ± {decimals(f'{each.half:.1f}')}" for each in question.expected]
    if len({*question.units}) > 1:
        return ", ".join(f"{each} {unit}" for each, unit in zip(shown, question.units, strict=True))
    return f"{', '.join(shown)} {question.unit}"


def measure(record: Path, out: Path | None = None, language: str | None = None) -> None:
    """Take the readings of a campaign at one prompt."""
    folder = out or results_beside(record)
    with speaking(chosen(language)):
        with opened_to_write(record, "measure") as campaign:
            over = False
            try:
                over = Prompt(campaign, folder).held()
            except EOFError:
                say("")
            if over:
                campaign.log.refuse_other(folder / RECORD)
                campaign.finish()
                write_outputs(campaign, folder)
        if not over:
            say(said("Paused; every reading is kept. Go on: axiscal measure {record}", record=record))
