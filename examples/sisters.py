"""A prior from the records of other machines of the same type: how large their errors are, and what they share.

    python examples/sisters.py records/*.axiscal

Sister i has errors z_i = m + d_i, in units of the stated prior: m ~ N(0, c w I) is common, d_i ~ N(0, c (1 - w) I)
is its own. The records weigh each variance c and share w on a grid; the next machine is one more z.
Describe your machine and instrument in `slide`, as they are in campaign.toml.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import axiscal_core as ac
from axiscal import Campaign

Array = NDArray[np.float64]
SIZES, SHARES = np.geomspace(0.06, 4.0, 16), np.linspace(0.05, 0.95, 10)
READINGS = 4


def slide() -> ac.Case:
    """Return the machine with its stated errors, and the laser on it."""
    errors = [ac.Error("EXX", "20 um", knots=7, rest=0.0, scale=0.0), ac.Error("EXX_reversal", "6 um")]
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, "500 mm"))], errors)
    laser = ac.Laser("laser", "X", noise="0.5 um", unknowns={"zero": "100 um"}, approach="both")
    return ac.Case(machine, [laser], usual="off", sure="exactly")


def read(case: ac.Case, record: Path) -> ac.Readings:
    """Return the readings of a record, metres."""
    with Campaign.open(record, write=False) as campaign:
        taken = campaign.state.readings
    table: dict[str, list[object]] = {"instrument": [each.setup for each in taken], "length": [r.value for r in taken]}
    for k, axis in enumerate(case.machine.axis_names):
        table |= {axis: [each.pose[k] for each in taken], f"{axis}_side": [each.approach[k] for each in taken]}
    return case.readings(table)


class Sisters(NamedTuple):
    """size : factor on the stated std; share : of the variance in common; mean : (n,) m; covariance : (n, n) m²"""

    size: float
    share: float
    mean: Array
    covariance: Array


def learnt(case: ac.Case, sisters: Sequence[ac.Readings]) -> Sisters:
    """Return what sisters' readings teach of the next machine's errors, set-ups' unknowns integrated out."""
    n = case.machine.size
    root = np.linalg.cholesky(case.prior.covariance[:n, :n])  # of the stated prior: the unit of z
    rows, pull = np.zeros((len(sisters) + 1, n, n)), np.zeros((len(sisters) + 1, n))  # the last one: nothing read yet
    for i, readings in enumerate(sisters):
        after = case.estimate(readings).normal
        inverse = np.linalg.inv(np.linalg.solve(root, np.linalg.solve(root, after.covariance[:n, :n]).T))
        rows[i], pull[i] = inverse - np.eye(n), inverse @ np.linalg.solve(root, after.mean[:n])
    tried = [(*_weighed(c, w, rows, pull), c, w) for c in SIZES for w in SHARES]
    weights = np.exp([each[0] - max(other[0] for other in tried) for each in tried])
    weights /= weights.sum()
    means, covariances = (np.array([each[k] for each in tried]) for k in (1, 2))
    mean: Array = weights @ means
    wide = np.tensordot(weights, covariances, 1) + (means - mean).T @ ((means - mean) * weights[:, None])
    size, share = (float(weights @ [each[k] for each in tried]) for k in (3, 4))
    return Sisters(size**0.5, share, root @ mean, root @ wide @ root.T)


def _weighed(c: float, w: float, rows: Array, pull: Array) -> tuple[float, Array, Array]:
    """Return log p(readings | c, w), and mean and covariance of the last machine, in units of the stated prior."""
    count, n = pull.shape
    common = np.linalg.cholesky(c * (w * np.ones((count, count)) + (1 - w) * np.eye(count)))
    told = np.einsum("ik,iab,il->kalb", common, rows, common).reshape(count * n, count * n) + np.eye(count * n)
    inverse, drawn = np.linalg.inv(told), np.einsum("ik,ia->ka", common, pull).ravel()
    last = np.kron(common[-1], np.eye(n))
    evidence = 0.5 * float(drawn @ inverse @ drawn) - 0.5 * float(np.linalg.slogdet(told)[1])
    return evidence, last @ inverse @ drawn, last @ inverse @ last.T


def main(records: Sequence[str]) -> None:
    """Print what the records teach, and what the same readings leave with it and without."""
    case = slide()
    found = learnt(case, [read(case, Path(record)) for record in records])
    mean, covariance, n = case.prior.mean.copy(), case.prior.covariance.copy(), case.machine.size
    mean[:n], covariance[:n, :n] = found.mean, found.covariance
    stated, prior = case.known(case.prior.mean, case.prior.covariance), case.known(mean, covariance)
    after = [1e6 * case.plan(READINGS, after=known).rms for known in (stated, prior)]
    print(
        f"{len(records)} sisters: {found.size:.2f} times the stated size, {found.share:.2f} of the variance in common"
    )
    print(f"before any reading: {1e6 * stated.rms:.2f} um as stated, {1e6 * prior.rms:.2f} um")
    print(f"after {READINGS} readings: {after[0]:.2f} um as stated, {after[1]:.2f} um")


if __name__ == "__main__":
    main(sys.argv[1:])
