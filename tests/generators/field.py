"""Files of people on which the program failed, beside the checkout; tests hold without them, by files of their own."""

from pathlib import Path

FIELD = Path(__file__).resolve().parents[3] / "shared" / "field"


def with_field(own: dict[str, str], *names: str) -> list[str]:
    """Return texts of one kind: a test's own, and those of the field where they are there.  names : FOLDER/FILE"""
    return [*own.values(), *((FIELD / name).read_text() for name in names if (FIELD / name).is_file())]
