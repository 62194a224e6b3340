"""Commands given as a person gives them, and what they say."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Outcome:
    """The exit status of a command, and what it wrote."""

    status: int
    out: str
    err: str

    @property
    def printed(self) -> str:
        """What a command that was carried out wrote to stdout."""
        assert self.status == 0, self
        return self.out

    @property
    def said(self) -> str:
        """The same in one line."""
        return " ".join(self.printed.split())

    @property
    def document(self) -> Any:
        """The one JSON document on stdout of a command that was carried out."""
        return json.loads(self.printed)

    @property
    def refusal(self) -> str:
        """Why a command was refused, in one line."""
        assert self.status == 1, self
        assert "Traceback" not in self.err
        return " ".join(self.err.split())

    def refused(self, *words: str) -> None:
        """Check that a command was refused in one paragraph with these words, and wrote nothing else."""
        text = self.refusal
        assert self.out == ""
        assert text.startswith("axiscal: ")
        assert "\n\n" not in self.err.strip()
        for word in words:
            assert word in text


Command = Callable[..., Outcome]
"""Takes the words of a command, texts or paths."""
