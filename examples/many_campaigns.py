"""Which set-up pays: ways of measuring tried on the same virtual machines, into a table with a row for each case.

    python examples/many_campaigns.py dial.toml laser.toml --machines 20 --out cases.csv
    python examples/many_campaigns.py dial.toml laser.toml --machines 1000 --cluster tcp://head:8786

A case is a campaign file and the number of a virtual machine, which draws its errors. Cases are worked on by the
processors of this computer, or by a Dask cluster, whose workers need axiscal too. Given again after an end of any kind,
the command goes on behind the last whole row of the table.
"""

import argparse
import csv
import io
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

import axiscal as ac
from axiscal.campaign.ending import reaches
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation, expanded_uncertainty
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import InputError
from axiscal.measurement.reading import Place
from axiscal.measurement.simulation import VirtualMachine, by_number
from axiscal.numerics import Array
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed

Row = dict[str, object]
Key = dict[str, str]
KEYS = ("campaign", "described", "machine")
FIGURES = ("readings", "minutes", "U_um", "true_rms_um", "within_U", "reached", "error")
LOOK = 2.0
"""Seconds between two looks for workers that were lost."""


def planned(campaign: CampaignDescription) -> tuple[Place, ...] | InputError:
    """Return the places of a campaign's plan, the same for every machine, or why there is none."""
    case = case_of(campaign)
    try:
        return placed(case, proposed(case, Limits.of(campaign.target)))
    except InputError as wrong:
        return wrong


def outcome(campaign: CampaignDescription, places: Sequence[Place] | InputError, machine: int) -> Row:
    """Return what measuring one virtual machine comes to, or in words why it cannot be measured."""
    if isinstance(places, InputError):
        return {"error": " ".join(str(places).split())}
    case, truth = case_of(campaign), ac.Simulator(campaign.machine, campaign.setups).drawn(machine)
    ends = np.cumsum(case.seconds_along(None, places)).tolist()
    readings = truth.measured(campaign.setups, places, ends, by_number(machine))
    known = concluded(case, readings)
    size, U = np.linalg.norm(missed(known, truth), axis=1), expanded_uncertainty(known).space
    return {
        "readings": len(readings),
        "minutes": known.timed.seconds / 60,
        "U_um": 1e6 * U,
        "true_rms_um": 1e6 * float(np.sqrt(np.mean(size**2))),
        "within_U": float(np.mean(size <= U)),
        "reached": reaches(campaign.target, known),
    }


def missed(known: Estimation, truth: VirtualMachine) -> Array:
    """Return what the estimate misses of the deviation over the volume and is promised, (m, 3) m."""
    stick, found = known.case.yardstick, list[Array]()
    volume = stick.volume
    for side in (1.0, -1.0):
        ways = np.full_like(volume.inside, side)
        left = truth.deviation(volume.inside, ways) - known.estimate().deviation(volume.inside, ways)
        found.append(left if volume.alignment is None else volume.alignment.left(volume.inside, left))
    whole = np.concatenate(found)
    counted: Array = (whole - whole.mean(axis=0) * np.array(stick.zeroed)) * np.array(stick.counted)
    return counted


def cases(files: Sequence[Path], machines: int) -> list[tuple[CampaignDescription, Key]]:
    """Return the campaign and the key of each case: all machines of the first file, then of the next."""
    found = list[tuple[CampaignDescription, Key]]()
    for file, campaign in ((file, ac.read_campaign(file)) for file in files):
        described = sha256((campaign.text + campaign.machine.text + campaign.prior_text).encode()).hexdigest()[:12]
        keys = ({"campaign": file.name, "described": described, "machine": str(n)} for n in range(machines))
        found += [(campaign, key) for key in keys]
    return found


def measured(
    left: Sequence[tuple[CampaignDescription, Key]], workers: Executor, look: Callable[[], object]
) -> Iterator[Row]:
    """Yield the row of each case that is left, in their order.  look : called while one is waited for"""
    plans = {id(campaign): workers.submit(planned, campaign) for campaign, _ in left}
    places = {campaign: _waited(plan, look) for campaign, plan in plans.items()}
    each = [workers.submit(outcome, of, places[id(of)], int(key["machine"])) for of, key in left]
    for (_, key), future in zip(left, each, strict=True):
        yield {**key, **_waited(future, look)}


def _waited(future: Future[Any], look: Callable[[], object]) -> Any:
    """Return what comes of a future."""
    while True:
        try:
            return future.result(LOOK)
        except TimeoutError:
            look()


def lost(client: Any) -> Callable[[], None]:
    """Return what names on stderr the workers of a Dask cluster that were lost since it was last called."""
    there = set[str]()

    def look() -> None:
        now = set(client.scheduler_info(n_workers=-1)["workers"])
        for gone in sorted(there - now):
            what = "others take its cases" if now else "and none is left: start one"
            print(f"worker {gone} was lost, {what}", file=sys.stderr)
        there.clear()
        there.update(now)

    look()
    return look


def kept(out: Path) -> list[Row]:
    """Return the rows of an earlier run, and cut off what it wrote of the next one; ends where it is another table."""
    if not out.exists():
        return []
    whole = out.read_text(encoding="utf-8").rpartition("\n")[0]
    table = csv.DictReader(io.StringIO(whole))
    if whole and table.fieldnames != [*KEYS, *FIGURES]:
        sys.exit(f"{out} is another table. Name another file: --out FILE")
    out.write_text(f"{whole}\n" if whole else "", encoding="utf-8")
    return [dict(row) for row in table]


def compared(rows: Sequence[Row], figure: str) -> Iterator[str]:
    """Yield how a figure of each other file differs from the first's, machine by machine, ± two standard errors."""
    values = dict[object, dict[object, float]]()
    for row in rows:
        values.setdefault(row["campaign"], {})[row["machine"]] = float(str(row.get(figure, "nan")))
    first, *others = values
    for name in others:
        more = np.array([values[name][machine] - values[first][machine] for machine in values[first]])
        more = more[np.isfinite(more)]
        error = 2 * more.std(ddof=1) / np.sqrt(len(more)) if len(more) > 1 else np.inf
        yield f"{name} instead of {first}: {figure} {more.mean():+.2f} ± {error:.2f}"


def main(words: Sequence[str]) -> None:
    """Write the table, each row as soon as it is there, and print what the other files change."""
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--machines", type=int, default=20)
    parser.add_argument("--cluster")
    parser.add_argument("--out", type=Path, default=Path("cases.csv"))
    asked = parser.parse_args(words)
    every, before = cases(asked.files, asked.machines), kept(asked.out)
    done = {tuple(row[key] for key in KEYS): row for row in before}
    rows = [done[tuple(key.values())] for _, key in every if tuple(key.values()) in done]
    left = [case for case in every if tuple(case[1].values()) not in done]
    workers: Executor = ProcessPoolExecutor()
    look: Callable[[], object] = list  # nobody is looked after here
    if asked.cluster:
        from dask.distributed import Client  # pip install distributed

        client = Client(asked.cluster)
        workers, look = client.get_executor(), lost(client)
    with workers, asked.out.open("a", newline="", buffering=1, encoding="utf-8") as file:
        table = csv.DictWriter(file, [*KEYS, *FIGURES], lineterminator="\n")
        if not asked.out.stat().st_size:
            table.writeheader()
        for row in measured(left, workers, look):
            table.writerow(row)
            rows.append(row)
    print(*compared(rows, "minutes"), *compared(rows, "U_um"), sep="\n")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as wrong:
        sys.exit(str(wrong))
