"""Faults in whole commands: at every call that changes the disk, in every command that writes.

Whatever the fault was, the record holds what was acknowledged, results are a set, nothing is left that nobody needs,
and the same command given again does its work.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from unittest.mock import patch

from axiscal.cli.app import run
from axiscal.exceptions import RecordError
from axiscal.present import rendering
from benchmarks.reliability.faults import HOWS, Fault, Outcome, faults
from benchmarks.reliability.record_faults import events
from benchmarks.reliability.trial import Say, Trial, scratch
from tests.cli.test_results_are_a_set import FILES, differing
from tests.generators.texts import campaign_text, setup_text

WRONG = campaign_text(
    "machine.toml",
    *(
        setup_text(name, "interferometer", direction="x", moves=["X"], noise="0.2 um", drift="0")
        for name in ("one", "two")
    ),
    target={"readings": 99},
    usual="off",
    sure="exactly",
)
INPUTS = {**FILES, "wrong.toml": WRONG}
RECORD = "mill.axiscal"


@dataclass(frozen=True, slots=True)
class Command:
    """A command that writes, and how it is looked at.

    before : commands given before, without a fault
    again : the command that is given after a fault; the same where none is named
    out : the folder or file that it writes; manifest : of the set that it writes, if it is one
    """

    words: tuple[str, ...]
    before: tuple[tuple[str, ...], ...] = ()
    again: tuple[str, ...] = ()
    out: str = ""
    manifest: str = ""


def _words(text: str) -> tuple[str, ...]:
    return tuple(word.replace("_", " ") for word in text.split())


START, NEXT = _words(f"start campaign.toml {RECORD}"), _words(f"next {RECORD}")
TAKEN = _words(f"record {RECORD} 20_um")
BEGUN = (START, NEXT)
MEASURED = (START, NEXT, _words(f"record {RECORD} -20_um"), NEXT, TAKEN)
THREE = (*MEASURED, NEXT, TAKEN)
FINISH = _words(f"finish {RECORD} --out out")
EXPORT = _words(f"export {RECORD} --to linuxcnc --out out")
RUN = _words("run campaign.toml --source sim:3 --out out")
ESTIMATE = _words("estimate campaign.toml readings.csv --out out")
UNDONE = _words(f"undo {RECORD}")
CONTRADICTORY = (
    _words(f"start wrong.toml {RECORD}"),
    *(
        _words(f"record {RECORD} {sign * value}_um --setup {name} --at X={20 + 65 * i}_mm")
        for name, sign in (("one", 1), ("two", -1))
        for i, value in enumerate((4, 12, 18, 20, 15))
    ),
)
SET, TABLES = "manifest.json", "manifest-linuxcnc.json"

COMMANDS: Mapping[str, Command] = {
    "init": Command(
        _words("init out --machine three-axis-mill --instrument interferometer --target 20_um"), out="out/campaign.toml"
    ),
    "start": Command(START),
    "next": Command(NEXT, (START,)),
    "record": Command(TAKEN, BEGUN),
    "undo": Command(UNDONE, MEASURED),
    "accept": Command(_words(f"accept {RECORD} sign --setup two"), CONTRADICTORY),
    "note": Command(_words(f"note {RECORD} warm"), MEASURED),
    "copy": Command(_words(f"copy {RECORD} copy.axiscal"), MEASURED, out="copy.axiscal"),
    "finish": Command(FINISH, MEASURED, out="out", manifest=SET),
    "finish, over earlier results": Command(FINISH, (*MEASURED, FINISH, UNDONE, UNDONE), out="out", manifest=SET),
    "export": Command(EXPORT, MEASURED, out="out", manifest=TABLES),
    "export, over earlier tables": Command(EXPORT, (*THREE, EXPORT, UNDONE), out="out", manifest=TABLES),
    "run": Command(RUN, again=(*RUN, "--resume"), out="out", manifest=SET),
    "estimate": Command(ESTIMATE, out="out", manifest=SET),
    "report": Command(_words(f"report {RECORD} --out out/page.pdf"), MEASURED, out="out/page.pdf"),
    "plan, as programs": Command(_words("plan campaign.toml --gcode linuxcnc --out out"), out="out"),
    "verify": Command(_words(f"verify {RECORD} --points 5 --plan out.csv"), MEASURED, out="out.csv"),
}


def tried(name: str, every: int = 1, hows: Sequence[str] = HOWS) -> Trial:
    """Try one command at every fault, or at every so manieth.  hows : kinds of faults"""
    command = COMMANDS[name]

    def work(folder: Path, say: Say) -> None:
        say(f"status {_given(folder, command.words, folder.with_name('said.txt'))}")

    with scratch() as top, _temporary(top / "temporary"):
        before = top / "before"
        before.mkdir()
        for file, text in INPUTS.items():
            (before / file).parent.mkdir(exist_ok=True)
            (before / file).write_text(text)
        for words in command.before:
            if _apart(before, words) != 0:
                raise AssertionError(f"{words} could not be done")
        _warmed(before, top / "warm", command)
        good, wrong = _looked_at_after_success(before, top / "good", command), list[str]()
        count = 0
        for fault, outcome in faults(before, top / "now", work, every=every, hows=hows):
            count += 1
            found = _wrong(before, top / "now", command, fault, outcome, good)
            wrong += [f"{fault.how} at {fault.at}: {found}"] if found else []
    return Trial(f"faults in the command {name}", count, len(wrong), "; ".join(wrong[:5]))


def all_tried(every: int = 1) -> Trial:
    """Try all commands."""
    trials = [tried(name, every) for name in COMMANDS]
    wrong = [f"{trial.what}: {trial.detail}" for trial in trials if trial.lost]
    count, lost = sum(trial.tried for trial in trials), sum(trial.lost for trial in trials)
    return Trial(f"faults in {len(trials)} whole commands", count, lost, "; ".join(wrong[:5]))


@contextmanager
def _temporary(folder: Path) -> Iterator[None]:
    """Let temporary files be in this folder, which goes with the trial: a kill leaves them to the system."""
    folder.mkdir()
    before, tempfile.tempdir = tempfile.tempdir, str(folder)
    try:
        yield
    finally:
        tempfile.tempdir = before


def _given(folder: Path, words: Sequence[str], said: Path) -> int:
    """Give a command in a folder and return its status; what it says goes into a file."""
    handle = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    with os.fdopen(handle, "w") as file, redirect_stdout(file), redirect_stderr(file), chdir(folder):
        return run(words)


def _warmed(before: Path, folder: Path, command: Command) -> None:
    """Give the command once here, so that what it imports is imported for all that are forked.

    Paper is left out: typst keeps threads, which no fork takes over.
    """
    shutil.copytree(before, folder)
    with (
        patch.object(rendering, "pdf", return_value=b""),
        redirect_stdout(StringIO()),
        redirect_stderr(StringIO()),
        chdir(folder),
    ):
        run(command.words)


def _apart(folder: Path, words: Sequence[str]) -> int:
    """Give a command in a process of its own and return its status."""
    child = os.fork()
    if child == 0:
        os._exit(_given(folder, words, folder.with_name("said.txt")))
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _looked_at_after_success(before: Path, folder: Path, command: Command) -> Mapping[str, str]:
    shutil.copytree(before, folder)
    if _apart(folder, command.words) != 0:
        raise AssertionError(f"{command.words} could not be done: {folder.with_name('said.txt').read_text()}")
    return _names(folder)


def _names(folder: Path) -> Mapping[str, str]:
    """Return what is in a folder: of each file its name and kind."""
    return {path.relative_to(folder).as_posix(): "folder" if path.is_dir() else "file" for path in folder.rglob("*")}


def _wrong(
    before: Path, folder: Path, command: Command, fault: Fault, outcome: Outcome, good: Mapping[str, str]
) -> str:
    """Return what is wrong after a fault, "" if nothing is."""
    said = folder.with_name("said.txt").read_text(errors="replace")
    if any(line.startswith("raised") for line in outcome.said) or "Traceback" in said or "A defect in" in said:
        return f"no error of ours: {said[-300:]}{outcome.said}"
    if fault.how in ("full", "broken") and outcome.said == ("status 1",) and not said.strip():
        return "says nothing"
    done = outcome.said == ("status 0",)
    lost = _lost(before, folder, command, done)
    if lost:
        return lost
    if _apart(folder, command.words) != 0:
        text = folder.with_name("said.txt").read_text()
        resumed = bool(command.again) and "--resume" in text
        if resumed and _apart(folder, command.again) != 0:
            return f"cannot be gone on with: {folder.with_name('said.txt').read_text()[-300:]}"
        if not resumed and not _answered_already(text):
            return f"cannot be given again: {text[-300:]}"
    leases = {f".{RECORD}.writer", "out/.campaign.axiscal.writer"}  # of a process that died: goes with the next writer
    mine = {"out/campaign.axiscal", *leases}
    left = {name for name in _names(folder) if name not in good} - mine
    return f"leaves {sorted(left)}" if left else _unset(folder, command, done=True)


def _answered_already(said: str) -> bool:
    """Whether a command that was killed behind its work says that this has been done."""
    text = " ".join(said.split())
    return any(
        known in text for known in ("Ask for one with", "exists already", "finished", "holds a campaign already")
    )


def _lost(before: Path, folder: Path, command: Command, done: bool) -> str:
    """Return what is missing of what was acknowledged, or is half."""
    try:
        for path in folder.rglob("*.axiscal"):
            events(path)
    except RecordError as failure:
        return f"a record that cannot be opened: {failure}"
    for path in sorted(before.glob("*.axiscal")):
        earlier, now = events(path), events(folder / path.name)
        if now[: len(earlier)] != earlier:
            return f"events of {path.name} are missing"
    for file in INPUTS:
        if (folder / file).read_bytes() != (before / file).read_bytes():
            return f"{file} is another"
    return _unset(folder, command, done)


def _unset(folder: Path, command: Command, done: bool) -> str:
    """Return what is wrong with the results: missing after success, or a set that does not agree with its manifest."""
    out = folder / command.out
    if command.out and done and not out.exists():
        return f"{command.out} is missing"
    if not command.manifest or not out.exists():
        return ""
    if not (out / command.manifest).exists():
        others = [path.name for path in out.iterdir() if path.name != "campaign.axiscal" and path.name[0] != "."]
        return f"no manifest beside {others}" if others or done else ""
    bad = sorted(name for name in differing(out, command.manifest) if Path(name).name[0] != ".")
    return f"not as the manifest says: {bad}" if bad else ""
