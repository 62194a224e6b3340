"""All commands in one application, and the one place where a failure becomes a paragraph on stderr."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated

import typer

from axiscal.cli.commands import AllCommands
from axiscal.cli.printing import complain, say
from axiscal.exceptions import AxiscalError, InputError
from axiscal.language.spoken import speaking
from axiscal.present.whose_language import chosen

INTERRUPTED = 130
"""What typer exits with after Ctrl-C; ours is 1, with a reason."""

app = typer.Typer(
    name="axiscal",
    cls=AllCommands,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=True,
    no_args_is_help=True,
    context_settings={"max_content_width": 100, "help_option_names": ["-h", "--help"]},
)


@app.callback()
def axiscal(version: Annotated[bool, typer.Option("--version", help="Print the version and end.")] = False) -> None:
    """Plan, run and evaluate the calibration of machine tools with the fewest minutes of machine time.

    \b
    Example: the loop with a person
      axiscal step start campaign.toml mill.axiscal
      axiscal measure mill.axiscal
      axiscal finish mill.axiscal --out results

    Exit status: 0 done, 1 the job could not be done and stderr says why, 2 wrong usage.
    """
    if version:
        from axiscal import __version__

        say(f"axiscal {__version__}")
        raise typer.Exit


def run(arguments: Sequence[str]) -> int:
    """Run one command and return the exit status."""
    try:
        return _status_of(arguments)
    except AxiscalError as failure:
        with suppress(InputError), speaking(chosen(None)):
            complain(str(failure))
            return 1
        complain(str(failure))  # the language that is asked for is none
    except KeyboardInterrupt:
        complain("Stopped by Ctrl-C. Nothing that was recorded is lost; give the command again.")
    except OSError as failure:
        place = f"{failure.filename}: " if failure.filename else ""
        complain(f"{place}{failure.strerror or failure}. Check the name, the permissions and the room on the disk.")
    except Exception as failure:
        if os.environ.get("AXISCAL_TRACEBACK"):
            raise
        kind = type(failure).__name__
        complain(
            f"A defect in axiscal: {kind}: {failure}. Nothing that was recorded is lost. "
            "Please report it with the output that AXISCAL_TRACEBACK=1 gives."
        )
    return 1


def _status_of(arguments: Sequence[str]) -> int:
    try:
        app(args=[shielded(word) for word in arguments], prog_name="axiscal")
    except SystemExit as end:
        if end.code == INTERRUPTED:
            raise KeyboardInterrupt from None
        return end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    return 0


def shielded(word: str) -> str:
    """Return a word of the command line; a negative number gets a true minus, so that it is not taken for an option."""
    is_number = word[:1] == "-" and word[1:].lstrip()[:1] in tuple("0123456789.")
    return "−" + word[1:] if is_number else word


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
