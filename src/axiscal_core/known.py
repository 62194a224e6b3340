"""What is known of a machine: a normal of its unknowns, and figures of it.

>>> import numpy as np, axiscal_core as ac
>>> machine = ac.Machine([ac.Axis.linear("X", "x", (0, 0.5))], [ac.Error("EXX", "5 um", length="200 mm")])
>>> case = ac.Case(machine, [ac.Laser("laser", "X", type_b={}, approach="+")], usual="off", sure="exactly")
>>> places = ac.Places("laser", [[0.0], [0.25], [0.5]])
>>> known = case.estimate(ac.Readings(places, ["0 um", "4 um", "1 um"]))
>>> known["EXX"]([0.25]).mean.round(7)
array([2.8e-06])
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike

from axiscal_core.curve import Curve
from axiscal_core.model import Model, Table
from axiscal_core.normal import Normal
from axiscal_core.places import Places, Readings
from axiscal_core.plan import expanded
from axiscal_core.refusals import Array, InputError, finite, named, one, one_of, spread, whole
from axiscal_core.units import Poses


@dataclass(frozen=True, eq=False)
class Known:
    """What is known.

    mean : (size,) of the unknowns, as `names`; alone : (size, size) covariance without causes of type B
    moved : (size, c, d) by what one standard deviation of each of those moves the mean, in each draw of the sizes,
        times the root of the draw's probability; shares : (d,) these roots
    sizes : factors on what was stated; bad : readings that were taken out, by index
    z : of each other reading, how far it is from what the others expect
    readings : that made it, None where none did; again : what estimates these with others
    """

    case: Model
    mean: Array
    alone: Array
    moved: Array
    shares: Array
    sizes: Mapping[str, float] = field(default_factory=dict)
    bad: tuple[int, ...] = ()
    z: Mapping[int, float] = field(default_factory=dict)
    readings: Readings | None = None
    again: Callable[[Readings], Known] | None = None

    @classmethod
    def of(cls, case: Model, mean: ArrayLike, covariance: ArrayLike) -> Known:
        """Return what is known already.  mean : (size,); covariance : (size, size)"""
        one("Known.of", "case", case, Model, "Case(machine, instruments)")
        found = finite("Known.of", "mean", mean, (case.size,))
        wide = spread("Known.of", "covariance", covariance, case.size)
        return cls(case, found, wide, np.zeros((case.size, 0, 1)), np.ones(1))

    def save(self, path: str | Path) -> None:
        """Write what is known, and the readings, to a file: JSON, or arrays of numpy where it ends in .npz.

        The case is not in it: whoever loads it brings the same one.  raises OSError
        """
        file, parts = _file("Known.save", path), self._parts()
        if file.suffix == ".npz":
            np.savez(file, allow_pickle=False, **parts)
        else:
            file.write_text(json.dumps({name: part.tolist() for name, part in parts.items()}), encoding="utf-8")

    def _parts(self) -> dict[str, np.ndarray]:
        parts = {"mean": self.mean, "alone": self.alone, "moved": self.moved.swapaxes(0, 1), "shares": self.shares}
        lists = {"names": self.names, "sizes": self.sizes, "factors": self.sizes.values()}
        lists |= {"bad": self.bad, "other": self.z, "z": self.z.values()}
        parts |= {name: np.array([*each]) for name, each in lists.items()} | {"again": np.array(self.again is not None)}
        if (read := self.readings) is not None:
            parts |= {"instruments": np.array(read.places.instruments), "poses": read.places.poses}
            parts |= {"sides": read.places.sides, "values": read.values}
            parts |= {name: each for name, each in (("std", read.std), ("time", read.time)) if each is not None}
        return parts

    @classmethod
    def load(cls, path: str | Path, case: Model) -> Known:
        """Return what `save` wrote.  case : of which it is known"""
        file = _file("Known.load", path)
        one("Known.load", "case", case, Model, "Case(machine, instruments)")
        try:
            if file.suffix == ".npz":
                with np.load(file, allow_pickle=False) as kept:
                    parts = dict(kept)
            else:
                parts = {name: np.array(part) for name, part in json.loads(file.read_text(encoding="utf-8")).items()}
            if tuple(parts["names"].tolist()) != case.names:
                what = f"= {str(file)!r} is of another case"
                raise InputError("Known.load", "path", what, "Give the case that it is known of")
            return cls._of_parts(case, parts)
        except InputError:
            raise
        except (OSError, EOFError, BadZipFile, LookupError, AttributeError, TypeError, ValueError) as fault:
            what = f"= {str(file)!r} does not hold what is known ({type(fault).__name__}: {fault})"
            raise InputError("Known.load", "path", what, "Give a file that Known.save wrote") from None

    @classmethod
    def _of_parts(cls, case: Model, parts: dict[str, np.ndarray]) -> Known:
        found = cls.of(case, parts["mean"], parts["alone"])
        shares = finite("Known.load", "shares", parts["shares"], (None,))
        moved = parts["moved"].reshape(-1, case.size, len(shares)).swapaxes(0, 1)
        sizes = dict(zip(parts["sizes"].tolist(), parts["factors"].tolist(), strict=True))
        z = dict(zip(parts["other"].tolist(), parts["z"].tolist(), strict=True))
        found = replace(found, moved=moved, shares=shares, sizes=sizes, bad=tuple(parts["bad"].tolist()), z=z)
        if "values" not in parts:
            return found
        places = Places(parts["instruments"].tolist(), parts["poses"], parts["sides"])
        readings = Readings(case.checked(places, "Known.load"), parts["values"], parts.get("std"), parts.get("time"))
        estimate = cast("Any", case).estimate  # of a case, which is above this file
        again = (lambda more: estimate(readings + more)) if parts["again"] else None
        return replace(found, readings=readings, again=again)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the unknowns."""
        return self.case.names

    @property
    def covariance(self) -> Array:
        """C + Σ G b (G b)ᵀ of the unknowns, (size, size): causes of type B count."""
        flat = self.moved.reshape(self.case.size, -1)
        return np.asarray(self.alone + flat @ flat.T)

    @property
    def normal(self) -> Normal:
        """Mean and covariance."""
        return Normal(self.mean, self.covariance)

    @property
    def rms(self) -> float:
        """The RMS standard deviation of the tool point over the volume, m; `aligned`, less a motion of it all."""
        return float(np.sqrt(self.case.volume.value(self.normal.factor)))

    @property
    def U(self) -> float:  # noqa: N802 (the field's letter)
        """Expanded uncertainty, m: the RMS deviation after correction exceeds it in 5 % of machines."""
        root = self.case.volume.root
        return expanded(root @ self.covariance @ root.T)

    def sample(self, count: int, seed: int = 0) -> Array:
        """Return machines that fit the readings, (count, size)."""
        return self.normal.sample(whole("Known.sample", "count", count, 1), whole("Known.sample", "seed", seed, 0))

    def read(self, readings: Readings | Table) -> Known:
        """Return what is known after more readings: all estimated anew, after a belief alone by eq. 31-33."""
        readings = self.case.taken_from(readings, "Known.read")
        values = self.case.values(readings, "Known.read")
        if self.again is not None:
            return self.again(readings)
        n = self.case.numbers(readings, self.mean)
        noise = self.case.shared(n, n) + np.diag(n.noise**2) + n.type_b @ n.type_b.T
        found = Normal(self.mean, self.covariance).read(n.rows, values - n.shown + n.rows @ self.mean, noise)
        every = readings if self.readings is None else self.readings + readings
        return replace(Known.of(self.case, found.mean, found.covariance), readings=every)

    def deviation(self, poses: Poses = (), joint: bool = False, sides: Poses | None = None) -> Normal:
        """Return the deviation of the tool point, a normal (m, 3) with covariances (m, 3, 3), m.

        joint : of all poses at once instead, mean (3 m,) and covariance (3 m, 3 m)
        sides : (m, q), from where axes came
        Rests count as before any reading: what was learnt of a cell is not used elsewhere.
        """
        one("Known.deviation", "joint", joint, bool, "True or False")
        machine = self.case.machine
        at, came = machine.come(poses, sides, "Known.deviation")
        own = machine.rows_at(at, came)
        rows = np.concatenate([own, np.zeros((*own.shape[:2], self.case.size - machine.size))], axis=2)
        rests = np.array([term.rest for term in machine.terms])
        levers = machine.effects(machine.levers(at).transpose(2, 0, 1), came).transpose(2, 0, 1) * rests
        if not joint:
            covariances = rows @ self.covariance @ rows.swapaxes(1, 2) + levers @ levers.swapaxes(1, 2)
            return Normal(rows @ self.mean, covariances)
        found, cells = self.normal.through(rows.reshape(-1, self.case.size)), self.case.cells(at)
        for lever, cell in zip(levers.reshape(-1, len(rests)).T, cells.T, strict=True):
            same = np.repeat(np.repeat(cell[:, None] == cell, 3, axis=0), 3, axis=1)  # poses in one cell share its rest
            found = Normal(found.mean, found.covariance + same * np.outer(lever, lever))
        return found

    def __iter__(self) -> Iterator[str]:
        return (term.name for term in self.case.machine.curves)

    def __getitem__(self, name: str) -> Curve:
        """Return one error as a curve: `known["EXX"](positions)` is a normal; bases of one's own: `table`."""
        machine = self.case.machine
        named("Known", "name", name)
        if name not in machine.by_name and name in (part.name for part in machine.parts):
            raise InputError("Known", "name", f"= {name!r} is no curve along one axis", "See Known.table")
        term = machine.by_name[one_of("Known", "name", name, [*machine.by_name])]
        known = Normal(self.mean[term.columns], self.covariance[term.columns, term.columns])
        return Curve.of(term.spline, known, machine.axes[term.axis].of)

    def budget(self, figures: ArrayLike, caused: ArrayLike | None = None) -> dict[str, float]:
        """Return what each source adds to the standard uncertainty of a figure F u: a sum of squares.

        figures : F (size,)
        caused : f (c,) what one standard deviation of each cause of type B does to the figure itself
        """
        rows = finite("Known.budget", "figures", figures, (self.case.size,))
        causes = self.case.causes
        own = np.zeros(len(causes)) if caused is None else finite("Known.budget", "caused", caused, (len(causes),))
        lines = {"readings and model": float(np.sqrt(rows @ self.alone @ rows))}
        moved = np.einsum("i,icd->cd", rows, self.moved)
        for name, each, f in zip(causes, moved, own, strict=False):
            lines[name] = float(np.linalg.norm(each - f * self.shares))
        return lines

    def table(self) -> dict[str, list[object]]:
        """Return the unknowns as columns: `pandas.DataFrame(known.table())`."""
        return {"name": [*self.names], "mean": self.mean.tolist(), "std": self.normal.std.tolist()}

    def __repr__(self) -> str:
        out = f", {len(self.bad)} readings taken out" if self.bad else ""
        return f"<Known: {self.rms:.3g} m RMS over the volume{out}>"


def _file(function: str, path: str | Path) -> Path:
    """Return a path that says by its ending how it is written."""
    file = Path(one(function, "path", path, (str, Path), '"known.json", or "known.npz"'))
    one_of(function, "path", file.suffix, (".json", ".npz"))
    return file
