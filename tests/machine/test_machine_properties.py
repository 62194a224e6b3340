"""Machines from generated chains and from damaged files: a machine, or a failure of ours, never anything else."""

import math

from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import AxiscalError, DescriptionError, InputError
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.machine.error_names import error_named
from axiscal.machine.machine_schema import parse_chain

NAMES = [letter + digit for letter in "XYZUVWPQRABC" for digit in ("", "1", "9")]
SOURCES = [load_machine(name).text for name in builtin_names()]


@st.composite
def chains(draw: st.DrawFn) -> tuple[str, list[tuple[str, bool]]]:
    """Draw a chain and the axes that it holds."""
    names = draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=6, unique=True))
    bed = draw(st.integers(0, len(names)))
    words = ["w", *(f"{name}'" for name in names[:bed]), "b", *names[bed:], "t"]
    if draw(st.booleans()):
        words.insert(-1, "(C)")
    text = "[" + " ".join(words) + "]" if draw(st.booleans()) else "-".join(words)
    return text, [(name, place < bed) for place, name in enumerate(names)]


@given(chains())
def test_every_chain_of_the_grammar_is_read_back(drawn: tuple[str, list[tuple[str, bool]]]) -> None:
    text, axes = drawn
    assert [(link.name, link.workpiece_side) for link in parse_chain(text)] == axes


@given(st.text(max_size=60) | st.text("wbtXYZABC'-()[] 1", max_size=30))
def test_any_text_is_a_chain_or_a_chain_error(text: str) -> None:
    try:
        links = parse_chain(text)
    except DescriptionError:
        return
    assert 1 <= len({link.name for link in links}) == len(links) <= 6


@given(st.text(max_size=20) | st.text("EXYZABC0O()_reversal12", max_size=14))
def test_any_text_is_an_error_name_or_an_input_error(text: str) -> None:
    try:
        name = error_named(text)
    except InputError:
        return
    assert error_named(name.name).name == name.name


@st.composite
def damaged(draw: st.DrawFn) -> str:
    """Draw a built-in machine with a few lines cut, swapped, or filled with something else."""
    lines = draw(st.sampled_from(SOURCES)).splitlines()
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, len(lines) - 1))
        start = draw(st.integers(0, len(lines[place])))
        end = draw(st.integers(start, min(len(lines[place]), start + 12)))
        junk = draw(st.text(max_size=6) | st.sampled_from(FRAGMENTS))
        lines[place] = lines[place][:start] + junk + lines[place][end:]
    return "\n".join(lines)


FRAGMENTS = ["", '"', "'", "{", "}", "[", "]", "=", "\n", "nan", "1e400", "-", "0", '"""', "deg", "mm", "[errors]", "."]


@given(damaged())
def test_a_damaged_file_is_a_machine_or_a_failure_of_ours(text: str) -> None:
    try:
        machine = machine_from_text(text)
    except AxiscalError as failure:
        message = str(failure)
    else:
        message = "right"
        assert all(axis.travel[0] < axis.travel[1] for axis in machine.axes)
        assert all(math.isfinite(entry.std) and entry.std > 0 for entry in machine.stated)
        assert all(entry.count <= 400 for entry in machine.stated)
    assert message.replace("\n- ", " ").replace("\nAnd ", " ").isprintable()
