"""What the package refuses in any test is said in a message that is translated; each {name} in a text has its value."""

import sys
from collections.abc import Mapping
from string import Formatter


class SaidInEnglishError(AssertionError):
    """A text that no translator finds, or one with a {name} that stays empty."""


def install() -> None:
    """Look at every text that the package says from now on; what strangers and tests refuse is theirs."""
    from axiscal.language import spoken

    made, translated = spoken._made, {*spoken.messages("de")}

    def looked_at(forms: tuple[str, ...], form: str, values: Mapping[str, object]) -> spoken.Said:
        text = forms[0] if forms else form
        if len(forms) == 1 and text and text not in translated and _refused_by_the_package():
            raise SaidInEnglishError(f"{text!r} is in English alone")
        if not {name for _, name, _, _ in Formatter().parse(text) if values and name} <= values.keys():
            raise SaidInEnglishError(f"{text!r} has only {sorted(values)}")
        return made(forms, form, values)

    spoken._made = looked_at


def _refused_by_the_package() -> bool:
    """Return whether a failure is made of the text, by a module of the package."""
    frame, through = sys._getframe(2), set[str]()
    while frame.f_back and (name := str(frame.f_globals["__name__"])) in (
        "axiscal.language.spoken",
        "axiscal.exceptions",
    ):
        through.add(name)
        frame = frame.f_back
    return "axiscal.exceptions" in through and str(frame.f_globals["__name__"]).startswith("axiscal.")
