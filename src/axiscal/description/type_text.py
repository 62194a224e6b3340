"""Knowledge from machines of one type: the text that a file and a record carry."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.exceptions import InputError, RecordError
from axiscal.machine import Machine, machine_from_text
from axiscal.numerics import Array

SCHEMA = "axiscal-type/1"


@dataclass(frozen=True, slots=True)
class Learned:
    """What was learnt of one error.

    scale, scale_std : how wrong its stated variance is, c; share, share_std : of the variance, common to all, ω
    """

    scale: float
    scale_std: float
    share: float
    share_std: float


@dataclass(frozen=True, slots=True)
class SisterRecord:
    """A record that was looked at.

    file : its name; digest : of what was read; readings : in it; left_out : why it does not count, "" where it does
    """

    file: str
    digest: str
    readings: int
    left_out: str = ""


@dataclass(frozen=True, eq=False)
class TypePrior:
    """What a type has taught.

    machine_text : the description over whose errors it stands; records : that were looked at, by their digests
    learned : by error; directions : in which sisters may differ together; doubt : that a machine is no sister
    mean : (n,); covariance : (n, n); own : (n, n) the part of it in which sisters differ, m or rad
    fine_knots : of that description, as in `Machine`; what was learnt before could not say it
    """

    machine_text: str
    records: tuple[SisterRecord, ...]
    learned: Mapping[str, Learned]
    directions: int
    doubt: float
    mean: Array
    covariance: Array
    own: Array
    fine_knots: bool = False

    @cached_property
    def machine(self) -> Machine:
        """The machine over whose errors it stands."""
        return machine_from_text(self.machine_text, fine_knots=self.fine_knots)

    @property
    def counted(self) -> tuple[SisterRecord, ...]:
        """The records that it was learnt from."""
        return tuple(record for record in self.records if not record.left_out)

    def text(self) -> str:
        """Return it as the JSON text that a file keeps and a record carries."""
        document = {
            "schema": SCHEMA,
            "machine": self.machine_text,
            "fine_knots": self.fine_knots,
            "records": [asdict(record) for record in self.records],
            "learned": {name: asdict(each) for name, each in self.learned.items()},
            "directions": self.directions,
            "doubt": self.doubt,
            "mean": self.mean.tolist(),
            "covariance": _packed(self.covariance),
            "own": _packed(self.own),
        }
        return json.dumps({**document, "digest": _digest(document)}, ensure_ascii=False, indent=1) + "\n"


def is_type_text(text: str) -> bool:
    """Return whether a record's prior is the text of a type, and not an earlier campaign."""
    return f'"{SCHEMA}"' in text[:200]


def type_prior(text: str) -> TypePrior:
    """Return what a type has taught from its text; raises RecordError where that is none."""
    try:
        document = json.loads(text)
        if document["schema"] != SCHEMA:
            raise ValueError(f"it is of the form {document['schema']!r}")
        if document.get("digest", _digest(document)) != _digest(document):  # what was learnt before has none
            raise ValueError("it has been changed since it was learnt, its digest does not fit")
        learned = {str(name): Learned(**fields) for name, fields in document["learned"].items()}
        records = tuple(SisterRecord(**fields) for fields in document["records"])
        mean = np.array(document["mean"], dtype=float)
        covariance, own = (_unpacked(document[name], len(mean)) for name in ("covariance", "own"))
        found = TypePrior(
            str(document["machine"]),
            records,
            learned,
            int(document["directions"]),
            float(document["doubt"]),
            mean,
            covariance,
            own,
            bool(document.get("fine_knots", False)),
        )
        _check(found)
    except (InputError, ValueError, KeyError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        what = "what the type has taught cannot be read: {reason}"
        raise RecordError(what, "Learn it anew with `axiscal shop type learn`", reason=error) from None
    return found


def _check(found: TypePrior) -> None:
    size = ErrorModel(found.machine).size
    if found.mean.shape != (size,) or not np.all(np.isfinite(found.mean)):
        raise ValueError(f"it has {found.mean.size} unknowns, and its machine {size}, all of them finite")
    for name, each in found.learned.items():
        spread = 0 <= each.scale_std < np.inf and 0 <= each.share_std < np.inf
        if not (0 < each.scale < np.inf and 0 <= each.share <= 1 and spread):
            raise ValueError(f"what was learnt of {name[:40]!r} is no size above zero and no share of 0 to 1")
    for record in found.records:
        words = (record.file, record.digest, record.left_out)
        if not all(isinstance(word, str) for word in words) or type(record.readings) is not int:
            raise ValueError("one of its records is no file with a digest and a count of readings")
    if not 0 < found.doubt < 1:
        raise ValueError(f"{found.doubt} is no doubt between 0 and 1")
    for name, matrix in (("covariance", found.covariance), ("own part", found.own)):
        scale = np.sqrt(np.maximum(np.diagonal(matrix), np.finfo(float).tiny))
        if not np.all(np.isfinite(matrix)) or np.linalg.eigvalsh(matrix / scale[:, None] / scale).min() < -1e-8:
            raise ValueError(f"its {name} is none")


def _digest(document: Mapping[str, Any]) -> str:
    """Return the SHA-256 of all that it says besides this."""
    said = {key: value for key, value in document.items() if key != "digest"}
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()


def _packed(matrix: Array) -> str:
    """Return the lower triangle, row by row, as base64 of little-endian doubles."""
    return base64.b64encode(matrix[np.tril_indices(len(matrix))].astype("<f8").tobytes()).decode()


def _unpacked(text: Any, size: int) -> Array:
    values = np.frombuffer(base64.b64decode(str(text), validate=True), dtype="<f8")
    if len(values) != size * (size + 1) // 2:
        raise ValueError(f"a triangle of {size} rows has {size * (size + 1) // 2} numbers, and here are {len(values)}")
    lower = np.zeros((size, size))
    lower[np.tril_indices(size)] = values
    return lower + np.tril(lower, -1).T
