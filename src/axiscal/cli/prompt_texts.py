"""What the prompt shows: the line on top, the set-up to mount, the reading to take, what can be typed."""

from __future__ import annotations

from axiscal.answers.answer_words import minutes_text
from axiscal.campaign.campaign import Campaign
from axiscal.cli.texts import micrometres
from axiscal.language.spoken import decimals, said
from axiscal.present.guide.answers import ACTIONS
from axiscal.present.guide.expectation import BAND
from axiscal.present.guide.mounting import mount_sentence, mount_steps
from axiscal.present.guide.progress import Progress, goals_text
from axiscal.present.guide.question import Question
from axiscal.units import to_unit


def help_text() -> str:
    """Return what can be typed at the prompt, in the language that is spoken."""
    undo, skip, note, leave, stop, pause, *_ = (said(word) for word in ACTIONS)
    because, text = said("REASON"), said("TEXT")
    rows = (
        ("-1.7", said("keep a reading, in the unit that is shown; a decimal comma does as well")),
        ("0.0021 mm", said("keep a reading in another unit")),
        ("Enter", said("show the question again")),
        (undo, said("take back the last reading or skip")),
        (f"{skip} {because}", said("the reading cannot be taken")),
        (f"{leave} {because}", said("nothing more can be read with this set-up; the plan is made anew without it")),
        (f"{note} {text}", said("keep a sentence in the record, such as the temperature: {note} 21.4 °C", note=note)),
        (stop, said("end the campaign here: what would be left, and what the tables would reach, is said first")),
        (pause, said("stop for now; axiscal measure goes on here")),
    )
    return "\n".join(f"  {typed:<18} {does}" for typed, does in rows)


def mounting_text(question: Question) -> str:
    """Return what to mount and the steps to do so."""
    steps = [f"  {name:<9} {what}" for name, what in mount_steps(question)]
    return "\n".join([f'\n{said("Set-up")} "{question.setup.name}": {mount_sentence(question)}.', *steps])


def headline(campaign: Campaign, question: Question) -> str:
    """Return one line: machine, readings, minutes, and how well the machine was, is and will be known."""
    now = Progress.of(campaign)
    goals = goals_text(campaign.description.target)
    parts = (
        campaign.description.machine.name,
        said("reading {number} of {last}", number=question.number, last=question.number + now.coming - 1),
        said(
            "{done} min done, about {left} left",
            done=minutes_text(to_unit(now.seconds, "min")),
            left=minutes_text(to_unit(now.left, "min"), coming=True),
        ),
        f"RMS {micrometres(now.before.rms)} → {micrometres(now.now.rms)}, "
        + said("{promised} expected", promised=micrometres(now.promised.rms)),
        said("target {goals}", goals=goals) if goals else "",
        said("at best {floor}", floor=micrometres(now.floor)),
    )
    return "\n" + " · ".join(part for part in parts if part)


def question_lines(question: Question) -> str:
    """Return where to go, from which side, the sign in words, and what to expect."""
    rows = (
        (said("go to"), question.go),
        (said("coming"), question.coming),
        (said("parked"), question.parked),
        (said("at"), question.touch),
        (said("again"), question.again),
        (said("sign"), question.sign),
        (said("expect"), expected_text(question)),
    )
    return "\n".join(f"  {name:<9} {what}" for name, what in rows if what)


def expected_text(question: Question) -> str:
    """Return what each number of the reading is expected to be, with two standard deviations."""
    pairs = zip(question.expected.mean, question.expected.std, strict=True)
    return ", ".join(f"{_plain(m, question.unit)} ± {_plain(BAND * s, question.unit)}" for m, s in pairs) + (
        f" {question.unit}"
    )


def _plain(value: float, unit: str) -> str:
    """Return a number in its unit with one decimal, none from a hundred on, and no minus before zero."""
    shown = to_unit(float(value), unit)
    digits = 1 if abs(shown) < 100 else 0
    return decimals(f"{round(shown, digits) + 0.0:.{digits}f}")
