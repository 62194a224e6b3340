"""TOML documents: the line of every key, and files that cannot be read."""

from pathlib import Path
from typing import Annotated

import pytest
from pydantic import BaseModel

from axiscal.document import Document, dotted, file, read_model, shown
from axiscal.document.validation import Beside, EachAs
from axiscal.exceptions import DescriptionError

TEXT = """\
# a comment with [brackets] = and "quotes"
name = "A # no comment"
path.to."the key" = 3
'single quoted' = 1

[tool]  # trailing
length = "1 mm"
inline = { a = 1, b = { c = 2 }, "d\\u0065" = [1,
  2, { e = 5 },
] }
text = \"\"\"
[not.a.table]
x = 1 \\\"\"\" \" still text\"\"\"\"\"
raw = '''
y = ']' '''
after = 1979-05-27 07:32:00 # a date with a blank

[[setups]]
name = "one"
[setups.park]
Y = "250 mm"

[[setups]]
name = "two"
[[setups.unknowns]]
zero = 1
[[setups.unknowns]]
zero = 2
[ axes . "X" ]
travel = [
  "0 mm",   # lower
  "600 mm",
]
"""

LINES: list[tuple[tuple[str | int, ...], int]] = [
    (("name",), 2),
    (("path", "to", "the key"), 3),
    (("single quoted",), 4),
    (("tool",), 6),
    (("tool", "length"), 7),
    (("tool", "inline", "b", "c"), 8),
    (("tool", "inline", "de"), 8),
    (("tool", "inline", "de", 1), 9),
    (("tool", "inline", "de", 2, "e"), 9),
    (("tool", "text"), 11),
    (("tool", "raw"), 14),
    (("tool", "after"), 16),
    (("setups",), 18),
    (("setups", 0), 18),
    (("setups", 0, "name"), 19),
    (("setups", 0, "park"), 20),
    (("setups", 0, "park", "Y"), 21),
    (("setups", 1), 23),
    (("setups", 1, "name"), 24),
    (("setups", 1, "unknowns", 0, "zero"), 26),
    (("setups", 1, "unknowns", 1), 27),
    (("setups", 1, "unknowns", 1, "zero"), 28),
    (("axes", "X"), 29),
    (("axes", "X", "travel"), 30),
    (("axes", "X", "travel", 0), 31),
    (("axes", "X", "travel", 1), 32),
]


@pytest.mark.parametrize(("keys", "line"), LINES)
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_every_key_has_its_line(keys: tuple[str | int, ...], line: int, line_end: str) -> None:
    document = Document.parse(TEXT.replace("\n", line_end), "x.toml")
    assert document.line(*keys) == line


BAD_FILES: list[tuple[bytes, int | None, str]] = [
    ("name = 'x'".encode("utf-16"), 1, "0xff is not UTF-8"),
    (b"a = 1\nname = '\xe4\xb0'", 2, "0xe4 is not UTF-8"),
    (b"a = 1\n\nb = '\xb5m'", 3, "0xb5 is not UTF-8"),
    (b"a = 1\nb = \x00", 2, "not valid TOML"),
    (b"a = 1\nb =", 2, "not valid TOML"),
    (b"a = 1\na = 2\n", 2, "cannot overwrite a value"),
    (b"[a]\n[b]\n[a]\n", 3, "declare"),
    (b"a = 1\nb = 'unfinished\nc = 2", 2, "unfinished"),
    (b"a = 12 mm", 1, "12 mm"),
    (b"C(0X)Y = 3", 1, "Names with parentheses stand in quotes"),
    (b"a = [12 mm, 3 mm]", 1, "12 mm"),
    (b"a = 1\rb = 2", 1, "not valid TOML"),
    (b"a\n", 1, "not valid TOML"),
    (b"= 1\n", 1, "not valid TOML"),
    (b"a = 2024-13-41", 1, "not valid TOML"),
    (b"a = " + b"9" * 4900, None, "not valid TOML"),
    (b"a = " + b"[\n" * 5000 + b"]\n" * 5000, None, "nested too deeply"),
    (b"a = " + b"[\n" * 5000, None, "nested too deeply"),
    (b"a = 1\n" + b".".join([b"a"] * 2000) + b" = 1", 2, "more than 100 parts"),
    (b"a = { " + b" . ".join([b"'a'"] * 600) + b" = 1 }", 1, "more than 100 parts"),
    (b"a = '" + b"x" * 6000 + b"'", 1, "6006 characters"),
    (b"# " + b"x\n# " * 400_000, None, "larger than 250 kB"),
]


@pytest.mark.parametrize(("content", "line", "fragment"), BAD_FILES)
def test_a_file_that_is_no_toml_text_is_refused_once(
    tmp_path: Path, content: bytes, line: int | None, fragment: str
) -> None:
    path = tmp_path / "machine.toml"
    path.write_bytes(content)
    with pytest.raises(DescriptionError) as failure:
        Document.read(path)
    assert failure.value.file == path
    assert failure.value.line == line
    assert fragment in str(failure.value)
    assert len(str(failure.value)) < 400 + len(str(path))


def test_a_value_of_thousands_of_lines_ends_the_search_for_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file, "_MOST_TRIED", 50_000)
    for begin, end, lines in (("[", "]", (1, 2, 1004)), ("[[[", "]]]", (None, None, None))):
        document = Document.parse(f"a = 1\nb = {begin}\n" + "1,\n" * 1000 + f"{end}\nc = 2\n", "x.toml")
        assert tuple(document.line(key) for key in ("a", "b", "c")) == lines
    deep = ".".join(['"a\\""'] * 150) + " = 1"
    assert Document.parse(deep, "x.toml").line('a"') == 1


def _early(key: str, hour: int, known: Beside) -> int:
    if hour > known.context:
        raise DescriptionError("{hour} is too late", "Come earlier", hour=hour)
    return hour


class Checked(BaseModel):
    when: Annotated[dict[str, int], EachAs(dict[str, int], _early)]


def test_what_a_field_is_made_by_may_raise_a_failure_of_ours_at_its_entry() -> None:
    with pytest.raises(DescriptionError, match=r"x\.toml, line 3: when\.b: 5 is too late\. Come earlier\."):
        read_model(Document.parse("[when]\na = 3\nb = 5", "x.toml"), Checked, context=4)


def test_values_and_keys_are_shown_as_written() -> None:
    assert shown(True) == "true"
    assert shown("a\x1bb") == '"a\\x1bb"'
    assert shown(["0 mm", 3]) == '["0 mm", 3]'
    assert shown({"a": 1}) == "{a = …}"
    assert shown(10**5000) == "an integer of more than 18 digits"
    assert len(shown("x" * 1000)) == 60
    assert dotted(("setups", 0, "noise")) == "setups[1].noise"
