"""Prompt, page and refusals in other languages: nothing is left out, nothing lost on the way to the screen."""

import re
from string import Formatter

import pytest
from babel.messages.catalog import Message

from axiscal.exceptions import Faults, InputError, ReadingError, RecordError
from axiscal.language.spoken import LANGUAGES, counted, messages, said, speaking
from axiscal.present.guide.question import Word, answer
from axiscal.present.whose_language import chosen
from tests.docs import languages
from tests.present.test_answers import DIAL

OTHERS = [language for language in LANGUAGES if language != "en"]


def names(text: str) -> set[str]:
    """Return the names in braces."""
    return {name for _, name, _, _ in Formatter().parse(text) if name is not None}


def pairs(message: Message) -> list[tuple[str, str]]:
    """Return each English text of a message with its translation."""
    one, other = message.id, message.string
    if isinstance(one, str):
        return [(one, str(other))]
    assert isinstance(other, list | tuple)
    return list(zip(one, other, strict=True))


@pytest.mark.parametrize("language", OTHERS)
def test_every_message_is_translated_and_none_is_left_over(language: str) -> None:
    kept = [message for message in languages.translated(language) if message.id]
    assert {
        message.id if isinstance(message.id, str) else tuple(message.id) for message in kept
    } == languages.messages()
    every = [pair for message in kept for pair in pairs(message)]
    assert [english for english, other in every if not other.strip()] == []
    assert [english for english, other in every if names(english) - {"count"} != names(other) - {"count"}] == []
    assert [english for english, other in every if re.search(r"\s$", english) and english[-1] != other[-1]] == []


@pytest.mark.parametrize("language", OTHERS)
def test_what_the_program_reads_is_what_the_translator_wrote(language: str) -> None:
    for message in languages.catalogue(language):
        if isinstance(message.id, str) and message.id:
            assert messages(language)[message.id] == message.string


def test_german_quotes_names_in_one_way_and_has_straight_quotes_only_in_what_is_typed() -> None:
    typed = {"example", "unit", "size", "ball", "axis", "low", "high", "low:.0f", "high:.0f", "written"}
    for text in messages("de").values():
        straight = text.count('"') and re.findall(r'"([^"]*)"(?= fehlt)|"\{([^{}]*)\}"', text)
        assert {key or name for key, name in straight or ()} <= typed, text
        assert re.sub("[^„“”]", "", text) == "„“" * text.count("„"), text


def test_a_message_is_said_in_the_language_that_is_spoken() -> None:
    assert said("reading {number} of {last}", number=3, last=9) == "reading 3 of 9"
    with speaking("de"):
        assert said("reading {number} of {last}", number=3, last=9) == "Messung 3 von 9"
        assert counted("{count} reading", "{count} readings", 1) == "1 Messung"
        assert counted("{count} reading", "{count} readings", 2) == "2 Messungen"
        assert answer("auslassen der Strahl ist weg", DIAL) == Word("skip", "der Strahl ist weg")
        assert answer("undo", DIAL) == answer("zurück", DIAL) == Word("undo")
        assert not isinstance(answer("-1,7", DIAL), Word)
    assert said("undo") == "undo"


def test_the_language_is_the_one_named_or_that_of_the_computer(monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("AXISCAL_LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(variable, raising=False)
    assert chosen(None) == "en"
    for usual, found in (("de_DE.UTF-8", "de"), ("C", "en"), ("tr_TR.UTF-8", "en")):
        monkeypatch.setenv("LANG", usual)
        assert chosen(None) == found
    monkeypatch.setenv("AXISCAL_LANGUAGE", "de")
    assert (chosen(None), chosen("en")) == ("de", "en")
    with pytest.raises(InputError, match=r"de \(Deutsch\)"):
        chosen("xx")


def test_a_failure_is_said_in_the_language_that_is_spoken_when_it_is_printed() -> None:
    faults = Faults()
    for line in (3, 5, 7):
        with faults.noted():
            raise ReadingError("{text} is not a finite number", "Give one of them", "a.csv", line, text="nan")
    with faults.noted():
        raise RecordError("There is nothing to take back", "Go on with `axiscal step next`", "a.csv", 9)
    with pytest.raises(ReadingError) as raised:
        faults.refuse()
    assert str(raised.value) == (
        "a.csv, line 3: nan is not a finite number. Give one of them. (3 times, up to line 7.)\n"
        "- line 9: There is nothing to take back. Go on with `axiscal step next`."
    )
    with speaking("de"):
        assert str(raised.value) == (
            "a.csv, Zeile 3: nan ist keine endliche Zahl. Eines davon angeben. (3-mal, bis Zeile 7.)\n"
            "- Zeile 9: Nichts kann zurückgenommen werden. Weiter mit `axiscal step next`."
        )
