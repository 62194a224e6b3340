"""Write build/fleet-printers.md: `python -m benchmarks.fleet`; what is done already is kept in build/fleet.jsonl."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.stats import ttest_1samp

from axiscal.errors.model import ErrorModel
from axiscal.ports.fleet.hierarchy import prior_units
from axiscal.ports.fleet.sister_records import equations_of, read_records
from axiscal.ports.fleet.type_learning import taught
from axiscal_core.threads import one_thread
from benchmarks.fleet.left_out import COUNTS, each_way
from benchmarks.fleet.printers import DATA, printers, types

_ASKED = 0.93
"""Share of the shape that is to be within its bands."""
ROOT = Path(__file__).resolve().parents[2]
PAGE, KEPT = ROOT / "build" / "fleet-printers.md", ROOT / "build" / "fleet.jsonl"
_HEAD = """# What sisters teach, in the field

Bed maps of printers of five types by as many owners; each machine is left out once, and its type is learnt from the
others: `python -m benchmarks.fleet` writes this page (the maps are not part of the project; it can be stopped, and goes
on where it was). Of each machine the median of its maps counts, at 7 × 7 nodes over the central 70 % of the bed, offset
and tilt taken off; readings stand at corners and centre, or on 3 × 3 or 4 × 4 of the nodes. One description serves all:
`EZX` and `EZY` of 50 um, `EZXY` of 25 um with a rest of 5 um, over 0.35 of the travel, two squarenesses for the tilt.
*stated* is that prior alone, *learnt* the same with sizes learnt, *type* what the sisters teach.
*Missed* is the RMS of truth less estimate over all nodes, um, the median over the machines. *Difference* is the mean
over the machines of the logarithm of missed by *type* over missed by the other, ± its standard error: below zero
the sisters help, and what is less than two of its errors above zero is no more than chance. *Held* is the share of the
unread nodes within the printed 95 %.
The form of the prior (three bands of scale for a curve, rests as stated) was settled with some of these maps in view,
so this is how well it serves them, not a test on maps that nobody had seen.

"""
_COLUMNS = "| type | machines | readings | missed: stated | learnt | type | difference to stated | to learnt | "
_COLUMNS += "held: stated | learnt | type | called strangers |\n|" + "---|" * 12


def _kept() -> dict[tuple[str, str], dict[str, Any]]:
    if not KEPT.exists():
        return {}
    rows = [json.loads(line) for line in KEPT.read_text(encoding="utf-8").splitlines()]
    return {(row["type"], row["machine"]): row for row in rows}


@one_thread()
def main() -> int:
    """Run; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", metavar="TYPE", help="one type; the page stays as it is")
    only = parser.parse_args().only
    if not DATA.exists():
        print(f"the maps are not in {DATA}", file=sys.stderr)
        return 1
    KEPT.parent.mkdir(exist_ok=True)
    for kind in types():
        if only in (None, kind):
            _measure(kind)
    rows = _kept()
    lines = [_line(kind, count, rows) for kind in types() for count in COUNTS if only in (None, kind)]
    print(table := "\n".join([_COLUMNS, *lines]))
    if only is None:
        PAGE.write_text(f"{_HEAD}{table}\n\n{_over_all(rows)}\n", encoding="utf-8")
    return 0


def _measure(kind: str) -> None:
    done, machines = _kept(), printers(kind)
    if all((kind, each.name) in done for each in machines):
        return
    with TemporaryDirectory() as folder:
        files = [each.write_record(Path(folder)) for each in machines]
        reference = machines[0].described().machine
        units = prior_units(ErrorModel(reference))
        records, equations = equations_of(read_records(files)[0], reference, units.root)
        digests = {record.file: record.digest for record in records}
        for machine, file in zip(machines, files, strict=True):
            if (kind, machine.name) in done:
                continue
            others = {digest: each for digest, each in equations.items() if digest != digests[file.name]}
            prior = taught(reference, units, tuple(records), others).text()
            found = {count: each_way(machine, prior, count) for count in COUNTS}
            ways = {str(count): {way: list(each) for way, each in of.items()} for count, of in found.items()}
            with KEPT.open("a", encoding="utf-8") as kept:
                kept.write(json.dumps({"type": kind, "machine": machine.name, "found": ways}) + "\n")
            print(kind, machine.name, ways, flush=True)


def _over_all(rows: dict[tuple[str, str], dict[str, Any]]) -> str:
    """Return what all machines say together, and where a type is worse than stated, or holds less than is asked for."""
    held, said, worse, short = list[float](), list[str](), list[str](), list[str]()
    for count in COUNTS:
        pairs = [(kind, row["found"][str(count)]) for (kind, _), row in rows.items()]
        held += [found["type"][1] for _, found in pairs]
        logs = {kind: [np.log(f["type"][0] / f["stated"][0]) for of, f in pairs if of == kind] for kind in types()}
        every = np.concatenate(list(logs.values()))
        said.append(f"{every.mean():+.3f} ± {every.std(ddof=1) / np.sqrt(len(every)):.3f} at {count} readings")
        for kind, each in logs.items():
            if np.mean(each) > 2 * np.std(each, ddof=1) / np.sqrt(len(each)):
                chance = ttest_1samp(each, 0.0).pvalue
                worse.append(
                    f"{kind} at {count} (of {len(each)} machines Student's t gives that a chance of {chance:.2f})"
                )
            shares = np.array([f["type"][1] for of, f in pairs if of == kind])
            if shares.mean() < _ASKED:
                error = 100 * shares.std(ddof=1) / np.sqrt(len(shares))
                short.append(f"{kind} at {count} ({100 * shares.mean():.1f} ± {error:.1f} %)")
    named = f"worse by two standard errors or more: {', '.join(worse)}" if worse else "worse nowhere by two"
    less = f"; less than 93 % in {', '.join(short)}" if short else ""
    return (
        f"Over all {len(rows)} machines the difference to *stated* is {'; '.join(said)}; {100 * np.mean(held):.1f} % "
        f"is held by *type*{less}. Of {len(COUNTS) * len(types())} rows it is {named}."
    )


def _line(kind: str, count: int, rows: dict[tuple[str, str], dict[str, Any]]) -> str:
    found = [row["found"][str(count)] for (of, _), row in rows.items() if of == kind]
    rms = {way: np.array([each[way][0] for each in found]) for way in ("stated", "learnt", "type")}
    held = {way: float(np.mean([each[way][1] for each in found])) for way in rms}
    strangers = sum(each["type"][2] < 0.5 for each in found)
    logs = [np.log(rms["type"] / rms[way]) for way in ("stated", "learnt")]
    said = [f"{each.mean():+.2f} ± {each.std(ddof=1) / np.sqrt(len(each)):.2f}" for each in logs]
    missed = " | ".join(f"{np.median(each):.1f}" for each in rms.values())
    held_said = " | ".join(f"{100 * each:.0f} %" for each in held.values())
    return f"| {kind} | {len(found)} | {count} | {missed} | {' | '.join(said)} | {held_said} | {strangers} |"


if __name__ == "__main__":
    sys.exit(main())
