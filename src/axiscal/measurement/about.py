"""Where readings are linearised: about the machine that is believed, instead of about the nominal one.

    e_i(x) = f_i(x) − h_i x,    y_i ← y_i − e_i(x)                                                (chord iteration)

f_i what the instrument would show by the exact chain where errors and unknowns are x, h_i the row of the reading. With
rows at the nominal machine the rounds converge by the largest rotation, about 1e-3 each; where that is not enough the
rows are taken at x as well (Gauss-Newton; Bell and Cathey 1993).
"""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class About:
    """point : (k,) errors of the machine, then unknowns of the set-ups; bent : rows are those of the machine there"""

    point: Array
    bent: bool = False
