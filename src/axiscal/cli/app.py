"""All commands in one application, and the one place where a failure becomes a paragraph on stderr.

The file of a command is loaded only when the command is run. So files of commands import what they need at their top,
and help only reads the table of their words.
"""

from __future__ import annotations

import gc
import os
import re
import sys
from collections import ChainMap
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from inspect import Signature
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.exceptions import TyperException

from axiscal.cli.arguments import TABLE, parameters, words_of
from axiscal.cli.printing import DOCUMENTS, agreed, complain, say
from axiscal.document.consent import asking, nobody
from axiscal.document.gone import instead_of
from axiscal.document.ports import culprit
from axiscal.exceptions import AxiscalError, InputError, PortError
from axiscal.language.spoken import WORDS, later, said, speaking
from axiscal.present.whose_language import chosen

_TREE, _GROUPS = TABLE["commands"], TABLE["groups"]
_GONE = later("{name} is gone. {instead}.")


class AllCommands(TyperGroup):
    """The commands of a group, "" for all.

    sections : those that help and completion show, by the heading over them; places : the files of all
    """

    def __init__(self, group: str = "", **attributes: Any) -> None:
        super().__init__(**attributes)
        self.sections = {"Commands": _TREE[group or "main"]} | ({} if group else {"More commands, in groups": _GROUPS})
        before = [_TREE[name] for name in {"": ("hidden", "step", "data"), "data": ("hidden",)}.get(group, ())]
        self.places: dict[str, str] = dict(ChainMap(*self.sections.values(), *before))
        self.commands = dict.fromkeys(self.places, TyperCommand("not loaded"))

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names that help and completion show."""
        return [name for each in self.sections.values() for name in each]

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return a command by the words that follow, or end with what to use instead of one that is gone."""
        if args[0] not in self.places and (instead := instead_of("commands", args[0])):
            ctx.fail(said(_GONE, name=args[0], instead=instead))
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command or group by its name; None if there is no such command."""
        place = self.places.get(cmd_name)
        if place is None or cmd_name not in _GROUPS:
            return None if place is None else _command(cmd_name, place)
        return AllCommands(cmd_name, name=cmd_name, help=place, rich_markup_mode=None, no_args_is_help=True)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the lists of commands into the help, each with the first line of its own."""
        for title, places in self.sections.items():
            with formatter.section(title):
                lines = {name: _GROUPS.get(name) or words_of(at)["help"].splitlines()[0] for name, at in places.items()}
                formatter.write_dl([*lines.items()])

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was called; each is a door of planning or estimating."""
        from axiscal_core.threads import one_thread  # help has no need of it

        with one_thread():
            return super().invoke(ctx)


def _command(name: str, place: str) -> Any:
    """Return a command as the table has it; its file is loaded when it is run."""
    file, _, function = place.partition(".")

    def called(**given: Any) -> None:
        try:
            module = import_module(f"axiscal.cli.{file}")
        except ModuleNotFoundError as missing:
            port = (missing.name or "").removeprefix("axiscal.ports.")
            if port == missing.name:
                raise
            what, remedy = "{command} needs {name}, which is not installed", "Install the package that brings it"
            raise PortError(what, remedy, command=name, name=port) from None
        if not gc.isenabled():  # as `main` leaves it: what is loaded stays, and need not be looked through
            gc.freeze()
            gc.enable()
        DOCUMENTS.set(given.pop("json", False))
        getattr(module, function)(**given)

    called.__signature__ = Signature([*parameters(place)])  # type: ignore[attr-defined]
    alone = typer.Typer(rich_markup_mode=None, add_completion=False)
    alone.command(name, help=words_of(place)["help"])(called)
    return typer.main.get_command(alone)


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
def axiscal(
    version: Annotated[bool, typer.Option("--version", help="Print the version and end.")] = False,
) -> None:
    """Plan, run and evaluate the calibration of machine tools with the fewest minutes of machine time.

    Alone, on a terminal with a screen, it opens the page.

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
    """Run one command in the language of the person, documents in English, and return the exit status.

    Without a command, whoever sits at a screen gets the page, and everybody else the help.
    """
    if not arguments and _at_a_screen():
        arguments = ["serve", "--start", "--browser"]
    try:
        with (
            speaking("en" if "--json" in arguments else chosen(None)),
            asking(agreed if sys.stdin.isatty() else nobody),
        ):
            try:
                ended = app(args=[shielded(word) for word in arguments], prog_name="axiscal", standalone_mode=False)
            except TyperException as wrong:
                return _refused(wrong)
            except typer.Abort:
                complain(said("Nobody answered. Nothing that was recorded is lost; give the command again."))
                return 1
            except SystemExit as end:
                ended = end.code
            if ended == INTERRUPTED:
                raise KeyboardInterrupt
            return ended if isinstance(ended, int) else 0 if ended is None else 1
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
            f"A defect in {culprit(failure)}: {kind}: {failure}. Nothing that was recorded is lost. "
            "Please report it with the output that AXISCAL_TRACEBACK=1 gives."
        )
    return 1


def _at_a_screen() -> bool:
    """Return whether a person is there, and a display that a browser can use."""
    screen = sys.platform in ("win32", "darwin") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(screen) and sys.stdin.isatty() and sys.stdout.isatty()


def _refused(wrong: Any) -> int:
    """Say what is wrong with the command line, or show the help of a group without a command."""
    text = wrong.format_message()
    if "\n" in text:
        wrong.show()
    else:
        path = "axiscal" if wrong.ctx is None else wrong.ctx.command_path
        option = f"{path.rpartition(' ')[2]} {getattr(wrong, 'option_name', '')}"
        if instead := instead_of("options", option):
            text = said(_GONE, name=option, instead=instead)
        asked = _in_words(text).rstrip(".")
        complain(said("{wrong} See `{command} -h`", wrong=asked if asked[-1] == "?" else f"{asked}.", command=path))
    return int(wrong.exit_code)


def _in_words(text: str) -> str:
    """Return a sentence of typer in the language that is spoken."""
    for message in WORDS["usage"]:
        pattern = re.sub(r"\\\{(\w+)\\\}", r"(?P<\1>.+)", re.escape(message))
        if found := re.fullmatch(pattern, text):
            return said(message, **{name: _in_words(value) for name, value in found.groupdict().items()})
    return text


def shielded(word: str) -> str:
    """Return a word of the command line; a negative number gets a true minus, so that it is not taken for an option."""
    is_number = word[:1] == "-" and word[1:].lstrip()[:1] in tuple("0123456789.")
    return "−" + word[1:] if is_number else word
