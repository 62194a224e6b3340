"""`axiscal measure`."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended
from axiscal.cli.arguments import OwnRecord
from axiscal.cli.opened import opened_to_write
from axiscal.cli.printing import say
from axiscal.cli.texts import accuracy_text, count_text, micrometres
from axiscal.exceptions import AxiscalError, OvertakenError
from axiscal.guide.answers import Value, Word, answer
from axiscal.guide.expectation import BAND, SURPRISING
from axiscal.guide.mounting import mount_sentence, mount_steps
from axiscal.guide.progress import Progress
from axiscal.guide.question import Question
from axiscal.guide.second_thoughts import doubted, others_doubted
from axiscal.guide.taking_back import take_back
from axiscal.record.events import Asked
from axiscal.units import to_unit

_HELP = """\
  -1.7           keep a reading, in the unit that is shown; a decimal comma does as well
  0.0021 mm      keep a reading in another unit
  Enter          show the question again
  undo           take back the last reading or skip
  skip REASON    the reading cannot be taken
  pause          stop for now; `axiscal measure` goes on here"""


def measure(record: OwnRecord) -> None:
    """Take the readings of a campaign at one prompt: where to go, what to expect, type what you read.

    Each reading is on the disk before the next question is shown. Type ? for help, pause to stop for now.

    \b
    Example:
      axiscal measure mill.axiscal
    """
    with opened_to_write(record, "measure") as campaign:
        prompt = _Prompt(campaign)
        try:
            while (asked := _question(campaign)) is not None and prompt.answered(Question.of(campaign, asked)):
                pass
        except EOFError:
            asked = campaign.state.pending
            say("")
    if asked is not None:
        say(f"Paused; every reading is kept. Go on: axiscal measure {record}")


def _question(campaign: Campaign) -> Asked | None:
    asked = campaign.next()
    if isinstance(asked, Ended):
        known = campaign.known().accuracy
        say(f"Done: {asked.because}. {accuracy_text(known, None, None)}, {_taken(campaign)}.")
        say(f"End it: axiscal finish {campaign.path} --out DIR")
        return None
    return asked


def _taken(campaign: Campaign) -> str:
    return f"{count_text(len(campaign.state.readings), 'reading')} in {to_unit(campaign.seconds(), 'min'):.0f} min"


class _Prompt:
    """The dialogue about one campaign; it remembers which set-up the person has mounted."""

    def __init__(self, campaign: Campaign) -> None:
        self.campaign = campaign
        readings = campaign.state.readings
        self.mounted = readings[-1].setup if readings else ""

    def answered(self, question: Question) -> bool:
        """Ask until the question has been answered or taken back; return False where the person pauses."""
        if question.setup.name != self.mounted:
            say(_mounting(question))
            if answer(input("Enter when it stands, or pause > "), question.setup) == Word("pause"):
                return False
            self.mounted = question.setup.name
        say(_headline(self.campaign, question))
        say(_shown(question))
        done = None
        while done is None:
            try:
                done = self._heed(answer(input(f"reading [{question.unit}] > "), question.setup), question)
            except OvertakenError:
                self.campaign.looked_at_again()
                say("  Nothing was done: the record has moved on in the meantime, on a page or by another command.")
                done = True
            except AxiscalError as failure:
                say(f"  {failure}")
        return done

    def _heed(self, typed: Value | Word, question: Question) -> bool | None:
        """Return True where there may be another question, False for a pause, None to ask the same one again."""
        if isinstance(typed, Value):
            return self._keep(typed, question)
        if typed.action == "pause":
            return False
        if typed.action == "undo":
            say(f"  {take_back(self.campaign).sentence}")
            return True
        if typed.action == "skip":
            self.campaign.skip(typed.text or input("  why can it not be taken? "))
            say("  skipped; the plan is made anew around it")
            return True
        say(_HELP if typed.action == "help" else _shown(question))
        return None

    def _keep(self, typed: Value, question: Question) -> bool | None:
        vouched = False
        surprise = question.expected.surprise(typed.values)
        if surprise >= SURPRISING:
            say(f"  That is {surprise:.1f} standard deviations from what is expected, {_expected(question)}.")
            word = input("  Type k to keep it, v to keep it and vouch for it, Enter to read again: ").strip().lower()
            if word not in ("k", "v"):
                return None
            vouched = word == "v"
        before = doubted(self.campaign)
        value, *others = (float(each) for each in typed.values)
        kept = self.campaign.record(value, accepted=vouched, others=tuple(others))
        at = question.go or f'set-up "{question.setup.name}"'
        say(f"  kept reading {kept.number} at {at}; it is on the disk")
        for sentence in others_doubted(self.campaign, before):
            say(f"  Mind: {sentence}")
        return True


def _mounting(question: Question) -> str:
    steps = [f"  {name:<9} {what}" for name, what in mount_steps(question)]
    return "\n".join([f'\nSet-up "{question.setup.name}": {mount_sentence(question)}.', *steps])


def _headline(campaign: Campaign, question: Question) -> str:
    """Return one line: machine, readings, minutes, and how well the machine was, is and will be known."""
    now, target = Progress.of(campaign), campaign.description.target
    goal = f" (target {micrometres(target.rms)})" if target.rms is not None else ""
    return (
        f"\n{campaign.description.machine.name} · reading {question.number} of {question.number + now.coming - 1} · "
        f"{to_unit(now.seconds, 'min'):.0f} min done, about {to_unit(now.left, 'min'):.0f} left · "
        f"RMS {micrometres(now.before.rms)} → {micrometres(now.now.rms)}, "
        f"{micrometres(now.promised.rms)} expected{goal}"
    )


def _shown(question: Question) -> str:
    lines = [
        f"  go to     {question.go}" if question.go else "",
        f"  coming    {question.coming}" if question.coming else "",
        f"  at        {question.touch}" if question.touch else "",
        f"  again     {question.again}" if question.again else "",
        f"  sign      {question.sign}",
        f"  expect    {_expected(question)}",
    ]
    return "\n".join(line for line in lines if line)


def _expected(question: Question) -> str:
    pairs = zip(question.expected.mean, question.expected.std, strict=True)
    return ", ".join(f"{_plain(m, question.unit)} ± {_plain(BAND * s, question.unit)}" for m, s in pairs) + (
        f" {question.unit}"
    )


def _plain(value: float, unit: str) -> str:
    """Return a number in its unit with one decimal, none from a hundred on, and no minus before nought."""
    shown = to_unit(float(value), unit)
    digits = 1 if abs(shown) < 100 else 0
    return f"{round(shown, digits) + 0.0:.{digits}f}"
