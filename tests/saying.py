"""What the package says in any test is a message that is translated, and each {name} in it has its value."""

import sys
from collections.abc import Mapping
from string import Formatter


class SaidInEnglishError(AssertionError):
    """A text that no translator finds, or one with a {name} that stays empty."""


def install() -> None:
    """Look at every text that the package says from now on; what strangers and tests say is theirs."""
    from axiscal.language import spoken

    made, translated = spoken._made, {*spoken.messages("de")}

    def looked_at(forms: tuple[str, ...], form: str, values: Mapping[str, object]) -> spoken.Said:
        text = forms[0] if forms else form
        if len(forms) == 1 and text and text not in translated and _by_the_package():
            raise SaidInEnglishError(f"{text!r} is in English alone")
        if not {name for _, name, _, _ in Formatter().parse(text) if values and name} <= values.keys():
            raise SaidInEnglishError(f"{text!r} has only {sorted(values)}")
        return made(forms, form, values)

    spoken._made = looked_at


def _by_the_package() -> bool:
    """Return whether it is the package that speaks, and not its language and failures for somebody else."""
    frame = sys._getframe(2)
    while frame.f_back and frame.f_globals["__name__"] in ("axiscal.language.spoken", "axiscal.exceptions"):
        frame = frame.f_back
    return str(frame.f_globals["__name__"]).startswith("axiscal.")
